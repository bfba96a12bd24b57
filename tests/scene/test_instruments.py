"""Meters as documents have them: grids of the standard, the film that follows, and places in metres."""

from typing import Any

import pytest
from nocturne.v1 import scene_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.instruments import MeterGrid
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import Meters, film_size
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film
from nocturne_scene.photometry.places import Places

LAMP = {
    "shape": {"type": "sphere", "centre": [0, 3, 0], "radius": 0.1},
    "kernel": {"type": "lambertian", "reflectance": 0},
    "luminaire": {"radiance": 1.0},
}
DESK = {"name": "desk", "grid": {"corner": [0, 0.75, 5], "right": [6, 0, 0], "up": [0, 0, -5], "border": 0.5}}
EYES = {"name": "eyes", "points": [[1, 1.2, 1], [2, 1.2, 1]], "normal": [0, 0, -1]}


def _document(*instruments: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {
        "nocturne": 1,
        "sensor": {"type": "meters", "instruments": [*instruments], **more},
        "surfaces": [LAMP],
    }


def _sensor(*instruments: dict[str, Any], **more: Any) -> Meters:
    sensor = check_document(_document(*instruments, **more)).sensor
    assert isinstance(sensor, Meters)
    return sensor


@pytest.mark.parametrize(("edge", "points"), [(1.0, 5), (2.0, 6), (5.0, 8), (10.0, 10), (100.0, 20)])
def test_points_of_en_12464(edge: float, points: int) -> None:
    """EN 12464-1, table A.1: areas by their longer side, and numbers of points along it."""
    grid = MeterGrid(corner=(0, 0, 0), right=(edge, 0, 0), up=(0, edge, 0))
    assert grid.cells() == (points, points)


def test_a_long_area_goes_by_its_shorter_side() -> None:
    corridor = MeterGrid(corner=(0, 0, 0), right=(20, 0, 0), up=(0, 2, 0))
    assert corridor.cells() == (60, 6)


def test_the_border_is_left_out() -> None:
    """5 m x 4 m are left: p = 0.616, 8 cells along 5 m, 6.4 along 4 m."""
    sensor = _sensor(DESK)
    assert sensor.layout() == ((8, 6), [(0, 0)])


def test_the_film_follows_from_the_instruments() -> None:
    sensor = _sensor(EYES, DESK, {"name": "roof", "points": [[0, 9, 0]]}, EYES | {"name": "more"})
    size, places = sensor.layout()
    assert size == (8, 8)
    assert places == [(0, 0), (0, 1), (0, 7), (1, 7)]
    assert film_size(sensor, 512, 512) == (8, 8)


def test_places_in_metres(tmp_path: Any) -> None:
    """The upper left cell of the plan is at small x and small z, as up is -z here."""
    document = check_document(_document(DESK, EYES, outdoor="eyes"))
    blobs = BlobStore(tmp_path)
    scene = compile_scene(document, blobs, Film(8, 7, 16))
    sensor = scene_pb2.CompiledScene.FromString(blobs.path(scene.scene_sha256).read_bytes()).sensor
    assert len(sensor.meters) == 56
    found = Places.read(sensor.instruments, 8, 7)
    assert found.outdoor == "eyes"
    assert [name for name, _ in found.outlines()] == ["desk", "eyes"]
    assert found.place(0, 0) == pytest.approx((0.5 + 0.3125, 0.75, 0.5 + 4 / 12))
    assert found.place(7, 5) == pytest.approx((5.5 - 0.3125, 0.75, 4.5 - 4 / 12))
    assert found.place(1, 6) == pytest.approx((2, 1.2, 1))
    assert found.place(5, 6) is None
    for x, y in ((0, 0), (7, 5), (1, 6)):
        # Right, up and forward of the pose are x, y and -z.
        meter, place = sensor.meters[8 * y + x].place, found.place(x, y)
        middle = document.sensor.position
        assert place is not None
        assert (middle[0] + meter.x, middle[1] + meter.y, middle[2] - meter.z) == pytest.approx(place)


def test_a_film_of_a_plane_in_metres(tmp_path: Any) -> None:
    meter = {
        "type": "irradiance_meter",
        "position": [1, 2, 3],
        "normal": [0, 1, 0],
        "up": [0, 0, -1],
        "height": 2,
    }
    document = check_document({"nocturne": 1, "sensor": meter, "surfaces": [LAMP]})
    blobs = BlobStore(tmp_path)
    scene = compile_scene(document, blobs, Film(4, 2, 1))
    sensor = scene_pb2.CompiledScene.FromString(blobs.path(scene.scene_sha256).read_bytes()).sensor
    found = Places.read(sensor.instruments, 4, 2)
    # A film is seen from behind, here from below with -z up: x is to the left.
    assert found.place(0, 0) == pytest.approx((1 + 1.5, 2, 3 - 0.5))
    assert found.place(3, 1) == pytest.approx((1 - 1.5, 2, 3 + 0.5))
    assert found.outlines() == []


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"instruments": 7}', '{"film": {}}', "nonsense"])
def test_a_header_that_is_not_understood_tells_nothing(text: str) -> None:
    assert Places.read(text, 4, 4) == Places()


SQUARE = {"corner": [0, 0, 0], "right": [1, 0, 0], "up": [0, 1, 0]}


@pytest.mark.parametrize(
    ("instrument", "place"),
    [
        ({"name": "a"}, ".points"),
        ({"name": "a", "points": [[0, 0, 0]], "grid": DESK["grid"]}, ".points"),
        ({"name": "a", "points": [[0, 0, 0]], "facing": [1, 0, 0]}, ".facing"),
        ({"name": "a", "points": [[0, 0, 0]], "measures": "semicylindrical"}, ".facing"),
        ({"name": "a", "points": [[0, 0, 0]], "normal": [0, 0, 0]}, ".normal"),
        (
            {"name": "a", "grid": SQUARE | {"border": 0.5}},
            ".right",
        ),
        ({"name": "a", "grid": SQUARE | {"up": [1, 0, 0]}}, ".up"),
        (
            {"name": "a", "grid": SQUARE | {"rows": 2}},
            ".rows",
        ),
    ],
)
def test_mistakes_have_a_place(instrument: dict[str, Any], place: str) -> None:
    with pytest.raises(InputError) as found:
        check_document(_document(instrument))
    assert any(each.place.endswith(place) for each in found.value.problems), found.value.problems


def test_names_are_unique_and_outdoors_is_one_of_them() -> None:
    with pytest.raises(InputError, match="another instrument"):
        check_document(_document(EYES, EYES))
    with pytest.raises(InputError, match="no instrument"):
        check_document(_document(EYES, outdoor="roof"))
