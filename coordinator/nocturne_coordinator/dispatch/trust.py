"""Whether an estimated error may end a render or a tile, and why not. Pure.

An error is estimated from the same samples as the image: where few of them carry much of the light, both come
out too low until more have come. So an estimate ends nothing by itself. It counts only with enough samples,
enough pixels that carry it, and neighbours that agree; the error of the mean must be as low; and two range
ends in a row must say so, with an error that falls between them as errors do.
"""

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.heavy_tails import HEAVY

MIN_SAMPLES = 32
"""Of each pixel. Cochran, "Sampling Techniques" (third edition, 1977), section 2.15: intervals of a mean are
good from 25 times the squared skewness on, here for a skewness of 1; 32 is the end of a range."""

MIN_EFFECTIVE_SAMPLE_SIZE = 100.0
"""Fewer pixels than these know the error to 10 % or worse: its square is a mean over them, each known about
to itself, and its root is known to half of that, twice for two standard deviations."""

_MIN_PART = 0.25
"""Of all pixels: a small film has no more than these. It needs as many samples in all as that many pixels
with the fewest samples have."""

CONFIDENCE = 1.96
"""Standard errors to each side of a 95 % interval."""

_SLOWEST_FALL = 0.35
"""Power of the samples by which an error must fall at least; that of independent samples is 0.5. Where it
falls more slowly, brighter samples are still met for the first time."""

_A_LITTLE_LESS = 0.9
"""Samples of those that a forecast needs: an error that is met a range earlier makes the one after it
useless."""


def min_samples(pixels: int) -> int:
    """Samples of each pixel before an estimate is trusted: more where there are few pixels."""
    return math.ceil(MIN_SAMPLES * max(1.0, MIN_EFFECTIVE_SAMPLE_SIZE / pixels))


def error_warning_of(estimate: ErrorEstimate) -> str:
    """Why an estimate is not to be trusted, a sentence; empty: it is, as far as one image can tell."""
    if estimate.samples < 2:
        return ""
    if estimate.mean <= 0.0:
        return "No light was found yet."
    if estimate.relative_error <= 0.0:
        return ""
    needed = min_samples(estimate.pixels)
    if estimate.samples < needed:
        return f"{estimate.samples} samples per pixel are too few, {needed} are needed."
    if estimate.effective_pixels < min(MIN_EFFECTIVE_SAMPLE_SIZE, _MIN_PART * estimate.pixels):
        carry = estimate.effective_pixels
        return f"About {carry:.2g} of {estimate.pixels:,} pixels carry the error."
    if estimate.unevenness > HEAVY:
        return "Few bright samples carry the light: neighbouring pixels disagree on how noisy they are."
    return ""


@dataclass(frozen=True, slots=True)
class RangeEnd:
    """Estimates from when every pixel had so many samples."""

    samples: int = 0
    error: float = 0.0
    """What a stop goes by; 0: unknown, or not to be trusted."""
    mean_samples: float = 0.0
    """When that was estimated: other pixels may have been ahead. 0: all had the same."""

    @classmethod
    def of(cls, estimate: ErrorEstimate) -> Self:
        """The larger of the relative error and the 95 % interval of the mean, relative to it."""
        if error_warning_of(estimate) or estimate.relative_error <= 0.0:
            return cls(estimate.samples)
        mean_error = CONFIDENCE * estimate.mean_error / estimate.mean
        return cls(estimate.samples, max(estimate.relative_error, mean_error), estimate.mean_samples)

    def meets(self, asked: float) -> bool:
        """Whether the error is known and low enough; unknown, as in a tile that is black so far, it never
        is."""
        return asked > 0.0 and 0.0 < self.error <= asked


def confirmed(before: RangeEnd, now: RangeEnd, asked: float) -> bool:
    """Whether two range ends in a row both have the error that was asked for, and it fell between them."""
    return before.meets(asked) and now.meets(asked) and falls(before, now)


def falls(before: RangeEnd, now: RangeEnd) -> bool:
    """Whether an error that is known twice falls with the samples as it should."""
    if not (before.error and now.error and now.samples > before.samples):
        return False
    more = (now.mean_samples or now.samples) / (before.mean_samples or before.samples)
    allowed: float = before.error * more**-_SLOWEST_FALL
    return now.error <= allowed


def samples_to_stop(
    estimate: ErrorEstimate, samples: float, asked: float, range_ends: Sequence[int]
) -> float:
    """Samples at which a stop by error is expected: the range end after the first that has the error.

    It falls as one over the root of the samples. Infinite: unknown, or beyond the last.
    """
    if estimate.relative_error <= 0.0:
        return math.inf
    now = RangeEnd.of(estimate)
    error = now.error or estimate.relative_error
    # A film that does not have it now has it at the next range end at best.
    at_best = samples if now.meets(asked) else math.nextafter(samples, math.inf)
    needed = max(min_samples(estimate.pixels), _A_LITTLE_LESS * samples * (error / asked) ** 2, at_best)
    first = bisect_left(range_ends, needed)
    return range_ends[first + 1] if first + 1 < len(range_ends) else math.inf
