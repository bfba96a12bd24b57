"""Lamps of narrow lines, from a scene document through the compiler to the image: the colour of the line,
whatever its width, also with a continuum.

A closed box whose walls scatter half of the light and all emit L has radiance 2 L everywhere, so X, Y, Z are
twice those of the lamp.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.spectra import published
from nocturne_scene.validation.documents import furnace

from tests.accuracy.tracing import Document, trace

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_EDGE = 16
_SAMPLES = 128

LINES = {
    # Powers (1 together), x, y, and Y per unit of radiance over K_m: the CIE 1931 table, linear in between.
    "Na": ([(588.995, 2 / 3), (589.592, 1 / 3)], 0.57039795, 0.42896562, 0.7667963),
    "Hg546": ([(546.074, 1.0)], 0.27349433, 0.71758787, 0.98433851),
    "Hg436": ([(435.833, 1.0)], 0.16652004, 0.0088972812, 0.017812411),
    "HeNe": ([(632.8, 1.0)], 0.71147236, 0.28848329, 0.23724544),
}


def _box(radiance: Any, wavelengths: str = "response") -> Document:
    document = furnace(0.5, 0.0)
    document["spectra"]["glow"] = radiance
    document["sensor"]["wavelengths"] = wavelengths
    document["tracing"] = {"sequence": "independent", "seed": 11}
    return document


def _lines(name: str, width: float) -> Document:
    return {"lines": [{"nm": nm, "power": power, "width": width} for nm, power in LINES[name][0]]}


@pytest.mark.parametrize("width", [0.01, 0.1, 1.0])
@pytest.mark.parametrize("name", LINES)
def test_a_line_has_its_colour_and_power(name: str, width: float, tmp_path: Path) -> None:
    """The mean of Y within 4 standard errors: false alarms 6e-5 each.

    X and Z come from the same photons, so that their proportions are those of the line but for its width
    (1e-3) and what differs between the doublet's lines.
    """
    image = trace(_box(_lines(name, width)), tmp_path, _EDGE, _SAMPLES)
    _, x, y, luminous = LINES[name]
    mean = image.xyz.reshape(-1, 3).mean(axis=0)
    error = np.sqrt(np.mean(image.y_error.astype(np.float64) ** 2) / image.y.size)
    assert abs(mean[1] - 2 * 683 * luminous) < 4 * error + 2e-4 * mean[1]
    assert error < 0.02 * mean[1]
    assert mean[:2] / mean.sum() == pytest.approx((x, y), abs=1e-3)


def test_lines_and_a_continuum(tmp_path: Path) -> None:
    """Half of the walls glow in lines, the others evenly: the mean radiance of all pixels is not known in
    closed form, but the sum over both kinds of box is that of one that has both.
    """
    even = published.observer("CIE 1931 2 degree")[:, 1].sum() * 0.01
    document = _box(_lines("Na", 0.01))
    document["spectra"]["even"] = 0.01
    means, variance = 0.0, 0.0
    for odd in (0, 1):
        document["tracing"]["seed"] = 11 + odd
        for index, surface in enumerate(document["surfaces"]):
            surface["luminaire"] = {"radiance": "even" if index % 2 == odd else "glow"}
        image = trace(document, tmp_path, _EDGE, 2 * _SAMPLES)
        means += image.y.mean()
        variance += float(np.mean(image.y_error.astype(np.float64) ** 2)) / image.y.size
    truth = 2 * 683 * (LINES["Na"][3] + even)
    assert abs(means - truth) < 4 * np.sqrt(variance) + 2e-4 * truth


def test_uniform_wavelengths_find_lines_as_well(tmp_path: Path) -> None:
    """Sodium lines 0.1 nm wide, which one in thousands of wavelengths would meet by chance."""
    errors = {}
    for wavelengths in ("response", "uniform"):
        image = trace(_box(_lines("Na", 0.1), wavelengths), tmp_path, _EDGE, 4 * _SAMPLES)
        errors[wavelengths] = np.sqrt(np.mean(image.y_error.astype(np.float64) ** 2))
    assert errors["uniform"] < 1.5 * errors["response"]
