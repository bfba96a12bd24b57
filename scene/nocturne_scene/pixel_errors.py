"""Variances of pixels' means, from their sums; docs/explanation/units-and-errors.md explains them."""

from collections.abc import Sequence

import numpy as np

from nocturne_scene.tile_sums import BLOCK, Counts, Values, block_sums


def variance_of_mean(sums: Values, squares: Values, counts: Values | Counts) -> Values:
    """Of n numbers each with such sums; 0 below two. All of one shape."""
    return np.maximum(0.0, covariance_of_means(squares, sums, sums, counts))


def covariance_of_means(products: Values, a: Values, b: Values, counts: Values | Counts) -> Values:
    """Of the means of n pairs of numbers; 0 below two."""
    n = np.maximum(counts, 2).astype(np.float64)
    found: Values = a * b
    found /= n
    np.subtract(products, found, out=found)
    found /= n * (n - 1.0)
    below_two = counts < 2
    if below_two.any():
        found[np.broadcast_to(below_two, found.shape)] = 0.0
    return found


def one_more_find(
    mean: Values, variance: Values, counts: Counts, light: Sequence[int] | None = None
) -> Values:
    """The addition to the variance of a pixel's mean, or of a region's sum, for light that its samples
    missed; shapes (height, width, ...), `counts` (height, width).

    Light that few samples find is unknown where none found it, and too well known where two found as much.
    So each error has the variance that one more lit sample would bring: that of the pixel's block, over the
    number of its lit samples: its samples weighed by their values, (sum of |x|)^2 / sum of x^2 (Kish's
    effective sample size), at least 1. A pixel with many lit samples needs the block's so much less. Stokes
    parameters may be of either sign, so samples are lit as in S0: `light` says of each value in whose.
    """
    n = np.maximum(counts, 2).astype(np.float64)
    n = n.reshape(n.shape + (1,) * (mean.ndim - 2))
    squares = mean * mean
    of_block = block_sums(variance)
    finds_of_block = _finds(n[::BLOCK, ::BLOCK], block_sums(np.abs(mean)), of_block, block_sums(squares))
    one_more = of_block / (finds_of_block if light is None else finds_of_block[..., [*light]])
    height, width = counts.shape
    found: Values = one_more.repeat(BLOCK, axis=0)[:height].repeat(BLOCK, axis=1)[:, :width]
    finds = _finds(n, mean, variance, squares)
    found /= finds if light is None else finds[..., [*light]]
    found[counts < 2] = 0.0
    return found


def _finds(n: Values, found: Values, variance: Values, squares: Values) -> Values:
    """At least 1; from sums over pixels of means, of their variances, and of their squares."""
    second = (n - 1.0) * variance + squares
    finds = np.divide(n * (found * found), second, out=np.ones_like(second), where=second > 0.0)
    return np.maximum(finds, 1.0, out=finds)


def pixel_variance(sums: Values, squares: Values, counts: Counts) -> Values:
    """Of the means of one quantity in pixels, all of shape (height, width), with one more lit sample."""
    own = variance_of_mean(sums, squares, counts)
    own += one_more_find(sums / np.maximum(counts, 1), own, counts)
    return own
