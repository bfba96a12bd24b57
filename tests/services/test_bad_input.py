"""Bad input gets the same clear answer at both endpoints and leaves nothing behind."""

import json
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
import pytest_asyncio
from nocturne.v1 import render_service_pb2 as pb
from nocturne.v1 import render_service_pb2_grpc
from nocturne_api.service import Service

from tests.services.endpoints import grpc_channel, rest_client, running

# The tests check that refused input leaves nothing behind, so one service serves all of them.
pytestmark = pytest.mark.asyncio(loop_scope="module")

Change = Callable[[dict[str, Any]], None]


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def shared(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[tuple[Service, Path]]:
    """A service, and the folder that holds its data."""
    folder = tmp_path_factory.mktemp("shared")
    async with running(folder, folder / "web") as service:
        yield service, folder / "data"


@pytest_asyncio.fixture(loop_scope="module")
async def rest(shared: tuple[Service, Path]) -> AsyncIterator[httpx.AsyncClient]:
    async with rest_client(shared[0]) as client:
        yield client


@pytest_asyncio.fixture(loop_scope="module")
async def channel(shared: tuple[Service, Path]) -> AsyncIterator[grpc.aio.Channel]:
    async with grpc_channel(shared[0]) as channel:
        yield channel


@pytest.fixture
def data(shared: tuple[Service, Path]) -> Path:
    """The data folder."""
    return shared[1]


def _unknown_field(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][0]["colour"] = "red"


def _missing_asset(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][0]["shape"] = {"type": "mesh", "asset": "sha256:" + "0" * 64, "format": "ply"}


def _nan_vertex(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][0]["shape"]["vertices"][1][2] = float("nan")


def _index_out_of_range(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][0]["shape"]["triangles"][0][2] = 3


def _empty_film(body: dict[str, Any]) -> None:
    body["width"] = 0


def _huge_film(body: dict[str, Any]) -> None:
    body["height"] = 1_000_000


def _no_samples(body: dict[str, Any]) -> None:
    body["samples"] = 0


def _empty_scene(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"] = []


def _no_luminaire(body: dict[str, Any]) -> None:
    del body["scene"]["surfaces"][1]["luminaire"]


def _no_request_id(body: dict[str, Any]) -> None:
    body["request_id"] = ""


def _long_name(body: dict[str, Any]) -> None:
    body["name"] = "x" * 201


def _unknown_kernel(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][0]["kernel"] = "velvet"


CASES = [
    (_unknown_field, "$.surfaces[0].colour"),
    (_missing_asset, "$.surfaces[0].shape.asset"),
    (_nan_vertex, "$.surfaces[0].shape.vertices[1][2]"),
    (_index_out_of_range, "$.surfaces[0].shape.triangles[0][2]"),
    (_empty_film, "$.width"),
    (_huge_film, "$.height"),
    (_no_samples, "$.samples"),
    (_empty_scene, "$.surfaces"),
    (_no_luminaire, "$.surfaces"),
    (_no_request_id, "$.request_id"),
    (_long_name, "$.name"),
    (_unknown_kernel, "$.surfaces[0].kernel"),
]


@pytest.mark.parametrize(("change", "place"), CASES, ids=[change.__name__.strip("_") for change, _ in CASES])
async def test_the_place_is_named(
    change: Change,
    place: str,
    body: dict[str, Any],
    rest: httpx.AsyncClient,
    data: Path,
) -> None:
    change(body)
    answer = await rest.post("/v1/renders", content=json.dumps(body))
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    told = answer.json()
    assert place in [problem["place"] for problem in told["problems"]]
    await _nothing_left(rest, data)


async def test_all_problems_are_told_at_once(body: dict[str, Any], rest: httpx.AsyncClient) -> None:
    _empty_film(body)
    _unknown_field(body)
    _no_request_id(body)
    told = (await rest.post("/v1/renders", json=body)).json()
    places = [problem["place"] for problem in told["problems"]]
    assert places == ["$.request_id", "$.width", "$.surfaces[0].colour"]


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"width": -5}, "$.width"),
        ({"width": "40"}, "$.width"),
        ({"width": 40.5}, "$.width"),
        ({"samples": None}, "$.samples"),
        ({"scene": []}, "$.scene"),
        ({"colour": 1}, "$.colour"),
    ],
)
async def test_the_envelope_is_strict(
    change: dict[str, Any], place: str, body: dict[str, Any], rest: httpx.AsyncClient, data: Path
) -> None:
    answer = await rest.post("/v1/renders", json={**body, **change})
    assert answer.status_code == 422
    assert [problem["place"] for problem in answer.json()["problems"]] == [place]
    await _nothing_left(rest, data)


@pytest.mark.parametrize("declared", [True, False], ids=["declared", "chunked"])
async def test_100_mb_are_not_read(declared: bool, rest: httpx.AsyncClient, data: Path) -> None:
    sent = 0

    async def pieces() -> AsyncIterator[bytes]:
        nonlocal sent
        yield b'{"scene": {"nocturne": "'
        for _ in range(100):
            sent += 1
            yield b"x" * 1_000_000

    headers = {"Content-Length": str(100_000_024)} if declared else {}
    answer = await rest.post("/v1/renders", content=pieces(), headers=headers)
    assert answer.status_code == 422
    assert "more than 8388608 bytes" in answer.json()["detail"]
    await _nothing_left(rest, data)


@pytest.mark.parametrize("levels", [100, 10_000])
async def test_deep_json(
    levels: int, body: dict[str, Any], rest: httpx.AsyncClient, channel: grpc.aio.Channel
) -> None:
    deep = "[" * levels + "]" * levels
    text = json.dumps(body).replace('"one lamp"', deep)
    answer = await rest.post("/v1/renders", content=text)
    assert answer.status_code == 422
    assert "nested deeper than 64" in answer.json()["detail"]

    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await _create(channel, body, json.dumps(body["scene"]).replace('"one lamp"', deep))
    assert caught.value.code() == grpc.StatusCode.INVALID_ARGUMENT
    assert "nested deeper than 64" in str(caught.value.details())


async def test_big_document_over_grpc(body: dict[str, Any], channel: grpc.aio.Channel) -> None:
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await _create(channel, body, json.dumps(body["scene"]) + " " * 2**23)
    assert caught.value.code() == grpc.StatusCode.INVALID_ARGUMENT
    with pytest.raises(grpc.aio.AioRpcError) as caught:
        await _create(channel, body, " " * 10 * 2**20)
    assert caught.value.code() == grpc.StatusCode.RESOURCE_EXHAUSTED


@pytest.mark.parametrize("text", ["", "{", "nonsense", '{"a": 1, "a": 2}', "[1]", '"x"', b"\xff\xfe{}"])
async def test_no_json(text: str | bytes, rest: httpx.AsyncClient) -> None:
    answer = await rest.post("/v1/renders", content=text)
    assert answer.status_code == 422
    assert answer.json()["problems"][0]["place"].startswith("$")


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("GET", "/v1/renders/none", 404),
        ("GET", "/v1/renders/none/preview.png", 404),
        ("GET", "/v1/renders/none/events", 404),
        ("GET", "/v1/renders/none/convergence", 404),
        ("POST", "/v1/renders/none:cancel", 404),
        ("GET", "/v1/nothing", 404),
        ("POST", "/v1/nothing", 404),
        ("DELETE", "/v1/renders", 405),
        ("GET", "/v1/renders?page_size=many", 422),
        ("GET", "/v1/renders?page_size=-1", 422),
        ("GET", "/v1/renders?page_token=guess", 422),
        ("GET", "/missing.js", 404),
    ],
)
async def test_every_error_is_a_problem_document(
    method: str, path: str, status: int, rest: httpx.AsyncClient
) -> None:
    answer = await rest.request(method, path)
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["status"] == status
    assert answer.headers["x-content-type-options"] == "nosniff"


async def _create(channel: grpc.aio.Channel, body: dict[str, Any], scene: str | None = None) -> pb.Render:
    fields = {key: body[key] for key in ("request_id", "name", "width", "height", "samples")}
    request = pb.CreateRenderRequest(scene_json=scene or json.dumps(body["scene"]), **fields)
    return await render_service_pb2_grpc.RenderServiceStub(channel).CreateRender(request)


async def _nothing_left(rest: httpx.AsyncClient, data: Path) -> None:
    assert (await rest.get("/v1/renders")).json()["renders"] == []
    assert [path for path in (data / "blobs").rglob("*") if path.is_file()] == []
