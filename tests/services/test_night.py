"""What keeps a night going, at both endpoints and the command line: conditions, pauses, extensions, tokens,
reasons."""

import copy
import json
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import asset_service_pb2, asset_service_pb2_grpc, job_pb2, render_service_pb2_grpc
from nocturne.v1 import render_service_pb2 as pb
from nocturne_api.access import Pace, secret_in
from nocturne_api.addresses import AddressError, check_host
from nocturne_api.compiling.pool import CompileLimits, compile_in_child
from nocturne_api.errors import TooMany, Unauthenticated
from nocturne_api.limits import CALLS_AT_ONCE, CALLS_PER_SECOND
from nocturne_api.operations.status_reason import Situation, sentence
from nocturne_api.service import Service, Settings, open_service
from nocturne_client import Client
from nocturne_client.cli.app import app
from nocturne_client.cli.stops import Stops, with_zone
from nocturne_coordinator.dispatch.records import RenderState, WorkerRow
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from prometheus_client.parser import text_string_to_metric_families
from typer.testing import CliRunner

from tests.services import coordinator_acts
from tests.services.endpoints import grpc_channel, rest_client

Stub = render_service_pb2_grpc.RenderServiceStub

_ENGINE = int(job_pb2.ENGINE_CURRENT)
_WORKER = WorkerRow("w", _ENGINE, 4, 0, 0, 0.0, 0, 0.0, 0.0)
STOP: dict[str, Any] = {
    "relative_error": 0.01,
    "tile_relative_error": 0.05,
    "wall_seconds": 60.0,
    "cpu_seconds": 3600.0,
}


async def test_stop_conditions_come_back_at_both_endpoints(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    stop = {**STOP, "until": "07:00 Europe/Berlin"}
    answer = await rest.post("/v1/renders", json={**body, "stop": stop, "priority": 300})
    assert answer.status_code == 201, answer.text
    render = answer.json()
    assert {name: render["stop"][name] for name in stop} == stop
    assert 0 < render["stop"]["until_time"] - time.time() <= 86400 + 3600
    assert render["priority"] == 300
    message = await Stub(channel).GetRender(pb.GetRenderRequest(id=render["id"]))
    assert {name: getattr(message.stop, name) for name in stop} == stop
    # The same words are the same request, whenever they are repeated, at either endpoint.
    again = await Stub(channel).CreateRender(
        pb.CreateRenderRequest(
            scene_json=json.dumps(body["scene"]),
            stop=pb.StopConditions(**stop),
            priority=300,
            **{name: body[name] for name in ("request_id", "name", "width", "height", "samples")},
        )
    )
    assert again.id == render["id"]
    other = await rest.post("/v1/renders", json={**body, "stop": {}, "priority": 300})
    assert other.json()["reason"] == "CONFLICT"


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"stop": {"relative_error": -1}}, "$.stop.relative_error"),
        ({"stop": {"until": "07:00"}}, "$.stop.until"),
        ({"stop": {"patience": 3}}, "$.stop.patience"),
        ({"stop": {"tile_samples": [4]}}, "$.stop.tile_samples"),
        ({"priority": 1001}, "$.priority"),
        ({"priority": -1}, "$.priority"),
    ],
)
async def test_what_can_not_be_asked_for_is_named(
    body: dict[str, Any], rest: httpx.AsyncClient, change: dict[str, Any], place: str
) -> None:
    answer = await rest.post("/v1/renders", json=body | change)
    assert answer.status_code == 422
    assert [each["place"] for each in answer.json()["problems"]] == [place]


async def test_pause_resume_priority_extend(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    path = f"/v1/renders/{render_id}"
    for _ in range(2):
        assert (await rest.post(f"{path}:pause")).json()["state"] == "PAUSED"
    assert (
        await Stub(channel).ResumeRender(pb.ResumeRenderRequest(id=render_id))
    ).state == pb.RENDER_STATE_QUEUED
    assert (
        await Stub(channel).PauseRender(pb.PauseRenderRequest(id=render_id))
    ).state == pb.RENDER_STATE_PAUSED
    assert (await rest.post(f"{path}:resume", json={})).json()["state"] == "QUEUED"
    changed = (await rest.post(f"{path}:setPriority", json={"priority": 7})).json()
    assert changed["priority"] == 7
    assert (await Stub(channel).SetPriority(pb.SetPriorityRequest(id=render_id, priority=9))).priority == 9
    assert (await rest.post(f"{path}:setPriority", json={"priority": 0})).status_code == 422

    coordinator_acts.progress(folder, render_id, 40 * 30 * 16)
    coordinator_acts.finish(folder, render_id)
    for verb in ("pause", "resume"):
        answer = await rest.post(f"{path}:{verb}")
        assert (answer.status_code, answer.json()["reason"]) == (409, "WRONG_STATE")
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await Stub(channel).PauseRender(pb.PauseRenderRequest(id=render_id))
    assert caught.value.code() == grpc.StatusCode.FAILED_PRECONDITION

    assert (await rest.post(f"{path}:extend", json={"samples": 8})).status_code == 422
    extended = (await rest.post(f"{path}:extend", json={"samples": 64, "stop": STOP})).json()
    assert (extended["state"], extended["samples"], extended["ended"]) == ("QUEUED", 64, 0.0)
    assert extended["progress"]["mean_samples"] == 16
    again = await Stub(channel).ExtendRender(
        pb.ExtendRenderRequest(id=render_id, samples=64, stop=pb.StopConditions(**STOP))
    )
    assert again.sequence == extended["sequence"]


async def test_an_extension_changes_only_what_it_names(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    asked = {**STOP, "until": "07:00 Europe/Berlin"}
    render_id = (await rest.post("/v1/renders", json={**body, "stop": asked})).json()["id"]
    path = f"/v1/renders/{render_id}:extend"
    more = (await rest.post(path, json={"samples": 64})).json()
    assert more["samples"] == 64
    assert {name: more["stop"][name] for name in asked} == asked
    changed = (await rest.post(path, json={"stop": {"relative_error": 0.02}})).json()["stop"]
    assert changed == {**more["stop"], "relative_error": 0.02}
    message = pb.ExtendRenderRequest(id=render_id, drop=["until", "tile_relative_error"])
    dropped = (await Stub(channel).ExtendRender(message)).stop
    assert (dropped.until, dropped.until_time, dropped.tile_relative_error) == ("", 0.0, 0.0)
    assert (dropped.relative_error, dropped.cpu_seconds) == (0.02, changed["cpu_seconds"])


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"stop": {"relative_error": 0}}, "$.stop.relative_error"),
        ({"stop": {"until": ""}}, "$.stop.until"),
        ({"drop": ["patience"]}, "$.drop[0]"),
        ({"drop": ["until"], "stop": {"until": "08:00Z"}}, "$.stop.until"),
    ],
)
async def test_an_extension_says_what_it_drops(
    body: dict[str, Any], rest: httpx.AsyncClient, change: dict[str, Any], place: str
) -> None:
    render_id = (await rest.post("/v1/renders", json={**body, "stop": STOP})).json()["id"]
    answer = await rest.post(f"/v1/renders/{render_id}:extend", json=change)
    assert answer.status_code == 422
    assert [each["place"] for each in answer.json()["problems"]] == [place]


async def test_what_would_end_at_once_is_not_extended(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    asked = {**body, "stop": {"cpu_seconds": 5.0}}
    render_id = (await rest.post("/v1/renders", json=asked)).json()["id"]
    folder.database.execute(
        "UPDATE render SET state = 'STOPPED_EARLY', cpu_seconds = 6 WHERE id = ?", (render_id,)
    )
    path = f"/v1/renders/{render_id}:extend"
    refused = await rest.post(path, json={"samples": 64})
    assert refused.status_code == 422
    assert "cpu_seconds" in refused.json()["detail"]
    assert (await rest.post(path, json={"samples": 64, "drop": ["cpu_seconds"]})).json()["state"] == "QUEUED"


async def test_replay_needs_samples(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    answer = await rest.post(f"/v1/renders/{render_id}:replay", json={"request_id": "again"})
    assert answer.json()["reason"] == "WRONG_STATE"
    folder.database.execute(
        "INSERT INTO tile (render_id, tile_index, samples, sums) VALUES (?, 1, 8, x'00')", (render_id,)
    )
    replay = (await rest.post(f"/v1/renders/{render_id}:replay", json={"request_id": "again"})).json()
    assert folder.database.row("SELECT stop FROM render WHERE id = ?", (replay["id"],))["stop"] == (  # type: ignore[index]
        '{"tile_samples":[0,8]}'
    )
    again = await Stub(channel).ReplayRender(pb.ReplayRenderRequest(id=render_id, request_id="again"))
    assert again.id == replay["id"]


async def test_grpc_has_the_history_and_the_stream_of_all(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render = (await rest.post("/v1/renders", json=body)).json()
    folder.database.execute(
        "INSERT INTO error_point VALUES (?, ?, ?, ?, ?, 0.25, 70.0)",
        (render["id"], render["created"] + 2.5, 4800, 4.0, 0.125),
    )
    points = (await rest.get(f"/v1/renders/{render['id']}/convergence")).json()["points"]
    answer = await Stub(channel).GetConvergence(pb.GetConvergenceRequest(id=render["id"]))
    told = [{name: getattr(point, name) for name in points[0]} for point in answer.points]
    assert told == points
    watching = Stub(channel).WatchRenders(pb.WatchRendersRequest())
    states = aiter(watching)
    assert (await anext(states)).id == render["id"]
    second = (await rest.post("/v1/renders", json={**body, "request_id": "second"})).json()
    assert (await anext(states)).id == second["id"]
    watching.cancel()


async def test_the_command_line_does_it_all(
    body: dict[str, Any], service: Service, rest: httpx.AsyncClient, tmp_path: Path, folder: DataFolder
) -> None:
    import asyncio

    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(body["scene"]))

    async def nocturne(*words: str, expect: int = 0) -> str:
        environment = {"NOCTURNE_URL": f"http://127.0.0.1:{service.port}", "TERM": "dumb", "COLUMNS": "200"}
        result = await asyncio.to_thread(CliRunner().invoke, app, words, env=environment)
        assert result.exit_code == expect, (words, result.output, result.exception)
        return result.output.strip()

    conditions = (
        "--error",
        "1%",
        "--tile-error",
        "0.05",
        "--for",
        "8h",
        "--cpu",
        "40 h",
        "--until",
        "07:00Z",
    )
    render_id = await nocturne("submit", str(scene), "--width", "40", "--height", "30", *conditions)
    stop = (await rest.get(f"/v1/renders/{render_id}")).json()["stop"]
    assert (stop["relative_error"], stop["tile_relative_error"]) == (0.01, 0.05)
    assert (stop["wall_seconds"], stop["cpu_seconds"], stop["until"]) == (28800.0, 144000.0, "07:00Z")
    assert "relative error 1.000%" in await nocturne("get", render_id)
    assert json.loads(await nocturne("pause", render_id, "--json"))["state"] == "PAUSED"
    assert "paused" in await nocturne("explain", render_id)
    assert json.loads(await nocturne("resume", render_id, "--json"))["state"] == "QUEUED"
    assert json.loads(await nocturne("priority", render_id, "250", "--json"))["priority"] == 250
    assert json.loads(await nocturne("extend", render_id, "--samples", "512", "--json"))["samples"] == 512
    assert "No coordinator" in await nocturne("explain", render_id)
    assert "no worker" in await nocturne("workers")
    folder.database.execute(
        "INSERT INTO worker VALUES ('w1', 2, 2, 10, 20, 5.5, 3, 1.0, unixepoch() + 0.0, 'a1')"
    )
    folder.database.execute("INSERT INTO quarantine VALUES ('w1', 'It lied.', 1.0)")
    assert "It lied." in await nocturne("workers")
    assert "It lied." not in await nocturne("workers", "--release", "w1")
    await nocturne("submit", str(scene), "--error", "a lot", expect=2)
    data = ("--data", str(tmp_path / "data"))
    secret = await nocturne("token", "create", "ann", "--scope", "submit", *data)
    assert secret.startswith("nct_")
    assert "ann  submit  weight 100" in await nocturne("token", "list", *data)
    await nocturne("token", "revoke", "ann", *data)
    assert "ann  revoked" in await nocturne("token", "list", *data)
    assert secret not in (tmp_path / "data" / "nocturne.db").read_bytes().decode(errors="replace")


def test_a_clock_on_the_wall_gets_its_zone(monkeypatch: pytest.MonkeyPatch) -> None:
    from datetime import datetime

    monkeypatch.setenv("TZ", "Europe/Berlin")
    time.tzset()
    try:
        # The clocks go forward in this night: tomorrow's zone is another than today's.
        evening = datetime(2026, 3, 28, 18, 0)  # noqa: DTZ001 - the clock on the wall
        assert with_zone("07:00", evening) == "2026-03-29T07:00:00+02:00"
        assert with_zone("19:00", evening) == "2026-03-28T19:00:00+01:00"
        assert with_zone("07:00 Asia/Tokyo", evening) == "07:00 Asia/Tokyo"
    finally:
        monkeypatch.undo()
        time.tzset()
    assert Stops(error="2.5%", duration="1.5 h").asked() == {"relative_error": 0.025, "wall_seconds": 5400.0}


# --- why ---


def situation(folder: DataFolder, **changes: Any) -> Situation:
    row = replace(folder.renders.page(1, "")[0][0], **changes.pop("render", {}))
    values: dict[str, Any] = {
        "render": row,
        "meters": {"coordinator_seen": 1000.0, "redis_in_step": 1.0, "worker_threads": 4.0},
        "workers": [_WORKER],
        "quarantined": {},
        "running": 1,
        "incompatible": {},
    }
    return Situation(**(values | changes))


async def test_why_tells_the_first_thing_in_the_way(
    body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    said = (await rest.get(f"/v1/renders/{render_id}/explanation")).json()["sentence"]
    assert said == (await Stub(channel).ExplainRender(pb.ExplainRenderRequest(id=render_id))).sentence
    good = {"coordinator_seen": 1000.0, "redis_in_step": 1.0, "worker_threads": 4.0}
    running = {"state": RenderState.RUNNING, "photons_per_second": 5.0, "predicted_end": 1600.0}
    for changes, words in (
        ({"render": {"state": RenderState.DEGRADED, "reason": "Tile 3."}}, "It has ended: DEGRADED. Tile 3."),
        ({"render": {"state": RenderState.PAUSED}}, "paused"),
        ({"meters": {}}, "No coordinator"),
        ({"meters": {**good, "folder_trouble": 1.0}}, "can't write"),
        ({"meters": {**good, "redis_in_step": 0.0}}, "can't reach Redis"),
        ({"workers": []}, "No worker is there"),
        ({"quarantined": {"w": "lied"}}, "in quarantine"),
        ({"workers": [replace(_WORKER, engine=1)]}, f"engine 1, and it needs engine {_ENGINE}"),
        (
            {
                "render": {"floating_point_profile": "a" * 16},
                "workers": [replace(_WORKER, floating_point_profile="b" * 16)],
            },
            f"floating-point profile {'a' * 16}. The workers that are there have {'b' * 16}, which",
        ),
        ({"render": running, "incompatible": {"w": "It rounds otherwise."}}, "1 workers get no jobs"),
        ({"running": 8}, "until one of 8 running renders ends"),
        ({"running": 0}, "about to start"),
        ({"render": running}, "in 10 minutes"),
        ({"render": {**running, "tiles_done": 2}}, "audits"),
        ({"render": {**running, "photons_per_second": 0.0}}, "No result came back"),
    ):
        assert words in sentence(situation(folder, **changes), 1000.0)


async def test_metrics_are_what_prometheus_reads(
    body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    await rest.post("/v1/renders", json=body)
    folder.database.execute("INSERT INTO meter VALUES (1, 'results_refused', 3.0)")
    answer = await rest.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=0.0.4")
    samples = {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }
    assert samples["nocturne_renders", "QUEUED"] == 1
    assert samples["nocturne_results_refused_total",] == 3
    assert samples["nocturne_backlog_ranges",] == 2 * 3


# --- compiling ---


def test_a_scene_that_takes_too_much_is_refused(scene: dict[str, Any], tmp_path: Path) -> None:
    document = check_document(scene)
    blobs = BlobStore(tmp_path)
    sha256 = compile_in_child(document, blobs, CompileLimits())
    assert len(sha256) == 64
    big = copy.deepcopy(scene)
    count = 30_000
    big["surfaces"][0]["shape"] = {
        "type": "mesh",
        "vertices": [[index, index % 7, 0] for index in range(count)],
        "triangles": [[index, index + 1, (index * 7) % count] for index in range(count - 1)],
    }
    # What the child has already is more than that; so the first larger array that it asks for is refused.
    with pytest.raises(InputError, match="needs more than 16 MiB"):
        compile_in_child(check_document(big), blobs, CompileLimits(memory_bytes=2**24))
    # The next is none the worse for it.
    assert compile_in_child(document, blobs, CompileLimits()) == sha256


def test_a_compile_that_never_ends_is_ended() -> None:
    endless = (
        "from nocturne_api.compiling.server import bound\n"
        "from nocturne_api.compiling.pool import CompileLimits\n"
        "bound(CompileLimits(cpu_seconds=1))\nwhile True: pass"
    )
    ended = subprocess.run([sys.executable, "-c", endless], timeout=60, check=False)
    assert ended.returncode in (-signal.SIGXCPU, -signal.SIGKILL)


# --- tokens ---


@pytest.fixture
async def guarded(tmp_path: Path, web: Path) -> AsyncIterator[Service]:
    settings = Settings(
        data=tmp_path / "data", web=web, port=0, grpc_port=0, grpc_unix=tmp_path / "grpc.sock", auth=True
    )
    service = await open_service(settings)
    await service.start()
    yield service
    await service.stop()


def bearer(secret: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {secret}"}


async def test_tokens_open_what_their_scopes_say(
    body: dict[str, Any], guarded: Service, folder_of_guarded: DataFolder
) -> None:
    tokens = folder_of_guarded.tokens
    secrets = {scope: tokens.create(scope, [scope]) for scope in ("read", "submit", "worker", "admin")}
    other = tokens.create("other", ["submit"])
    async with rest_client(guarded) as rest:
        assert (await rest.get("/healthz")).status_code == 200
        assert (await rest.get("/")).status_code == 200
        refused = await rest.get("/v1/renders")
        assert (refused.status_code, refused.json()["reason"]) == (401, "UNAUTHENTICATED")
        assert "Basic" in refused.headers["www-authenticate"]
        assert (await rest.get("/v1/renders", headers=bearer("nct_wrong"))).status_code == 401
        assert (await rest.get("/v1/renders", auth=("any", secrets["read"]))).status_code == 200
        for scope, status in (("read", 403), ("worker", 403), ("submit", 201), ("admin", 201)):
            request = {**body, "request_id": scope}
            answer = await rest.post("/v1/renders", json=request, headers=bearer(secrets[scope]))
            assert answer.status_code == status, scope
        renders = (await rest.get("/v1/renders", headers=bearer(secrets["read"]))).json()["renders"]
        mine = next(render for render in renders if render["owner"] == "submit")
        for secret, status in (
            (other, 403),
            (secrets["read"], 403),
            (secrets["submit"], 200),
            (secrets["admin"], 200),
        ):
            answer = await rest.post(f"/v1/renders/{mine['id']}:pause", headers=bearer(secret))
            assert answer.status_code == status
        assert (await rest.get("/v1/workers", headers=bearer(secrets["worker"]))).status_code == 403
        assert (await rest.get("/v1/events", headers=bearer(secrets["worker"]))).status_code == 403
        scene = f"/v1/assets/{mine['scene_sha256']}"
        assert (await rest.head(scene, headers=bearer(secrets["worker"]))).status_code == 200
        assert (
            await rest.post("/v1/workers/w:release", headers=bearer(secrets["submit"]))
        ).status_code == 403
        await rest.post(f"/v1/renders/{mine['id']}:cancel", headers=bearer(secrets["submit"]))
        for secret, status in ((other, 403), (secrets["read"], 403), (secrets["submit"], 204)):
            answer = await rest.delete(f"/v1/renders/{mine['id']}", headers=bearer(secret))
            assert answer.status_code == status
        tokens.revoke("submit")
        assert (await rest.get("/v1/renders", headers=bearer(secrets["submit"]))).status_code == 401
    outcomes = [(call["who"], call["what"], call["outcome"]) for call in folder_of_guarded.calls.last(20)]
    assert ("other", "pause", "FORBIDDEN") in outcomes
    assert ("other", "delete", "FORBIDDEN") in outcomes
    assert ("submit", "pause", "done") in outcomes
    assert ("submit", "create", "done") in outcomes


@pytest.fixture
def folder_of_guarded(guarded: Service, tmp_path: Path) -> Any:
    assert guarded.port
    folder = DataFolder(tmp_path / "data")
    yield folder
    folder.close()


async def test_grpc_asks_for_tokens_too(
    body: dict[str, Any], guarded: Service, folder_of_guarded: DataFolder, tmp_path: Path
) -> None:
    secret = folder_of_guarded.tokens.create("ann", ["submit"])
    worker = folder_of_guarded.tokens.create("farm", ["worker"])

    def metadata(secret: str) -> tuple[tuple[str, str], ...]:
        return (("authorization", f"Bearer {secret}"),)

    async with grpc_channel(guarded) as channel:
        with pytest.raises(grpc.aio.AioRpcError) as caught:
            await Stub(channel).ListRenders(pb.ListRendersRequest())
        assert caught.value.code() == grpc.StatusCode.UNAUTHENTICATED
        with pytest.raises(grpc.aio.AioRpcError) as caught:
            await anext(aiter(Stub(channel).WatchRenders(pb.WatchRendersRequest())))
        assert caught.value.code() == grpc.StatusCode.UNAUTHENTICATED
        request = pb.CreateRenderRequest(
            scene_json=json.dumps(body["scene"]),
            **{name: body[name] for name in ("request_id", "name", "width", "height", "samples")},
        )
        made = await Stub(channel).CreateRender(request, metadata=metadata(secret))
        assert made.owner == "ann"
        fetch = asset_service_pb2.FetchRequest(sha256=made.scene_sha256)
        assets = asset_service_pb2_grpc.AssetServiceStub(channel)
        chunks = [chunk async for chunk in assets.Fetch(fetch, metadata=metadata(worker))]
        assert chunks[0].total_bytes == sum(len(chunk.data) for chunk in chunks)
        with pytest.raises(grpc.aio.AioRpcError) as caught:
            await Stub(channel).ListRenders(pb.ListRendersRequest(), metadata=metadata(worker))
        assert caught.value.code() == grpc.StatusCode.PERMISSION_DENIED
    async with grpc.aio.insecure_channel(f"unix:{tmp_path / 'grpc.sock'}") as channel:
        assert len((await Stub(channel).ListRenders(pb.ListRendersRequest())).renders) == 1


async def test_the_client_sends_its_token(guarded: Service, folder_of_guarded: DataFolder) -> None:
    import asyncio

    secret = folder_of_guarded.tokens.create("ann", ["read"])

    def listed() -> int:
        with Client(f"http://127.0.0.1:{guarded.port}", token=secret) as client:
            return len(client.list())

    assert await asyncio.to_thread(listed) == 0


def test_an_address_that_others_can_reach_needs_tokens_and_tls() -> None:
    for host in ("0.0.0.0", "192.168.1.5", "::"):  # noqa: S104 - refused
        with pytest.raises(AddressError, match="--auth"):
            check_host(host, any_address=False)
    assert check_host("127.0.0.1", any_address=False)


def test_too_many_calls_are_refused_for_a_while() -> None:
    pace = Pace()
    for _ in range(int(CALLS_AT_ONCE)):
        pace.take("a", 0.0)
    with pytest.raises(TooMany):
        pace.take("a", 0.0)
    pace.take("b", 0.0)
    pace.take("a", 1.01 / CALLS_PER_SECOND)
    with pytest.raises(TooMany):
        pace.take("a", 1.02 / CALLS_PER_SECOND)


@pytest.mark.parametrize(
    "header", ["", "Bearer", "Bearer ", "Basic !!!", "Basic YTo=", "Digest x", "Basic //79"]
)
def test_a_header_without_a_secret_is_nobody(header: str) -> None:
    with pytest.raises(Unauthenticated):
        secret_in(header)
