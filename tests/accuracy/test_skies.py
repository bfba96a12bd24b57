"""Irradiance from CIE skies, on tilted planes and through an opening in a room's ceiling.

A sky is an environment map of 512 x 256 pixels. What its texels must give is computed by quadrature over
them: the tracer is compared with that, and that with the published value.
"""

from math import pi, radians
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.validation.cie171 import FLOOR_G_TO_N, ROOM, WALL_A_TO_F, ceiling_around
from nocturne_scene.validation.documents import film, measured_scene, quad, surface, white_tile
from nocturne_scene.validation.skies import horizontal_illuminance
from nocturne_scene.validation.truths import truths

from tests.accuracy.agreement import ROUNDING, Values
from tests.accuracy.meters import Measurement
from tests.accuracy.skies import ORIENTATION, Sky, map_luminance
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_ROOMS: dict[str, dict[str, list[float]]] = truths("cie171")["5.9"]["A to N"]

_MAP_ERROR = 1e-3
"""Of an illuminance: texels are 0.7 degrees, 2 % of an opening of 1 m or more, each of one luminance. Along
the opening's edge that is wrong by up to half of a texel's change, 4 % near the sun."""

_COLOUR = 1e-4
"""Of a luminance: the spectrum that stands for a grey texel."""

_SAMPLES = 64


def _document(picture: Path, sensor: Document, surfaces: list[Document]) -> Document:
    document = measured_scene(sensor, surfaces, photons_together=4)
    document["environment"] = {
        "asset": picture.name,
        "luminance": 1.0,
        **ORIENTATION,
    }
    return document


@pytest.mark.parametrize(
    ("degrees", "uniform", "overcast"),
    [
        (0, 3.1415927, 2.443461),
        (30, 2.9311458, 2.2069372),
        (60, 2.3561945, 1.6357195),
        (90, 1.5707963, 0.96804322),
    ],
)
def test_tilted_planes(degrees: int, uniform: float, overcast: float, tmp_path: Path) -> None:
    """Under a uniform sky, pi (1 + cos b) / 2, and the overcast sky of Moon and Spencer (1942), 7 pi / 9 for
    a level plane and pi / 6 + 4 / 9 for an upright one; black ground. False alarms: 0.01."""
    tilt = radians(degrees)
    for kind, truth in ((5, uniform), (16, overcast)):
        folder = tmp_path / str(kind)
        folder.mkdir()
        Sky(kind).write(folder / "sky.exr")
        sensor = film([0, 0, 0], [0, float(np.sin(tilt)), float(np.cos(tilt))], 1e-3)
        ground = surface(quad([-1, -1, -9], [2, 0, 0], [0, 2, 0]))
        measurement = Measurement(_document(folder / "sky.exr", sensor, [ground]), folder, 16, 16)
        measurement.by_pixels(_SAMPLES, "Y").check(truth, _COLOUR, values=2)


@pytest.mark.parametrize(("edge", "kind"), [(edge, kind) for edge in _ROOMS for kind in _ROOMS[edge]])
def test_cie_171_5_9_roof_opening(edge: str, kind: str, tmp_path: Path) -> None:
    """Fourteen points of a black room below an opening without glass. False alarms: 0.01.

    Points stand 1e-5 m in front of the walls, which matters most for A, 0.25 m below the opening: 4e-5.
    """
    sky, size = Sky(int(kind)), float(edge)
    picture = tmp_path / "sky.exr"
    sky.write(picture)
    outside = horizontal_illuminance(sky.kind)
    points = WALL_A_TO_F + FLOOR_G_TO_N
    tiles, meters = zip(*(white_tile(point) for point in points), strict=True)
    document = _document(picture, meters[0], [*tiles, *ROOM, *ceiling_around(size)])
    # So that photons from the tiles go through it more often.
    low = 2.0 - size / 2
    document["important_directions"] = [{"shape": quad([low, low, 3], [size, 0, 0], [0, size, 0])}]
    measurement = Measurement(document, tmp_path, 8, 8)
    truths = _ROOMS[edge][kind]
    for seed, (meter, (place, normal), published) in enumerate(zip(meters, points, truths, strict=True)):
        by_map = 100.0 * _through_opening(picture, size, place, normal) / outside
        assert by_map == pytest.approx(published, rel=_MAP_ERROR)
        measurement.move(**meter)
        reading = measurement.by_pixels(_SAMPLES, "Y", seed) * (100.0 * pi / outside)
        reading.check(by_map, _COLOUR + 4e-5 + ROUNDING, values=len(points))


def _through_opening(picture: Path, size: float, place: list[float], normal: list[float]) -> float:
    count = 400
    across = 2.0 + size * ((np.arange(count) + 0.5) / count - 0.5)
    x, y = np.meshgrid(across, across, indexing="ij")
    to: Values = np.stack([x - place[0], y - place[1], np.full_like(x, 3.0 - place[2])], axis=-1)
    distance = np.sqrt((to**2).sum(axis=-1))
    directions = to / distance[..., None]
    cosine = np.clip(directions @ np.array(normal), 0.0, None)
    seen = map_luminance(picture, directions) * cosine * directions[..., 2] / distance**2
    return float(seen.sum()) * (size / count) ** 2
