"""Bad input to a service in a separate process, at both endpoints; tests/services has every kind of it."""

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import grpc
import httpx
import numpy as np
import pytest
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc
from nocturne_client import Client
from nocturne_client.local.programs import need_program

from tests.system.renders import CORNELL
from tests.system.up import Up

pytestmark = pytest.mark.system

_REFLECTANCE = "$.surfaces[3].kernel.reflectance"


def _unknown_spectrum(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][3]["kernel"] = {"type": "lambertian", "reflectance": "whyte"}


def _missing_asset(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][1]["shape"] = {"type": "mesh", "asset": "sha256:" + "0" * 64, "format": "ply"}


def _nan_vertex(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][2]["shape"]["vertices"][1][2] = float("nan")


def _index_out_of_range(body: dict[str, Any]) -> None:
    body["scene"]["surfaces"][2]["shape"]["triangles"][1][0] = 99


def _no_luminaire(body: dict[str, Any]) -> None:
    for surface in body["scene"]["surfaces"]:
        surface.pop("luminaire", None)


def _huge_film(body: dict[str, Any]) -> None:
    body["width"] = 2**31


def _deep(body: dict[str, Any]) -> None:
    body["scene"]["note"] = _DEEP_MARK


_DEEP_MARK = "ten thousand levels"
_DEEP = '{"x":' * 10_000 + "0" + "}" * 10_000


def _text(value: Any) -> str:
    return json.dumps(value).replace(json.dumps(_DEEP_MARK), _DEEP)


@pytest.fixture
def body() -> dict[str, Any]:
    """A good request."""
    scene = json.loads(CORNELL.read_text())
    return {"request_id": "bad", "name": "", "scene": scene, "width": 64, "height": 64, "samples": 16}


@pytest.fixture
def nothing_comes_of_it(running_service: Up) -> Iterator[None]:
    """No render, and no file in the data folder that was not there before."""
    before = _files(running_service.data)
    yield
    assert httpx.get(f"{running_service.url}/v1/renders", trust_env=False).json()["renders"] == []
    assert _files(running_service.data) == before


@pytest.mark.usefixtures("nothing_comes_of_it")
@pytest.mark.parametrize(
    ("spoil", "place", "message"),
    [
        (_unknown_spectrum, _REFLECTANCE, "white"),
        (_missing_asset, "$.surfaces[1].shape.asset", "upload"),
        (_nan_vertex, "$.surfaces[2].shape.vertices[1][2]", "finite"),
        (_index_out_of_range, "$.surfaces[2].shape.triangles[1][0]", "99"),
        (_no_luminaire, "$.surfaces", "luminaire"),
        (_huge_film, "$.width", "16384"),
        (_deep, "$", "nested deeper than 64"),
    ],
)
def test_both_endpoints_name_place_and_reason(
    spoil: Any, place: str, message: str, body: dict[str, Any], running_service: Up
) -> None:
    spoil(body)
    answer = httpx.post(
        f"{running_service.url}/v1/renders", content=_text(body), trust_env=False, timeout=300
    )
    assert (answer.status_code, answer.headers["content-type"]) == (422, "application/problem+json")
    problem = answer.json()["problems"][0]
    assert problem["place"] == place
    assert message in problem["message"]

    error = _refusal_by_grpc(running_service.grpc, body)
    assert error.code() is grpc.StatusCode.INVALID_ARGUMENT
    assert f"{problem['place']}: " in str(error.details())
    assert message in str(error.details())


@pytest.mark.usefixtures("nothing_comes_of_it")
def test_100_mb_of_json_are_refused(running_service: Up) -> None:
    def pieces() -> Iterator[bytes]:
        yield b'{"name": "'
        for _ in range(100):
            yield b"x" * 1_000_000

    answer = httpx.post(f"{running_service.url}/v1/renders", content=pieces(), trust_env=False, timeout=300)
    assert answer.status_code == 422
    assert "more than 8388608 bytes" in answer.json()["detail"]


def test_a_billion_voxels_in_a_header(body: dict[str, Any], running_service: Up, tmp_path: Path) -> None:
    """A file of a few kilobytes that claims 4 GB: refused by the compiler's child, before it reads values."""
    np.ones((9, 9, 9), "<f4").tofile(tmp_path / "ones.f32")
    grids = [{"name": "density", "file": "ones.f32"}]
    (tmp_path / "ones.json").write_text(json.dumps({"dims": [9, 9, 9], "voxel_size": 0.01, "grids": grids}))
    command: list[str | Path] = [need_program("nocturne-grid"), "create", tmp_path / "ones.json"]
    subprocess.run([*command, "-o", tmp_path / "ones.vdb"], check=True, capture_output=True)
    data = bytearray((tmp_path / "ones.vdb").read_bytes())
    # Name, then "int64" and the value, each after its length.
    at = data.index(b"file_voxel_count") + len("file_voxel_count") + 4 + len("int64") + 4
    data[at : at + 8] = (1_000_000_000).to_bytes(8, "little")
    (tmp_path / "huge.vdb").write_bytes(data)
    with Client(running_service.url) as client:
        asset = client.upload(tmp_path / "huge.vdb")
    before = _files(running_service.data)
    density = {"asset": f"sha256:{asset}", "grid": "density"}
    body["scene"]["media"] = {"smoke": {"scattering": 1, "density": density}}
    box = {"shape": {"type": "medium_box", "medium": "smoke"}, "interior": {"media": ["smoke"]}}
    body["scene"]["surfaces"].append(box)
    answer = httpx.post(f"{running_service.url}/v1/renders", json=body, trust_env=False, timeout=300)
    assert answer.status_code == 422
    problem = answer.json()["problems"][0]
    assert problem["place"] == "$.media.smoke.density.asset"
    assert "says that it has 1000000000 voxels; at most 500000000 are read" in problem["message"]
    assert _files(running_service.data) == before


def _refusal_by_grpc(target: str, body: dict[str, Any]) -> Any:
    """The error; typed as Any because grpc's exceptions are not those of its type stubs."""
    fields = {key: body[key] for key in ("request_id", "name", "width", "height", "samples")}
    request = render_service_pb2.CreateRenderRequest(scene_json=_text(body["scene"]), **fields)
    with grpc.insecure_channel(target) as channel:
        service = render_service_pb2_grpc.RenderServiceStub(channel)
        with pytest.raises(grpc.RpcError) as caught:
            service.CreateRender(request, timeout=300)
    return caught.value


def _files(data: Path) -> set[Path]:
    """All but logs and SQLite's own."""
    kept = (path for path in data.rglob("*") if path.is_file())
    return {path for path in kept if path.suffix != ".log" and not path.name.startswith("nocturne.db")}
