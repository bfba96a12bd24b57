"""Documents whose meters measure daylight coefficients: what is compiled, how its film is cut, what is
refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight_ranges import daylight_range_ends
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import film_size
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film
from nocturne_scene.ranges import TileGrid, extended_schedule
from nocturne_scene.scene_ranges import schedule_for_scene
from nocturne_scene.tile_sums import TileSums, decode

from tests.weather import epw

_GREY = {"type": "lambertian", "reflectance": 0.5}


def _document(blobs: BlobStore, of: str, weather: str = "", **further: Any) -> dict[str, Any]:
    year = {"of": of, "weather": {"asset": "sha256:" + blobs.put((weather or epw()).encode())}, **further}
    floor = {"type": "quad", "corner": [0, 0, 0], "edge_u": [0, 0, 4], "edge_v": [4, 0, 0]}
    lamp = {"type": "quad", "corner": [0, 3, 0], "edge_u": [1, 0, 0], "edge_v": [0, 0, 1]}
    return {
        "nocturne": 1,
        "sensor": {
            "type": "meters",
            "instruments": [{"name": "desk", "points": [[1, 1, 1], [2, 1, 1]], "normal": [0, 1, 0]}],
            "daylight": year,
        },
        "surfaces": [
            {"shape": floor, "kernel": _GREY},
            {"shape": lamp, "kernel": _GREY, "luminaire": {"radiance": 1.0}},
        ],
    }


def _compiled(folder: Path, of: str, **further: Any) -> tuple[scene_pb2.CompiledScene, BlobStore, str]:
    blobs = BlobStore(folder, durable=False)
    document = check_document(_document(blobs, of, **further))
    film = Film(*film_size(document.sensor, 1, 1), 64)
    assert (film.width, film.height) == (2, 32)
    digest = compile_scene(document, blobs, film).scene_sha256
    return scene_pb2.CompiledScene.FromString(blobs.path(digest).read_bytes()), blobs, digest


def test_lamps_are_left_out_and_patches_counted(tmp_path: Path) -> None:
    scene, blobs, digest = _compiled(tmp_path, "sky", patches=145)
    assert not scene.luminaires
    # One batch has two meters.
    assert len(scene.sensor.meters) == 2
    assert (scene.daylight.divisions, len(scene.daylight.patches)) == (1, 0)
    assert not scene.daylight.reflected_alone
    schedule = schedule_for_scene(blobs, digest, 2, 32, 64)
    assert schedule.coefficients == Patches(1).count == 146
    assert list(schedule.range_ends) == [1, 32, 64] == daylight_range_ends(64)
    more = extended_schedule(schedule, 256)
    assert list(more.range_ends) == [1, 32, 64, 128, 256]
    assert more.coefficients == 146


def test_suns_are_counted_once_and_straight(tmp_path: Path) -> None:
    scene, blobs, digest = _compiled(tmp_path, "sun_straight", patches=145)
    suns = np.array([[each.x, each.y, each.z] for each in scene.daylight.suns])
    assert 2000 < len(suns) < 4380
    # All above the horizon; in the north of the Earth most of them in the south, which is +z.
    assert suns[:, 1].min() > 0
    assert np.mean(suns[:, 2] > 0) > 0.7
    schedule = schedule_for_scene(blobs, digest, 2, 32, 64)
    assert schedule.coefficients == len(suns) + 1
    assert list(schedule.range_ends) == [1]
    # A result is not much more than half a megabyte.
    tile = TileGrid.of(schedule).tile(0)
    assert 8 * schedule.coefficients * tile.width * tile.height < 600_000


def test_patches_of_the_sun_are_those_where_it_is(tmp_path: Path) -> None:
    scene, blobs, digest = _compiled(tmp_path, "sun_reflected", sun_patches=145)
    assert scene.daylight.reflected_alone
    assert scene.environment.HasField("map")
    assert 30 < len(scene.daylight.patches) < 100
    assert schedule_for_scene(blobs, digest, 2, 32, 64).coefficients == len(scene.daylight.patches)


def test_melanopic_light_has_another_response_alone(tmp_path: Path) -> None:
    plain, *_ = _compiled(tmp_path, "sky")
    seen, *_ = _compiled(tmp_path, "sky", melanopic=True)
    assert list(seen.sensor.response_x) == list(seen.sensor.response_y) != list(plain.sensor.response_y)
    for each in (plain, seen):
        each.sensor.Clear()
    assert plain == seen


@pytest.mark.parametrize(
    ("further", "said"),
    [
        ({"weather": "LOCATION,nowhere"}, "line 1: 2 fields; expected 10"),
        ({"north": [0, 1, 0]}, "north is straight up"),
        ({"batches": 33}, "multiple of 8"),
        ({"patches": 100}, "one of 145, 577, 2305"),
    ],
)
def test_what_is_no_year_is_refused(tmp_path: Path, further: dict[str, Any], said: str) -> None:
    blobs = BlobStore(tmp_path, durable=False)
    with pytest.raises(InputError, match=said):
        compile_scene(check_document(_document(blobs, "sky", **further)), blobs, Film(2, 32, 64))


def test_too_many_meters_are_refused(tmp_path: Path) -> None:
    blobs = BlobStore(tmp_path, durable=False)
    document = _document(blobs, "sun_straight", batches=64)
    grid = {"corner": [0, 1, 0], "right": [4, 0, 0], "up": [0, 0, -4], "columns": 64, "rows": 64}
    document["sensor"]["instruments"] = [{"name": "room", "grid": grid}]
    with pytest.raises(InputError, match="GB of daylight coefficients; at most 4"):
        compile_scene(check_document(document), blobs, Film(64, 4096, 64))


def test_coefficients_follow_the_sums_of_a_tile() -> None:
    plain = TileSums.zeros(4, 4)
    daylight = np.arange(48.0).reshape(4, 4, 3)
    both = TileSums(plain.pixels, plain.block_products, plain.tile_products, daylight)
    found = decode(both.encode(), 4, 4, 0)
    assert np.array_equal(found.coefficients, daylight)
    both += found
    assert np.array_equal(both.coefficients, 2 * found.coefficients)
    with pytest.raises(ValueError, match="no sums of 4 x 4"):
        decode(both.encode()[:-8], 4, 4, 0)
