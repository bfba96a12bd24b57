"""Droplets and tabulated matrices in polarised light, by single scattering at right angles.

Light falls straight down on a box of a medium, past filters or none, and a meter looks along y:
L = E p(90 degrees) s exp(-e h) (1 - exp(-e l)) / e, e the extinction, s the scattering coefficient, h the
depth of the line of sight, l its length in the box. Its Stokes vector is the scattering matrix times that of
the light.
"""

from math import cos, exp, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.media import mie
from nocturne_scene.validation.documents import GREY, quad, sun

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document
from tests.spheres import elements

pytestmark = pytest.mark.system

_DEPTH, _LENGTH = 1.0, 2.0


def _box(medium: Document, filters: list[Document], **sensor: Any) -> Document:
    """`filters` in the order in which light meets them."""
    box = {"type": "box", "minimum": [-1, -1, -1], "maximum": [1, 1, _DEPTH]}
    placed = [
        {"shape": quad([-2, -2, 3 - 0.5 * number], [4, 0, 0], [0, 4, 0]), "kernel": kernel}
        for number, kernel in enumerate(filters)
    ]
    meter = {
        "type": "radiance_meter",
        "position": [0, -3, 0],
        "look_at": [0, 0, 0],
        "up": [0, 0, 1],
        "diameter": 1e-4,
        "cone_degrees": 1e-3,
        "stokes": True,
        **(sensor or GREY),
    }
    return {
        "nocturne": 1,
        "sensor": meter,
        "media": {"drops": medium},
        "surfaces": [{"shape": box, "interior": {"media": ["drops"]}}, *placed],
        "distant": [sun(0)],
        "tracing": {"maximum_depth": 1},
    }


def _polariser(degrees: float) -> Document:
    """Across the light, from the direction across the plane of scattering, x, counterclockwise for who looks
    up at the light, who has -y there."""
    return {"type": "polariser", "axis": [cos(radians(degrees)), -sin(radians(degrees)), 0.0]}


_QUARTER = {"type": "retarder", "axis": [1, 0, 0], "retardance_degrees": 90}


def _scattered(
    light: tuple[float, float, float, float], s12: float, s22: float, s33: float, s34: float, s44: float
) -> np.ndarray[Any, Any]:
    """Over S11. Bohren and Huffman's S1 is positive in the plane of scattering, ours across it."""
    one, two, three, four = light
    return np.array(
        [one - s12 * two, -s12 * one + s22 * two, s33 * three + s34 * four, s44 * four - s34 * three]
    )


def _factor(extinction: float) -> float:
    return exp(-extinction * _DEPTH) * (1 - exp(-extinction * _LENGTH)) / extinction


_LIGHT: dict[str, tuple[list[Document], tuple[float, float, float, float]]] = {
    "unpolarised": ([], (1.0, 0.0, 0.0, 0.0)),
    "along 20": ([_polariser(20)], (0.5, 0.5 * cos(radians(40)), 0.5 * sin(radians(40)), 0.0)),
    "along 45": ([_polariser(45)], (0.5, 0.0, 0.5, 0.0)),
    "circular": ([_polariser(45), _QUARTER], (0.5, 0.0, 0.0, -0.5)),
}


@pytest.mark.parametrize("light", _LIGHT)
def test_a_tabulated_matrix(light: str, tmp_path: Path) -> None:
    """Linear between its cosines, of any particle: values times elements are. False alarms: 0.01 together."""
    cosines, values = [-1.0, -0.5, 0.25, 1.0], [0.5, 0.4, 1.0, 3.0]
    matrix = {
        "s12": [0.0, -0.3, -0.5, 0.0],
        "s22": [0.9, 0.8, 0.95, 1.0],
        "s33": [-0.5, 0.2, 0.6, 1.0],
        "s34": [0.0, 0.4, -0.3, 0.0],
        "s44": [-0.4, 0.1, 0.55, 1.0],
    }
    phase = {
        "type": "tabulated",
        "cosines": cosines,
        "values": [values],
        "matrix": {name: [row] for name, row in matrix.items()},
    }
    filters, stokes = _LIGHT[light]
    document = _box({"scattering": 0.3, "absorption": 0.2, "phase": phase}, filters)
    total = 2 * pi * float(np.trapezoid(values, cosines))
    at = np.interp(0.0, cosines, values)
    of = {name: float(np.interp(0.0, cosines, np.multiply(row, values)) / at) for name, row in matrix.items()}
    truth = 0.3 * at / total * _factor(0.5) * _scattered(stokes, **of)
    measurement = Measurement(document, tmp_path, 8, 8)
    for name, expected in zip(("grey", "S1.grey", "S2.grey", "S3.grey"), truth, strict=True):
        measurement.by_pixels(1024, name).check(
            expected, 5e-6 * truth[0] / max(1e-9, abs(expected)), values=16
        )


@pytest.mark.parametrize("light", ["unpolarised", "circular"])
def test_droplets(light: str, tmp_path: Path) -> None:
    """Haze by the amplitudes of its sizes. The compiler's table is good to 1 % of the light."""
    index, nm = 1.33, 548.0
    radii = np.linspace(2e-9, 5e-6, 3000)
    distribution = mie.Distribution(0.07e-6, 2, 0.5)
    weights = distribution.density(radii) * (radii[1] - radii[0])
    wave = 2 * pi / (nm * 1e-9)
    s11, *others = (weights @ each[:, 0] for each in elements(index, wave * radii, np.array([0.0])))
    s12, s33, s34 = (each / s11 for each in others)
    filters, stokes = _LIGHT[light]
    line = {"wavelengths": "uniform", "responses": {"line": {"table": [[547, 0], [548, 1], [549, 0]]}}}
    droplets = {"mode_radius": 0.07e-6, "alpha": 2, "gamma": 0.5, "number": 1e9, "index": index}
    document = _box({"droplets": droplets}, filters, **line)
    measurement = Measurement(document, tmp_path, 8, 8)
    readings = [measurement.by_pixels(4096, name) for name in ("line", "S1.line", "S2.line", "S3.line")]
    expected = _scattered(stokes, s12, 1.0, s33, s34, s33)
    for reading, truth in zip(readings[1:], expected[1:] / expected[0], strict=True):
        found = reading.mean / readings[0].mean
        noise = 4 * (reading.error + abs(truth) * readings[0].error) / readings[0].mean
        assert abs(found - truth) <= noise + 0.01, (found, truth)
    assert np.abs(expected[1:]).max() > 0.02
