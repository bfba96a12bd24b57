"""What a grid of noisy readings says of the field behind it: calmed values, and the least of the true values.

J.-S. Lee, "Digital image enhancement and noise filtering by use of local statistics", IEEE Transactions on
Pattern Analysis and Machine Intelligence 2 (1980) 165: a value gives way to its surroundings as far as its
own noise explains how it differs from them. Here the surroundings are a plane through up to 5 x 5 values.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Values = NDArray[np.float64]

_HALF = 2
"""Values to each side that surroundings have."""
_LEAST = 6
"""Values of which surroundings are made; fewer tell nothing."""
_CLEAR = 2.0
"""Standard deviations by which differences exceed the noise's before they are taken for the field's."""
_DRAWS = 256


@dataclass(frozen=True)
class Least:
    """The least true value of a grid."""

    value: float
    """Without what the choice among noisy readings makes it too low by."""
    low: float
    high: float
    """Of an interval of 95 % or more."""


def calmed(values: Values, errors: Values) -> Values:
    """Values of a grid, smoothed as far as their standard errors explain differences, and no further.

    Both have the shape (rows, columns). Where an error is 0, or a grid is too small, values stay."""
    found: Values = _calmed(values[None], errors)[0]
    return found


def least(values: Values, errors: Values) -> Least:
    """The least of the values without noise, whose readings and standard errors are given; any shape.

    The least reading is too low: of many readings, it is one of those that chance has lowered. By how much,
    noise tells that is added to the calmed field. The interval needs no smoothness: the lowest value's own
    reading is not below its interval, and no value is above its own, of all values at once (Bonferroni).
    """
    low, high = _bounds(values.ravel(), errors.ravel(), 0.05)
    found = float(values.min())
    if values.ndim == 2 and min(values.shape) > 0 and errors.any():
        field = calmed(values, errors)
        noise = np.random.default_rng(0).standard_normal((_DRAWS, *values.shape)) * errors
        again = _calmed(field + noise, errors).min(axis=(1, 2))
        found = float(2.0 * field.min() - again.mean())
    return Least(min(max(found, low), high), low, high)


def least_is_at_least(values: Values, errors: Values, limit: float | Values) -> tuple[float, float]:
    """Probabilities, each a lower bound, that the least true value is at `limit` or above, and below it."""
    distance = (values - limit).ravel()
    error = np.broadcast_to(errors, values.shape).ravel()
    exact = error <= 0.0
    z = np.where(exact, np.where(distance >= 0.0, np.inf, -np.inf), distance / np.where(exact, 1.0, error))
    holds = float(stats.norm.cdf(z.min()))
    return holds, max(0.0, 1.0 - len(z) * float(stats.norm.cdf(z.min())))


def _bounds(values: Values, errors: Values, chance: float) -> tuple[float, float]:
    one, all_of_them = stats.norm.isf(0.5 * chance), stats.norm.isf(0.5 * chance / len(values))
    return float((values - one * errors).min()), float((values + all_of_them * errors).min())


def _calmed(draws: Values, errors: Values) -> Values:
    """Of several grids with the same errors, shape (grids, rows, columns)."""
    grids, rows, columns = draws.shape
    found = draws.copy()
    for row in range(rows):
        for column in range(columns):
            top, left = max(0, row - _HALF), max(0, column - _HALF)
            bottom, right = min(rows, row + _HALF + 1), min(columns, column + _HALF + 1)
            shape = bottom - top, right - left, row - top, column - left
            own = errors[row, column]
            if own <= 0.0 or shape[0] * shape[1] < _LEAST:
                continue
            plane, middle, freedom = _plane(*shape)
            around = draws[:, top:bottom, left:right].reshape(grids, -1)
            noise = float((1.0 - np.diag(plane)) @ errors[top:bottom, left:right].ravel() ** 2) / freedom
            rest = around - around @ plane.T
            beyond = (rest**2).sum(axis=1) / freedom - noise * (1.0 + _CLEAR * np.sqrt(2.0 / freedom))
            beyond = np.maximum(0.0, beyond)
            keep = beyond / (beyond + own**2)
            expected = around @ plane[middle]
            found[:, row, column] = expected + keep * (draws[:, row, column] - expected)
    return found


@lru_cache(maxsize=256)
def _plane(rows: int, columns: int, row: int, column: int) -> tuple[Values, int, float]:
    """What makes a plane of values by least squares, the middle's number, and the degrees of freedom left."""
    down, across = np.mgrid[:rows, :columns]
    terms = np.stack([np.ones(rows * columns), down.ravel() - row, across.ravel() - column], axis=1)
    matrix = terms @ np.linalg.pinv(terms)
    return matrix, row * columns + column, float(rows * columns - np.linalg.matrix_rank(terms))
