"""Cameras: the circle of confusion, the light on a film behind a lens, motion blur."""

from math import pi, radians, sqrt, tan
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK, quad, ring, surface

from tests.accuracy.agreement import sidak_bound
from tests.accuracy.ruler import Vector
from tests.accuracy.spectral_meters import Estimate, flat, measure, scene
from tests.accuracy.tracing import trace

pytestmark = pytest.mark.system

# Focal length, f-number, distance in focus, distance of a point, mm: diameter of its image on the film, mm;
# irradiance on the film's middle over the object's radiance, sr.
LENSES = {
    (50.0, 2.0, 2000.0, 4000.0): (0.32051282, 0.17618681),
    (85.0, 1.4, 3000.0, 2000.0): (0.88519971, 0.33766452),
}


@pytest.mark.parametrize("lens", LENSES)
def test_circle_of_confusion(lens: tuple[float, float, float, float], tmp_path: Path) -> None:
    """A ball far smaller than the lens: a disc of diameter D has the variance D^2 / 16 along x and along y.

    The ball's own image and the pixel add variances that are known. Eight images with other random numbers.
    """
    focal, stop, focus, distance = lens
    film = 1.0 / (1.0 / focal - 1.0 / focus)
    diameter, ball = LENSES[lens][0], 0.1 * focal / stop
    height = 1.5 * (diameter + 2 * ball / distance * film)
    sensor = {
        "type": "thin_lens",
        "position": [0, 0, 0],
        "look_at": [0, 0, 1],
        "vertical_field_of_view_degrees": float(np.degrees(2 * np.arctan(height / 2 / film))),
        "lens_radius": focal / stop / 2,
        "focus_distance": focus,
    }
    shape = {"type": "sphere", "centre": [0, 0, distance], "radius": ball}
    lamp = {"shape": shape, "kernel": BLACK, "luminaire": {"radiance": 1.0}}
    edge = 32
    places = (np.arange(edge) + 0.5 - edge / 2) * height / edge
    known = (2 * ball / distance * film) ** 2 / 16 + (height / edge) ** 2 / 12
    found = []
    for seed in range(8):
        image = flat(trace(scene(sensor, [lamp], None, seed=seed), tmp_path, edge, 256))
        for axis in (0, 1):
            weights = image.sum(axis=axis) / image.sum()
            variance = (weights * places**2).sum() - (weights * places).sum() ** 2
            found.append(4.0 * np.sqrt(variance - known))
    Estimate.of(found).check(diameter, sidak_bound(6), f"circle of confusion, mm, {lens}")


@pytest.mark.parametrize("lens", LENSES)
def test_light_on_a_film(lens: tuple[float, float, float, float], tmp_path: Path) -> None:
    """The lens seen from the film is a round opening full of light: E = pi L sin^2 of its radius."""
    focal, stop, focus, _ = lens
    film = 1.0 / (1.0 / focal - 1.0 / focus)
    sensor = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1e-3}
    disc = {"type": "disc", "centre": [0, 0, film], "normal": [0, 0, -1], "radius": focal / stop / 2}
    lamp = {"shape": disc | {"segments": 1024}, "kernel": BLACK, "luminaire": {"radiance": 1.0}}
    estimate = measure(scene(sensor, [lamp], None), tmp_path, 4096)
    estimate.check(LENSES[lens][1], sidak_bound(6), f"E / L, {lens}")


@pytest.mark.parametrize("lens", LENSES)
def test_light_through_the_camera(lens: tuple[float, float, float, float], tmp_path: Path) -> None:
    """A pixel is the radiance of the object in focus, the mean over the lens's area: E / L depends on the
    lens alone.

    A wide lamp in focus, and a black plate close to the lens that covers a part of it: all around a round
    opening of the same axis, or one half. The open part counts by its area, except for polygons (6e-6 of it)
    and the plate's distance (1e-4 of the lens, seen under up to its opening angle).
    """
    focal, stop, focus, _ = lens
    radius = focal / stop / 2
    sensor = {
        "type": "thin_lens",
        "position": [0, 0, 0],
        "look_at": [0, 0, 1],
        "vertical_field_of_view_degrees": 0.01,
        "lens_radius": radius,
        "focus_distance": focus,
    }
    wide = quad([-radius, -radius, focus], [0, 2 * radius, 0], [2 * radius, 0, 0])
    lamp = surface(wide, radiance=1.0)
    near = 1e-4 * radius
    half = quad([0, -2 * radius, near], [2 * radius, 0, 0], [0, 4 * radius, 0])
    plates = {1.0: [], 0.5: [half]} | {
        part**2: [ring(part * radius, 2 * radius, near)] for part in (0.3, 0.8)
    }
    for share, shapes in plates.items():
        document = scene(sensor, [lamp, *map(surface, shapes)], None)
        estimate = measure(document, tmp_path, 1024)
        estimate.check(share, sidak_bound(8), f"part {share} of the lens {lens}")
    # The film of the test before sees the whole lens with this radiance, so this is its E / L.
    film = 1.0 / (1.0 / focal - 1.0 / focus)
    assert pi * radius**2 / (radius**2 + film**2) == pytest.approx(LENSES[lens][1], rel=1e-7)


def test_fall_off(tmp_path: Path) -> None:
    """Of the light through an opening of a tenth of its distance; through a tiny one it is cos^4."""
    ratios = []
    for angle in (0.0, 20.0):
        centre = [tan(radians(angle)), 0, 1]
        disc = {"type": "disc", "centre": centre, "normal": [0, 0, -1], "radius": 0.1, "segments": 1024}
        sensor = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, 1], "height": 1e-6}
        lamp = {"shape": disc, "kernel": BLACK, "luminaire": {"radiance": 1.0}}
        ratios.append(measure(scene(sensor, [lamp], None), tmp_path, 16384))
    straight, slanted = ratios
    error = np.hypot(straight.error / straight.mean, slanted.error / slanted.mean)
    # A disc of radius a at distance 1, off axis by t: E = (pi / 2)(1 - (1 + t^2 - a^2) / root).
    exact = [_disc(tan(radians(angle)), 0.1) for angle in (0.0, 20.0)]
    ratio = slanted.mean / straight.mean
    assert ratio == pytest.approx(exact[1] / exact[0], rel=float(sidak_bound(6) * error))
    tiny = _disc(tan(radians(20)), 1e-3) / _disc(0.0, 1e-3)
    assert tiny == pytest.approx(0.77972824, rel=1e-6)


def _disc(off: float, radius: float) -> float:
    """E / L of a disc parallel to the film at distance 1: Gershun; Howell, A Catalog of Radiation Heat
    Transfer Configuration Factors, B-13.
    """
    z = 1.0 + off**2 - radius**2
    return pi / 2 * (1.0 - z / sqrt(z * z + 4.0 * radius**2))


def test_a_lens_camera_shows_radiance_everywhere(tmp_path: Path) -> None:
    """Its pixels are radiances by definition, without fall-off: uniform light is uniform up to the
    corners.
    """
    sensor = {
        "type": "thin_lens",
        "position": [0, 0, 0],
        "look_at": [0, 0, 1],
        "vertical_field_of_view_degrees": 80.0,
        "lens_radius": 0.0125,
        "focus_distance": 2.0,
    }
    far = {"shape": {"type": "sphere", "centre": [0, 0, 9], "radius": 0.1}, "kernel": {"type": "null"}}
    image = flat(trace(scene(sensor, [far]), tmp_path, 16, 256))
    assert np.abs(image - 1.0).max() < 1e-2
    assert image.mean() == pytest.approx(1.0, rel=1e-4)


def test_motion_blur(tmp_path: Path) -> None:
    """A bar of width 1 that moves by 3: ramps of width 1, a plateau of 1/3 between them."""
    bar = {
        "shape": quad([-1, -5, 0], [1, 0, 0], [0, 10, 0]),
        "kernel": BLACK,
        "luminaire": {"radiance": 1.0},
        "motion": {"translate": [3, 0, 0]},
    }
    sensor = {
        "type": "orthographic",
        "position": [1, 0, 5],
        "look_at": [1, 0, 0],
        "height": 0.5,
    }
    image = flat(trace(scene(sensor, [bar], None), tmp_path, (96, 8), 512))
    right = (np.arange(96) - 48) / 16 + 1  # of the pixels' left edges

    def covered(x: Vector) -> Vector:
        """Integral of the trapezoid up to x."""
        up, flat_, down = np.clip(x + 1, 0, 1), np.clip(x, 0, 2), np.clip(x - 2, 0, 1)
        return np.asarray((up**2 / 2 + flat_ + down - down**2 / 2) / 3)

    truth = (covered(right + 1 / 16) - covered(right)) * 16
    bound = sidak_bound(96)
    for column, expected in enumerate(truth):
        Estimate.of(image[:, column]).check(float(expected), bound * 1.6, column)  # Student's t of 8 values
    assert image.mean() * 6 == pytest.approx(1.0, rel=1e-3)
