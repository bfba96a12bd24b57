"""Skies from measured irradiances: how bright each direction is, and how many lumens a watt has.

R. Perez, P. Ineichen, R. Seals, J. Michalsky, R. Stewart, "Modeling daylight availability and irradiance
components from direct and global irradiance", Solar Energy 44 (1990) 271: clearness, brightness and luminous
efficacies (equations 1, 2, 7 and 8; table 4). R. Perez, R. Seals, J. Michalsky, "All-weather model for sky
luminance distribution - preliminary configuration and validation", Solar Energy 50 (1993) 235, with its
erratum, 51 (1993) 423: the luminance of a direction (table 1). The tables are in data/perez.csv.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.spectra.published import Floats, data_bytes

SOLAR_CONSTANT = 1361.1
"""Total irradiance above the air at 1 au, W/m2 (ASTM E490-22)."""

_BINS = np.array([1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200])
"""Of the sky's clearness."""

_LEAST_COSINE = 0.01
"""Of a direction's zenith angle: at the horizon exp(b / cos) would be of infinity."""


@dataclass(frozen=True)
class Weather:
    """Of many times, arrays of one shape."""

    direct_normal: Floats
    """Irradiance across the Sun's beam, W/m2."""
    diffuse_horizontal: Floats
    """Irradiance of level ground by the sky alone, W/m2; above zero."""
    sun_zenith: Floats
    """Degrees, below 90."""
    distance: Floats
    """Of the Sun, au."""
    dew_point: Floats
    """Degrees Celsius."""


@dataclass(frozen=True)
class Sky:
    """Skies by weather, arrays of the weather's shape."""

    diffuse_illuminance: Floats
    """Of level ground by the sky, lx."""
    direct_illuminance: Floats
    """Across the Sun's beam, lx."""
    parameters: Floats
    """a, b, c, d and e of the relative luminance, shape (..., 5)."""


def air_mass(zenith: Floats) -> Floats:
    """Kasten 1965, as the model was fitted; `zenith` in degrees."""
    return np.asarray(1 / (np.cos(np.radians(zenith)) + 0.15 * (93.885 - zenith) ** -1.253))


def sky_of(weather: Weather) -> Sky:
    """The skies of some weather."""
    diffuse, direct = weather.diffuse_horizontal, weather.direct_normal
    z = np.radians(weather.sun_zenith)
    kappa = 1.041 * z**3
    clearness = ((diffuse + direct) / diffuse + kappa) / (1 + kappa)
    above = SOLAR_CONSTANT / weather.distance**2
    brightness = np.maximum(diffuse * air_mass(weather.sun_zenith) / above, 1e-3)
    chosen = np.searchsorted(_BINS, clearness, side="right")
    water = np.exp(0.07 * weather.dew_point - 0.075)
    a, b, c, d = np.moveaxis(_table("diffuse")[chosen], -1, 0)
    of_sky = a + b * water + c * np.cos(z) + d * np.log(brightness)
    a, b, c, d = np.moveaxis(_table("direct")[chosen], -1, 0)
    of_sun = np.maximum(0.0, a + b * water + c * np.exp(5.73 * z - 5) + d * brightness)
    return Sky(diffuse * of_sky, direct * of_sun, _parameters(chosen, brightness, z))


def _parameters(chosen: NDArray[np.intp], brightness: Floats, z: Floats) -> Floats:
    # The fit has no such skies, and gives them luminances below zero.
    dark = (chosen >= 1) & (chosen <= 4)
    brightness = np.where(dark, np.maximum(brightness, 0.2), brightness)
    terms = _table("luminance")[chosen].reshape(*chosen.shape, 5, 4)
    delta, angle = brightness[..., None], z[..., None]
    found = terms[..., 0] + terms[..., 1] * angle + delta * (terms[..., 2] + terms[..., 3] * angle)
    # Equations 7 and 8 of 1993, for the first bin.
    first = chosen == 0
    c1, c2, c3, c4 = _table("luminance")[0, 8:12]
    d1, d2, d3, d4 = _table("luminance")[0, 12:16]
    c = np.exp(np.maximum(0.0, brightness * (c1 + c2 * z)) ** c3) - c4
    d = -np.exp(brightness * (d1 + d2 * z)) + d3 + brightness * d4
    found[..., 2] = np.where(first, c, found[..., 2])
    found[..., 3] = np.where(first, d, found[..., 3])
    return np.asarray(found, dtype=np.float64)


def relative_luminance(parameters: Floats, cos_zenith: Floats, cos_from_sun: Floats) -> Floats:
    """Luminances in directions above the horizon, in no unit.

    Of a sky far darker than the Sun beside it (5 W/m2 by the sky and 9 by a Sun in the zenith) the fit is
    zero or below in all directions: this is zero, and callers take an even sky.

    `parameters`: a, b, c, d, e along the last axis, which is dropped; the rest is broadcast.
    """
    a, b, c, d, e = np.moveaxis(parameters, -1, 0)
    angle = np.arccos(np.clip(cos_from_sun, -1.0, 1.0))
    gradation = 1 + a * np.exp(b / np.maximum(cos_zenith, _LEAST_COSINE))
    indicatrix = 1 + c * np.exp(d * angle) + e * cos_from_sun**2
    return np.asarray(np.maximum(0.0, gradation * indicatrix), dtype=np.float64)


@lru_cache(maxsize=3)
def _table(name: str) -> Floats:
    """A row for each bin of clearness."""
    rows = [line.split(",") for line in data_bytes("perez.csv").decode("ascii").splitlines()]
    return np.array([numbers for first, *numbers in rows if first == name], dtype=np.float64)
