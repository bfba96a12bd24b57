"""Correlated colour temperature and distance from the Planckian locus, with standard errors.

CIE 015:2018, 9.5: the temperature of the black body nearest in u, v of CIE 1960; Duv is positive above the
locus (ANSI C78.377). Temperatures by Planck's law with c2 = 1.4388e-2 m K and the CIE 1931 observer.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats

LOWEST, HIGHEST = 1000.0, 100_000.0
"""K; between these a temperature is looked for."""
FARTHEST = 0.05
"""Of |Duv|: light farther from the locus has no correlated temperature."""


@dataclass(frozen=True, slots=True)
class ColourTemperature:
    """Of light."""

    kelvin: float
    """NaN where the light is too far from the locus."""
    kelvin_error: float
    duv: float
    duv_error: float


@lru_cache(maxsize=1)
def _locus() -> tuple[Floats, Floats]:
    """Reciprocal megakelvins in equal steps, and u, v there."""
    reciprocal = np.linspace(1e6 / HIGHEST, 1e6 / LOWEST, 2000)
    wavelengths = published.visible_wavelengths()
    observer = published.observer("CIE 1931 2 degree")
    # The constant of ITS-90 (CIE 015:2018, 9.1).
    scale = 1.4388e-2 / (published.PLANCK * published.LIGHT_SPEED / published.BOLTZMANN)
    xyz = np.array([published.planck(1e6 / each / scale, wavelengths) @ observer for each in reciprocal])
    return reciprocal, _uv(xyz)


def _uv(xyz: Floats) -> Floats:
    below = xyz @ np.array([1.0, 15.0, 3.0])
    return np.stack([4.0 * xyz[..., 0] / below, 6.0 * xyz[..., 1] / below], axis=-1)


def colour_temperature_of(xyz: Floats) -> tuple[float, float]:
    """K and Duv of X, Y, Z, whatever their distance from the locus."""
    return _nearest(_uv(xyz))


def colour_temperature(xyz: Floats, covariance: Floats) -> ColourTemperature:
    """Of X, Y, Z, with their 3 x 3 covariance; errors to first order."""
    kelvin, duv = _nearest(_uv(xyz))
    step = 1e-4 * float(xyz.sum())
    slopes = []
    for axis in range(3):
        moved = np.array([xyz + sign * step * np.eye(3)[axis] for sign in (1.0, -1.0)])
        above, below = (_nearest(each) for each in _uv(moved))
        slopes.append([(above[0] - below[0]) / (2.0 * step), (above[1] - below[1]) / (2.0 * step)])
    kelvin_error, duv_error = (
        math.sqrt(max(0.0, float(slope @ covariance @ slope))) for slope in np.array(slopes).T
    )
    if abs(duv) > FARTHEST:
        kelvin = kelvin_error = math.nan
    return ColourTemperature(kelvin, kelvin_error, duv, duv_error)


def _nearest(uv: Floats) -> tuple[float, float]:
    """K and Duv: the foot of the perpendicular on the locus, a parabola through three points."""
    reciprocal, locus = _locus()
    squares = ((locus - uv) ** 2).sum(axis=1)
    at = min(max(int(squares.argmin()), 1), len(squares) - 2)
    a, b, c = squares[at - 1 : at + 2]
    shift = 0.5 * float((a - c) / (a - 2.0 * b + c))
    found = float(reciprocal[at]) + shift * float(reciprocal[1] - reciprocal[0])
    place = [float(np.interp(found, reciprocal[at - 1 : at + 2], locus[at - 1 : at + 2, i])) for i in (0, 1)]
    # The locus between knots is curved; the distance to its chord is wrong by less than 1e-7.
    distance = math.hypot(uv[0] - place[0], uv[1] - place[1])
    along = locus[at + 1] - locus[at - 1]
    side = float(along[0] * (uv[1] - place[1]) - along[1] * (uv[0] - place[0]))
    return 1e6 / found, math.copysign(distance, side)
