"""Who may ask, and what every answer carries."""

import asyncio
import shutil
import socket
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from grpc_health.v1 import health_pb2, health_pb2_grpc
from grpc_reflection.v1alpha import reflection_pb2, reflection_pb2_grpc
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc
from nocturne_api.addresses import AddressError, check_host, listen
from nocturne_api.service import Service, Settings, open_service

from tests.services.endpoints import started


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:7070", "192.168.1.5", "localhost.evil.example", "", "[::"]
)
async def test_foreign_host_names_are_refused(host: str, rest: httpx.AsyncClient) -> None:
    answer = await rest.get("/v1/renders", headers={"Host": host})
    assert answer.status_code in (400, 403)


@pytest.mark.parametrize("host", ["localhost", "localhost:1234", "127.0.0.1:7070", "[::1]:7070", "LOCALHOST"])
async def test_loopback_names_are_welcome(host: str, rest: httpx.AsyncClient) -> None:
    assert (await rest.get("/v1/renders", headers={"Host": host})).status_code == 200


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
async def test_changes_from_other_sites_are_refused(
    site: str, body: dict[str, Any], rest: httpx.AsyncClient
) -> None:
    """By a browser's own word, also where it sends no Origin."""
    answer = await rest.post("/v1/renders", json=body, headers={"Sec-Fetch-Site": site})
    assert answer.status_code == 403
    for own in ("same-origin", "none"):
        answer = await rest.post("/v1/renders", json=body, headers={"Sec-Fetch-Site": own})
        assert answer.status_code == 201


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://127.0.0.1:1"])
async def test_changes_from_other_origins_are_refused(
    origin: str, body: dict[str, Any], rest: httpx.AsyncClient
) -> None:
    answer = await rest.post("/v1/renders", json=body, headers={"Origin": origin})
    assert (answer.status_code, answer.json()["reason"]) == (403, "REFUSED")
    assert (await rest.get("/v1/renders")).json()["renders"] == []


async def test_changes_from_our_own_page_are_welcome(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    origin = str(rest.base_url).rstrip("/")
    assert (await rest.post("/v1/renders", json=body, headers={"Origin": origin})).status_code == 201


async def test_the_page_and_its_cache(rest: httpx.AsyncClient) -> None:
    index = await rest.get("/")
    assert (index.status_code, index.headers["cache-control"]) == (200, "no-cache")
    assert "default-src 'self'" in index.headers["content-security-policy"]
    assert (await rest.get("/renders/some-id")).text == index.text
    script = await rest.get("/assets/index-abc123.js")
    assert "immutable" in script.headers["cache-control"]
    assert "javascript" in script.headers["content-type"]


@pytest.mark.parametrize(
    "path", ["/../secret.txt", "/%2e%2e/secret.txt", "/assets/..%2f..%2fsecret.txt", "/a%00.js"]
)
async def test_nothing_outside_the_page_is_served(path: str, rest: httpx.AsyncClient) -> None:
    answer = await rest.get(path)
    assert answer.status_code == 404
    assert "not for the web" not in answer.text


async def test_a_page_that_is_not_built_says_so(rest: httpx.AsyncClient, web: Path) -> None:
    (web / "index.html").unlink()
    assert "not built" in (await rest.get("/")).text


async def test_reference_and_openapi(rest: httpx.AsyncClient, web: Path) -> None:
    paths = (await rest.get("/openapi.json")).json()["paths"]
    assert "/v1/renders/{render_id}:cancel" in paths
    assert (await rest.get("/scene.schema.json")).json()["title"] == "SceneDocument"
    # What the viewer does with them, tests/web shows in a browser.
    page = await rest.get("/docs")
    assert (page.status_code, page.text) == (200, (web / "reference.html").read_text())
    (web / "reference.html").unlink()
    assert "not built" in (await rest.get("/docs")).text


async def test_health_at_both_endpoints(
    rest: httpx.AsyncClient, channel: grpc.aio.Channel, tmp_path: Path
) -> None:
    assert (await rest.get("/readyz?exclude=merging")).json()["ready"]
    request = health_pb2.HealthCheckRequest(service="nocturne.v1.RenderService")
    answer = await health_pb2_grpc.HealthStub(channel).Check(request)
    assert answer.status == health_pb2.HealthCheckResponse.SERVING
    async with grpc.aio.insecure_channel(f"unix:{tmp_path / 'grpc.sock'}") as by_socket:
        answer = await health_pb2_grpc.HealthStub(by_socket).Check(request)
    assert answer.status == health_pb2.HealthCheckResponse.SERVING


async def test_reflection_lists_the_services(channel: grpc.aio.Channel) -> None:
    request = reflection_pb2.ServerReflectionRequest(list_services="")
    call = reflection_pb2_grpc.ServerReflectionStub(channel).ServerReflectionInfo(iter([request]))
    names = [each.name for each in (await anext(aiter(call))).list_services_response.service]
    assert {"nocturne.v1.RenderService", "nocturne.v1.AssetService", "grpc.health.v1.Health"} <= set(names)


@pytest.mark.parametrize("host", ["0.0.0.0", "192.168.1.5", "::", "example.org"])  # noqa: S104
def test_routable_addresses_need_a_word(host: str) -> None:
    with pytest.raises(AddressError, match="without authentication"):
        check_host(host, any_address=False)
    assert check_host(host, any_address=True) is False


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "localhost"])
def test_loopback_needs_none(host: str) -> None:
    assert check_host(host, any_address=False) is True


async def test_a_test_that_fails_leaves_no_server(tmp_path: Path) -> None:
    """Otherwise the next service in this process may wait for it without end."""
    ports: list[int] = []

    async def fail() -> None:
        async with started(Settings(tmp_path / "data", tmp_path, port=0, grpc_port=0)) as service:
            ports.extend([service.port, service.grpc_port])
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        await fail()
    for port in ports:
        with pytest.raises(ConnectionRefusedError):
            await asyncio.open_connection("127.0.0.1", port)


async def test_taken_ports_are_a_clear_error(service: Service, tmp_path: Path) -> None:
    for port, grpc_port in ((service.port, 0), (0, service.grpc_port)):
        with pytest.raises(AddressError, match="can't listen"):
            await open_service(Settings(tmp_path / "other", tmp_path, port=port, grpc_port=grpc_port))


def test_an_answer_does_not_wait_for_its_head_to_be_acknowledged() -> None:
    """On a connection that is used again, that was 40 ms for every call."""
    with listen("127.0.0.1", 0) as listener, socket.create_connection(listener.getsockname()):
        taken, _ = listener.accept()
        with taken:
            assert taken.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


async def test_a_folder_that_was_moved_away_is_said(
    rest: httpx.AsyncClient, channel: grpc.aio.Channel, body: dict[str, Any], tmp_path: Path
) -> None:
    """Nothing is taken, nothing is made in its place, and all goes on when it is back."""
    renders = render_service_pb2_grpc.RenderServiceStub(channel)
    (tmp_path / "data").rename(tmp_path / "elsewhere")
    for answer in (await rest.post("/v1/renders", json=body), await rest.get("/v1/renders")):
        assert (answer.status_code, answer.headers["Retry-After"]) == (503, "5")
        assert "was moved away or replaced" in answer.json()["detail"]
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await renders.ListRenders(render_service_pb2.ListRendersRequest())
    assert caught.value.code() == grpc.StatusCode.UNAVAILABLE
    assert not (tmp_path / "data").exists()
    shutil.copytree(tmp_path / "elsewhere", tmp_path / "data")
    assert (await rest.post("/v1/renders", json=body)).status_code == 503
    shutil.rmtree(tmp_path / "data")
    (tmp_path / "elsewhere").rename(tmp_path / "data")
    assert (await rest.post("/v1/renders", json=body)).status_code == 201
