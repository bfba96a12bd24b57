"""Prisms: the deviation of a beam by dispersing glass, at the Fraunhofer lines C, d and F.

Deviation d(i) = i + asin(sin A sqrt(n^2 - sin^2 i) - cos A sin i) - A, least where sin i = n sin(A / 2): Born
and Wolf, Principles of Optics, section 4.7. Glasses: Schott's catalogue (Sellmeier coefficients).
"""

from math import asin, cos, degrees, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

from tests.accuracy.ruler import Ruler, extruded
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

GLASSES = {
    "N-BK7": {"b": [1.03961212, 0.231792344, 1.01046945], "c": [0.00600069867, 0.0200179144, 103.560653]},
    "SF10": {"b": [1.61625977, 0.259229334, 1.07762317], "c": [0.0127534559, 0.0581983954, 116.60768]},
    "F2": {"b": [1.34533359, 0.209073176, 0.937357162], "c": [0.00997743871, 0.0470450767, 111.886764]},
    "N-SF11": {"b": [1.73759695, 0.313747346, 1.89878101], "c": [0.013188707, 0.0623068142, 155.23629]},
}

# Line, nm; incidence and least deviation, degrees.
LEAST = {
    "N-BK7": [
        (486.13, 49.5690544, 39.1381087),
        (587.56, 49.3233493, 38.6466985),
        (656.27, 49.2145684, 38.4291367),
    ],
    "SF10": [
        (486.13, 60.8374133, 61.6748265),
        (587.56, 59.7829553, 59.5659106),
        (656.27, 59.3641953, 58.7283907),
    ],
    "F2": [
        (486.13, 54.6903971, 49.3807942),
        (587.56, 54.0978922, 48.1957844),
        (656.27, 53.8539281, 47.7078561),
    ],
    "N-SF11": [
        (486.13, 64.58946, 69.1789201),
        (587.56, 63.1713144, 66.3426288),
        (656.27, 62.6201974, 65.2403948),
    ],
}
_APEX = 60.0
_SIZE = 0.01
"""Edge of the prism, m."""
_DISTANCE = 1000.0
"""To the ruler, m: the prism's size is 1e-5 of it, or 6e-4 degrees; the beam leaves at a known point."""


def line(nm: float) -> Document:
    """Light of one line: a triangle, 0.1 nm wide at its foot."""
    return {"table": [[round(nm - 0.05, 2), 0.0], [nm, 1.0], [round(nm + 0.05, 2), 0.0]]}


def near(nm: float) -> Document:
    """A response that draws wavelengths to a line; its measurement is ignored."""
    middle = round(nm)
    return {"table": [[middle - 1, 0.0], [middle, 1.0], [middle + 1, 0.0]], "outside": "zero"}


def _direction(angle: float) -> np.ndarray:
    return np.array([0.0, sin(radians(angle)), cos(radians(angle))])


def _deviation(document: Document, nm: float, incidence: float, expected: float, folder: Path) -> float:
    into = _direction(incidence - 30.0)
    left, right = (np.array([0.0, sqrt(3) / 4, side * 0.25]) * _SIZE for side in (-1, 1))
    start = left - 2 * _SIZE * into
    document = document | {
        "sensor": {
            "type": "orthographic",
            "position": start.tolist(),
            "look_at": left.tolist(),
            "height": 1e-6,
            "responses": {"near": near(nm)},
        }
    }
    out = _direction(incidence - 30.0 - expected)
    ruler = Ruler.at(right + _DISTANCE * out, out, _DISTANCE * radians(0.2), line(nm))
    place = ruler.read(document, folder, (1, 1), 8192).place().item()
    return expected - degrees(place / _DISTANCE)


@pytest.mark.parametrize("glass", LEAST)
@pytest.mark.parametrize("which", range(3))
def test_least_deviation(glass: str, which: int, tmp_path: Path) -> None:
    """Within 2e-4 degrees, and as by the exact formula one degree to both sides."""
    nm, least_at, least = LEAST[glass][which]
    corners = [np.array([0.0, y, z]) * _SIZE for y, z in ((0.0, -0.5), (0.0, 0.5), (sqrt(3) / 2, 0.0))]
    kernel = {"type": "dielectric", "index": {"sellmeier": GLASSES[glass]}}
    document = {"nocturne": 1, "surfaces": [{"shape": extruded(corners, _SIZE), "kernel": kernel}]}
    n = sin(radians(least_at)) / sin(radians(_APEX / 2))
    for incidence in (least_at - 1.0, least_at, least_at + 1.0):
        expected = _exact(n, incidence)
        deviation = _deviation(document, nm, incidence, expected, tmp_path)
        assert deviation == pytest.approx(expected, abs=2e-4)
        assert deviation > least - 2e-4


def _exact(n: float, incidence: float) -> float:
    i, apex = radians(incidence), radians(_APEX)
    return incidence + degrees(asin(sin(apex) * sqrt(n * n - sin(i) ** 2) - cos(apex) * sin(i))) - _APEX
