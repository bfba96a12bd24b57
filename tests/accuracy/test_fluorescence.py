"""Fluorescent surfaces, against integrals over exciting and emitted wavelengths by quadrature.

The photons of a reading in a response r are those of wavelength `out`; what a surface sends there is
rho(out) L(out) + integral of Phi(in, out) L(in) over `in`.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK, furnace, quad, sun, surface
from numpy.typing import NDArray

from tests.accuracy.agreement import ROUNDING
from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

Floats = NDArray[np.float64]

_NM = np.arange(360.0, 830.0 + 0.05, 0.1)
"""For quadratures."""
_ABSORPTION = [[380, 0.1], [450, 0.7], [510, 0.3], [560, 0.0]]
_EMISSION = [[470, 0.0], [520, 1.0], [560, 0.6], [700, 0.0]]
_YIELD = 0.9
_DYE = {"absorption": {"table": _ABSORPTION}, "emission": {"table": _EMISSION}, "quantum_yield": _YIELD}
_RED_DYE = {
    "absorption": {"table": [[450, 0.0], [540, 0.25], [600, 0.0]]},
    "emission": {"table": [[560, 0.0], [620, 1.0], [720, 0.0]]},
    "quantum_yield": 0.5,
}
_GREY = {"table": [[400, 0.1], [500, 0.2], [600, 0.6], [830, 0.8]]}
_BANDS = {
    "blue": {"table": [[430, 0], [440, 1], [460, 1], [470, 0]]},
    "green": {"table": [[510, 0], [520, 1], [540, 1], [550, 0]]},
    "red": {"table": [[600, 0], [610, 1], [640, 1], [650, 0]]},
}


def _table(knots: Any, *, hold: bool = False) -> Floats:
    at, values = np.array(knots, dtype=float).T
    ends = None if hold else 0.0
    return np.asarray(np.interp(_NM, at, values, left=ends, right=ends))


def _integral(values: Floats) -> float:
    return float(np.trapezoid(values, _NM))


def _excited(dye: Document, light: Floats) -> Floats:
    """What a dye emits at each wavelength."""
    emission = _table(dye["emission"]["table"])
    photons = _integral(_table(dye["absorption"]["table"]) * _NM * light)
    return np.asarray(dye["quantum_yield"] * photons * emission / _integral(emission * _NM))


def _in_cavity(emitted: Floats, reflectance: Floats, dyes: list[Document]) -> Floats:
    """Radiance where all walls do the same: (1 - rho - Phi)^-1 e, as a sum over bounces."""
    total, light = np.zeros_like(_NM), emitted
    for _ in range(200):
        total = total + light
        light = reflectance * light + sum(_excited(dye, light) for dye in dyes)
    return total


def _responses() -> dict[str, Any]:
    return {"wavelengths": "uniform", "responses": _BANDS}


def _check(
    measurement: Measurement, light: Floats, samples: int, bands: tuple[str, ...] = tuple(_BANDS)
) -> None:
    for name in bands:
        truth = _integral(_table(_BANDS[name]["table"]) * light) / (830.0 - 360.0)
        measurement.by_pixels(samples, name).check(truth, max(ROUNDING, 2e-5), values=len(bands))


def _cavity(fluorescence: list[Document], **tracing: Any) -> Document:
    document = furnace(0.5, 1.0)
    document["kernels"] = {
        "wall": {"type": "lambertian", "reflectance": "wall", "fluorescence": fluorescence}
    }
    # Light in the blue and the red.
    document["spectra"] = {"wall": _GREY, "glow": {"table": [[400, 0.2], [460, 1.0], [500, 0.0], [700, 0.3]]}}
    document["sensor"] |= _responses()
    return document | {"tracing": tracing}


_GLOW = _table([[400, 0.2], [460, 1.0], [500, 0.0], [700, 0.3]])


@pytest.mark.every_sixth
@pytest.mark.parametrize("together", [1, 4])
@pytest.mark.parametrize("estimator", ["two_photons", "mixture", "split"])
@pytest.mark.parametrize("roulette", ["weight", "albedo"])
def test_closed_cavity(together: int, estimator: str, roulette: str, tmp_path: Path) -> None:
    """Whatever the matrix, the radiance is (1 - rho - Phi)^-1 e. False alarms: 0.01."""
    tracing = {"photons_together": together, "estimator": estimator, "roulette": roulette}
    document = _cavity([_DYE, _RED_DYE], **tracing)
    document["spectra"]["wall"] = 0.2
    light = _in_cavity(_GLOW, np.full_like(_NM, 0.2), [_DYE, _RED_DYE])
    _check(Measurement(document, tmp_path, 8, 8), light, 256)


def _matrix() -> Document:
    """A re-radiation matrix that is no product, some of it to shorter wavelengths."""
    exciting, emitted = np.arange(400.0, 601.0, 20.0), np.arange(450.0, 701.0, 25.0)
    rows = [
        [
            float(f"{2e-3 * np.exp(-(((out - into - 60) / 50) ** 2)) * (1 + out / into):.4g}")
            for out in emitted
        ]
        for into in exciting
    ]
    return {"excitation_nm": exciting.tolist(), "emission_nm": emitted.tolist(), "values": rows}


def _by_matrix(matrix: Document, light: Floats) -> Floats:
    exciting, emitted = np.array(matrix["excitation_nm"]), np.array(matrix["emission_nm"])
    found = np.zeros_like(_NM)
    at_knots = [
        _integral(np.interp(_NM, exciting, column / exciting, left=0, right=0) * _NM * light)
        for column in np.array(matrix["values"]).T
    ]
    found += np.interp(_NM, emitted, at_knots, left=0, right=0)
    return found


def test_closed_cavity_of_a_measured_matrix(tmp_path: Path) -> None:
    """The same for a table. False alarms: 0.01."""
    matrix = _matrix()
    total, light = np.zeros_like(_NM), _GLOW
    for _ in range(200):
        total, light = total + light, 0.3 * light + _by_matrix(matrix, light)
    document = _cavity([matrix])
    document["spectra"]["wall"] = 0.3
    _check(Measurement(document, tmp_path, 8, 8), total, 256)


def _under(light: list[Document], kernel: Document, **more: Any) -> Document:
    """A plane, seen at an angle by a narrow meter."""
    sensor = {
        "type": "radiance_meter",
        "position": [1.5, 0, 2],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "diameter": 1e-3,
        "cone_degrees": 0.05,
    }
    plane = surface(quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), kernel)
    surfaces = [plane, *more.pop("surfaces", [])]
    return {"nocturne": 1, "sensor": sensor | _responses(), "surfaces": surfaces, "distant": light, **more}


_LAMP = [[400, 1.0], [440, 2.0], [480, 1.0], [500, 0.0]]
_KERNEL = {"type": "lambertian", "reflectance": 0.2, "fluorescence": [_DYE, _RED_DYE]}


def _above(light: Floats) -> Floats:
    return np.asarray(0.2 * light + _excited(_DYE, light) + _excited(_RED_DYE, light)) / np.pi


@pytest.mark.parametrize("together", [1, 4])
def test_plane_under_a_lamp(together: int, tmp_path: Path) -> None:
    """A distant lamp, by quadrature. False alarms: 0.01."""
    document = _under([sun(30, irradiance={"table": _LAMP})], _KERNEL)
    document["tracing"] = {"photons_together": together}
    _check(Measurement(document, tmp_path, 8, 8), _above(_table(_LAMP) * np.cos(np.radians(30))), 256)


@pytest.mark.parametrize("filled", ["absorption", "media"])
@pytest.mark.parametrize("together", [1, 4])
def test_a_filter_weakens_light_by_its_own_wavelength(filled: str, together: int, tmp_path: Path) -> None:
    """Exciting light comes through a filter of colour, the meter looks from below it. False alarms: 0.01."""
    coefficient = {"table": [[380, 2.0], [460, 0.5], [520, 3.0]]}
    shape = {"type": "box", "minimum": [-1, -1, 1.0], "maximum": [1, 1, 1.4]}
    block: Document = {"shape": shape}
    if filled == "media":
        block["interior"] = {"media": ["dye"]}
    else:
        block["kernel"] = {"type": "dielectric", "index": 1.0, "absorption": coefficient}
    document = _under([sun(0, irradiance={"table": _LAMP})], _KERNEL, surfaces=[block])
    document["sensor"]["position"] = [0.6, 0, 0.8]
    if filled == "media":
        document["media"] = {"dye": {"absorption": coefficient, "scattering": 0.0}}
    document["tracing"] = {"photons_together": together}
    left = np.exp(-0.4 * _table(coefficient["table"], hold=True))
    _check(Measurement(document, tmp_path, 8, 8), _above(_table(_LAMP) * left), 512, ("green", "red"))


def test_photons_are_kept(tmp_path: Path) -> None:
    """Of a surface that absorbs all light of some wavelengths and loses none, as many photons leave as fall
    on it: to 1e-4 of them. The meter weighs power by the wavelength, which counts photons."""
    all_blue = {"table": [[400, 1.0], [500, 1.0]]}
    dye = {"absorption": all_blue, "emission": {"table": [[530, 0], [600, 1], [640, 0]]}}
    kernel = {"type": "lambertian", "reflectance": 0.0, "fluorescence": [dye]}
    document = _under([], kernel)
    document["environment"] = {"radiance": {"table": [[400, 1.0], [500, 1.0]]}}
    document["sensor"]["responses"] = {"per_photon": {"table": [[360, 3.6e-3], [830, 8.3e-3]]}}
    document["tracing"] = {"estimator": "mixture", "mixture": {"kernel": 1.0}, "h": 1e6}
    reading = Measurement(document, tmp_path, 16, 16).by_pixels(16384, "per_photon")
    truth = 1e-5 * (500**2 - 400**2) / 2 / (830 - 360)
    assert reading.error < 3e-5 * truth
    reading.check(truth, 2e-5)


def test_nothing_else_changes(tmp_path: Path) -> None:
    """Light that excites nothing is reflected as if nothing fluoresced. False alarms: 0.01."""
    red = {"table": [[610, 1.0], [640, 1.0]]}
    document = _under([sun(0, irradiance=red)], _KERNEL)
    expected = 0.2 * _table(red["table"]) / np.pi
    _check(Measurement(document, tmp_path, 8, 8), expected, 64, ("red",))


def test_black_walls_need_a_light(tmp_path: Path) -> None:
    """In a box whose other walls are black, a fluorescent one is lit by ultraviolet light alone."""
    lamp = {"table": [[370, 1.0], [390, 1.0]]}
    uv = {
        "absorption": {"table": [[365, 0.8], [400, 0.8]]},
        "emission": {"table": [[500, 0], [530, 1], [560, 0]]},
    }
    kernel = {"type": "lambertian", "reflectance": 0.0, "fluorescence": [uv]}
    document = _under([sun(0, irradiance=lamp)], kernel, surfaces=[])
    document["surfaces"].append(surface(quad([-1, -1, -1], [2, 0, 0], [0, 2, 0]), BLACK))
    light = _excited(uv | {"quantum_yield": 1.0}, _table(lamp["table"])) / np.pi
    _check(Measurement(document, tmp_path, 8, 8), light, 256, ("green",))
