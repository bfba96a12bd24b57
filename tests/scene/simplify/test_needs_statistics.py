"""Intervals of bias against synthetic renders whose truth is known.

Seeds are fixed. Bounds on counts are those that a right method passes with at least 999 of 1000 seeds, by the
binomial distribution.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from nocturne_scene.simplify.statistics import (
    FEW,
    FEWEST,
    bias,
    effective_pixels,
    noise,
    ratio_of_costs,
    resolvable,
)
from numpy.typing import ArrayLike, NDArray

Values = NDArray[np.float64]

RENDERS, PIXELS, TRIALS = 8, 256, 200


def _truth() -> Values:
    return np.random.default_rng(7).uniform(0.2, 2.0, PIXELS)


def _nothing(full: Values) -> Values:
    return np.zeros_like(full)


def _everywhere(full: Values) -> Values:
    return 0.05 * full


def _spot(full: Values) -> Values:
    return np.where(np.arange(PIXELS) < 8, 0.5 * full, 0.0)


def _shifted(full: Values) -> Values:
    """Nothing in the mean: brighter here, darker there."""
    change = np.where(np.arange(PIXELS) % 2, 0.05, -0.05) * full
    shifted: Values = change - change.mean()
    return shifted


def _pairs(full: Values, simple: Values, common: float, random: np.random.Generator) -> tuple[Values, Values]:
    """Renders of skew noise (gamma, relative spread 0.1), the noise of both correlated by `common`."""
    own = [random.gamma(100, 0.01, (RENDERS, PIXELS)) - 1 for _ in range(2)]
    other = common * own[0] + np.sqrt(1 - common**2) * own[1]
    return full * (1 + own[0]), simple + full * other


def _binomial(parts: ArrayLike, trials: int, probability: float) -> Any:
    """Quantiles of the number of successes."""
    # Late: it takes two seconds, in each process that only collects this file.
    from scipy import stats

    return stats.binom.ppf(parts, trials, probability)


@pytest.mark.parametrize("common", [0.0, 0.9])
@pytest.mark.parametrize("change", [_nothing, _everywhere, _spot, _shifted])
def test_intervals_hold_the_truth(change: Callable[[Values], Values], common: float) -> None:
    """The interval of the mean holds as often as it says. That of the local bias holds at least so often,
    above all at its upper end, which decides the parts that may be left out."""
    random = np.random.default_rng(11)
    full = _truth()
    simple = full + change(full)
    mean = simple.mean() / full.mean() - 1
    local = np.sqrt(np.mean((simple - full) ** 2 / (full**2 + 0.01 * full.mean() ** 2)))
    found = [bias(*_pairs(full, simple, common, random), 0.95) for _ in range(TRIALS)]
    # Each bound: passed by chance 999 times in 1000 where the interval is right.
    inside = sum(each.mean.low <= mean <= each.mean.high for each in found)
    low, high = _binomial([0.0005, 0.9995], TRIALS, 0.95)
    assert low <= inside <= high
    assert sum(local <= each.local.high for each in found) >= _binomial(0.001, TRIALS, 0.975)
    assert sum(each.local.low <= local for each in found) >= _binomial(0.001, TRIALS, 0.975)


@pytest.mark.parametrize("change", [_nothing, _everywhere])
def test_heavy_tails_of_many_pixels_do_no_harm(change: Callable[[Values], Values]) -> None:
    """A render's pixel has its light from one photon of three, or none: upper ends hold as often as they say,
    where enough pixels carry the noise."""
    random = np.random.default_rng(31)
    full = np.random.default_rng(7).uniform(0.2, 2.0, 1024)
    simple = full + change(full)
    local = np.sqrt(np.mean((simple - full) ** 2 / (full**2 + 0.01 * full.mean() ** 2)))
    trials, held = 100, 0
    for _ in range(trials):
        hits = (random.random((2, RENDERS, full.size)) < 1 / 3) * 3.0
        assert effective_pixels(full * hits[0]) > FEW
        held += local <= bias(full * hits[0], simple * hits[1], 0.95).local.high
    assert held >= _binomial(0.001, trials, 0.975)


def test_a_few_pixels_that_carry_the_noise_are_counted() -> None:
    random = np.random.default_rng(37)
    even = 1 + random.normal(0, 0.1, (RENDERS, PIXELS))
    # Of 28 squared differences of normal noise a pixel's sum varies by a fourth or so, which costs some.
    assert effective_pixels(even) > 0.7 * PIXELS
    rare = even.copy()
    rare[2, 7] = rare[5, 9] = 1000.0
    assert effective_pixels(rare) < 5
    assert effective_pixels(np.ones((RENDERS, PIXELS))) == PIXELS


def test_noise_is_no_bias() -> None:
    """The squared local bias is right in the mean, though a render's noise is as large as the bias.

    With 5 standard errors: wrong by chance once in two million. The mean that it is relative to has noise
    too, of six renders: by Taylor's series that makes the result larger by a part of 3 * 0.1^2 / 6 = 0.5 %,
    at most.
    """
    random = np.random.default_rng(13)
    full = _truth()
    simple = 1.1 * full
    truth = float(np.mean((simple - full) ** 2 / (full**2 + 0.01 * full.mean() ** 2)))
    found = [bias(*_pairs(full, simple, 0.0, random), 0.95).local.value ** 2 for _ in range(TRIALS)]
    error = np.std(found, ddof=1) / np.sqrt(TRIALS)
    assert error < 0.01 * truth
    assert abs(np.mean(found) - truth) < 5 * error + 0.005 * truth


def test_common_seeds_make_intervals_shorter() -> None:
    random = np.random.default_rng(17)
    full = _truth()
    apart = bias(*_pairs(full, full, 0.0, random), 0.95)
    common = bias(*_pairs(full, full, 0.99, random), 0.95)
    assert common.largest < 0.5 * apart.largest


def test_noise_of_a_render_is_found() -> None:
    """Relative spread 0.1 everywhere, with levels: the expectation is 0.01 F^2 / (F^2 + 0.01 M^2)."""
    random = np.random.default_rng(19)
    full = _truth()
    found = [noise(*_pairs(full, full, 0.0, random)) for _ in range(100)]
    expected = np.mean(0.01 * full**2 / (full**2 + 0.01 * full.mean() ** 2))
    error = np.std(found, ddof=1) / 10
    assert abs(np.mean(found) - expected) < 5 * error + 0.005 * expected


def test_a_pixel_that_is_bright_by_chance_does_not_hide_its_noise() -> None:
    """One render of eight found light there: relative to itself that is little, relative to the rest much."""
    renders = np.ones((RENDERS, 2))
    renders[:, 1] = 0.0
    renders[3, 1] = 8.0
    assert noise(renders, renders) > 10


def test_what_can_be_seen_is_what_the_interval_shows() -> None:
    """Nothing left out: the upper ends lie about where `resolvable` says, within a factor of two (the
    jackknife is too large for a U-statistic whose first-order part is zero)."""
    random = np.random.default_rng(23)
    full = _truth()
    ends = [bias(*_pairs(full, full, 0.0, random), 0.95).local.high for _ in range(100)]
    expected = resolvable(0.01, RENDERS, PIXELS, 0.95)
    assert 0.5 * expected < np.median(ends) < 2 * expected


def test_ratio_of_times() -> None:
    random = np.random.default_rng(29)
    inside = 0
    for _ in range(TRIALS):
        # Machines are slower now and then, for both alike: the ratio does not see that.
        load = random.uniform(1, 2, RENDERS)
        full, simple = load * np.exp(random.normal(0, 0.05, (2, RENDERS)))
        found = ratio_of_costs(full, 0.4 * simple, 0.95)
        inside += found.low <= 0.4 <= found.high
    low, high = _binomial([0.0005, 0.9995], TRIALS, 0.95)
    assert low <= inside <= high


def test_too_few_renders_and_black_images_are_refused() -> None:
    with pytest.raises(ValueError, match=f"at least {FEWEST}"):
        bias(np.ones((3, 5)), np.ones((3, 5)), 0.95)
    with pytest.raises(ValueError, match="same shape"):
        bias(np.ones((8, 5)), np.ones((8, 6)), 0.95)
    with pytest.raises(ValueError, match="black"):
        bias(np.zeros((8, 5)), np.ones((8, 5)), 0.95)
