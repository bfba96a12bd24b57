"""Droplets of many sizes by Mie's theory: cross-sections and phase functions. The only user of miepython.

miepython gives the series' coefficients a_n, b_n of each size; their sum over angles is done here for all
sizes at once (C. F. Bohren and D. R. Huffman, "Absorption and scattering of light by small particles", Wiley
1983, equations 4.46, 4.47, 4.61, 4.62 and 4.74).

The first time takes seconds; what was computed is kept in the user's cache folder, named by all that it
depends on.
"""

import hashlib
import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import miepython
import numpy as np
import platformdirs
from numpy.typing import NDArray

from nocturne_coordinator.scene import bounds
from nocturne_coordinator.scene.published import FIRST, LAST, Floats

# nm, 360 to 830.
WAVELENGTHS = np.linspace(FIRST, LAST, 21)

# Sizes of droplets. With twice as many the phase function of fog differs by 0.5 %, 2 % in the glory.
_SIZES = 900

# Sizes that scatter less than this part of the peak's light are left out.
_TAIL = 1e-4

# A knot is added where a straight line misses the phase function by more than this part of it.
_TOLERANCE = 0.01
_FIRST_ANGLES = 360
_MOST_COSINES = 6000

# Part of the name of what is kept: raised when the same distribution gives other numbers.
_VERSION = 1


@dataclass(frozen=True)
class Distribution:
    """Modified gamma: n(r) in proportion to r^alpha exp(-(alpha / gamma) (r / mode)^gamma), mode in m."""

    mode_radius: float
    alpha: float
    gamma: float

    def density(self, radii: Floats) -> Floats:
        """Return the probability density of radii in m, 1/m."""
        b = self.alpha / self.gamma
        order = (self.alpha + 1) / self.gamma
        log_scale = math.log(self.gamma) + order * math.log(b) - math.lgamma(order)
        x = np.asarray(radii, dtype=np.float64) / self.mode_radius
        with np.errstate(divide="ignore"):
            log = log_scale + self.alpha * np.log(x) - b * x**self.gamma
        return np.asarray(np.exp(log) / self.mode_radius, dtype=np.float64)


@dataclass(frozen=True)
class Scattering:
    """What a droplet does on average, at WAVELENGTHS."""

    cross_section: Floats
    """m2, shape (21,); droplets are clear, so this is extinction too."""
    cosines: Floats
    """Of the scattering angle, increasing from -1 to 1."""
    phase: Floats
    """Per steradian, shape (21, cosines); its integral over all directions is 1."""


class TooLargeError(Exception):
    """The droplets are too large to be computed; the message says which would do."""


def scattering(distribution: Distribution, index: tuple[float, ...]) -> Scattering:
    """Return how droplets scatter whose index of refraction at WAVELENGTHS is `index`.

    Cosines are chosen so that straight lines between them miss the phase function by less than 1 %. Raises
    TooLargeError.
    """
    radii = _radii(distribution)
    largest = 2 * math.pi * radii[-1] / (FIRST * 1e-9)
    if largest > bounds.DROPLET_SIZE:
        limit = bounds.DROPLET_SIZE * FIRST * 1e-9 / (2 * math.pi)
        raise TooLargeError(
            f"the distribution reaches droplets of {radii[-1] * 1e6:.3g} micrometres; "
            f"expected a radius of at most {limit * 1e6:.3g}"
        )
    return _kept(distribution, index)


@lru_cache(maxsize=32)
def _kept(distribution: Distribution, index: tuple[float, ...]) -> Scattering:
    place = _place(distribution, index)
    try:
        with np.load(place) as found:
            return Scattering(found["cross_section"], found["cosines"], found["phase"])
    except (OSError, ValueError, KeyError, EOFError):
        made = _compute(distribution, index)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        unfinished = place.with_suffix(f".{os.getpid()}.npz")
        np.savez(unfinished, cross_section=made.cross_section, cosines=made.cosines, phase=made.phase)
        unfinished.replace(place)
    except OSError:
        pass  # nowhere to keep it: computed again next time
    return made


def _place(distribution: Distribution, index: tuple[float, ...]) -> Path:
    content = repr((_VERSION, miepython.__version__, _SIZES, _TAIL, _TOLERANCE, distribution, index))
    return (
        platformdirs.user_cache_path("nocturne") / f"mie-{hashlib.sha256(content.encode()).hexdigest()}.npz"
    )


def _radii(distribution: Distribution) -> Floats:
    """Equal steps of the square root over all sizes that scatter: dense for haze, and where fog has most."""
    wide = distribution.mode_radius * np.geomspace(1e-3, 1e4, 4001)
    # Far below the wavelength scattering falls with the sixth power of the radius.
    efficiency = np.minimum(1.0, (2 * np.pi * wide / (FIRST * 1e-9)) ** 4)
    light = distribution.density(wide) * wide**3 * efficiency
    seen = np.flatnonzero(light > _TAIL * light.max())
    return np.linspace(math.sqrt(wide[seen[0]]), math.sqrt(wide[seen[-1]]), _SIZES) ** 2


def _compute(distribution: Distribution, index: tuple[float, ...]) -> Scattering:
    radii = _radii(distribution)
    # The trapezoid rule over the square root of the radius, whose ends count for nothing.
    roots = np.sqrt(radii)
    weights = distribution.density(radii) * 2 * roots * (roots[1] - roots[0])
    series = [_Series(n, radii, weights, nm * 1e-9) for n, nm in zip(index, WAVELENGTHS, strict=True)]
    angles, values = _refined(series)
    cosines = np.cos(angles)[::-1].copy()
    cosines[0], cosines[-1] = -1.0, 1.0
    phase = values[:, ::-1]
    total = np.asarray(2 * np.pi * np.trapezoid(phase, cosines, axis=1))
    return Scattering(np.array([one.cross_section for one in series]), cosines, phase / total[:, None])


def _refined(series: "list[_Series]") -> tuple[Floats, Floats]:
    """Angles between which straight lines over the cosine are good enough, and values there."""
    angles = np.linspace(0, np.pi, _FIRST_ANGLES + 1)
    values = _all(series, angles)
    low = np.arange(len(angles) - 1)
    high = low + 1
    while len(low) and len(angles) + len(low) <= _MOST_COSINES:
        middles = 0.5 * (angles[low] + angles[high])
        between = _all(series, middles)
        ends, at = np.cos(angles), np.cos(middles)
        share = (ends[low] - at) / (ends[low] - ends[high])
        lines = values[:, low] * (1 - share) + values[:, high] * share
        poor = np.any(np.abs(lines - between) > _TOLERANCE * between, axis=0)
        new = len(angles) + np.arange(int(poor.sum()))
        angles = np.concatenate([angles, middles[poor]])
        values = np.concatenate([values, between[:, poor]], axis=1)
        low, high = np.concatenate([low[poor], new]), np.concatenate([new, high[poor]])
    order = np.argsort(angles)
    return angles[order], values[:, order]


def _all(series: "list[_Series]", angles: Floats) -> Floats:
    return np.stack([one.intensity(np.cos(angles)) for one in series])


class _Series:
    """The series of all sizes at one wavelength."""

    def __init__(self, index: float, radii: Floats, weights: Floats, wavelength: float) -> None:
        wave_number = 2 * math.pi / wavelength
        found = [miepython.coefficients(complex(index), wave_number * radius) for radius in radii]
        orders = max(len(a) for a, _ in found)
        self._a, self._b = (
            np.array([np.pad(pair[which], (0, orders - len(pair[which]))) for pair in found])
            for which in (0, 1)
        )
        n = np.arange(1, orders + 1)
        per_size = np.sum((2 * n + 1) * (np.abs(self._a) ** 2 + np.abs(self._b) ** 2), axis=1)
        self.cross_section = float(2 * math.pi / wave_number**2 * (weights @ per_size))
        self._scale = (2 * n + 1) / (n * (n + 1))
        self._weights = weights

    def intensity(self, cosines: Floats) -> Floats:
        """Return what goes into directions, for unpolarised light, on any scale."""
        total = np.zeros(len(cosines))
        for at in _chunks(len(cosines)):
            pi, tau = _angular(len(self._scale), cosines[at])
            a, b = self._a * self._scale, self._b * self._scale
            first, second = a @ pi + b @ tau, a @ tau + b @ pi
            total[at] = self._weights @ (np.abs(first) ** 2 + np.abs(second) ** 2)
        return total


def _chunks(count: int) -> Iterator[slice]:
    return (slice(start, start + 500) for start in range(0, count, 500))


def _angular(orders: int, cosines: Floats) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """pi_n and tau_n, shape (orders, cosines), by upward recurrence."""
    pi, tau = np.empty((orders, len(cosines))), np.empty((orders, len(cosines)))
    before, current = np.zeros(len(cosines)), np.ones(len(cosines))
    for n in range(1, orders + 1):
        pi[n - 1] = current
        tau[n - 1] = n * cosines * current - (n + 1) * before
        before, current = current, ((2 * n + 1) * cosines * current - (n + 1) * before) / n
    return pi, tau
