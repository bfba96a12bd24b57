"""Lamps that are thin compared with the offset by which photons leave a surface: a strip of 0.1 mm and a wire
light a floor as much as their radiance times their solid angle says, whatever else the scene has.

Glass anywhere in a scene makes photons towards lights fly on until they meet one, so that a scene with a ball
of glass under its floor is traced by other means than the same scene without it.
"""

from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import diffuse, film, measured_scene, quad, sphere, surface

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

SAMPLES, ALBEDO, SKY, RADIANCE = 64, 0.5, 0.05, 1e6
HEIGHT = 1.6
LENGTH, WIDTH = 0.02, 1e-4
RADIUS = 5e-5
PLACE = [0.3, 0.0, 0.2]
"""On the floor, m; the lamps hang above [0.5, 1.6, 0.3]."""

FLOOR = surface(quad([-5, 0, -5], [0, 0, 10], [10, 0, 0]), diffuse(ALBEDO))
GLASS = surface(sphere([0.0, -2.0, 0.0], 0.5), {"type": "dielectric", "index": 1.5})
STRIP = quad([0.5, HEIGHT, 0.3], [LENGTH, 0, 0], [0, 0, WIDTH])
STRIP_OF_TRIANGLES = {
    "type": "mesh",
    "vertices": [[0.5 + LENGTH * i / 40, HEIGHT, 0.3 + WIDTH * side] for i in range(41) for side in (0, 1)],
    "triangles": [triangle for i in range(0, 80, 2) for triangle in ([i, i + 2, i + 3], [i, i + 3, i + 1])],
}
BALL = sphere([0.5, HEIGHT, 0.3], RADIUS)

CAMERA: Document = {
    "type": "orthographic",
    "position": [PLACE[0], 0.5, PLACE[2]],
    "look_at": PLACE,
    "up": [0, 0, 1],
    "height": 1e-3,
}

WAYS: list[Document] = [{}, {"photons_together": 1}, {"estimator": "mixture"}, {"estimator": "split"}]


def _irradiance_of_strip() -> float:
    """By midpoints: E = L times the sum of cos^2 dA / r^2, where the strip is small compared with r."""
    along, across = (np.arange(n) + 0.5 for n in (200, 20))
    x = 0.5 + LENGTH * along[:, None] / 200 - PLACE[0]
    z = 0.3 + WIDTH * across[None, :] / 20 - PLACE[2]
    squared = x**2 + z**2 + HEIGHT**2
    return float(RADIANCE * (HEIGHT**2 / squared**2).mean() * LENGTH * WIDTH)


def _irradiance_of_ball() -> float:
    """E = L pi (R / d)^2 cos, exact for a ball above the horizon."""
    d = sqrt(0.2**2 + 0.1**2 + HEIGHT**2)
    return RADIANCE * pi * (RADIUS / d) ** 2 * HEIGHT / d


LAMPS = {
    "strip": (STRIP, _irradiance_of_strip()),
    "triangles": (STRIP_OF_TRIANGLES, _irradiance_of_strip()),
    "ball": (BALL, _irradiance_of_ball()),
}


def _scene(sensor: Document, lamp: str, glass: bool, **tracing: Any) -> Document:
    lit = surface(LAMPS[lamp][0], diffuse(0.0), RADIANCE)
    surfaces = [FLOOR, lit, *([GLASS] if glass else [])]
    document = measured_scene(sensor, surfaces, direction="adjoint", sharing=1, **tracing)
    return document | {"environment": {"radiance": SKY}}


@pytest.mark.parametrize("tracing", WAYS, ids=str)
@pytest.mark.parametrize("glass", [False, True], ids=["no glass", "glass"])
@pytest.mark.parametrize("lamp", LAMPS)
def test_a_floor(lamp: str, glass: bool, tracing: Document, tmp_path: Path) -> None:
    reading = Measurement(_scene(CAMERA, lamp, glass, **tracing), tmp_path, 32, 32).by_pixels(SAMPLES)
    truth = ALBEDO / pi * (LAMPS[lamp][1] + pi * SKY)
    reading.check(truth, 1e-3)
    assert reading.error < 0.02 * truth, reading


@pytest.mark.parametrize("glass", [False, True], ids=["no glass", "glass"])
@pytest.mark.parametrize("lamp", LAMPS)
def test_a_meter(lamp: str, glass: bool, tmp_path: Path) -> None:
    meter = film(PLACE, [0.0, 1.0, 0.0], 1e-3)
    reading = Measurement(_scene(meter, lamp, glass), tmp_path, 32, 32).by_pixels(SAMPLES)
    truth = LAMPS[lamp][1] + pi * SKY
    reading.check(truth, 1e-3)
    assert reading.error < 0.02 * truth, reading
