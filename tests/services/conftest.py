"""A real API on a fresh data folder, both endpoints on free ports."""

import copy
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import grpc
import httpx
import pytest
from nocturne_api.service import Service
from nocturne_coordinator.store.data_folder import DataFolder

from tests.services.endpoints import grpc_channel, rest_client, running

SCENE: dict[str, Any] = {
    "nocturne": 1,
    "name": "one lamp",
    "spectra": {"white": {"table": [[400, 0.5], [700, 0.5]]}, "lamp": {"blackbody": 3000}},
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "surfaces": [
        {
            "name": "floor",
            "shape": {
                "type": "mesh",
                "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
                "triangles": [[0, 1, 2]],
            },
            "kernel": {"type": "lambertian", "reflectance": "white"},
        },
        {
            "name": "lamp",
            "shape": {"type": "quad", "corner": [0, 0, 2], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.0},
            "luminaire": {"radiance": "lamp", "two_sided": True},
        },
    ],
}


@pytest.fixture
def scene() -> dict[str, Any]:
    """A small scene document; the test may change it."""
    return copy.deepcopy(SCENE)


@pytest.fixture
def body(scene: dict[str, Any]) -> dict[str, Any]:
    """A create request for `scene`."""
    return {"request_id": "first", "name": "lamp", "scene": scene, "width": 40, "height": 30, "samples": 16}


@pytest.fixture
def web(tmp_path: Path) -> Path:
    """The folder of the page, built."""
    folder = tmp_path / "web"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<!doctype html><title>page</title>")
    (folder / "reference.html").write_text("<!doctype html><title>reference</title>")
    (folder / "assets" / "index-abc123.js").write_text("export {}")
    (tmp_path / "secret.txt").write_text("not for the web")
    return folder


@pytest.fixture
async def service(tmp_path: Path, web: Path) -> AsyncIterator[Service]:
    async with running(tmp_path, web) as service:
        yield service


@pytest.fixture
async def rest(service: Service) -> AsyncIterator[httpx.AsyncClient]:
    async with rest_client(service) as client:
        yield client


@pytest.fixture
async def channel(service: Service) -> AsyncIterator[grpc.aio.Channel]:
    async with grpc_channel(service) as channel:
        yield channel


@pytest.fixture
def folder(service: Service, tmp_path: Path) -> Iterator[DataFolder]:
    """The data folder as another process sees it: what a coordinator writes is written through this."""
    assert service.port
    folder = DataFolder(tmp_path / "data")
    yield folder
    folder.close()
