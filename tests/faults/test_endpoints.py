"""Who is slow, wants everything or is not welcome any more, at both endpoints: others are served.

One file, though long: connections are held by many methods, and each time the other callers are checked
alike.
"""

import asyncio
import contextlib
import hashlib
import json
import threading
import time
from collections import Counter
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from nocturne.v1 import asset_service_pb2, render_service_pb2_grpc
from nocturne.v1 import render_service_pb2 as pb
from nocturne_api import limits

from tests.faults.owners import Guarded, guarded, metadata, next_of, request
from tests.services import coordinator_acts
from tests.services.endpoints import refusal_of_upload
from tests.system.waiting import LIMIT_S

HALF_A_HEAD = b"GET /v1/renders HTTP/1.1\r\nHost: localhost\r\nX-A: "
# All of 127.0.0.0/8 is this machine: a second caller has another address.
ELSEWHERE = "127.0.0.2"
# Only a guard: slow steps here have a second at most, and a busy machine may take some more.
_CLOSED_S = 15.0


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """So few connections that a test takes them all."""
    monkeypatch.setattr(limits, "REST_CONNECTIONS", 60)
    monkeypatch.setattr(limits, "CONNECTIONS_OF_ADDRESS", 40)


@pytest.fixture
async def service(tmp_path: Path) -> AsyncIterator[Guarded]:
    async with guarded(tmp_path) as service:
        yield service


class Connections:
    """Connections that are open until the end of a test."""

    def __init__(self, port: int) -> None:
        self._port = port
        self._writers: list[asyncio.StreamWriter] = []

    async def open(
        self, data: bytes, address: str = ELSEWHERE
    ) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        reader, writer = await asyncio.open_connection("127.0.0.1", self._port, local_addr=(address, 0))
        self._writers.append(writer)
        writer.write(data)
        return reader, writer

    async def close(self) -> None:
        for writer in self._writers:
            writer.close()
        for writer in self._writers:
            with contextlib.suppress(OSError):
                await writer.wait_closed()


@pytest.fixture
async def connections(service: Guarded) -> AsyncIterator[Connections]:
    found = Connections(service.service.port)
    yield found
    await found.close()


async def status_at(connections: Connections, token: str, address: str) -> int:
    """The status of a call in a separate connection."""
    call = f"GET /v1/renders HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n\r\n"
    reader, _ = await connections.open(call.encode(), address)
    return int((await reader.readline()).split()[1])


# --- slow senders ---


async def trickle_until_closed(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bytes:
    """Sends a byte now and then until the other side closes; returns its answer, empty after a reset."""
    answer = asyncio.create_task(reader.read())
    async with asyncio.timeout(_CLOSED_S):
        while not answer.done():
            await asyncio.sleep(0.1)
            with contextlib.suppress(OSError):
                writer.write(b"a")
    try:
        return answer.result()
    except ConnectionResetError:
        return b""


@pytest.mark.usefixtures("few")
async def test_half_a_request_holds_nobody_up(service: Guarded, connections: Connections) -> None:
    """P8: more connections than there are, from one address; callers there and elsewhere are served."""
    token = service.token("alice", "submit")
    for _ in range(150):
        await connections.open(HALF_A_HEAD)
    begun = time.monotonic()
    for address in ("127.0.0.1", ELSEWHERE, "127.0.0.1", ELSEWHERE):
        assert await status_at(connections, token, address) == 200
    # Before the first of the half requests has had its time.
    assert time.monotonic() - begun < limits.HEAD_SECONDS / 2


@pytest.mark.usefixtures("few")
async def test_half_a_request_from_many_addresses(service: Guarded, connections: Connections) -> None:
    """P8: no address has many, and all together have more than there are."""
    token = service.token("alice", "submit")
    for number in range(150):
        await connections.open(HALF_A_HEAD, f"127.0.1.{number + 1}")
    assert await status_at(connections, token, "127.0.0.1") == 200


@pytest.mark.parametrize("begin", [b"", HALF_A_HEAD])
async def test_a_head_has_its_time(
    begin: bytes, connections: Connections, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P8: also where a byte comes now and then, and after a whole request on the same connection."""
    monkeypatch.setattr(limits, "HEAD_SECONDS", 1.0)
    whole = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
    for before in (b"", whole):
        reader, writer = await connections.open(before)
        if before:
            await reader.readuntil(b"alive\n")
        writer.write(begin or b"G")
        begun = time.monotonic()
        answer = await trickle_until_closed(reader, writer)
        assert time.monotonic() - begun > 0.9
        if answer:
            head, _, body = answer.partition(b"\r\n\r\n")
            assert head.startswith(b"HTTP/1.1 408")
            assert json.loads(body)["reason"] == "TOO_SLOW"


def upload(token: str, size: int, name: str) -> bytes:
    """The head of one."""
    head = f"PUT /v1/assets/{name} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n"
    return f"{head}Content-Length: {size}\r\n\r\n".encode()


async def test_a_body_has_its_time(
    service: Guarded, connections: Connections, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P8: an upload that does not end is ended, and leaves nothing; a slow one that goes on is taken."""
    monkeypatch.setattr(limits, "BODY_SECONDS", 1.0)
    token = service.token("alice", "submit")
    reader, writer = await connections.open(upload(token, 1_000_000, "a" * 64) + b"x")
    answer = await trickle_until_closed(reader, writer)
    assert answer == b"" or answer.startswith(b"HTTP/1.1 408")
    content = bytes(20_000)
    reader, writer = await connections.open(upload(token, 20_000, hashlib.sha256(content).hexdigest()))
    for start in range(0, 20_000, 1000):
        writer.write(content[start : start + 1000])
        await asyncio.sleep(0.1)
    assert (await reader.readline()).split()[1] == b"200"
    incoming = service.folder.root / "blobs" / "incoming"
    assert list(incoming.iterdir()) == []
    # Interrupted uploads do not count.
    rows = service.folder.database.rows("SELECT size_bytes FROM upload")
    assert [row["size_bytes"] for row in rows] == [20_000]


@pytest.mark.parametrize("begins", [True, False])
async def test_a_call_has_its_time(begins: bool, service: Guarded, monkeypatch: pytest.MonkeyPatch) -> None:
    """P8: the same by gRPC, also where not even a first message comes."""
    monkeypatch.setattr(limits, "BODY_SECONDS", 0.5)
    about = asset_service_pb2.Asset(sha256="a" * 64, size_bytes=1_000_000)
    over = threading.Event()

    def slowly() -> Iterator[asset_service_pb2.UploadRequest]:
        if begins:
            yield asset_service_pb2.UploadRequest(asset=about)
        while not over.wait(0.1):
            if begins:
                yield asset_service_pb2.UploadRequest(data=b"x")

    allowed = metadata(service.token("alice", "submit"))
    try:
        async with asyncio.timeout(_CLOSED_S):
            ended = await refusal_of_upload(service.service, slowly(), allowed)
    finally:
        over.set()
    assert ended == grpc.StatusCode.DEADLINE_EXCEEDED


async def test_an_answer_that_nobody_reads_is_given_up(
    service: Guarded, connections: Connections, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P8: it held a connection and an open file."""
    monkeypatch.setattr(limits, "UNREAD_SECONDS", 0.5)
    token = service.token("alice", "submit")
    async with service.rest(token) as alice:
        made = (await alice.post("/v1/renders", json=request("a"))).json()["id"]
    coordinator_acts.picture(service.folder, made, bytes(30_000_000))
    head = f"GET /v1/renders/{made}/preview.png HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
    reader, _ = await connections.open(f"{head}Authorization: Bearer {token}\r\n\r\n".encode())
    await asyncio.sleep(2.0)
    assert (await reader.readline()).split()[1] == b"200"
    received = 0
    with contextlib.suppress(ConnectionResetError):
        while piece := await reader.read(2**20):
            received += len(piece)
    assert received < 30_000_000


async def test_calls_of_one_address_are_bounded(
    service: Guarded, connections: Connections, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P8: with all in use that it may have, it gets 503 and UNAVAILABLE, and another address is served."""
    monkeypatch.setattr(limits, "CONNECTIONS_OF_ADDRESS", 5)
    monkeypatch.setattr(limits, "GRPC_CALLS_OF_ADDRESS", 3)
    token = service.token("alice", "submit")
    watching = f"GET /v1/events HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n\r\n"
    for _ in range(5):
        reader, _ = await connections.open(watching.encode())
        await reader.readuntil(b": watching")
    assert await status_at(connections, token, ELSEWHERE) == 503
    assert await status_at(connections, token, "127.0.0.1") == 200
    async with service.grpc() as channel:
        stub = render_service_pb2_grpc.RenderServiceStub(channel)
        made = pb.CreateRenderRequest(
            request_id="a",
            scene_json=json.dumps(request("a")["scene"]),
            width=8,
            height=8,
            samples=1,
        )
        await stub.CreateRender(made, metadata=metadata(token))
        streams = [stub.WatchRenders(pb.WatchRendersRequest(), metadata=metadata(token)) for _ in range(3)]
        for stream in streams:
            await stream.read()
        with pytest.raises(grpc.aio.AioRpcError) as caught:
            await stub.ListRenders(pb.ListRendersRequest(), metadata=metadata(token))
        assert caught.value.code() == grpc.StatusCode.UNAVAILABLE
        for stream in streams:
            stream.cancel()


async def uploads_begun(service: Guarded, count: int) -> None:
    """Returns when so many have a file."""
    incoming = service.folder.root / "blobs" / "incoming"
    for _ in range(int(LIMIT_S / 0.02)):
        if len(list(incoming.iterdir())) >= count:
            return
        await asyncio.sleep(0.02)
    pytest.fail("they did not begin")


async def test_uploads_at_once_are_bounded(
    service: Guarded, connections: Connections, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P8: each has a thread; one owner leaves room for others, and has room again when its own are over."""
    monkeypatch.setattr(limits, "UPLOADS_AT_ONCE", 6)
    monkeypatch.setattr(limits, "UPLOADS_OF_OWNER", 4)
    alice, bob = service.token("alice", "submit"), service.token("bob", "submit")
    opened = [await connections.open(upload(alice, 1000, f"{number:064x}") + b"x") for number in range(4)]
    await uploads_begun(service, 4)
    content = b"whole"
    path = f"/v1/assets/{hashlib.sha256(content).hexdigest()}"
    async with service.rest(alice) as by_alice, service.rest(bob) as by_bob:
        refused = await by_alice.put(path, content=content)
        assert (refused.status_code, refused.json()["reason"]) == (429, "TOO_MANY")
        for number in range(2):
            await connections.open(upload(bob, 1000, f"{number:064x}") + b"x")
        await uploads_begun(service, 6)
        assert (await by_bob.put(path, content=content)).status_code == 503
        for _, writer in opened:
            writer.close()
        for _ in range(1000):
            if (await by_alice.put(path, content=content)).status_code == 200:
                return
            await asyncio.sleep(0.05)
    pytest.fail("there is no room again")


async def test_wrong_tokens_are_slowed_down(service: Guarded, monkeypatch: pytest.MonkeyPatch) -> None:
    """P8: at both endpoints; a caller with a token is served meanwhile, from the same address too."""
    monkeypatch.setattr(limits, "WRONG_TOKEN_DELAY_S", 0.3)
    token = service.token("alice", "submit")
    found: Counter[int] = Counter()
    async with service.rest("nct_" + 43 * "x") as wrong, service.rest(token) as alice:

        async def call() -> None:
            answer = await wrong.get("/v1/renders")
            found[answer.status_code] += 1
            if answer.status_code == 429:
                assert answer.headers["retry-after"]
                assert "wrong tokens from this address" in answer.json()["detail"]

        begun = time.monotonic()
        for _ in range(6):
            await asyncio.gather(*(call() for _ in range(10)))
        seconds = time.monotonic() - begun
        assert found[401] <= limits.WRONG_TOKENS_AT_ONCE + 1 + limits.WRONG_TOKENS_PER_SECOND * seconds
        assert found.total() == found[401] + found[429] == 60
        assert seconds > 5 * 0.3
        assert (await alice.get("/v1/renders")).status_code == 200
    async with service.grpc() as channel:
        stub = render_service_pb2_grpc.RenderServiceStub(channel)
        codes: Counter[grpc.StatusCode] = Counter()
        for _ in range(14):
            with pytest.raises(grpc.aio.AioRpcError) as caught:
                await stub.ListRenders(pb.ListRendersRequest(), metadata=metadata("nct_wrong"))
            codes[caught.value.code()] += 1
        assert codes[grpc.StatusCode.RESOURCE_EXHAUSTED] >= 1
        assert codes[grpc.StatusCode.UNAUTHENTICATED] >= limits.WRONG_TOKENS_AT_ONCE
        await stub.ListRenders(pb.ListRendersRequest(), metadata=metadata(token))


# --- streams ---


async def test_a_revoked_token_ends_its_streams(service: Guarded) -> None:
    """P10: by either transport, before anything that happened after; others go on.

    How soon, `python -m bench crowds` says.
    """
    secrets = {name: service.token(name, "read") for name in ("eve", "alice")}
    async with contextlib.AsyncExitStack() as stack:
        clients = {
            name: await stack.enter_async_context(service.rest(secret)) for name, secret in secrets.items()
        }
        paths = dict.fromkeys(secrets, "/v1/events")
        submitter = await stack.enter_async_context(service.rest(service.token("bob", "submit")))
        made = (await submitter.post("/v1/renders", json=request("a"))).json()["id"]
        answers = {
            name: await stack.enter_async_context(client.stream("GET", paths[name]))
            for name, client in clients.items()
        }
        of_one = await stack.enter_async_context(clients["eve"].stream("GET", f"/v1/renders/{made}/events"))
        lines = {name: answer.aiter_lines() for name, answer in answers.items()}
        for each in lines.values():
            assert await anext(each) == ": watching"
        stub = render_service_pb2_grpc.RenderServiceStub(await stack.enter_async_context(service.grpc()))
        call = stub.WatchRenders(pb.WatchRendersRequest(), metadata=metadata(secrets["eve"]))
        assert (await next_of(call)).id == made

        service.folder.tokens.revoke("eve")
        await submitter.post("/v1/renders", json=request("b", name="after it"))
        async with asyncio.timeout(LIMIT_S):
            rest_of_stream = [line async for line in lines["eve"]]
            assert [line async for line in of_one.aiter_lines()]
            assert await call.code() == grpc.StatusCode.UNAUTHENTICATED
            while "after it" not in await anext(lines["alice"]):
                pass
        assert any("the token was revoked" in line for line in rest_of_stream)
        assert not any("after it" in line for line in rest_of_stream)


async def watchers(client: httpx.AsyncClient, count: int, stack: contextlib.AsyncExitStack) -> list[int]:
    """Opens streams that stay open; gives their statuses."""
    found = []
    for _ in range(count):
        answer = await stack.enter_async_context(client.stream("GET", "/v1/events"))
        found.append(answer.status_code)
    return found


async def test_too_many_watchers_are_told_by_the_status(
    service: Guarded, monkeypatch: pytest.MonkeyPatch
) -> None:
    """P11: 503, UNAVAILABLE, before the first byte; one owner leaves room for others."""
    monkeypatch.setattr("nocturne_api.operations.watchers.WATCHERS", 4)
    monkeypatch.setattr("nocturne_api.operations.watchers.WATCHERS_OF_OWNER", 3)
    token = service.token("alice", "submit")
    async with (
        service.rest(token) as alice,
        service.rest(service.token("bob", "submit")) as bob,
        service.grpc() as channel,
        contextlib.AsyncExitStack() as stack,
    ):
        assert await watchers(alice, 5, stack) == [200, 200, 200, 503, 503]
        assert await watchers(bob, 2, stack) == [200, 503]
        refused = await bob.get("/v1/events")
        assert refused.json()["reason"] == "OVERLOADED"
        assert refused.headers["retry-after"]
        stub = render_service_pb2_grpc.RenderServiceStub(channel)
        with pytest.raises(grpc.aio.AioRpcError) as caught:
            await stub.WatchRenders(pb.WatchRendersRequest(), metadata=metadata(token)).read()
        assert caught.value.code() == grpc.StatusCode.UNAVAILABLE
        assert (await bob.get("/v1/renders")).status_code == 200


async def test_a_stream_of_the_wrong_scope_is_told_by_the_status(service: Guarded) -> None:
    """P11: 403, PERMISSION_DENIED, before the first byte."""
    token = service.token("farm", "worker")
    made = service.token("alice", "submit")
    async with service.rest(token) as farm, service.rest(made) as alice, service.grpc() as channel:
        render = (await alice.post("/v1/renders", json=request("a"))).json()["id"]
        for path in ("/v1/events", f"/v1/events?render={render}", f"/v1/renders/{render}/events"):
            answer = await farm.get(path)
            assert (answer.status_code, answer.json()["reason"]) == (403, "FORBIDDEN"), path
        stub = render_service_pb2_grpc.RenderServiceStub(channel)
        calls: list[Any] = [
            stub.WatchRenders(pb.WatchRendersRequest(), metadata=metadata(token)),
            stub.WatchRender(pb.WatchRenderRequest(id=render), metadata=metadata(token)),
        ]
        for call in calls:
            with pytest.raises(grpc.aio.AioRpcError) as caught:
                await call.read()
            assert caught.value.code() == grpc.StatusCode.PERMISSION_DENIED
