"""When an estimated error is to be trusted, and when two range ends agree on it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate, estimate_error
from nocturne_coordinator.dispatch.heavy_tails import HEAVY
from nocturne_coordinator.dispatch.trust import (
    MIN_EFFECTIVE_SAMPLE_SIZE,
    MIN_SAMPLES,
    RangeEnd,
    confirmed,
    error_warning_of,
    min_samples,
)

GOOD = ErrorEstimate(
    relative_error=0.02,
    mean=10.0,
    mean_error=0.01,
    top_percent_share=0.03,
    effective_pixels=9000.0,
    unevenness=0.2,
    pixels=10_000,
    zero_pixels=0,
    samples=64,
)


def test_a_good_estimate_is_trusted() -> None:
    assert error_warning_of(GOOD) == ""
    assert RangeEnd.of(GOOD) == RangeEnd(64, 0.02)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"samples": MIN_SAMPLES - 1}, "31 samples per pixel are too few"),
        (
            {"effective_pixels": MIN_EFFECTIVE_SAMPLE_SIZE - 1},
            "About 99 of 10,000 pixels carry the error",
        ),
        ({"unevenness": HEAVY + 0.01}, "Few bright samples carry the light"),
        ({"mean": 0.0}, "No light was found"),
    ],
)
def test_each_reason_for_doubt_alone_keeps_a_render_going(change: dict[str, Any], told: str) -> None:
    doubtful = replace(GOOD, **change)
    assert told in error_warning_of(doubtful)
    assert RangeEnd.of(doubtful).error == 0.0


def test_the_mean_is_bounded_too() -> None:
    """By its 95 % interval: lamps and lit surfaces may each be known well, and the mean of all badly."""
    assert RangeEnd.of(replace(GOOD, mean_error=1.0)).error == pytest.approx(0.196)


def test_small_films_need_as_many_samples_in_all() -> None:
    assert min_samples(10_000) == MIN_SAMPLES
    assert min_samples(1) == MIN_SAMPLES * MIN_EFFECTIVE_SAMPLE_SIZE
    one = replace(GOOD, pixels=1, effective_pixels=1.0, unevenness=0.0, samples=3199)
    assert "3200 are needed" in error_warning_of(one)
    assert error_warning_of(replace(one, samples=3200)) == ""


def test_two_range_ends_in_a_row_must_agree() -> None:
    before, now = RangeEnd(64, 0.04), RangeEnd(128, 0.03)
    assert confirmed(before, now, 0.05)
    assert not confirmed(before, now, 0.035)
    assert not confirmed(RangeEnd(64, 0.0), now, 0.05)
    assert not confirmed(before, RangeEnd(128, 0.0), 0.05)
    assert not confirmed(RangeEnd(), now, 0.05)
    # An error that does not fall is not that of the samples so far.
    assert not confirmed(before, RangeEnd(128, 0.039), 0.05)
    # Most pixels had as many samples as later when the first was estimated.
    assert confirmed(RangeEnd(64, 0.04, 122.0), RangeEnd(128, 0.039, 128.0), 0.05)
    assert not confirmed(RangeEnd(64, 0.04, 70.0), RangeEnd(128, 0.039, 128.0), 0.05)


def test_the_image_of_a_prism_is_not_taken_for_done() -> None:
    """91 of 9,216 pixels have met light, in one sample of 48 each: what each knows is that it knows
    nothing, and all together said 2.3 %."""
    random = np.random.default_rng(3)
    sums = np.zeros((96, 96, 4))
    lit = random.choice(96 * 96, 91, replace=False)
    y = sums.reshape(-1, 4)
    y[lit, :3] = random.lognormal(3.0, 2.0, (91, 1))
    y[lit, 3] = y[lit, 1] ** 2
    estimate = estimate_error(sums, np.full((96, 96), 48, dtype=np.uint32))
    assert 0.0 < estimate.relative_error < 0.11
    assert estimate.zero_pixels == 9216 - 91
    assert error_warning_of(estimate)
    assert RangeEnd.of(estimate).error == 0.0
