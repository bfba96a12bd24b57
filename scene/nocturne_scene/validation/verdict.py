"""What the readings of suites say together: how z is distributed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist, fmean, stdev

from nocturne_scene.validation.cases import Value

FALSE_ALARM = 0.01
"""How often the largest |z| or another figure fails by chance alone."""

ROUNDING = 2e-5
"""Of a truth: what single precision and polygons for circles may take. A reading without noise, such as of an
even light that fills the film, has no z; it is right within this."""


@dataclass(frozen=True)
class Reading:
    """A value as it was read."""

    suite: str
    value: Value
    found: float
    error: float
    """Standard error; 0 where nothing varies."""
    half_interval: float
    """Half of the 95 % interval."""

    @property
    def z(self) -> float | None:
        """Deviation in standard errors; None where there is no noise to speak of."""
        if self.error <= ROUNDING * abs(self.value.truth):
            return None
        return (self.found - self.value.truth) / self.error

    @property
    def is_exact(self) -> bool:
        """Whether a reading without noise is right to rounding."""
        return abs(self.found - self.value.truth) <= 2.0 * ROUNDING * abs(self.value.truth) + 4.0 * self.error


@dataclass(frozen=True)
class Verdict:
    """Of many readings."""

    values: int
    exact: int
    """Without noise, right to rounding."""
    wrong: int
    """Without noise, and wrong."""
    mean: float
    """Of z; NaN where there is none."""
    deviation: float
    """Standard deviation of z."""
    inside: float
    """Part of the 95 % intervals that hold the truth."""
    largest: float
    bound: float
    """That the largest |z| exceeds by chance with probability FALSE_ALARM (Sidak)."""
    mean_bound: float
    deviation_bound: float
    """Of |deviation - 1|."""

    @property
    def is_good(self) -> bool:
        """Whether chance explains every deviation."""
        return (
            not self.wrong
            and not self.largest > self.bound
            and not abs(self.mean) > self.mean_bound
            and not self.deviation - 1.0 > self.deviation_bound
        )


def verdict(readings: Sequence[Reading]) -> Verdict:
    """Of all readings of a suite, or of all suites."""
    z = [each.z for each in readings if each.z is not None]
    silent = [each for each in readings if each.z is None]
    held = [
        abs(each.found - each.value.truth) <= each.half_interval for each in readings if each.z is not None
    ]
    quantile = -NormalDist().inv_cdf(FALSE_ALARM / 2.0)
    count = max(1, len(z))
    sidak = -NormalDist().inv_cdf((1.0 - (1.0 - FALSE_ALARM) ** (1.0 / count)) / 2.0)
    return Verdict(
        len(readings),
        sum(each.is_exact for each in silent),
        sum(not each.is_exact for each in silent),
        fmean(z) if z else math.nan,
        stdev(z) if len(z) > 1 else math.nan,
        fmean(held) if held else math.nan,
        max(map(abs, z), default=math.nan),
        sidak,
        quantile / math.sqrt(count),
        quantile / math.sqrt(2.0 * count),
    )
