"""Glare of renders and files with a layer of luminaires, which is made by default."""

import asyncio
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from nocturne_client.cli.app import app
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.errors import InputError
from nocturne_scene.ranges import TileGrid
from typer.testing import CliRunner

from tests.services.test_tiles import Committer
from tests.sums import sums_of

WIDTH, HEIGHT = 128, 64
PANORAMA = {"type": "panorama", "position": [0, 0, 4], "look_at": [0, 0, 0]}
LAMP = math.atan(1 / (2 * math.sqrt(6)))
"""Solid angle of a square of 1 m, 2 m away, from straight below a corner: atan(a b / (d sqrt(a2 + b2 + d2))),
with a = b = 1 and d = 2."""


@pytest.fixture
def body(body: dict[str, Any]) -> dict[str, Any]:
    body["scene"]["sensor"] = dict(PANORAMA)
    return {**body, "width": WIDTH, "height": HEIGHT}


async def until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(60):
        while not true():  # noqa: ASYNC110 - another process makes the layers
            await asyncio.sleep(0.02)


def commit(folder: DataFolder, render_id: str, luminance: float) -> None:
    """The same in all pixels."""
    grid = TileGrid.of(folder.renders.schedule(render_id))
    tiles = [grid.tile(index) for index in range(grid.count)]
    sums = {
        index: (2, sums_of(np.full((2, tile.height, tile.width, 3), luminance)), 0)
        for index, tile in enumerate(tiles)
    }
    committer = Committer(folder)
    committer.commit(render_id, sums)
    committer.ownership.release()


async def test_the_luminaires_of_a_panorama_are_known(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    made = (await rest.post("/v1/renders", json=body)).json()
    assert (made["layers"], made["sensor"]) == (["emission"], "panorama")
    await until(lambda: bool(folder.renders.get(made["id"]).layers_sha256))
    commit(folder, made["id"], 500.0)
    address = f"/v1/renders/{made['id']}/glare"
    told = (await rest.get(address)).json()
    (lamp,) = told["sources"]
    assert lamp["solid_angle"] == pytest.approx(LAMP, rel=0.01)
    assert lamp["luminance"] == pytest.approx(500.0)
    assert told["ugr"] is not None
    assert told["dgp_sources"] == []
    assert not any("layer" in note for note in told["notes"])
    away = (await rest.get(address, params={"azimuth": 180})).json()
    assert (away["ugr"], away["sources"]) == (None, [])
    assert any("no luminaire is in sight" in note for note in away["notes"])
    bright = (await rest.get(address, params={"threshold": 400})).json()
    # All that is seen.
    assert [each["solid_angle"] for each in bright["sources"]] == pytest.approx([2 * math.pi], rel=1e-3)
    assert bright["sources"] == bright["dgp_sources"]


async def test_a_panorama_without_luminaires_has_no_layer(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    del body["scene"]["surfaces"][1]["luminaire"]
    body["scene"]["environment"] = {"radiance": 1}
    made = (await rest.post("/v1/renders", json=body)).json()
    assert made["layers"] == []
    commit(folder, made["id"], 500.0)
    told = (await rest.get(f"/v1/renders/{made['id']}/glare")).json()
    assert told["ugr"] is None
    assert any("no layer emission: UGR's sources are pixels of 2000 cd/m2" in note for note in told["notes"])


async def test_what_is_made_without_being_asked_for_is_no_part_of_the_request(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its making may fail, and the request is still the same."""

    def fails(*_: object) -> str:
        raise InputError.at("$.layers", "can't be made, as nocturne-trace failed")

    monkeypatch.setattr("nocturne_api.background.layer_builder.layers_in_child", fails)
    made = (await rest.post("/v1/renders", json=body)).json()
    await until(lambda: not folder.layers.due())
    assert (await rest.get(f"/v1/renders/{made['id']}")).json()["layers"] == []
    again = await rest.post("/v1/renders", json=body)
    assert (again.status_code, again.json()["id"]) == (201, made["id"])


async def test_layers_that_are_asked_for_are_beside_it(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    made = (await rest.post("/v1/renders", json={**body, "layers": ["depth"]})).json()
    assert made["layers"] == ["depth", "emission"]
    large = {**body, "request_id": "large", "width": 4096, "height": 2048}
    assert (await rest.post("/v1/renders", json=large)).json()["layers"] == []


def test_the_command_line_rates_what_it_rendered(scene: dict[str, Any], tmp_path: Path) -> None:
    scene["sensor"] = {**PANORAMA, "position": [0.5, 0.5, 4], "look_at": [0.5, 3, 4], "up": [0, 0, 1]}
    scene["surfaces"][1]["luminaire"]["radiance"] = {"blackbody": 3000, "luminance": 700}
    scene["environment"] = {"radiance": {"illuminant": "E", "luminance": 50}}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    image = tmp_path / "image.exr"

    def run(*arguments: str) -> str:
        found = CliRunner().invoke(app, [*arguments])
        assert found.exit_code == 0, found.output
        return found.output

    size = ["--width", "128", "--height", "64", "--samples", "16"]
    run("render", str(tmp_path / "scene.json"), "-o", str(image), *size)
    below = json.loads(run("glare", str(image), "--elevation", "-60", "--json"))
    (lamp,) = below["sources"]
    assert lamp["luminance"] == pytest.approx(700.0, rel=0.02)
    # The square is straight below: four times one with a = b = 1 / 2.
    assert lamp["solid_angle"] == pytest.approx(4 * math.atan(0.25 / (2 * math.sqrt(4.5))), rel=0.01)
    assert lamp["elevation_degrees"] == pytest.approx(-30.0, abs=0.5)
    assert below["ugr"] is not None
    assert below["dgp_sources"] == []
    shown = run("glare", str(image), "--elevation", "-60")
    assert "source of UGR" in shown
    assert "source of DGP" not in shown
    assert "unified glare rating not known" in run("glare", str(image), "--elevation", "60")
    assert "note: no luminaire" not in run("glare", str(image), "--elevation", "60", "--threshold", "40")
