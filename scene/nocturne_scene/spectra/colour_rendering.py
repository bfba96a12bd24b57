"""How a light renders colours: CIE 13.3-1995 (Ra, R9), and ANSI/IES TM-30-20 with CIE 224:2017 (Rf, Rg).

A light counts by its tristimulus values alone, of itself and from each test colour: integrals of its spectrum
times fixed weights, so that whoever knows these integrals needs no spectrum.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.temperature import colour_temperature_of

_TEST_COLOURS, _SAMPLES = 14, 99
_R9 = 8
_HUE_BINS = 16

# CIECAM02 for TM-30: average surround, Y_b 20, L_A 100, complete adaptation.
_CAT02 = np.array([[0.7328, 0.4296, -0.1624], [-0.7036, 1.6975, 0.0061], [0.0030, 0.0136, 0.9834]])
_HPE = np.array([[0.38971, 0.68898, -0.07868], [-0.22981, 1.18340, 0.04641], [0.0, 0.0, 1.0]])
_TO_HPE = _HPE @ np.linalg.inv(_CAT02)
_C, _NC = 0.69, 1.0
_N = 0.2
_NBB = 0.725 * (1.0 / _N) ** 0.2
_Z = 1.48 + math.sqrt(_N)
_K = 1.0 / (5.0 * 100.0 + 1.0)
_FL = 0.2 * _K**4 * 500.0 + 0.1 * (1.0 - _K**4) ** 2 * 500.0 ** (1.0 / 3.0)


class ColourRendering(NamedTuple):
    """Of a light; 100 is the reference's, of the same colour temperature."""

    ra: float
    r9: float
    rf: float
    rg: float


@lru_cache(maxsize=1)
def weights() -> Floats:
    """The integrals that count, shape (401, 345), at `colour_wavelengths`: X, Y, Z of the light and from 14
    test colours by the observer of 1931, then of the light and from 99 samples by that of 1964."""
    first = int(published.COLOUR_RANGE[0] - published.FIRST)
    places = slice(first, first + len(published.colour_wavelengths()))
    small, large = (published.observer(name)[places] for name in published.OBSERVERS)
    one = np.ones((len(small), 1))
    colours = np.hstack([one, published.test_colours()])
    samples = np.hstack([one, published.colour_evaluation_samples()])
    of_small = (colours[:, :, None] * small[:, None, :]).reshape(len(small), -1)
    of_large = (samples[:, :, None] * large[:, None, :]).reshape(len(large), -1)
    return np.hstack([of_small, of_large])


def colour_rendering(integrals: Floats, hues: Floats | None = None) -> ColourRendering:
    """From a light's integrals with `weights`. `hues`: of the reference's samples, by which these go into
    bins, where they are to stay as they are."""
    colours, samples = _split(integrals)
    kelvin, _ = colour_temperature_of(colours[0])
    planckian, daylight = _planckian(kelvin), _daylight(max(kelvin, 4000.0))
    of_1995 = planckian if kelvin < 5000.0 else daylight
    of_2017 = _blended(planckian, daylight, min(1.0, max(0.0, kelvin / 1000.0 - 4.0)))
    ri = _special_indices(colours, _split(of_1995)[0])
    test, reference = _ucs(samples), _ucs(_split(of_2017)[1])
    differences = np.linalg.norm(test - reference, axis=-1)
    return ColourRendering(
        float(ri[:8].mean()),
        float(ri[_R9]),
        _fidelity(float(differences.mean())),
        _gamut(test, reference, _hues(reference) if hues is None else hues),
    )


def reference_hues(integrals: Floats) -> Floats:
    """Of the samples under the light's reference."""
    kelvin, _ = colour_temperature_of(_split(integrals)[0][0])
    blend = min(1.0, max(0.0, kelvin / 1000.0 - 4.0))
    reference = _blended(_planckian(kelvin), _daylight(max(kelvin, 4000.0)), blend)
    return _hues(_ucs(_split(reference)[1]))


def _split(integrals: Floats) -> tuple[Floats, Floats]:
    """X, Y, Z of the light and from test colours, by either observer."""
    end = 3 * (1 + _TEST_COLOURS)
    return integrals[:end].reshape(-1, 3), integrals[end:].reshape(-1, 3)


def _planckian(kelvin: float) -> Floats:
    """Integrals, for Y = 1. By the constant of ITS-90, as CIE 015 and CIE 13.3 have it."""
    scale = 1.4388e-2 / (published.PLANCK * published.LIGHT_SPEED / published.BOLTZMANN)
    return _of_spectrum(published.planck(kelvin / scale, published.colour_wavelengths()))


def _daylight(kelvin: float) -> Floats:
    """Integrals of the phase of daylight, for Y = 1: CIE 015:2018, 4.1.2."""
    t = 1000.0 / kelvin
    if kelvin <= 7000.0:
        x = 0.244063 + 0.09911 * t + 2.9678 * t**2 - 4.6070 * t**3
    else:
        x = 0.237040 + 0.24748 * t + 1.9018 * t**2 - 2.0064 * t**3
    y = -3.0 * x**2 + 2.870 * x - 0.275
    below = 0.0241 + 0.2562 * x - 0.7341 * y
    m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / below
    m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / below
    return _of_spectrum(published.daylight_components() @ np.array([1.0, m1, m2]))


def _of_spectrum(values: Floats) -> Floats:
    found = values @ weights()
    return np.asarray(found / found[1], dtype=np.float64)


def _blended(planckian: Floats, daylight: Floats, part: float) -> Floats:
    """CIE 224:2017: between 4000 and 5000 K both, for equal Y."""
    return (1.0 - part) * planckian + part * daylight


def _uv(xyz: Floats) -> Floats:
    below = xyz @ np.array([1.0, 15.0, 3.0])
    found: Floats = np.stack([4.0 * xyz[..., 0], 6.0 * xyz[..., 1]], axis=-1) / below[..., None]
    return found


def _special_indices(test: Floats, reference: Floats) -> Floats:
    """R_i of CIE 13.3-1995, of all test colours; first comes the light itself."""
    test, reference = (100.0 * each / each[0, 1] for each in (test, reference))
    seen, known = _uv(test), _uv(reference)
    c, d = (_adapting(seen[..., 0], seen[..., 1])), _adapting(known[..., 0], known[..., 1])
    ratio_c, ratio_d = d[0][0] / c[0][0] * c[0][1:], d[1][0] / c[1][0] * c[1][1:]
    below = 16.518 + 1.481 * ratio_c - ratio_d
    u, v = (10.872 + 0.404 * ratio_c - 4.0 * ratio_d) / below, 5.520 / below
    adapted = _uvw(np.stack([u, v], axis=-1), test[1:, 1], known[0])
    expected = _uvw(known[1:], reference[1:, 1], known[0])
    found: Floats = 100.0 - 4.6 * np.linalg.norm(adapted - expected, axis=-1)
    return found


def _adapting(u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """c and d."""
    return (4.0 - u - 10.0 * v) / v, (1.708 * v + 0.404 - 1.481 * u) / v


def _uvw(uv: Floats, y: Floats, white: Floats) -> Floats:
    """U*, V*, W* of CIE 1964."""
    w = 25.0 * np.cbrt(y) - 17.0
    return np.stack([13.0 * w * (uv[..., 0] - white[0]), 13.0 * w * (uv[..., 1] - white[1]), w], axis=-1)


def _ucs(xyz: Floats) -> Floats:
    """J', a', b' of CAM02-UCS of samples; first comes the white."""
    xyz = 100.0 * xyz / xyz[0, 1]
    rgb = xyz @ _CAT02.T
    # Complete adaptation, to a white whose Y is 100.
    compressed = _compressed((rgb * (100.0 / rgb[0])) @ _TO_HPE.T)
    r, g, b = np.moveaxis(compressed, -1, 0)
    red_green, yellow_blue = r - 12.0 * g / 11.0 + b / 11.0, (r + g - 2.0 * b) / 9.0
    achromatic = (2.0 * r + g + b / 20.0 - 0.305) * _NBB
    hue = np.arctan2(yellow_blue, red_green)
    lightness = 100.0 * (achromatic / achromatic[0]) ** (_C * _Z)
    eccentricity = 0.25 * (np.cos(hue + 2.0) + 3.8)
    t = 50000.0 / 13.0 * _NC * _NBB * eccentricity * np.hypot(red_green, yellow_blue)
    t /= r + g + 1.05 * b
    chroma = t**0.9 * np.sqrt(lightness / 100.0) * (1.64 - 0.29**_N) ** 0.73
    colourfulness = np.log1p(0.0228 * chroma * _FL**0.25) / 0.0228
    j = 1.7 * lightness / (1.0 + 0.007 * lightness)
    found = np.stack([j, colourfulness * np.cos(hue), colourfulness * np.sin(hue)], axis=-1)
    return found[1:]


def _compressed(cones: Floats) -> Floats:
    power = (_FL * np.abs(cones) / 100.0) ** 0.42
    found: Floats = np.sign(cones) * 400.0 * power / (power + 27.13) + 0.1
    return found


def _fidelity(difference: float) -> float:
    return 10.0 * math.log1p(math.exp((100.0 - 6.73 * difference) / 10.0))


def _hues(ucs: Floats) -> Floats:
    """Bins, 0 to 15."""
    degrees = np.degrees(np.arctan2(ucs[:, 2], ucs[:, 1])) % 360.0
    return np.floor(degrees / (360.0 / _HUE_BINS))


def _gamut(test: Floats, reference: Floats, hues: Floats) -> float:
    bins = [hues == each for each in range(_HUE_BINS) if (hues == each).any()]
    areas = [_area(np.stack([each[mask, 1:].mean(axis=0) for mask in bins])) for each in (test, reference)]
    return 100.0 * areas[0] / areas[1]


def _area(corners: Floats) -> float:
    following = np.roll(corners, -1, axis=0)
    return float((corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]).sum()) / 2.0
