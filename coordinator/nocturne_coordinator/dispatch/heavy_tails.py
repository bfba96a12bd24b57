"""Whether an image's error bars can be trusted, told from the sums that are kept. Pure.

An error bar is an estimate from the same samples as the mean. Where a pixel lives on rare bright samples,
both come out too low until some have arrived, and nothing in that pixel says so. Its neighbours do: they show
nearly the same, so their variances should be nearly the same, and with heavy tails they are not.
"""

import numpy as np
from nocturne_scene.tile_sums import Values

HEAVY = 0.45
"""Unevenness from which on 95 % intervals hold the truth in less than some 90 of 100 cases.

From distributions whose intervals are known (uniform, exponential, log-normal, Pareto, rare events, 16 to
4000 samples): tests/coordinator/test_heavy_tails.py has them.
"""

_ALIKE = 3.0
"""Neighbours that differ by more standard errors than these show different things, such as an edge."""

_ENOUGH = 2**18
"""Pairs of neighbours: results wait while an error is estimated."""


def unevenness(y: Values, variance: Values) -> float:
    """How unevenly an image's variance is spread, from each pixel's mean and the variance of that mean.

    Difference of neighbouring pixels' variances over their sum, in [0, 1]: near 0 with many samples of
    light-tailed sums, near 1 where few samples carry the noise; 0 without noise or neighbours. Variances are
    taken relative to Y^2 + 0.01 M^2, M the image's mean Y, as in `relative_error`; Y is the mean of both
    neighbours, so that a bright sample does not hide itself.
    """
    level = 0.01 * float(np.mean(y)) ** 2
    differences = totals = 0.0
    for (y_one, v_one), (y_other, v_other) in _neighbours(y, variance):
        scale = (0.5 * (y_one + y_other)) ** 2 + level
        total = v_one + v_other
        alike = (y_one - y_other) ** 2 <= _ALIKE**2 * total
        # Twice black is alike, and says nothing.
        weight = np.divide(alike, scale, out=np.zeros_like(scale), where=scale > 0.0)
        differences += float(np.sum(np.abs(v_one - v_other) * weight))
        totals += float(np.sum(total * weight))
    return differences / totals if totals > 0.0 else 0.0


def _neighbours(y: Values, variance: Values) -> list[tuple[tuple[Values, Values], tuple[Values, Values]]]:
    """Values and those to their right; pixels and those below. Of a large film those of some rows."""
    step = max(1, y.size // _ENOUGH)
    return [
        ((y[::step, :-1], variance[::step, :-1]), (y[::step, 1:], variance[::step, 1:])),
        ((y[:-1:step], variance[:-1:step]), (y[1::step], variance[1::step])),
    ]
