"""Meters aim at the Sun, lamps and sky as any surface does, so that few samples suffice for small lights.

Readings are the means of eight seeds, by Student's t with their scatter. The scatter is bounded, too:
photons that leave a film by cosine alone would exceed the bound a hundred times.
"""

from math import cos, exp, pi, radians, sin
from pathlib import Path

import pytest
from nocturne_scene.validation.documents import BLACK, diffuse, disc, film, measured_scene, quad, surface

from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

SAMPLES = 256
METER = film([0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 0.1)
GROUND = surface(quad([-5, 0, -5], [0, 0, 10], [10, 0, 0]), diffuse(0.2))

SUN_RADIUS = radians(0.2665)
SUN_RADIANCE = 1e4
ELEVATION = radians(30.0)
SUN = {
    "direction": [cos(ELEVATION), sin(ELEVATION), 0.0],
    "radiance": SUN_RADIANCE,
    "angular_diameter_degrees": 0.533,
}
SUN_ACROSS = SUN_RADIANCE * pi * sin(SUN_RADIUS) ** 2
"""Irradiance across the Sun's direction; at a tilt by its cosine."""


def _read(document: Document, folder: Path) -> Reading:
    return Measurement(document, folder, 4, 4).by_seeds(SAMPLES)


def _check(reading: Reading, truth: float, scatter: float = 0.01) -> None:
    reading.check(truth, 2e-5)
    assert reading.error < scatter * truth, reading


def _under_the_sun(*surfaces: Document, **tracing: object) -> Document:
    return measured_scene(METER, list(surfaces), **tracing) | {"distant": [SUN]}


WAYS: list[Document] = [
    {},
    {"sharing": 16},
    {"estimator": "mixture"},
    {"estimator": "split"},
    {"sequence": "independent", "sharing": 1},
    {"photons_together": 1},
]


@pytest.mark.parametrize("tracing", WAYS, ids=str)
def test_the_sun(tracing: Document, tmp_path: Path) -> None:
    document = _under_the_sun(GROUND, direction="adjoint", **tracing)
    _check(_read(document, tmp_path), SUN_ACROSS * sin(ELEVATION))


@pytest.mark.parametrize("tracing", WAYS, ids=str)
def test_a_mirror_shows_the_sun_once_more(tracing: Document, tmp_path: Path) -> None:
    """A wall that mirrors all, opposite to a Sun that is large enough to be met by chance in it."""
    mirror = surface(
        quad([-2.0, 0.0, -50.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]),
        {"type": "conductor", "index": {"n": 0.001, "k": 100.0}},
    )
    wide = SUN | {"angular_diameter_degrees": 40.0}
    document = _under_the_sun(mirror, direction="adjoint", **tracing) | {"distant": [wide]}
    truth = SUN_RADIANCE * pi * sin(radians(20.0)) ** 2 * sin(ELEVATION)
    _check(_read(document, tmp_path), 2.0 * truth, 0.05)


def test_the_sun_through_two_panes(tmp_path: Path) -> None:
    """Each of which lets half of it through."""
    panes = [
        surface(
            quad([-5, height, -5], [0, 0, 10], [10, 0, 0]),
            {"type": "mask", "opacity": 0.5, "kernel": BLACK},
        )
        for height in (1.5, 2.0)
    ]
    document = _under_the_sun(*panes, direction="adjoint")
    _check(_read(document, tmp_path), 0.25 * SUN_ACROSS * sin(ELEVATION), 0.05)


def test_the_sun_above_a_haze_that_absorbs(tmp_path: Path) -> None:
    roof = {"shape": {"type": "box", "minimum": [-9, -1, -9], "maximum": [9, 2, 9]}}
    haze = roof | {"kernel": {"type": "dielectric", "index": 1.0, "absorption": 0.5}}
    document = _under_the_sun(haze, direction="adjoint")
    _check(_read(document, tmp_path), SUN_ACROSS * sin(ELEVATION) * exp(-0.5 / sin(ELEVATION)))


@pytest.mark.parametrize("tracing", WAYS, ids=str)
def test_a_small_lamp(tracing: Document, tmp_path: Path) -> None:
    """A disc of 1 cm, 2 m above the middle of a film of 1 cm: pi L r^2 / (d^2 + r^2) on its axis, and less
    towards the film's corners by a part of 1e-5."""
    lamp = surface(disc([0.0, 3.0, 0.0], [0.0, -1.0, 0.0], 0.01), radiance=1e4)
    small = film([0.0, 1.0, 0.0], [0.0, 1.0, 0.0], 0.01)
    # In the dark: where nothing scatters light, too, directions are chosen at the film.
    document = measured_scene(small, [lamp], direction="adjoint", **tracing)
    _check(_read(document, tmp_path), 1e4 * pi * 0.01**2 / (4.0 + 0.01**2))


@pytest.mark.parametrize("tracing", WAYS, ids=str)
def test_lights_that_fill_the_sky_are_met_by_cosine_as_before(tracing: Document, tmp_path: Path) -> None:
    """Pi times the radiance, and without noise where the two kinds of photons share it rightly."""
    document = measured_scene(METER, [GROUND], direction="adjoint", **tracing)
    document["environment"] = {"radiance": 2.0}
    _check(_read(document, tmp_path), 2.0 * pi)
