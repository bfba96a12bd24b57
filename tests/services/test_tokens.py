"""Who may call: tokens and their scopes, addresses, and the pace of calls."""

import json
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import grpc
import pytest
from nocturne.v1 import asset_service_pb2, asset_service_pb2_grpc, render_service_pb2_grpc
from nocturne.v1 import render_service_pb2 as pb
from nocturne_api.access import RateLimiter, secret_in
from nocturne_api.addresses import AddressError, check_host
from nocturne_api.errors import RateLimited, Unauthenticated
from nocturne_api.limits import CALLS_AT_ONCE, CALLS_PER_SECOND
from nocturne_api.service import Service, Settings
from nocturne_client import Client
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.endpoints import grpc_channel, rest_client, started

Stub = render_service_pb2_grpc.RenderServiceStub


@pytest.fixture
async def guarded(tmp_path: Path, web: Path) -> AsyncIterator[Service]:
    settings = Settings(
        data=tmp_path / "data", web=web, port=0, grpc_port=0, grpc_unix=tmp_path / "grpc.sock", auth=True
    )
    async with started(settings) as service:
        yield service


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
        # Others' renders are not there for who may not see them.
        for secret, status in (
            (other, 404),
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
        for secret, status in ((other, 404), (secrets["read"], 403), (secrets["submit"], 204)):
            answer = await rest.delete(f"/v1/renders/{mine['id']}", headers=bearer(secret))
            assert answer.status_code == status
        tokens.revoke("submit")
        assert (await rest.get("/v1/renders", headers=bearer(secrets["submit"]))).status_code == 401
    outcomes = [(call["who"], call["what"], call["outcome"]) for call in folder_of_guarded.calls.last(20)]
    assert ("other", "pause", "NOT_FOUND") in outcomes
    assert ("other", "delete", "NOT_FOUND") in outcomes
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
    pace = RateLimiter()
    for _ in range(int(CALLS_AT_ONCE)):
        pace.take("a", 0.0)
    with pytest.raises(RateLimited):
        pace.take("a", 0.0)
    pace.take("b", 0.0)
    pace.take("a", 1.01 / CALLS_PER_SECOND)
    with pytest.raises(RateLimited):
        pace.take("a", 1.02 / CALLS_PER_SECOND)


@pytest.mark.parametrize(
    "header", ["", "Bearer", "Bearer ", "Basic !!!", "Basic YTo=", "Digest x", "Basic //79"]
)
def test_a_header_without_a_secret_is_nobody(header: str) -> None:
    with pytest.raises(Unauthenticated):
        secret_in(header)
