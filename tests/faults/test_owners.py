"""Several owners: the renders, requests and names of one owner do not affect the others.

Long: each way in which one owner could reach another has its test.
"""

import asyncio
import hashlib
import json
import time
from collections.abc import AsyncIterator
from pathlib import Path

import grpc
import httpx
import pytest
from nocturne.v1 import asset_service_pb2, asset_service_pb2_grpc, render_service_pb2_grpc
from nocturne.v1 import render_service_pb2 as pb
from nocturne_api import limits as limits_of_api
from nocturne_api.compiling.turns import CompileTurns
from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership

from tests.coordinator.schema import columns_by_table
from tests.coordinator.world import World
from tests.faults.owners import Guarded, guarded, metadata, next_of, request
from tests.services.conftest import SCENE
from tests.services.test_leaving import compiles, slow
from tests.services.webhook_receiver import until_true

MANY = 3000
# The quickest counts: the machine may do other things besides.
_TRIES = 5


@pytest.fixture
async def service(tmp_path: Path) -> AsyncIterator[Guarded]:
    async with guarded(tmp_path) as service:
        yield service


@pytest.fixture
async def alice(service: Guarded) -> AsyncIterator[httpx.AsyncClient]:
    async with service.rest(service.token("alice", "submit")) as client:
        yield client


@pytest.fixture
async def bob(service: Guarded) -> AsyncIterator[httpx.AsyncClient]:
    async with service.rest(service.token("bob", "submit")) as client:
        yield client


# --- admission ---


def create(world: World, owner: str, weight: int = 100, priority: int = 100, samples: int = 60) -> str:
    render = world.create(samples)
    world.store.change(render, owner=owner, owner_weight=weight, priority=priority)
    return render


def running(world: World) -> list[str]:
    """Owners of the renders at work, sorted."""
    return sorted(
        each.row.owner for each in world.store.stored.values() if each.row.state is RenderState.RUNNING
    )


def test_who_has_none_at_work_does_not_wait_for_others() -> None:
    """P7: one owner has queued many; each other one's first render starts at once, and ends."""
    world = World()
    for _ in range(40):
        create(world, "hog", priority=limits.MAX_PRIORITY, samples=4000)
    world.start()
    world.worker()
    world.run_until(lambda: len(running(world)) == limits.MAX_RUNNING)
    first, second, other = create(world, "alice"), create(world, "alice"), create(world, "bob")
    world.run_until(lambda: running(world) == ["alice", "bob"] + ["hog"] * limits.MAX_RUNNING)
    assert world.row(second).state is RenderState.QUEUED
    world.run_until(lambda: all(world.row(each).state.ended for each in (first, second, other)))
    assert "hog" in running(world)


NUMBERS = 34 * 3 * 9
"""That the sums of a small film hold."""


def test_a_film_as_large_as_all_memory_leaves_room_for_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """P16: others start at once; a second one that is too large waits for the first."""
    monkeypatch.setattr(limits, "MAX_RUNNING_SUMS", 4 * NUMBERS)
    world = World()
    large, too = (world.create(10**6, width=340, height=10) for _ in range(2))
    world.store.change(large, owner="alice")
    world.store.change(too, owner="carol")
    world.start()
    world.run_until(lambda: running(world) == ["alice"])
    world.worker()
    others = [create(world, owner) for owner in ("alice", "bob", "carol")]
    world.run_until(lambda: all(world.row(each).state is RenderState.SUCCEEDED for each in others))
    assert (world.row(large).state, world.row(too).state) == (RenderState.RUNNING, RenderState.QUEUED)
    world.store.requests.cancel(large)
    world.run_until(lambda: running(world) == ["carol"])


def test_nobody_holds_more_than_half_of_what_others_leave(monkeypatch: pytest.MonkeyPatch) -> None:
    """P16: 4 of 8 films' memory, then 2, then 1, and all have one at work; then the next owner waits."""
    monkeypatch.setattr(limits, "MAX_RUNNING_SUMS", 4 * NUMBERS)
    world = World()
    owners = ("alice", "bob", "carol")
    for owner in owners:
        for _ in range(6):
            create(world, owner, samples=10**6)
        if not world.coordinators:
            world.start()
        world.run(2.0)
    assert running(world) == ["alice"] * 4 + ["bob"] * 2 + ["carol"]


def test_a_film_that_memory_can_never_hold_is_refused_by_a_sentence() -> None:
    """P16: taken up, it would end the coordinator again and again."""
    world = World(settings=Settings(memory_bytes=4 * 2**30))
    large, other = world.create(10, width=8192, height=8192), create(world, "bob")
    world.start()
    world.worker()
    world.run_until(lambda: world.row(large).state.ended and world.row(other).state.ended)
    assert (world.row(large).state, world.row(other).state) == (RenderState.FAILED, RenderState.SUCCEEDED)
    assert world.store.renders.get(large).reason.startswith(
        "A film of 8192 x 8192 needs 16.5 GiB of memory where "
    )


def test_with_little_memory_fewer_films_are_at_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """P16: of two fifths of it one owner has half, here four films."""
    monkeypatch.setattr(limits, "MEMORY_BESIDE", 0)
    memory = round(2 * 4 * NUMBERS * 8 / limits.SUMS_PART_OF_MEMORY) + 8
    world = World(settings=Settings(memory_bytes=memory))
    for _ in range(6):
        create(world, "alice", samples=10**6)
    world.start()
    world.run(2.0)
    assert running(world) == ["alice"] * 4


def test_newcomers_are_bounded_too() -> None:
    """P7: however many owners there are, only so many renders are at work."""
    world = World()
    for number in range(40):
        create(world, f"owner {number}", samples=4000)
    world.start()
    world.run(3.0)
    assert len(running(world)) == limits.MAX_RUNNING + limits.MAX_NEWCOMERS


def test_places_are_shared_by_weight() -> None:
    """P7: of two owners with many renders, one of three times the weight has three times as many at work."""
    world = World()
    for _ in range(20):
        create(world, "light", samples=4000)
        create(world, "heavy", weight=300, samples=4000)
    world.start()
    world.run(1.0)
    assert running(world) == ["heavy"] * 6 + ["light"] * 2


def test_an_owners_renders_go_by_priority() -> None:
    """P7: between the owner's own renders nothing has changed."""
    world = World()
    made = [create(world, "alice", priority=number + 1, samples=4000) for number in range(12)]
    world.start()
    world.run(1.0)
    assert [world.row(each).state.value for each in made] == ["QUEUED"] * 4 + ["RUNNING"] * 8


# --- many renders ---


def queue_many(folder: DataFolder, owner: str, count: int) -> None:
    """As if the owner had asked for its newest render so many times."""
    columns = [name for name in columns_by_table()["render"] if name != "number"]
    own = {"id": "'r-' || n", "request_id": "'q-' || n"}
    values = ", ".join(own.get(name, name) for name in columns)
    with folder.database.transaction():
        folder.database.execute(
            f"""WITH RECURSIVE counting (n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM counting WHERE n < ?)
                INSERT INTO render ({", ".join(columns)}) SELECT {values} FROM counting,
                (SELECT * FROM render WHERE owner = ? ORDER BY number DESC LIMIT 1) AS newest""",  # noqa: S608
            (count, owner),
        )


async def test_whose_scene_compiles_at_once_waits_for_nobodys(
    alice: httpx.AsyncClient, bob: httpx.AsyncClient
) -> None:
    """P7: one owner's scenes take minutes to be compiled, as many as may be compiled at once and more."""
    slowly = [request(f"slow-{number}", scene=slow(SCENE, number)) for number in range(6)]
    waiting = [asyncio.create_task(alice.post("/v1/renders", json=each)) for each in slowly]
    try:
        await until_true(lambda: compiles() >= limits_of_api.COMPILES_AT_ONCE, 10.0)
        begun = time.monotonic()
        answer = await bob.post("/v1/renders", json=request("quick"))
        assert answer.status_code == 201
        assert time.monotonic() - begun < 3.0
        assert not any(each.done() for each in waiting)
        assert compiles() == limits_of_api.COMPILES_AT_ONCE
    finally:
        for each in waiting:
            each.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)


async def test_turns_of_compilers() -> None:
    """P7: of one owner two at once; next to them one of each other owner, up to four; then who has fewest."""
    turns, at_work, may_end = CompileTurns(), [], asyncio.Event()

    async def compiling(owner: str) -> None:
        async with turns.turn(owner):
            at_work.append(owner)
            await may_end.wait()

    tasks = [asyncio.create_task(compiling(owner)) for owner in "aaabbcdef"]
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert at_work == [*"aabcde"]
    # One that waits and one that works are called off.
    tasks[2].cancel()
    tasks[0].cancel()
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert at_work == [*"aabcdef"]
    may_end.set()
    await asyncio.gather(*tasks, return_exceptions=True)
    assert at_work == [*"aabcdefb"]


async def test_a_list_of_ten_thousand_is_answered_at_once(
    service: Guarded, alice: httpx.AsyncClient, bob: httpx.AsyncClient
) -> None:
    """P7: a page of them, another owner's page, and what the coordinator reads of them, in 0.2 s each of
    processor time."""
    assert (await alice.post("/v1/renders", json=request("a"))).status_code == 201
    assert (await bob.post("/v1/renders", json=request("b"))).status_code == 201
    queue_many(service.folder, "alice", 10_000)
    # Lists do not read through documents, which may have meshes in them.
    service.folder.database.execute(
        "UPDATE render SET scene_document = ? WHERE number % 50 = 0 OR number > 9800", ("00" * 100_000,)
    )
    for client, count in ((alice, 200), (bob, 1)):
        took = []
        for _ in range(_TRIES):
            begun = time.process_time()
            answer = await client.get("/v1/renders?page_size=200")
            took.append(time.process_time() - begun)
            assert len(answer.json()["renders"]) == count
        assert min(took) < 0.2
    ownership = Ownership(service.folder.root, service.folder.database)
    ledger = Ledger(service.folder.database, ownership)
    took = []
    for _ in range(_TRIES):
        begun = time.process_time()
        found = ledger.renders.all()
        took.append(time.process_time() - begun)
    assert min(took) < 0.2
    assert [each.owner for each in found].count("alice") == limits.MAX_NEXT_OF_OWNER
    assert [each.owner for each in found].count("bob") == 1
    ownership.release()


# --- quotas ---


async def test_open_renders_are_bounded_by_owner(tmp_path: Path) -> None:
    """P7: 429 with Retry-After, RESOURCE_EXHAUSTED with the same. Another owner goes on, and so does this one
    when a render has ended."""
    async with guarded(tmp_path, owner_open_renders=2) as service:
        token = service.token("alice", "submit")
        async with service.rest(token) as alice, service.rest(service.token("bob", "submit")) as bob:
            made = [(await alice.post("/v1/renders", json=request(name))).json()["id"] for name in "ab"]
            refused = await alice.post("/v1/renders", json=request("c"))
            assert (refused.status_code, refused.json()["reason"]) == (429, "QUOTA")
            assert int(refused.headers["retry-after"]) > 0
            assert "alice would have 3 open renders, and may have 2: wait until" in refused.json()["detail"]
            # The same request again is no render more.
            assert (await alice.post("/v1/renders", json=request("a"))).json()["id"] == made[0]
            async with service.grpc() as channel:
                stub = render_service_pb2_grpc.RenderServiceStub(channel)
                service.folder.database.execute(
                    "INSERT INTO tile (render_id, tile_index, samples, sums) VALUES (?, 0, 4, ?)",
                    (made[0], b"\x00"),
                )
                with pytest.raises(grpc.aio.AioRpcError) as caught:
                    await stub.ReplayRender(
                        pb.ReplayRenderRequest(id=made[0], request_id="r"), metadata=metadata(token)
                    )
                assert caught.value.code() == grpc.StatusCode.RESOURCE_EXHAUSTED
                assert ("retry-after", "60") in tuple(caught.value.trailing_metadata() or ())
            assert (await bob.post("/v1/renders", json=request("a"))).status_code == 201
            assert (await alice.post(f"/v1/renders/{made[0]}:cancel")).status_code == 200
            assert (await alice.post("/v1/renders", json=request("c"))).status_code == 201
            # A cancelled render can't come back by an extension.
            again = await alice.post(f"/v1/renders/{made[0]}:extend", json={"samples": 32})
            assert (again.status_code, again.json()["reason"]) == (429, "QUOTA")
            assert (await alice.get(f"/v1/renders/{made[0]}")).json()["state"] == "CANCELLED"


async def test_samples_are_bounded_by_owner(tmp_path: Path) -> None:
    """P7: all open renders together, and their extensions."""
    async with guarded(tmp_path, owner_open_samples=40 * 30 * 100) as service:
        token = service.token("alice", "submit")
        async with service.rest(token) as alice:
            made = await alice.post("/v1/renders", json=request("a", samples=60))
            assert made.status_code == 201
            assert (await alice.post("/v1/renders", json=request("b", samples=60))).status_code == 429
            longer = f"/v1/renders/{made.json()['id']}:extend"
            refused = await alice.post(longer, json={"samples": 120})
            assert "144,000 open samples, and may have 120,000" in refused.json()["detail"]
            assert (await alice.post(longer, json={"samples": 100})).status_code == 200


async def test_bytes_are_bounded_by_owner(tmp_path: Path) -> None:
    """P7: uploads and what renders take; a refused upload is not counted, a deleted file neither."""
    async with guarded(tmp_path, owner_stored_bytes=350_000) as service:
        token = service.token("alice", "submit")
        async with service.rest(token) as alice, service.rest(service.token("bob", "submit")) as bob:
            data = [bytes([number]) * 130_000 for number in range(3)]
            paths = [f"/v1/assets/{hashlib.sha256(each).hexdigest()}" for each in data]
            for path, content in zip(paths[:2], data[:2], strict=True):
                assert (await alice.put(path, content=content)).status_code == 200
            refused = await alice.put(paths[2], content=data[2])
            assert (refused.status_code, refused.json()["reason"]) == (429, "QUOTA")
            assert "390,000 stored bytes, and may have 350,000: delete renders" in refused.json()["detail"]
            assert (await alice.head(paths[2])).status_code == 404
            async with service.grpc() as channel:
                stub = asset_service_pb2_grpc.AssetServiceStub(channel)
                sha256 = paths[2].rpartition("/")[2]
                about = asset_service_pb2.Asset(sha256=sha256, size_bytes=len(data[2]))
                with pytest.raises(grpc.aio.AioRpcError) as caught:
                    await stub.Upload(
                        iter([asset_service_pb2.UploadRequest(asset=about)]), metadata=metadata(token)
                    )
            assert caught.value.code() == grpc.StatusCode.RESOURCE_EXHAUSTED
            # A film of 40 x 30 takes 196 KB when it is done.
            assert (await alice.post("/v1/renders", json=request("a"))).status_code == 429
            assert (await bob.put(paths[2], content=data[2])).status_code == 200
            # An upload of other bytes than were said fails, and counts nothing.
            for _ in range(3):
                assert (await bob.put(paths[0][:-1] + "0", content=data[0])).status_code == 422
            assert (await bob.post("/v1/renders", json=request("a"))).status_code == 201


# --- names ---


async def test_request_ids_are_the_owners_own(alice: httpx.AsyncClient, bob: httpx.AsyncClient) -> None:
    """P12: the same id of two owners makes two renders; of one owner, one."""
    first = (await alice.post("/v1/renders", json=request("night", name="alice's secret"))).json()
    other = await bob.post("/v1/renders", json=request("night", name="another"))
    assert (other.status_code, other.json()["owner"], other.json()["name"]) == (201, "bob", "another")
    assert other.json()["id"] != first["id"]
    again = await alice.post("/v1/renders", json=request("night", name="alice's secret"))
    assert again.json()["id"] == first["id"]
    assert (await alice.post("/v1/renders", json=request("night", name="b"))).status_code == 409


_DESCRIBED = json.loads((Path(__file__).parents[2] / "docs" / "reference" / "openapi.json").read_text())
_ROUTES_OF_A_RENDER = [
    (method, route)
    for route, methods in _DESCRIBED["paths"].items()
    for method in methods
    if "{render_id}" in route
]
_BODIES: dict[tuple[str, str], object] = {
    ("post", ":extend"): {"samples": 32},
    ("post", ":setPriority"): {"priority": 1},
    ("post", ":replay"): {"request_id": "x"},
    ("post", ":lookFirst"): {},
    ("post", ":setTags"): {"tags": []},
    ("post", ":measure"): {},
    ("put", "/regions"): {"regions": []},
}
"""Of calls that must have one."""


async def test_others_renders_are_read_by_a_role_only(
    service: Guarded, alice: httpx.AsyncClient, bob: httpx.AsyncClient
) -> None:
    """P12: a caller without the right gets the same answer as for a render that does not exist."""
    render = (await alice.post("/v1/renders", json=request("a"))).json()["id"]
    reader = service.rest(service.token("reader", "read"))
    both = service.rest(service.token("both", "submit", "read"))
    async with reader, both:
        path = f"/v1/renders/{render}"
        assert len(_ROUTES_OF_A_RENDER) > 20
        for method, route in _ROUTES_OF_A_RENDER:
            body = _BODIES.get((method, route.removeprefix("/v1/renders/{render_id}")))
            told = await bob.request(method, route.format(render_id=render), json=body)
            assert (told.status_code, told.json()["reason"]) == (404, "NOT_FOUND"), (method, route)
        assert (await bob.get(f"/v1/events?render={render}")).status_code == 404
        nowhere = (await bob.get(f"/v1/renders/{'r-' + 12 * 'a'}")).json()["detail"]
        assert (await bob.get(path)).json()["detail"] == nowhere.replace("r-aaaaaaaaaaaa", render)
        assert (await bob.get("/v1/renders")).json()["renders"] == []
        for client in (alice, reader, both):
            assert (await client.get(path)).json()["id"] == render
            assert [each["id"] for each in (await client.get("/v1/renders")).json()["renders"]] == [render]
        # To see is not to change.
        for client in (reader, both):
            assert (await client.post(f"{path}:cancel")).json()["reason"] == "FORBIDDEN"


async def test_an_ambiguous_beginning_names_only_ones_own(
    alice: httpx.AsyncClient, bob: httpx.AsyncClient
) -> None:
    """P12: nor does a beginning that is unique among one's own become ambiguous by others'."""
    of_alice = [(await alice.post("/v1/renders", json=request(name))).json()["id"] for name in "ab"]
    of_bob = (await bob.post("/v1/renders", json=request("a"))).json()["id"]
    told = (await alice.get("/v1/renders/r-")).json()
    assert told["reason"] == "AMBIGUOUS_ID"
    assert all(each in told["detail"] for each in of_alice)
    assert of_bob not in told["detail"]
    assert (await bob.get("/v1/renders/r-")).json()["id"] == of_bob


async def test_a_stream_shows_ones_own(service: Guarded, alice: httpx.AsyncClient) -> None:
    """P12: at the same time as a stream of a user who sees all, fed by the same poller, and full of others'
    renders."""
    token = service.token("carol", "submit")
    assert (await alice.post("/v1/renders", json=request("a"))).status_code == 201
    queue_many(service.folder, "alice", MANY)
    async with service.grpc() as channel, service.rest(token) as carol:
        stub = render_service_pb2_grpc.RenderServiceStub(channel)
        everything = pb.WatchRendersRequest()
        reads_all = stub.WatchRenders(everything, metadata=metadata(service.token("reader", "read")))
        assert (await next_of(reads_all)).owner == "alice"
        own = stub.WatchRenders(everything, metadata=metadata(token))
        made = (await carol.post("/v1/renders", json=request("c"))).json()["id"]
        assert (await next_of(own)).id == made
        assert (await carol.post(f"/v1/renders/{made}:pause")).status_code == 200
        assert (await next_of(own)).id == made
        own.cancel()
        reads_all.cancel()
