"""Photometry of renders and of files: stored regions, tables, isolines, glare, and refusals."""

import asyncio
import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from nocturne_api.service import Service
from nocturne_client import Client, contract
from nocturne_client.cli.app import app
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.measuring import glare_of_file, measure_file
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.ranges import TileGrid
from nocturne_scene.tile_sums import TileSums
from typer.testing import CliRunner

from tests.services.test_tiles import HEIGHT, TILE, WIDTH, Committer
from tests.sums import sums_of

SAMPLES = 8
Values = np.ndarray[Any, Any]
Rendered = Callable[..., Any]


def ramp(height: int, width: int) -> Values:
    """Samples whose Y is 100, 1 more for each column and 10 for each row, on the mean; X is twice, Z half."""
    y = 100.0 + np.arange(width) + 10.0 * np.arange(height)[:, None]
    noise = np.where(np.arange(SAMPLES) % 2, 1.1, 0.9)[:, None, None]
    return (y * noise)[..., None] * [2.0, 1.0, 0.5]


@pytest.fixture
def rendered(body: dict[str, Any], rest: httpx.AsyncClient, folder: DataFolder) -> Rendered:
    """Makes a render of samples, and its id."""

    async def render(drawn: Values, **changes: Any) -> str:
        height, width = drawn.shape[1:3]
        asked = {**body, "request_id": f"{width}x{height}", "width": width, "height": height, **changes}
        render_id = str((await rest.post("/v1/renders", json=asked)).json()["id"])
        grid = TileGrid.of(folder.renders.schedule(render_id))
        tiles: dict[int, tuple[int, TileSums, int]] = {}
        for index in range(grid.count):
            tile = grid.tile(index)
            part = drawn[:, tile.y : tile.y + tile.height, tile.x : tile.x + tile.width]
            tiles[index] = (len(drawn), sums_of(part), 0)
        committer = Committer(folder)
        committer.commit(render_id, tiles)
        committer.ownership.release()
        return render_id

    return render


async def test_parts_of_an_image_are_measured_across_tiles(
    rest: httpx.AsyncClient, rendered: Rendered
) -> None:
    render_id = await rendered(ramp(HEIGHT, WIDTH))
    assert TILE - 4 < TILE < TILE + 4 < WIDTH
    outlines = [
        {"name": "seam", "kind": "rectangle", "points": [[28, 4], [36, 8]]},
        {"kind": "line", "points": [[30, 5], [34, 5]]},
    ]
    asked = {"outlines": outlines, "bins": 4}
    told = (await rest.post(f"/v1/renders/{render_id}:measure", json=asked)).json()
    assert (told["quantity"], told["unit"], told["channel"]) == ("luminance", "cd/m2", "Y")
    seam, line = told["measurements"]
    assert (seam["pixels"], seam["mean"]) == (32, pytest.approx(100 + 31.5 + 55))
    low, high = seam["minimum"], seam["maximum"]
    assert (low["x"], low["y"], low["value"]) == (28, 4, pytest.approx(168))
    assert (high["x"], high["y"], high["value"]) == (35, 7, pytest.approx(205))
    # The error includes the variance of one more lit sample.
    assert 1.0 < low["standard_error"] / (168 * 0.1 / np.sqrt(SAMPLES - 1)) < 1.02
    assert [seam["u0"], seam["ud"]] == pytest.approx([168 / 186.5, 168 / 205])
    assert seam["u0_error"] > 0.0
    assert [each["value"] for each in line["profile"]] == pytest.approx([180, 181, 182, 183, 184])
    assert line["profile_csv"].startswith("distance_pixels,x,y,luminance cd/m2,standard_error\r\n0,30,5,180,")
    assert (sum(seam["histogram"]["counts"]), seam["histogram"]["outside"]) == (32, 0)
    assert len(seam["histogram"]["edges"]) == 5
    (of_seam, _) = csv.DictReader(io.StringIO(told["csv"]))
    assert (of_seam["name"], of_seam["unit"], float(of_seam["mean"])) == ("seam", "cd/m2", 186.5)
    of_x = (await rest.post(f"/v1/renders/{render_id}:measure", json={"channel": "X"})).json()
    assert of_x["quantity"] == "X"
    assert of_x["measurements"][0]["pixels"] == WIDTH * HEIGHT


async def test_regions_are_kept_with_their_render(
    rest: httpx.AsyncClient, rendered: Rendered, folder: DataFolder
) -> None:
    render_id = await rendered(ramp(HEIGHT, WIDTH))
    address = f"/v1/renders/{render_id}/regions"
    assert (await rest.get(address)).json() == {"regions": []}
    regions = [{"name": "desk", "kind": "polygon", "points": [[1, 1], [9, 1], [5, 9.5]]}]
    assert (await rest.put(address, json={"regions": regions})).json() == {"regions": regions}
    assert (await rest.get(address)).json() == {"regions": regions}
    told = (await rest.post(f"/v1/renders/{render_id}:measure", json={})).json()
    assert [each["outline"] for each in told["measurements"]] == regions
    await rest.post(f"/v1/renders/{render_id}:cancel")
    folder.database.execute("UPDATE render SET state = 'CANCELLED'")
    assert (await rest.delete(f"/v1/renders/{render_id}")).status_code == 204
    assert folder.database.rows("SELECT * FROM measured_region") == []


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"outlines": [{"kind": "rectangle", "points": [[0, 0], [41, 3]]}]}, "$.outlines[0].points"),
        ({"outlines": [{"kind": "line", "points": [[0, 0, 0], [1, 1]]}]}, "[x, y] for each point"),
        ({"outlines": [{"kind": "circle", "points": []}]}, "$.outlines[0].kind"),
        ({"channel": "rods"}, "expected X, Y, Z"),
        ({"bins": 100_000}, "$.bins"),
    ],
)
async def test_what_cannot_be_measured_is_refused_with_its_place(
    rest: httpx.AsyncClient, body: dict[str, Any], asked: dict[str, Any], message: str
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    answer = await rest.post(f"/v1/renders/{render_id}:measure", json=asked)
    assert answer.status_code == 422
    assert message in answer.text
    assert (await rest.post(f"/v1/renders/{render_id}:measure", json={})).status_code == 404


async def test_isolines_are_where_the_image_has_their_value(
    rest: httpx.AsyncClient, rendered: Rendered
) -> None:
    render_id = await rendered(ramp(HEIGHT, WIDTH))
    address = f"/v1/renders/{render_id}/isolines"
    told = (await rest.get(address, params={"level": [250.0, 150.0]})).json()
    assert [each["level"] for each in told["isolines"]] == [150.0, 250.0]
    assert (told["unit"], told["block"]) == ("cd/m2", 1)
    for each in told["isolines"]:
        (line,) = each["lines"]
        # A pixel's value is at its middle.
        values = [100 + (x - 0.5) + 10 * (y - 0.5) for x, y in line]
        assert values == pytest.approx([each["level"]] * len(line))
    by_itself = (await rest.get(address)).json()["isolines"]
    assert [each["level"] for each in by_itself] == [200.0]


async def test_glare_is_of_panoramas(
    rest: httpx.AsyncClient, rendered: Rendered, scene: dict[str, Any], body: dict[str, Any]
) -> None:
    body["scene"]["sensor"] = {"type": "panorama", "position": [0, 0, 4], "look_at": [0, 0, 0]}
    even = np.full((2, 32, 64, 3), 1000.0)
    render_id = await rendered(even)
    # By a threshold, whether the scene's own layers are there yet or not.
    told = (await rest.get(f"/v1/renders/{render_id}/glare", params={"threshold": 2000})).json()
    assert told["vertical_illuminance"] == pytest.approx(np.pi * 1000, rel=0.005)
    assert told["dgp"] == pytest.approx(5.87e-5 * np.pi * 1000 + 0.16, rel=0.005)
    assert (told["ugr"], told["sources"]) == (None, [])
    seen = (await rest.get(f"/v1/renders/{render_id}/glare", params={"threshold": 500})).json()
    assert len(seen["sources"]) == 1
    body["scene"] = scene
    body["scene"]["sensor"] = {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "vertical_field_of_view_degrees": 40,
    }
    other = await rendered(even, request_id="pinhole")
    answer = await rest.get(f"/v1/renders/{other}/glare")
    assert answer.status_code == 422
    assert "sensor of type panorama" in answer.text


async def test_the_client_and_the_command_line_measure_renders(
    service: Service, rendered: Rendered, body: dict[str, Any]
) -> None:
    url = f"http://127.0.0.1:{service.port}"
    body["scene"]["sensor"] = {"type": "panorama", "position": [0, 0, 4], "look_at": [0, 0, 0]}
    render_id = await rendered(np.repeat(ramp(32, 64)[:2], 2, axis=0))

    def use() -> None:
        with Client(url) as client:
            seam = contract.Outline("seam", "rectangle", [[28, 4], [36, 8]])
            found = client.measure(render_id, [seam], "X", 4, (0.0, 1000.0))
            assert found.quantity == "X"
            (measured,) = found.measurements
            assert measured.histogram is not None
            assert sum(measured.histogram.counts) == 32
            assert [each.level for each in client.isolines(render_id, [200.0]).isolines] == [200.0]
            assert client.glare(render_id, azimuth=90.0, threshold=1.0).vertical_illuminance > 0.0
            assert client.regions(render_id).regions == []
        words = CliRunner().invoke(
            app, ["measure", render_id, "--polygon", "1,1 9,1 5,9", "--keep", "--url", url]
        )
        assert "luminance in cd/m2" in words.output
        with Client(url) as client:
            assert [each.kind for each in client.regions(render_id).regions] == ["polygon"]

    await asyncio.to_thread(use)


async def test_the_exr_of_a_running_render_has_what_is_committed(
    rest: httpx.AsyncClient, rendered: Rendered, tmp_path: Path
) -> None:
    render_id = await rendered(ramp(HEIGHT, WIDTH))
    path = tmp_path / "now.exr"
    path.write_bytes((await rest.get(f"/v1/renders/{render_id}/image.exr")).content)
    seam = contract.Outline("", "rectangle", [[28, 4], [36, 8]])
    of_file = measure_file(path, [seam], "Y", 0)
    asked = {"outlines": [{"kind": "rectangle", "points": seam.points}]}
    of_render = (await rest.post(f"/v1/renders/{render_id}:measure", json=asked)).json()
    (one,), (other,) = of_file.measurements, of_render["measurements"]
    assert one.mean == pytest.approx(other["mean"], rel=1e-6)
    assert one.mean_error == pytest.approx(other["mean_error"], rel=1e-4)
    assert of_file.unit == "cd/m2"


async def test_the_scene_comes_back_as_it_was_submitted(
    rest: httpx.AsyncClient, body: dict[str, Any]
) -> None:
    render_id = (await rest.post("/v1/renders", json=body)).json()["id"]
    assert (await rest.get(f"/v1/renders/{render_id}/scene.json")).json() == body["scene"]
    assert (await rest.get("/v1/renders/none/scene.json")).status_code == 404
    assert (await rest.get(f"/v1/renders/{render_id}/image.exr")).status_code == 404


# --- files, and the command line ---


def image(folder: Path, drawn: Values, quantity: str = "luminance") -> Path:
    path = folder / "image.exr"
    sums = sums_of(drawn)
    counts = np.full(drawn.shape[1:3], len(drawn), dtype=np.uint32)
    squares = Squares(sums.block_products, sums.tile_products[None], max(drawn.shape[1:3]))
    write_image(path, sums.pixels, counts, squares, Provenance("0" * 64, "", 2, quantity=quantity))
    return path


def run(*arguments: str) -> str:
    found = CliRunner().invoke(app, [*arguments])
    assert found.exit_code == 0, found.output
    return found.output


def test_a_file_is_measured_as_a_render_is(tmp_path: Path) -> None:
    path = image(tmp_path, ramp(16, 32), "illuminance")
    told = json.loads(run("measure", str(path), "--region", "2,3,4,5", "--json"))
    (found,) = told["measurements"]
    assert (told["quantity"], told["unit"]) == ("illuminance", "lx")
    assert found["mean"] == pytest.approx(100 + 3.5 + 50, rel=1e-6)
    # The error includes the variance of one more lit sample.
    assert 1.0 < found["minimum"]["standard_error"] / (132 * 0.1 / np.sqrt(SAMPLES - 1)) < 1.02
    words = run("measure", str(path), "--region", "2,3,4,5", "--polygon", "0,0 8,0 0,8", "--histogram", "3")
    assert "illuminance in lx, with 95 % intervals" in words
    assert "polygon 0,0 8,0 0,8" in words
    profile = run("measure", str(path), "--line", "0,0,3,0", "--csv").splitlines()
    assert [row.split(",")[3] for row in profile] == ["illuminance lx", "100", "101", "102", "103"]
    table = run("measure", str(path), "--region", "0,0,2,2", "--region", "2,2,2,2", "--csv").splitlines()
    assert len(table) == 3


def test_a_picture_is_no_measurable_image(tmp_path: Path) -> None:
    picture = tmp_path / "a.png"
    picture.write_bytes(b"PNG")
    found = CliRunner().invoke(app, ["measure", str(picture)])
    assert isinstance(found.exception, NocturneClientError)
    assert "give the EXR of the image" in str(found.exception)


def test_the_glare_of_a_fisheye_file(tmp_path: Path) -> None:
    path = image(tmp_path, np.full((2, 64, 64, 3), 500.0))
    told = json.loads(run("glare", str(path), "--projection", "equidistant", "--json"))
    assert told["vertical_illuminance"] == pytest.approx(np.pi * 500, rel=0.02)
    told = run("glare", str(path), "--projection", "equidistant")
    assert "unified glare rating not known" in told
    assert "note: UGR is not known: nothing has 2000 cd/m2 or more" in told
    with pytest.raises(NocturneClientError) as refused:
        glare_of_file(path, "cube", 180.0, (0.0, 0.0, None))
    assert "expected panorama" in str(refused.value.problems[0])
    meter = image(tmp_path, np.full((2, 16, 32, 3), 500.0), "illuminance")
    with pytest.raises(NocturneClientError) as refused:
        glare_of_file(meter, "panorama", 180.0, (0.0, 0.0, None))
    assert "this image is of illuminance" in str(refused.value.problems[0])


def test_a_file_that_has_not_the_shape_of_a_panorama_is_rated_with_a_note(tmp_path: Path) -> None:
    for width, projection, warned in (
        (32, "panorama", True),
        (32, "equidistant", False),
        (64, "panorama", False),
    ):
        path = image(tmp_path, np.full((2, 32, width, 3), 500.0))
        notes = glare_of_file(path, projection, 180.0, (0.0, 0.0, None)).notes
        assert any("another camera's image" in note for note in notes) == warned


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--polygon", "0,0 1,1"], "expected three corners"),
        (["--line", "0,0,1"], "expected X0,Y0,X1,Y1"),
        (["--region", "30,0,9,9"], "outside of the film"),
        (["--channel", "rods"], "expected X, Y, Z"),
        (["--keep"], "kept with renders"),
    ],
)
def test_wrong_parts_are_refused(tmp_path: Path, arguments: list[str], message: str) -> None:
    path = image(tmp_path, ramp(16, 32))
    found = CliRunner().invoke(app, ["measure", str(path), *arguments])
    assert isinstance(found.exception, NocturneClientError)
    told = [str(found.exception), *map(str, found.exception.problems)]
    assert any(message in each for each in told)
    with pytest.raises(NocturneClientError):
        measure_file(tmp_path / "none.exr", [], "Y", 0)
