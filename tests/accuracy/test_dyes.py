"""Dyes in media, against closed forms, quadratures and photons that are followed from the light."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import along, film, slab, sun
from numpy.typing import NDArray

from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

Floats = NDArray[np.float64]

_BLUE = [[440, 0.0], [441, 1.0], [459, 1.0], [460, 0.0]]
_EMISSION = [[500, 0.0], [540, 1.0], [600, 0.0]]
_RANGE_NM = 830.0 - 360.0
"""What readings are divided by."""


def _dye(coefficient: float, quantum_yield: float = 1.0) -> Document:
    """Absorbs from 430 to 470 nm, evenly, and emits where it is clear."""
    return {
        "absorption": {"table": [[429, 0.0], [430, coefficient], [470, coefficient], [471, 0.0]]},
        "emission": {"table": _EMISSION},
        "quantum_yield": quantum_yield,
    }


def _emitted_power() -> float:
    """Over the power that is absorbed, with one photon for each."""
    nm = np.arange(360.0, 830.01, 0.05)
    blue, emission = (_at(nm, table) for table in (_BLUE, _EMISSION))
    photons = np.trapezoid(blue * nm, nm) / np.trapezoid(blue, nm)
    return float(photons * np.trapezoid(emission, nm) / np.trapezoid(emission * nm, nm))


def _at(nm: Floats, table: list[list[float]]) -> Floats:
    at, values = np.array(table, dtype=float).T
    return np.asarray(np.interp(nm, at, values, left=0.0, right=0.0))


def _power(table: list[list[float]]) -> float:
    at, values = np.array(table, dtype=float).T
    return float(np.trapezoid(values, at))


_WATTS = {
    "wavelengths": "uniform",
    "responses": {"green": {"table": [[480, 0], [490, 1], [620, 1], [630, 0]]}},
}


def _film(z: float, towards: float) -> Document:
    """Irradiance on a small film that faces up or down."""
    return film([0, 0, z], [0, 0, towards], 1e-3) | _WATTS


def _document(medium: Document, body: Document, sensor: Document, **more: Any) -> Document:
    return {"nocturne": 1, "sensor": sensor, "media": {"fog": medium}, "surfaces": [body], **more}


@pytest.mark.parametrize("together", [1, 4])
def test_light_that_a_slab_of_dye_traps(together: int, tmp_path: Path) -> None:
    """Of light that is emitted in a slab of index 1.5 a part of sqrt(1 - 1 / n^2) = 0.7454 is totally
    reflected at both faces and never leaves; the rest does, half of it upwards. Even light from below and
    above excites.

    Of light at an angle a face lets T of it in, and 1 - t is absorbed a crossing, t = exp(-a d / cos): of it
    T (1 - t) / (1 - R t) in all. Flux of both sides: 2 pi L times the mean over the cosine.
    """
    index, depth, coefficient = 1.5, 1.0, 0.8
    body = slab(depth, 200.0, "fog") | {"kernel": {"type": "dielectric", "index": index}}
    document = _document({"fluorescence": [_dye(coefficient)]}, body, _film(0.01, -1.0))
    document["environment"] = {"radiance": {"table": _BLUE}}
    document["tracing"] = {"photons_together": together}
    sine2 = (np.arange(200_000) + 0.5) / 200_000
    outside = np.sqrt(1 - sine2)
    inside = np.sqrt(1 - sine2 / index**2)
    s = ((outside - index * inside) / (outside + index * inside)) ** 2
    p = ((index * outside - inside) / (index * outside + inside)) ** 2
    reflected, left = (s + p) / 2, np.exp(-coefficient * depth / inside)
    absorbed = 2 * np.pi * float(np.mean((1 - reflected) * (1 - left) / (1 - reflected * left)))
    trapped = np.sqrt(1 - 1 / index**2)
    assert trapped == pytest.approx(0.7454, abs=5e-5)
    truth = 0.5 * (1 - trapped) * absorbed * _power(_BLUE) * _emitted_power() / _RANGE_NM
    Measurement(document, tmp_path, 8, 8).by_pixels(2048, "green").check(truth, 2e-5)


@pytest.mark.parametrize("estimator", ["two_photons", "mixture"])
@pytest.mark.parametrize(("degrees", "quantum_yield"), [(0.0, 1.0), (75.0, 0.6)])
def test_photons_are_kept(estimator: str, degrees: float, quantum_yield: float, tmp_path: Path) -> None:
    """A slab without faces, in even light: as many photons as it absorbs leave it, evenly to all sides, and
    the radiance in a direction is their flux over 4 pi cos. False alarms: 0.01 in each."""
    coefficient = 1.5
    medium = {"fluorescence": [_dye(coefficient, quantum_yield)]}
    document = _document(medium, slab(1.0, 200.0, "fog"), along(degrees, 1.0) | _WATTS)
    document["environment"] = {"radiance": {"table": _BLUE}}
    document["tracing"] = {"estimator": estimator}
    cosine = (np.arange(200_000) + 0.5) / 200_000
    absorbed = 2 * 2 * np.pi * float(np.mean((1 - np.exp(-coefficient / cosine)) * cosine))
    photons = quantum_yield * absorbed * _power(_BLUE) * _emitted_power()
    truth = photons / (4 * np.pi * np.cos(np.radians(degrees))) / _RANGE_NM
    Measurement(document, tmp_path, 8, 8).by_pixels(1024, "green").check(truth, 2e-5)


def _walk(count: int, depth: float, absorption: float, scattering: float, emitting: float) -> Floats:
    """Energy that leaves the lower face as light of the dye, for each of many blue photons that come straight
    down on a slab: `emitting` is what emitted light is absorbed by, for good. Even scattering."""
    random = np.random.default_rng(7)
    z, mu = np.zeros(count), np.ones(count)
    changed, alive = np.zeros(count, dtype=bool), np.ones(count, dtype=bool)
    out = np.zeros(count)
    while alive.any():
        extinction = np.where(changed, emitting, absorption) + scattering
        z = np.where(alive, z + mu * random.exponential(size=count) / extinction, z)
        out[alive & changed & (z > depth)] = 1.0
        alive &= (z > 0) & (z < depth)
        absorbed = alive & (random.random(count) * extinction >= scattering)
        alive &= ~(absorbed & changed)
        changed |= absorbed
        mu = 2 * random.random(count) - 1
    return out


@pytest.mark.parametrize("density", ["even", "layers"])
def test_photons_from_the_light_come_to_the_same(density: str, tmp_path: Path) -> None:
    """Fog with a dye that absorbs a part of its emission, under a lamp; photons from the light, followed by
    another program, leave as much below. False alarms: 0.01 in each."""
    absorption, scattering, emitting = 0.7, 1.2, 0.3
    medium: Document = {
        "scattering": scattering,
        # None where the dye absorbs.
        "absorption": {"table": [[475, 0.0], [480, emitting], [640, emitting]]},
        "fluorescence": [_dye(absorption)],
    }
    if density == "layers":
        medium["density"] = {
            "layers": [[-2.0, 1.0], [1.0, 1.0]],
            "above": {"point": [0, 0, 0], "up": [0, 0, 1]},
        }
    document = _document(medium, slab(1.0, 100.0, "fog"), _film(-1.01, 1.0))
    document["distant"] = [sun(0, irradiance={"table": _BLUE})]
    walked = _walk(400_000, 1.0, absorption, scattering, emitting)
    factor = _power(_BLUE) * _emitted_power() / _RANGE_NM
    reading = Measurement(document, tmp_path, 8, 8).by_pixels(4096, "green")
    error = float(np.hypot(reading.error, factor * walked.std() / np.sqrt(walked.size)))
    assert abs(reading.mean - factor * walked.mean()) < 3.0 * error, (reading, factor * walked.mean())
    assert error < 0.015 * reading.mean
