"""Colours in absolute units through the tracer: patches under illuminants, black bodies, lines.

CIE 1931 2 degree observer, 1 nm, 360-830 nm (CIE 015:2018). Chart: the mean of 30 charts (BabelColor 2012),
linear between 10 nm, constant outside 380-730 nm. K_m = 683 lm/W.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK

from tests.accuracy.agreement import sidak_bound, student_bound
from tests.accuracy.spectral_meters import NO_ROULETTE, level
from tests.accuracy.tracing import Document, trace
from tests.system.images import Image

pytestmark = pytest.mark.system

_TRUTH = json.loads((Path(__file__).parent / "data" / "chart.json").read_text())
CHART = {entry["patch"]: entry for entry in _TRUTH["patches"]}
ILLUMINANTS = ("E", "D65", "A")

_OTHER_PATCHES = (
    *("light skin", "blue flower", "moderate red", "orange yellow"),
    *("green", "magenta", "neutral 6.5", "neutral 3.5"),
)
_PIXELS = 8
"""Along a patch's edge."""


def _chart(illuminant: str) -> Document:
    """24 patches in a plane, 6 x 4, under a uniform sky; those with a truth first."""
    surfaces = []
    for index, patch in enumerate((*CHART, *_OTHER_PATCHES)):
        row, column = divmod(index, 6)
        quad = {"type": "quad", "corner": [column, -1 - row, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}
        kernel = {"type": "lambertian", "reflectance": {"chart_patch": patch}}
        surfaces.append({"shape": quad, "kernel": kernel})
    return {
        "nocturne": 1,
        "sensor": {"type": "orthographic", "position": [3, -2, 1], "look_at": [3, -2, 0], "height": 4},
        "surfaces": surfaces,
        "environment": {"radiance": {"illuminant": illuminant, "luminance": 100.0}},
    }


def _patches(image: Image) -> np.ndarray:
    """Shape (16, pixels, 3)."""
    rows = image.xyz.astype(np.float64).reshape(4, _PIXELS, 6, _PIXELS, 3)
    patches = rows.transpose(0, 2, 1, 3, 4).reshape(24, _PIXELS**2, 3)
    return patches[: len(CHART)]


@pytest.mark.parametrize("illuminant", ILLUMINANTS)
def test_chart_at_49_samples(illuminant: str, tmp_path: Path) -> None:
    """A patch's mean within the Sidak bound of 48 values of Student's t, by the spread of its 64 pixels.

    False alarms 0.01. Rounding: of the truth's last digits.
    """
    patches = _patches(trace(_chart(illuminant), tmp_path, (6 * _PIXELS, 4 * _PIXELS), 49))
    truths = np.array([each[illuminant] for each in CHART.values()])
    errors = patches.std(axis=1, ddof=1) / _PIXELS
    allowed = student_bound(truths.size, _PIXELS**2 - 1) * errors + 2e-5 + 1e-5 * truths
    np.testing.assert_array_less(np.abs(patches.mean(axis=1) - truths), allowed)


@pytest.mark.parametrize("illuminant", ILLUMINANTS)
def test_chart_at_many_samples(illuminant: str, tmp_path: Path) -> None:
    """Within 0.1 %. Without roulette and by the kernel alone, so that only wavelengths are drawn."""
    tracing = NO_ROULETTE | {"estimator": "mixture", "mixture": {"kernel": 1.0, "environment": 0.0}}
    document = _chart(illuminant) | {"tracing": tracing}
    patches = _patches(trace(document, tmp_path, (6 * _PIXELS, 4 * _PIXELS), 1024))
    truths = np.array([each[illuminant] for each in CHART.values()])
    ratio = patches.mean(axis=1) / truths
    np.testing.assert_allclose(ratio, 1.0, atol=1e-3)


def _lamp(radiance: object) -> Document:
    """A lamp that fills the image."""
    return {
        "nocturne": 1,
        "sensor": {"type": "orthographic", "position": [0, 0, 1], "look_at": [0, 0, 0], "height": 0.1},
        "surfaces": [level(0.0, 1.0, BLACK, luminaire={"radiance": radiance})],
    }


def _mean(radiance: object, folder: Path, samples: int = 2048) -> tuple[np.ndarray, np.ndarray]:
    """X, Y, Z and their standard errors, from 64 pixels."""
    pixels = trace(_lamp(radiance), folder, 8, samples).xyz.astype(np.float64).reshape(-1, 3)
    return pixels.mean(axis=0), pixels.std(axis=0, ddof=1) / 8


# x, y.
WHITES = {
    "E": (0.33331438, 0.33328771),
    "D65": (0.31272695, 0.32902322),
    "D50": (0.34568422, 0.35850409),
    "A": (0.44757355, 0.40743939),
}


@pytest.mark.parametrize("illuminant", WHITES)
def test_whites(illuminant: str, tmp_path: Path) -> None:
    """Chromaticities within 3e-5, ten times the noise."""
    xyz, _ = _mean({"illuminant": illuminant, "luminance": 100.0}, tmp_path)
    assert xyz[1] == pytest.approx(100.0, rel=1e-4)
    np.testing.assert_allclose(xyz[:2] / xyz.sum(), WHITES[illuminant], atol=3e-5)


# Temperature, K: cd/m2, x, y by Planck's law with the constants of the SI of 2019.
BLACK_BODIES = {
    2042.15: (599126.67, 0.52211207, 0.41393796),
    2856.0: (19749784.0, 0.44753514, 0.40742829),
    5772.0: (1843714300.0, 0.32655303, 0.33583366),
    6500.0: (3072528000.0, 0.31352588, 0.3236283),
}


@pytest.mark.parametrize("kelvin", BLACK_BODIES)
def test_black_bodies(kelvin: float, tmp_path: Path) -> None:
    """Luminance within 1e-4, chromaticity within 3e-5."""
    luminance, *chromaticity = BLACK_BODIES[kelvin]
    xyz, _ = _mean({"blackbody": kelvin}, tmp_path)
    assert xyz[1] == pytest.approx(luminance, rel=1e-4)
    np.testing.assert_allclose(xyz[:2] / xyz.sum(), chromaticity, atol=3e-5)


# Lines, nm, and their powers: x, y, Y per radiance over 683 lm/W; linear within the observer's 1 nm table.
LINES = {
    "sodium": ([(588.995, 2.0 / 3.0), (589.592, 1.0 / 3.0)], 0.57039795, 0.42896562, 0.7667963),
    "mercury, green": ([(546.074, 1.0)], 0.27349433, 0.71758787, 0.98433851),
    "mercury, blue": ([(435.833, 1.0)], 0.16652004, 0.0088972812, 0.017812411),
    "helium-neon": ([(632.8, 1.0)], 0.71147236, 0.28848329, 0.23724544),
}


@pytest.mark.parametrize("width", [0.01, 0.1, 1.0])
@pytest.mark.parametrize("lamp", LINES)
def test_lines(lamp: str, width: float, tmp_path: Path) -> None:
    """Whatever their width, within the Sidak bound of standard errors from 64 pixels and 5e-4.

    5e-4: a line as wide as a step of the observer's table averages over its kinks.
    """
    lines, x, y, luminance = LINES[lamp]
    radiance = {"lines": [{"nm": nm, "power": power, "width": width} for nm, power in lines]}
    xyz, error = _mean(radiance, tmp_path, 4096)
    truth = luminance / y * 683.0 * np.array([x, y, 1.0 - x - y])
    # Z of light at the red end is nearly nothing.
    allowed = sidak_bound(36) * error + 5e-4 * truth + 1e-5 * truth.max()
    np.testing.assert_array_less(np.abs(xyz - truth), allowed)
