"""How the light of a region is polarised: degree and angle of linear polarisation, with 95 % intervals.

Noise of S1 and S2 makes sqrt(S1² + S2²) too large. The degree given here is without that from two standard
errors on, and less of it below (the modified asymptotic estimator of S. Plaszczynski et al., "A novel
estimator of the polarization amplitude from normally distributed Stokes parameters", MNRAS 439, 2014). Its
interval holds the degrees by which chance explains the reading (J. F. L. Simmons and B. G. Stewart, "Point
and interval estimation of the true unbiased degree of linear polarization", Astronomy and Astrophysics 142,
1985), with the larger of the errors across and along.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nocturne_scene.responses import POLARISERS, STOKES, stokes_channel
from nocturne_scene.tile_sums import Values
from nocturne_scene.uncertainty import CONFIDENCE, RegionReading

_TAIL = 0.025
_AS_NORMAL = 400.0
"""Of a square of the degree over its error: the distribution is as good as normal."""


@dataclass(frozen=True, slots=True)
class LinearPolarisation:
    """Of a region's mean light; NaN where errors are not known."""

    degree: float
    """In [0, 1]."""
    degree_interval: tuple[float, float]
    angle_degrees: float
    """From the sensor's right towards up, in [0, 180)."""
    angle_error: float
    """95 %, to each side; 90 where nothing is known of it."""


def polarisation_of(
    reading: RegionReading, names: Sequence[str], channel: str = "Y"
) -> LinearPolarisation | None:
    """None in the dark, and where the image does not tell; `names` are those of the reading's values."""
    wanted = [channel, *(stokes_channel(layer, channel) for layer in STOKES[:2])]
    if not set(wanted) <= set(names):
        return None
    places = [list(names).index(name) for name in wanted]
    whole, *both = (reading.mean[place] for place in places)
    if not whole > 0.0:
        return None
    linear = np.array(both) / whole
    correlation = _correlation(reading, names, channel, places)
    angle = 0.5 * math.degrees(math.atan2(linear[1], linear[0])) % 180.0
    found = float(np.hypot(*linear))
    errors = np.array(reading.error)[places]
    covariance = None if correlation is None else _of_ratio(correlation, errors, linear, whole)
    if covariance is None or not np.isfinite(covariance).all():
        return LinearPolarisation(found, (math.nan, math.nan), angle, math.nan)
    towards = linear / found if found > 0.0 else np.array([1.0, 0.0])
    across = np.array([-towards[1], towards[0]])
    aside = float(across @ covariance @ across)
    interval = _interval(found, float(np.linalg.eigvalsh(covariance)[-1]))
    error = 90.0
    if interval[0] > 0.0:
        error = min(90.0, math.degrees(CONFIDENCE * math.sqrt(max(0.0, aside)) / (2.0 * found)))
    return LinearPolarisation(min(1.0, _without_bias(found, aside)), interval, angle, error)


def _correlation(
    reading: RegionReading, names: Sequence[str], channel: str, places: list[int]
) -> Values | None:
    """Of the errors of S0, S1 and S2. Known in any pixel where the image tells the light behind polarisers:
    of half of S0 + c S1 + s S2 the variance has that of each, and their covariances. Else as in its tile."""
    behind = {stokes_channel(layer, channel): degrees for layer, degrees in POLARISERS.items()}
    if set(behind) <= set(names) and reading.own_variance:
        own = np.array(reading.own_variance)
        terms, seen = [], []
        for name, degrees in behind.items():
            cosine, sine = math.cos(math.radians(2.0 * degrees)), math.sin(math.radians(2.0 * degrees))
            squares = own[places] @ np.array([1.0, cosine**2, sine**2])
            terms.append([2.0 * cosine, 2.0 * sine, 2.0 * cosine * sine])
            seen.append(4.0 * own[list(names).index(name)] - squares)
        first, second = [0, 0, 1], [1, 2, 2]
        both = np.sqrt(own[places][first] * own[places][second])
        pairs = np.linalg.solve(np.array(terms), np.array(seen))
        pairs = np.clip(np.divide(pairs, both, out=np.zeros(3), where=both > 0.0), -1.0, 1.0)
        found = np.eye(3)
        found[first, second] = found[second, first] = pairs
        return found
    return None if reading.correlations is None else reading.correlations[np.ix_(places, places)]


def _of_ratio(correlation: Values, error: Values, linear: Values, whole: float) -> Values:
    """Covariance of S1 / S0 and S2 / S0, to first order."""
    covariance = correlation * error[:, None] * error[None, :]
    slopes = np.array([[-linear[0], 1.0, 0.0], [-linear[1], 0.0, 1.0]]) / whole
    return np.asarray(slopes @ covariance @ slopes.T)


def _without_bias(found: float, variance: float) -> float:
    if not found > 0.0 or not variance > 0.0:
        return found
    return found - variance * -math.expm1(-(found**2) / variance) / (2.0 * found)


def _interval(found: float, variance: float) -> tuple[float, float]:
    """The square of a degree over its variance is distributed as chi-square of two degrees of freedom, not
    central."""
    from scipy import optimize, stats

    if not variance > 0.0:
        return found, found
    square, error = found**2 / variance, math.sqrt(variance)
    if square > _AS_NORMAL:
        return max(0.0, found - CONFIDENCE * error), min(1.0, found + CONFIDENCE * error)

    def ends(probability: float) -> float:
        """The largest degree, in errors, at which a smaller reading is at least as probable."""

        def excess(true: float) -> float:
            return float(stats.ncx2.cdf(square, 2, true**2)) - probability

        if excess(1e-9) <= 0.0:
            return 0.0
        return float(optimize.brentq(excess, 1e-9, math.sqrt(square) + 10.0))

    low, high = ends(1.0 - _TAIL), ends(_TAIL)
    return low * error, min(1.0, high * error)
