"""Do methods agree, and do the errors that images state hold?

Student's t of means over seeds (Welch), for the whole image and its quarters, for X, Y, Z and each further
response. Light that a method meets seldom makes the scatter of few seeds too small, so a difference is a
fault only if neither this scatter nor the stated errors explain it, with new seeds and more samples each time
it is tested again, and if it does not shrink then.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy import stats

from tests.accuracy.agreement import ROUNDING
from tests.crossings.methods import Readings, Values

ALPHA = 0.01
"""False alarms, of all scenes of a run together."""


@dataclass(frozen=True)
class Difference:
    """Where two methods differ most."""

    one: str
    other: str
    probability: float
    """By the scatter of seeds, of all regions and channels that were compared (Bonferroni)."""
    stated: float
    """The same by the errors that images state."""
    what: str
    """Channel and region."""
    ratio: float
    """Of the other's mean to the one's."""

    @property
    def off(self) -> float:
        """Part of the larger mean."""
        return 1.0 - 1.0 / self.ratio if self.ratio > 1.0 else self.ratio - 1.0

    @property
    def surely(self) -> float:
        """Probability that neither explains."""
        return max(self.probability, self.stated)

    def __str__(self) -> str:
        return (
            f"{self.other} / {self.one} = {self.ratio:.4g} in {self.what}; "
            f"probability {self.probability:.2g} by seeds, {self.stated:.2g} by stated errors"
        )


_TINY = 1e-300
"""Variance of values that have none."""
_QUARTERS = 4
_REGIONS = ("the image", "its first quarter", "its second quarter", "its third quarter", "its last quarter")


def differences(found: Mapping[str, Readings]) -> list[Difference]:
    """Of all pairs of methods."""
    return [_difference(one, other, found[one], found[other]) for one, other in combinations(found, 2)]


def _difference(name: str, other_name: str, one: Readings, other: Readings) -> Difference:
    mean, other_mean = one.means.mean(axis=0), other.means.mean(axis=0)
    rounding = (ROUNDING * np.maximum(np.abs(mean), np.abs(other_mean))) ** 2
    by_seeds = _p(other_mean - mean, _of_seeds(one), _of_seeds(other), rounding, len(one.means) - 1)
    by_stated = _p(other_mean - mean, _of_stated(one), _of_stated(other), rounding, None)
    at = np.unravel_index(np.argmin(np.maximum(by_seeds, by_stated)), by_seeds.shape)
    count = by_seeds.size
    ratio = float(other_mean[at] / mean[at]) if mean[at] else 1.0 if not other_mean[at] else float("inf")
    return Difference(
        name,
        other_name,
        min(1.0, count * float(by_seeds[at])),
        min(1.0, count * float(by_stated[at])),
        f"{one.names[at[1]]} of {_REGIONS[at[0]]}",
        ratio,
    )


def _of_seeds(one: Readings) -> Values:
    """Variance of the mean over seeds."""
    return _at_least(one, np.asarray(one.means.var(axis=0, ddof=1) / len(one.means)))


def _of_stated(one: Readings) -> Values:
    return _at_least(one, np.asarray((one.errors**2).mean(axis=0) / len(one.errors)))


def _at_least(one: Readings, variance: Values) -> Values:
    """Where a method met nothing by any seed, that says nothing of how much it may miss: a quarter then has
    the variance of a quarter that is as the whole image."""
    nothing = ~one.means.any(axis=0)
    return np.where(nothing, np.maximum(variance, _QUARTERS * variance[:1]), variance)


def _p(off: Values, one: Values, other: Values, rounding: Values, degrees: int | None) -> Values:
    """Two-sided probabilities; 1 where nothing differs, as where both are black."""
    variance = one + other + rounding
    z = np.divide(np.abs(off), np.sqrt(variance), out=np.zeros_like(off), where=variance > 0.0)
    if degrees is None:
        return np.asarray(2.0 * stats.norm.sf(z))
    # Welch and Satterthwaite.
    below = (one**2 + other**2) / degrees
    freedom = np.divide((one + other) ** 2, below, out=np.full_like(off, degrees), where=below > 0.0)
    return np.asarray(2.0 * stats.t.sf(z, freedom))


def leans(found: Mapping[str, Readings]) -> dict[str, float]:
    """How much more of the image's mean Y each method brings than the first one, in standard errors: the
    normal score of Welch's t. A fault too small for a scene adds up over many; light that the first one
    meets seldom, of which it mostly has too little, has the opposite sign."""
    (_, plain), *others = found.items()
    scores = {}
    for other_name, other in others:
        off = other.means[:, 0, 1].mean() - plain.means[:, 0, 1].mean()
        p = _p(np.array([off]), _of_whole(plain), _of_whole(other), np.zeros(1), len(plain.means) - 1)[0]
        scores[other_name] = float(np.sign(off) * stats.norm.isf(max(float(p), _TINY) / 2.0))
    return scores


def _of_whole(one: Readings) -> Values:
    return _of_seeds(one)[:1, 1]


def agree(found: Mapping[str, Readings]) -> float:
    """The least probability of all pairs by seeds alone, for all pairs together."""
    pairs = differences(found)
    return min((min(1.0, len(pairs) * each.probability) for each in pairs), default=1.0)


def holm(probabilities: Sequence[float], alpha: float = ALPHA) -> list[bool]:
    """Which are too small, with false alarms of alpha for all together (Holm 1979)."""
    order = np.argsort(probabilities)
    found = [False] * len(probabilities)
    for place, index in enumerate(order):
        if probabilities[index] >= alpha / (len(probabilities) - place):
            break
        found[index] = True
    return found


def held(found: Mapping[str, Readings]) -> tuple[int, int]:
    """How many of the 95 % intervals of Y that images state hold the truth, and how many there are.

    The truth is the mean of all other images: those of other methods weigh as precisely as these know it.
    """
    inside = count = 0
    for name, one in found.items():
        truth, variance = _others(found, name)
        mean = one.means[..., 1]
        width = one.factors * np.sqrt(one.errors[..., 1] ** 2 + variance) + ROUNDING * truth
        # Where nothing is seen, nothing is stated.
        seen = (mean > 0.0) | (truth > 0.0)
        inside += int(np.count_nonzero((np.abs(mean - truth) <= width) & seen))
        count += int(np.count_nonzero(seen))
    return inside, count


def _others(found: Mapping[str, Readings], name: str) -> tuple[Values, Values]:
    """Mean of Y over all images but each one of a method, and its variance; shape (seeds, regions)."""
    weights, sums = 0.0, 0.0
    for other_name, other in found.items():
        y, n = other.means[..., 1], len(other.means)
        variance = np.maximum(y.var(axis=0, ddof=1), (other.errors[..., 1] ** 2).mean(axis=0))
        # An image is not its own truth.
        mean = (y.sum(axis=0) - y) / (n - 1) if other_name == name else y.mean(axis=0)
        weight = (n - 1 if other_name == name else n) / np.maximum(variance, _TINY)
        weights, sums = weights + weight, sums + weight * mean
    return np.asarray(sums / weights), np.asarray(1.0 / weights)
