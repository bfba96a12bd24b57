"""Droplets of many sizes by Mie's theory: cross-sections, phase functions and scattering matrices, for all
sizes at once.

C. F. Bohren and D. R. Huffman, "Absorption and scattering of light by small particles", Wiley 1983, equations
4.46, 4.47, 4.61, 4.62, 4.74, 4.77 and 4.88.

Results are kept in the user's cache folder, named by all that they depend on.
"""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs
from numpy.typing import NDArray

from nocturne_scene.replacing import replacing
from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange

Complexes = NDArray[np.complex128]

# Wavelengths at which spheres are computed: so many from 360 to 830 nm, in equal steps; in other ranges in
# equal parts, as wide as the first of these.
_VISIBLE_COUNT = 21
_PART = 1.0 + (VISIBLE.last - VISIBLE.first) / (_VISIBLE_COUNT - 1) / VISIBLE.first

# Largest circumference of a droplet over the wavelength. Time grows with its square: seconds here.
LARGEST_SIZE = 1000.0

# Sizes of droplets. With twice as many the phase function of fog differs by 0.5 %, 2 % in the glory.
_SIZES = 900

# Sizes that scatter less than this part of the peak's light are left out.
_TAIL = 1e-4

# A knot is added where a straight line misses the phase function by more than this part of it.
_TOLERANCE = 0.01
_FIRST_ANGLES = 360
_MAX_COSINES = 6000

# Part of the name of kept results: raised when the same distribution gives other numbers.
_VERSION = 2


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
    """What a droplet does on average, at n `wavelengths`."""

    cross_section: Floats
    """m2, shape (n,); droplets are clear, so this is extinction too."""
    cosines: Floats
    """Of the scattering angle, increasing from -1 to 1."""
    phase: Floats
    """Per steradian, shape (n, cosines); its integral over all directions is 1."""
    matrix: Floats | None = None
    """S12, S33 and S34 over S11, as Bohren and Huffman define them, shape (3, n, cosines): S1 of light is
    positive in the plane of scattering. S22 is S11, S44 is S33. None where nobody asked."""


class TooLargeError(Exception):
    """The droplets are too large to be computed; the message says which would do."""


def wavelengths(within: WavelengthRange = VISIBLE) -> Floats:
    """Return where spheres are computed, nm; in between, their properties are linear."""
    if within.is_usual:
        return np.linspace(within.first, within.last, _VISIBLE_COUNT)
    count = math.ceil(math.log(within.last / within.first) / math.log(_PART)) + 1
    return np.geomspace(within.first, within.last, count)


def scattering(
    distribution: Distribution,
    index: tuple[float, ...],
    within: WavelengthRange = VISIBLE,
    *,
    polarised: bool = False,
) -> Scattering:
    """Return how droplets scatter whose index of refraction at `wavelengths` is `index`; `polarised`: with
    their matrix.

    Cosines are chosen so that straight lines between them miss the phase function, and what is asked for of
    the matrix, by less than 1 % of the phase function. Raises TooLargeError.
    """
    radii = _radii(distribution, within)
    largest = 2 * math.pi * radii[-1] / (within.first * 1e-9)
    if largest > LARGEST_SIZE:
        limit = LARGEST_SIZE * within.first * 1e-9 / (2 * math.pi)
        raise TooLargeError(
            f"the distribution reaches droplets of {radii[-1] * 1e6:.3g} micrometres; "
            f"expected a radius of at most {limit * 1e6:.3g}"
        )
    return _kept(distribution, index, within, polarised)


@lru_cache(maxsize=32)
def _kept(
    distribution: Distribution, index: tuple[float, ...], within: WavelengthRange, polarised: bool
) -> Scattering:
    place = _place(distribution, index, within, polarised)
    try:
        with np.load(place) as found:
            matrix = found["matrix"] if polarised else None
            return Scattering(found["cross_section"], found["cosines"], found["phase"], matrix)
    except (OSError, ValueError, KeyError, EOFError):
        made = _compute(distribution, index, within, polarised)
    matrix = np.empty(0) if made.matrix is None else made.matrix
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with replacing(place) as unfinished:
            np.savez(
                unfinished,
                cross_section=made.cross_section,
                cosines=made.cosines,
                phase=made.phase,
                matrix=matrix,
            )
    except OSError:
        pass  # nowhere to keep it: computed again next time
    return made


def _place(
    distribution: Distribution, index: tuple[float, ...], within: WavelengthRange, polarised: bool = False
) -> Path:
    # Tables from before scenes had ranges, or matrices, keep their names.
    more = (*(() if within.is_usual else (within,)), *(("matrix",) if polarised else ()))
    content = repr((_VERSION, _SIZES, _TAIL, _TOLERANCE, distribution, index, *more))
    return (
        platformdirs.user_cache_path("nocturne") / f"mie-{hashlib.sha256(content.encode()).hexdigest()}.npz"
    )


def _radii(distribution: Distribution, within: WavelengthRange = VISIBLE) -> Floats:
    """Equal steps of the square root over all sizes that scatter: dense for haze, and where fog has most."""
    wide = distribution.mode_radius * np.geomspace(1e-3, 1e4, 4001)
    # Far below the wavelength scattering falls with the sixth power of the radius.
    efficiency = np.minimum(1.0, (2 * np.pi * wide / (within.first * 1e-9)) ** 4)
    light = distribution.density(wide) * wide**3 * efficiency
    seen = np.flatnonzero(light > _TAIL * light.max())
    return np.linspace(math.sqrt(wide[seen[0]]), math.sqrt(wide[seen[-1]]), _SIZES) ** 2


def _compute(
    distribution: Distribution, index: tuple[float, ...], within: WavelengthRange, polarised: bool
) -> Scattering:
    radii = _radii(distribution, within)
    # The trapezoid rule over the square root of the radius, whose ends count for nothing.
    roots = np.sqrt(radii)
    weights = distribution.density(radii) * 2 * roots * (roots[1] - roots[0])
    series = [
        _Series(n, radii, weights, nm * 1e-9, polarised)
        for n, nm in zip(index, wavelengths(within), strict=True)
    ]
    angles, values = _refined(series)
    cosines = np.cos(angles)[::-1].copy()
    cosines[0], cosines[-1] = -1.0, 1.0
    phase, matrix = values[0][:, ::-1], values[1:, :, ::-1]
    total = np.asarray(2 * np.pi * np.trapezoid(phase, cosines, axis=1))
    return Scattering(
        np.array([one.cross_section for one in series]),
        cosines,
        phase / total[:, None],
        matrix / phase if polarised else None,
    )


def _refined(series: "list[_Series]") -> tuple[Floats, Floats]:
    """Angles between which straight lines over the cosine are good enough, and values there."""
    angles = np.linspace(0, np.pi, _FIRST_ANGLES + 1)
    values = _all(series, angles)
    low = np.arange(len(angles) - 1)
    high = low + 1
    while len(low) and len(angles) + len(low) <= _MAX_COSINES:
        middles = 0.5 * (angles[low] + angles[high])
        between = _all(series, middles)
        ends, at = np.cos(angles), np.cos(middles)
        share = (ends[low] - at) / (ends[low] - ends[high])
        lines = values[..., low] * (1 - share) + values[..., high] * share
        poor = np.any(np.abs(lines - between) > _TOLERANCE * between[0], axis=(0, 1))
        new = len(angles) + np.arange(int(poor.sum()))
        angles = np.concatenate([angles, middles[poor]])
        values = np.concatenate([values, between[..., poor]], axis=-1)
        low, high = np.concatenate([low[poor], new]), np.concatenate([new, high[poor]])
    order = np.argsort(angles)
    return angles[order], values[..., order]


def _all(series: "list[_Series]", angles: Floats) -> Floats:
    """Cosine series at angles, shape (elements, wavelengths, angles)."""
    terms = max(one.cosine_series.shape[1] for one in series)
    padded = np.stack(
        [np.pad(one.cosine_series, ((0, 0), (0, terms - one.cosine_series.shape[1]))) for one in series],
        axis=1,
    )
    rows = padded.reshape(-1, terms)
    values = np.empty((len(rows), len(angles)))
    for at in _chunks(len(angles), 500):
        values[:, at] = rows @ np.cos(np.arange(terms)[:, None] * angles[at])
    return values.reshape(*padded.shape[:2], len(angles))


class _Series:
    """All sizes at one wavelength."""

    def __init__(
        self, index: float, radii: Floats, weights: Floats, wavelength: float, polarised: bool
    ) -> None:
        wave_number = 2 * math.pi / wavelength
        a, b = coefficients(index, wave_number * radii)
        n = np.arange(1, a.shape[1] + 1)
        per_size = (np.abs(a) ** 2 + np.abs(b) ** 2) @ (2 * n + 1)
        self.cross_section = float(2 * math.pi / wave_number**2 * (weights @ per_size))
        scale = (2 * n + 1) / (n * (n + 1))
        self.cosine_series = _cosine_series(scale * a, scale * b, weights, polarised)
        """S11 and, where they are asked for, S12, S33 and S34, all on one scale, a row for each: sum of c_k
        cos(k angle)."""


def coefficients(index: float, sizes: Floats) -> tuple[Complexes, Complexes]:
    """Return a_n and b_n of clear spheres, n from 1, shape (sizes, orders).

    `sizes` are 2 pi radius / wavelength. Zero beyond as many orders as W. J. Wiscombe says ("Improved Mie
    scattering algorithms", Applied Optics 19, 1980). Bohren and Huffman, equation 4.88: downward recurrence
    for the logarithmic derivative and, past the size, the Bessel function's quotient; upward for all else.
    """
    x = np.asarray(sizes, dtype=np.float64)
    counts = np.ceil(x + 4.05 * np.cbrt(x) + 2).astype(int)
    orders = int(counts.max())
    derivative, quotient = np.zeros((2, orders + 1, len(x)))
    d, r = np.zeros(len(x)), np.zeros(len(x))
    inside = index * x
    # Past its size by so much that nothing is left of the zeros that the recurrence starts from.
    first = math.ceil(inside.max() + 10 * np.cbrt(inside.max())) + 16
    # A quotient between two zeros is not used; past the size there are none.
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        for n in range(max(orders, first), 0, -1):
            r = 1.0 / ((2 * n + 1) / x - r)
            if n <= orders:
                derivative[n], quotient[n] = d, r
            d = n / inside - 1.0 / (d + n / inside)
        a, b = np.zeros((2, len(x), orders), dtype=np.complex128)
        psi, psi_before = np.sin(x), np.cos(x)
        chi, chi_before = np.cos(x), -np.sin(x)
        for n in range(1, orders + 1):
            upward = (2 * n - 1) / x * psi - psi_before
            psi, psi_before = np.where(n > x, quotient[n] * psi, upward), psi
            chi, chi_before = (2 * n - 1) / x * chi - chi_before, chi
            there = n <= counts
            for found, factor in ((a, 1.0 / index), (b, index)):
                slope = factor * derivative[n] + n / x
                real, imaginary = slope * psi - psi_before, slope * chi - chi_before
                found[there, n - 1] = (real / (real - 1j * imaginary))[there]
    return a, b


def _cosine_series(a: Complexes, b: Complexes, weights: Floats, polarised: bool) -> Floats:
    """c_k of sum over sizes of weight x (|S1|^2 + |S2|^2); with the matrix, of its other elements, too.

    S1 and S2 are polynomials of the cosine of a degree below the number of orders, so that as many even steps
    of the angle as twice the orders hold everything. From S1 + S2 and S1 - S2, which need half the products.
    Small sizes have few orders, so they are summed in portions. In single precision the forward peak's
    rounding is a part of 1e-4 of the least that goes sideways.
    """
    # Late, as it takes a quarter of a second: most distributions are in the cache.
    from scipy.fft import dct

    orders = a.shape[1]
    angles = np.linspace(0, np.pi, 2 * orders + 1)
    pi, tau = _angular(orders, np.cos(angles))
    pairs = [
        (amplitudes.astype(np.complex64), functions.astype(np.float32))
        for amplitudes, functions in ((a + b, pi + tau), (a - b, pi - tau))
    ]
    totals = np.zeros((4 if polarised else 1, len(angles)))
    for at in _chunks(len(weights), 100):
        used = int(np.flatnonzero(np.any(b[at] != 0, axis=0) | np.any(a[at] != 0, axis=0))[-1]) + 1
        parts = [
            each @ functions[:used]
            for amplitudes, functions in pairs
            for each in (amplitudes[at, :used].real, amplitudes[at, :used].imag)
        ]
        squares = [weights[at] @ np.square(each, dtype=np.float64) for each in parts]
        for square in squares:
            totals[0] += 0.5 * square
        if polarised:
            totals[1:] += _other_elements(weights[at], parts, squares)
    series = np.asarray(dct(totals, type=1) / (len(angles) - 1), dtype=np.float64)
    series[:, [0, -1]] *= 0.5
    return series


def _other_elements(weights: Floats, parts: list[NDArray[Any]], squares: list[Floats]) -> Floats:
    """S12, S33 and S34 by real and imaginary parts of P = S1 + S2 and of M = S1 - S2, times two.

    |S2|^2 - |S1|^2 = -Re P M*, Re S1 S2* = (|P|^2 - |M|^2) / 4, Im S2 S1* = Im P M* / 2.
    """
    p_real, p_imag, m_real, m_imag = parts

    def product(one: NDArray[Any], other: NDArray[Any]) -> Floats:
        return np.asarray(weights @ np.multiply(one, other, dtype=np.float64), dtype=np.float64)

    p_real_squared, p_imag_squared, m_real_squared, m_imag_squared = squares
    return np.stack(
        [
            -product(p_real, m_real) - product(p_imag, m_imag),
            0.5 * (p_real_squared + p_imag_squared - m_real_squared - m_imag_squared),
            product(p_imag, m_real) - product(p_real, m_imag),
        ]
    )


def _chunks(count: int, step: int) -> Iterator[slice]:
    return (slice(start, start + step) for start in range(0, count, step))


def _angular(orders: int, cosines: Floats) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """pi_n and tau_n, shape (orders, cosines), by upward recurrence."""
    pi, tau = np.empty((orders, len(cosines))), np.empty((orders, len(cosines)))
    before, current = np.zeros(len(cosines)), np.ones(len(cosines))
    for n in range(1, orders + 1):
        pi[n - 1] = current
        tau[n - 1] = n * cosines * current - (n + 1) * before
        before, current = current, ((2 * n + 1) * cosines * current - (n + 1) * before) / n
    return pi, tau
