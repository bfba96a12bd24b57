"""Every call that changes something, or tried to, is recorded; too many are refused at each endpoint."""

import asyncio
import hashlib
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from fastapi.routing import APIRoute
from nocturne.v1 import asset_service_pb2, render_service_pb2
from nocturne.v1 import asset_service_pb2_grpc as asset_grpc
from nocturne.v1 import render_service_pb2_grpc as render_grpc
from nocturne_api import limits
from nocturne_api.rest import app as rest_app
from nocturne_api.service import Service, Settings, open_service
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.endpoints import grpc_channel, rest_client, running

_READING_METHODS = {"GET", "HEAD", "OPTIONS"}
# Asks which files are missing; a POST, because the question is long.
# The page's cookie changes nothing that is kept, nor does a preflight, nor reading a picture for the page.
_READING = {
    ("POST", "/v1/assets:batchMissing"),
    ("POST", "/v1/pictures"),
    ("POST", "/v1/preflights"),
    ("POST", "/v1/renders/{render_id}:measure"),
    ("POST", "/v1/session"),
    ("DELETE", "/v1/session"),
}
_READING_CALLS = ("Get", "List", "Watch", "Fetch", "Explain", "ReadRegion", "BatchMissing", "Preflight")

_DATA = b"a file"
_SHA256 = hashlib.sha256(_DATA).hexdigest()

# For each route that changes something: the body of a call, and the name in its record.
_CALLS: dict[tuple[str, str], tuple[Any, str]] = {
    ("POST", "/v1/renders"): ("body", "create"),
    ("POST", "/v1/groups"): ("body", "create"),
    ("POST", "/v1/renders/{render_id}:cancel"): ({}, "cancel"),
    ("DELETE", "/v1/renders/{render_id}"): (b"", "delete"),
    ("POST", "/v1/renders/{render_id}:pause"): ({}, "pause"),
    ("POST", "/v1/renders/{render_id}:resume"): ({}, "resume"),
    ("POST", "/v1/renders/{render_id}:extend"): ({"samples": 32}, "extend"),
    ("POST", "/v1/renders/{render_id}:setPriority"): ({"priority": 7}, "priority"),
    ("POST", "/v1/renders/{render_id}:setTags"): ({"tags": ["a"]}, "tags"),
    ("POST", "/v1/renders/{render_id}:lookFirst"): ({}, "look first"),
    ("POST", "/v1/renders/{render_id}:replay"): ({"request_id": "again"}, "replay"),
    ("PUT", "/v1/renders/{render_id}/regions"): ({"regions": []}, "keep regions"),
    ("POST", "/v1/imports"): ({"files": {"a.xml": _SHA256}}, "import"),
    ("PUT", "/v1/assets/{sha256}"): (_DATA, f"upload {_SHA256}"),
    ("POST", "/v1/workers/{worker_id}:drain"): (b"", "drain w-1"),
    ("POST", "/v1/workers/{worker_id}:release"): (b"", "release w-1"),
    ("POST", "/v1/webhooks"): ({"url": "https://example.org/"}, "create webhook"),
    ("DELETE", "/v1/webhooks/{webhook_id}"): (b"", "delete webhook wh-1"),
}


def routes() -> set[tuple[str, str]]:
    """Method and path of each route that may change something."""
    found = set()
    for module in rest_app._ROUTERS:
        for route in module.router.routes:
            if isinstance(route, APIRoute):
                found |= {(method, route.path) for method in (route.methods or set()) - _READING_METHODS}
    return found - _READING


def test_the_table_has_every_route_that_changes_something() -> None:
    assert routes() == set(_CALLS)


@pytest.mark.parametrize(("method", "path"), sorted(_CALLS))
async def test_every_change_in_rest_is_recorded(
    method: str, path: str, body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    before = folder.calls.last(1)[0]["number"]
    content, what = _CALLS[method, path]
    address = path.format(render_id=render_id, sha256=_SHA256, worker_id="w-1", webhook_id="wh-1")
    if isinstance(content, bytes):
        answer = await rest.request(method, address, content=content)
    else:
        json = {**body, "request_id": "another"} if content == "body" else content
        answer = await rest.request(method, address, json=json)
    call = folder.calls.last(1)[0]
    assert call["number"] == before + 1  # type: ignore[operator]
    assert call["what"] == what
    expected = "done" if answer.status_code < 300 else answer.json()["reason"]
    assert call["outcome"] == expected
    if "{render_id}" in path:
        assert call["render_id"] == render_id


_METHODS = [
    (module, service.name, method.name)
    for module, file in (
        (render_grpc, render_service_pb2.DESCRIPTOR),
        (asset_grpc, asset_service_pb2.DESCRIPTOR),
    )
    for service in file.services_by_name.values()
    for method in service.methods
    if not method.name.startswith(_READING_CALLS)
]


@pytest.mark.parametrize(("module", "service_name", "method"), _METHODS, ids=[name for *_, name in _METHODS])
async def test_every_change_in_grpc_is_recorded(
    module: Any, service_name: str, method: str, channel: grpc.aio.Channel, folder: DataFolder
) -> None:
    """Of a render that there is not, which is an attempt too."""
    stub = getattr(module, f"{service_name}Stub")(channel)
    files = (render_service_pb2, asset_service_pb2)
    request = next(getattr(file, f"{method}Request")() for file in files if hasattr(file, f"{method}Request"))
    if method == "CreateRender":
        request.scene_json = "{}"
    if hasattr(request, "id"):
        request.id = "r-nowhere"
    if method == "Upload":
        request.asset.sha256 = "not a digest"
        call = stub.Upload(iter([request]))
    else:
        call = getattr(stub, method)(request)
    with pytest.raises(grpc.aio.AioRpcError):
        await call
    recorded = folder.calls.last(2)
    assert len(recorded) == 1
    assert recorded[0]["outcome"] in ("NOT_FOUND", "INVALID_INPUT")


async def test_who_may_not_is_recorded_by_name(tmp_path: Path, body: dict[str, Any]) -> None:
    settings = Settings(data=tmp_path / "data", web=tmp_path, port=0, grpc_port=0, auth=True)
    service = await open_service(settings)
    await service.start()
    folder = DataFolder(tmp_path / "data")
    headers = {"Authorization": f"Bearer {folder.tokens.create('reader', ['read'])}"}
    try:
        async with rest_client(service) as rest:
            for method, path in sorted(_CALLS):
                content, what = _CALLS[method, path]
                address = path.format(render_id="r-1", sha256=_SHA256, worker_id="w-1", webhook_id="wh-1")
                json = body if content == "body" else content
                sent = {"content": json} if isinstance(json, bytes) else {"json": json}
                answer = await rest.request(method, address, headers=headers, **sent)
                call = folder.calls.last(1)[0]
                assert (call["who"], call["what"]) == ("reader", what)
                # For a missing object the answer does not show whether the caller has the right.
                assert answer.json()["reason"] in ("FORBIDDEN", "NOT_FOUND")
                assert call["outcome"] == answer.json()["reason"]
        assert len(folder.calls.last(100)) == len(_CALLS)
    finally:
        folder.close()
        await service.stop()


# --- too much ---


@pytest.fixture
async def small(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, web: Path) -> AsyncIterator[Service]:
    """A service with limits so low that a test reaches them."""
    monkeypatch.setattr(limits, "REST_CONNECTIONS", 6)
    monkeypatch.setattr(limits, "GRPC_CALLS", 3)
    async with running(tmp_path, web) as service:
        yield service


async def test_too_many_connections_are_refused_and_it_recovers(small: Service) -> None:
    held = [await asyncio.open_connection("127.0.0.1", small.port) for _ in range(8)]
    # Those on which nothing is asked make room, those on which something is do not.
    for reader, writer in held[2:]:
        writer.write(b"GET /v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n")
        await reader.readline()
    async with rest_client(small) as rest:
        assert (await rest.get("/v1/renders")).status_code == 503
    for _, writer in held:
        writer.close()
        await writer.wait_closed()
    async with rest_client(small) as rest:
        for _ in range(1000):
            if (await rest.get("/v1/renders")).status_code == 200:
                return
            await asyncio.sleep(0.05)
    pytest.fail("it did not recover")


async def test_too_many_calls_in_grpc_are_refused_and_it_recovers(
    small: Service, body: dict[str, Any]
) -> None:
    async with rest_client(small) as rest:
        await rest.post("/v1/renders", json=body)
    async with grpc_channel(small) as channel:
        stub = render_grpc.RenderServiceStub(channel)
        watching = []
        for _ in range(limits.GRPC_CALLS):
            watching.append(stub.WatchRenders(render_service_pb2.WatchRendersRequest()))
            # Calls that wait for a connection come in no order, and one that is refused holds nothing: each
            # is in progress before the next one is made.
            await watching[-1].read()
        with pytest.raises(grpc.aio.AioRpcError) as refused:
            await stub.ListRenders(render_service_pb2.ListRendersRequest())
        assert refused.value.code() == grpc.StatusCode.RESOURCE_EXHAUSTED
        for call in watching:
            call.cancel()
        async with asyncio.timeout(20):
            while True:
                try:
                    await stub.ListRenders(render_service_pb2.ListRendersRequest())
                    return
                except grpc.aio.AioRpcError:
                    await asyncio.sleep(0.02)


async def test_too_many_calls_of_one_token_are_refused_at_both_endpoints(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limits, "CALLS_AT_ONCE", 5.0)
    monkeypatch.setattr(limits, "CALLS_PER_SECOND", 0.001)
    settings = Settings(data=tmp_path / "data", web=tmp_path, port=0, grpc_port=0, auth=True)
    service = await open_service(settings)
    await service.start()
    folder = DataFolder(tmp_path / "data")
    try:
        authorization = f"Bearer {folder.tokens.create('eager', ['read'])}"
        other = f"Bearer {folder.tokens.create('other', ['read'])}"
        async with rest_client(service) as rest:
            statuses = [
                (await rest.get("/v1/renders", headers={"Authorization": authorization})).status_code
                for _ in range(8)
            ]
            assert statuses == [200] * 5 + [429] * 3
            assert (await rest.get("/v1/renders", headers={"Authorization": other})).status_code == 200
        async with grpc_channel(service) as channel:
            stub = render_grpc.RenderServiceStub(channel)
            codes = []
            for _ in range(8):
                try:
                    await stub.ListRenders(
                        render_service_pb2.ListRendersRequest(), metadata=(("authorization", authorization),)
                    )
                    codes.append(grpc.StatusCode.OK)
                except grpc.aio.AioRpcError as error:
                    codes.append(error.code())
            assert codes == [grpc.StatusCode.OK] * 5 + [grpc.StatusCode.RESOURCE_EXHAUSTED] * 3
    finally:
        folder.close()
        await service.stop()


async def test_too_many_watchers_are_refused(
    rest: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nocturne_api.operations.watchers.WATCHERS", 1)
    async with rest.stream("GET", "/v1/events") as first:
        assert first.status_code == 200
        # Kept: an iterator that nobody holds closes its stream, and then there is room for the second.
        lines_of_first = first.aiter_lines()
        assert (await anext(lines_of_first)).startswith(":")
        async with rest.stream("GET", "/v1/events") as second:
            lines = [line async for line in second.aiter_lines()]
            assert second.status_code == 503
    assert any("watchers are connected" in line for line in lines)


async def test_a_header_that_never_ends_is_cut_off(service: Service) -> None:
    reader, writer = await asyncio.open_connection("127.0.0.1", service.port)
    writer.write(b"GET / HTTP/1.1\r\nHost: localhost\r\nX-Long: ")
    try:
        for _ in range(64):
            writer.write(b"x" * 65536)
            await writer.drain()
        answer = await asyncio.wait_for(reader.read(100), 20)
    except (ConnectionError, OSError):
        answer = b""
    assert not answer or answer.startswith(b"HTTP/1.1 4")
    writer.close()
