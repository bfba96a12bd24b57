"""The irradiance at points below lamps, on axis and in the rooms of CIE 171:2006.

At each point stands a white tile of a tenth of a millimetre that a radiance meter looks at: pi times its
radiance is the irradiance, and photons from the tile aim at the lamp.
"""

from dataclasses import replace
from math import cos, hypot, pi, radians, sin, sqrt
from pathlib import Path
from typing import Any

import pytest
from nocturne_scene.validation.cie171 import CEILING_G_TO_N, FLOOR_G_TO_N, ROOM, WALL_A_TO_F
from nocturne_scene.validation.documents import (
    TILE_OFF_PLANE,
    Point,
    box,
    disc,
    measured_scene,
    quad,
    sphere,
    surface,
    white_tile,
)
from nocturne_scene.validation.truths import truths

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document, part_of

pytestmark = pytest.mark.system

CIE_171: dict[str, Any] = truths("cie171")


def _check_points(
    surfaces: list[Document],
    points: list[Point],
    truths: list[float],
    folder: Path,
    uncertainty: float,
    rim: float = 0.0,
) -> None:
    """`rim`: part of the directions towards a lamp that miss it; few readings may have met any."""
    samples = part_of(256) * 8 * 8
    for i, (point, truth) in enumerate(zip(points, truths, strict=True)):
        here = folder / str(i)
        here.mkdir()
        tile, meter = white_tile(point)
        scene = measured_scene(meter, [tile, *surfaces])
        reading = Measurement(scene, here, 8, 8).by_pixels(256) * pi
        of_rim = truth * sqrt(rim * (1.0 - rim) / samples)
        reading = replace(reading, error=hypot(reading.error, of_rim))
        reading.check(truth, uncertainty, values=len(points))


@pytest.mark.parametrize(("radius", "distance"), [(1.0, 2.0), (0.01, 3.0), (0.001, 10.0)])
@pytest.mark.parametrize("shape", ["disc", "sphere", "sphere at 60 degrees"])
def test_on_axis(shape: str, radius: float, distance: float, tmp_path: Path) -> None:
    """E = pi L r^2 / (r^2 + d^2) below a disc, pi L (r / d)^2 cos below a sphere above the horizon.

    Uncertainty: the tile is 1e-5 m nearer than the point, and the disc a polygon (6e-6). Photons go into
    a cone that is wider than a sphere by what rounds directions, half a microradian. False alarms: 0.01.
    """
    tilt = radians(60.0) if "60" in shape else 0.0
    if tilt and radius == 1.0:
        pytest.skip("at 60 degrees this sphere reaches below the horizon")
    if shape == "disc":
        lamp, truth = disc([0, 0, distance], [0, 0, -1], radius), radius**2 / (radius**2 + distance**2)
    else:
        lamp, truth = sphere([0, 0, distance], radius), (radius / distance) ** 2 * cos(tilt)
    surfaces = [surface(lamp, radiance=1.0)]
    normal = [sin(tilt), 0.0, cos(tilt)]
    uncertainty = 2e-5 + 2 * TILE_OFF_PLANE / distance
    rim = 0.0 if shape == "disc" else 1.0 - (1.0 + 5e-7 * distance / radius) ** -2
    _check_points(surfaces, [([0, 0, 0], normal)], [pi * truth], tmp_path, uncertainty, rim)


def test_cie_171_5_2_point_source(tmp_path: Path) -> None:
    """A diffuse disc of 5 mm that has 1000 cd along its axis.

    Uncertainty: its size changes E by up to 2 (r / d)^2 = 6e-6, tiles nearer by 1e-5 m by 1e-5.
    """
    radius = 0.005
    lamp = surface(disc([0, 0, 3], [0, 0, -1], radius), radiance=1000.0 / (pi * radius**2))
    table = CIE_171["5.2"]
    points: list[Point] = [([x, y, 0.0], [0.0, 0.0, 1.0]) for x, y in table["xy"]]
    _check_points([lamp], points, table["lx"], tmp_path, 4e-5)


def test_cie_171_5_3_area_source(tmp_path: Path) -> None:
    """Uncertainty: tiles stand 1e-5 m in front of the walls; A is 0.25 m below the lamp's plane."""
    lamp = surface(quad([1.5, 1.5, 3], [0, 1, 0], [1, 0, 0]), radiance=1000.0)
    points = WALL_A_TO_F + FLOOR_G_TO_N
    _check_points([*ROOM, lamp], points, CIE_171["5.3"]["A to N"], tmp_path, 5e-5)


def test_cie_171_5_6_diffuse_floor(tmp_path: Path) -> None:
    """The floor as a lamp of the same exitance, 100 so that readings are percent."""
    lamp = surface(quad([0, 0, 0], [4, 0, 0], [0, 4, 0]), radiance=100.0 / pi)
    points = WALL_A_TO_F[4:0:-1] + WALL_A_TO_F[:1] + CEILING_G_TO_N
    _check_points([*ROOM[1:], lamp], points, CIE_171["5.6"]["B to N"], tmp_path, 5e-5)


def test_cie_171_5_7_behind_an_obstruction(tmp_path: Path) -> None:
    """J and K see nothing of the wall: exactly 0."""
    lamp = surface(quad([0, 4, 0], [4, 0, 0], [0, 0, 3]), radiance=100.0 / pi)
    obstruction = surface(box([0, 2.5, 0], [4, 2.7, 1]))
    points = WALL_A_TO_F + FLOOR_G_TO_N[:5]
    surfaces = [ROOM[0], ROOM[1], ROOM[3], ROOM[4], lamp, obstruction]
    _check_points(surfaces, points, CIE_171["5.7"]["A to K"], tmp_path, 5e-5)
