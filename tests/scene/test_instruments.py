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
        ({"name": "a", "grid": SQUARE, "faces": {"surface": "b", "count": 1}}, ".points"),
        ({"name": "a", "faces": {"surface": "b", "count": 1, "spread": True, "first": 1}}, ".first"),
        ({"name": "a", "points": [[0, 0, 0]], "normals": [[1, 0, 0], [0, 1, 0]]}, ".normals"),
        ({"name": "a", "points": [[0, 0, 0]], "normals": [[0, 0, 0]]}, ".normals[0]"),
        ({"name": "a", "points": [[0, 0, 0]], "normals": [[1, 0, 0]], "normal": [1, 0, 0]}, ".normals"),
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


BOX = {
    "name": "crate",
    "shape": {"type": "box", "minimum": [0, 0, 0], "maximum": [1, 2, 4]},
    "kernel": {"type": "lambertian", "reflectance": 0.5},
    "scale": 2.0,
    "rotate": {"axis": [0, 1, 0], "degrees": 90},
    "translate": [10, 0, 0],
}
ROOF = {
    "name": "roof",
    "shape": {
        "type": "mesh",
        "vertices": [[0, 0, 0], [3, 0, 0], [3, 0, 3], [0, 0, 3], [9, 0, 0]],
        "triangles": [[0, 2, 1], [0, 3, 2], [1, 2, 4]],
    },
    "kernel": {"type": "lambertian", "reflectance": 0.5},
}


def _meters_of(folder: Any, faces: dict[str, Any], **instrument: Any) -> tuple[list[Any], list[Any]]:
    """Places and normals of an instrument on faces, as the tracer gets them."""
    document = _document({"name": "on it", "faces": {"distance": 0.01, **faces}, **instrument})
    document["surfaces"] += [BOX, ROOF]
    count = faces["count"]
    blobs = BlobStore(folder)
    scene = compile_scene(check_document(document), blobs, Film(count, 1, 1))
    sensor = scene_pb2.CompiledScene.FromString(blobs.path(scene.scene_sha256).read_bytes()).sensor
    found = Places.read(sensor.instruments, count, 1)
    # Right, up and forward of the pose are x, y and -z.
    normals = [(each.normal.x, each.normal.y, -each.normal.z) for each in sensor.meters]
    middle = sensor.position
    for index, each in enumerate(sensor.meters):
        place = (middle.x + each.place.x, middle.y + each.place.y, middle.z - each.place.z)
        assert found.place(index, 0) == pytest.approx(place, abs=1e-6)
    return [found.place(index, 0) for index in range(count)], normals


def test_a_box_has_six_faces(tmp_path: Any) -> None:
    """Scaled by 2, turned so that x becomes -z and z becomes x, and shifted."""
    places, normals = _meters_of(tmp_path, {"surface": "crate", "count": 6})
    assert normals == [
        pytest.approx(each, abs=1e-9)
        for each in [(0, 0, 1), (0, 0, -1), (0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0)]
    ]
    middle, half = (14.0, 2.0, -1.0), (4.0, 2.0, 1.0)
    for place, normal in zip(places, normals, strict=True):
        expected = [m + n * (h + 0.01) for m, n, h in zip(middle, normal, half, strict=True)]
        assert place == pytest.approx(expected, abs=1e-6)


def test_faces_of_a_mesh(tmp_path: Any) -> None:
    places, normals = _meters_of(tmp_path, {"surface": "roof", "first": 1, "count": 2, "side": "back"})
    assert normals == [pytest.approx((0, -1, 0))] * 2
    assert places == [pytest.approx((1, -0.01, 2)), pytest.approx((5, -0.01, 1))]


def test_points_spread_over_a_surface_stand_for_equal_areas(tmp_path: Any) -> None:
    """Triangles of 4.5, 4.5 and 9 m2; the mean of x is that of their areas."""
    places, normals = _meters_of(tmp_path, {"surface": "roof", "spread": True, "count": 400})
    assert normals == [pytest.approx((0, 1, 0))] * 400
    assert [x > 3 for x, _, _ in places].count(True) == 200
    mean = (4.5 * 2 + 4.5 * 1 + 9 * 5) / 18
    assert sum(x for x, _, _ in places) / 400 == pytest.approx(mean, rel=5e-3)
    assert len({*places}) == 400


def test_cylinders_on_faces_stand_upright(tmp_path: Any) -> None:
    _, normals = _meters_of(tmp_path, {"surface": "crate", "count": 6}, measures="cylindrical")
    assert normals == [pytest.approx((0, 1, 0))] * 6
    _, normals = _meters_of(tmp_path, {"surface": "crate", "count": 6}, normal=[0, 0, 2])
    assert normals == [pytest.approx((0, 0, 1))] * 6


def test_points_have_their_own_normals() -> None:
    sensor = _sensor({"name": "a", "points": [[0, 0, 0], [1, 0, 0]], "normals": [[1, 0, 0], [0, 0, -3]]})
    assert sensor.instruments[0].axes() == [(1, 0, 0), (0, 0, -3)]


MOVING = BOX | {"name": "moving", "motion": {"translate": [1, 0, 0]}}
BALL = {
    "name": "ball",
    "shape": {"type": "sphere", "centre": [0, 9, 0], "radius": 1},
    "kernel": BOX["kernel"],
}


@pytest.mark.parametrize(
    ("faces", "place", "told"),
    [
        ({"surface": "crat", "count": 6}, ".surface", "no surface"),
        ({"surface": "crate", "count": 7}, ".count", "6 faces"),
        ({"surface": "roof", "first": 2, "count": 2}, ".count", "3 faces"),
        ({"surface": "twice", "count": 1}, ".surface", "2 surfaces"),
        ({"surface": "moving", "count": 1}, ".surface", "moves"),
        ({"surface": "ball", "count": 1}, ".surface", "triangles"),
    ],
)
def test_faces_that_are_not_there(faces: dict[str, Any], place: str, told: str, tmp_path: Any) -> None:
    document = _document({"name": "a", "faces": faces})
    twice = ROOF | {"name": "twice"}
    document["surfaces"] += [BOX, ROOF, twice, twice, MOVING, BALL]
    with pytest.raises(InputError, match=told) as found:
        compile_scene(check_document(document), BlobStore(tmp_path))
    assert [each.place for each in found.value.problems] == [f"$.sensor.instruments[0].faces{place}"]
