"""How far two images are apart, and whether chance explains it.

The rule of Mitsuba 3's own tests (`share_explained`) compares pixel by pixel: it sees a wrong shape at once,
and no error of 1 % everywhere. Sums over tiles and over the image see that.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import special

Values = NDArray[np.float64]

SIGNIFICANCE = 0.01
"""Chance that two estimates of the same image count as different: by the pixels' bound, and by the tiles'."""

EXPLAINED = 0.9975
"""Share of all values that must lie within the pixels' bound: the rule of Mitsuba 3's tests."""

MEAN_BOUND = 3.0
"""Standard errors of an image's mean: exceeded by chance 27 times in 10,000, for each channel."""

_TILE = 8

_MIN_TILES = 16
"""Fewer do not show how much tiles scatter."""

# Parts of the mean: pixels much darker count as if they were a tenth of it.
_LEVEL = 0.01

# Of the squared errors, the largest are left out of the trimmed mean.
_TRIMMED = 0.001

# Where neither image has noise, values may differ by this part of the brightest.
_ROUNDING = 1e-4


@dataclass(frozen=True)
class Estimate:
    """An image whose noise is known, or not."""

    mean: Values
    """Shape (height, width, channels)."""
    variance: Values | None = None
    """Of the mean, same shape; None if it is not known."""
    degrees: float = np.inf
    """Of freedom: how many values the variance was found from, less one."""
    correlation: float = 1.0
    """How many times the variance of a sum of pixels is that of pixels that know nothing of each other."""


@dataclass(frozen=True)
class Verdict:
    """Whether chance explains the difference of two images."""

    share_explained: float
    """Of the values that lie within the bound that all of an image's pixels keep with 99 %."""
    largest_tile: float
    """Bound of the tiles' smallest p-value over that p-value: more than 1 is too much."""
    mean_z: Values
    """By channel, standard errors of the image's mean."""

    @property
    def pixels_agree(self) -> bool:
        """The rule of Mitsuba 3's tests."""
        return self.share_explained >= EXPLAINED

    @property
    def sums_agree(self) -> bool:
        """Tiles of 8 x 8 pixels, and the whole image."""
        return self.largest_tile <= 1.0 and bool(np.all(np.abs(self.mean_z) <= MEAN_BOUND))


@dataclass(frozen=True)
class Difference:
    """How far an image is from another."""

    relmse: float
    """Mean of squared differences over squared values (plus a hundredth of the squared mean)."""
    trimmed_relmse: float
    """The same without the largest thousandth."""
    ratio: Values
    """Of the images' means, by channel."""
    ratio_error: Values | None
    """Its standard error, where the noise is known."""
    verdict: Verdict | None
    """None where the noise is not known."""
    by_tiles: "ByTiles | None" = None
    """Where the noise of one image is known, and of the other one is not."""


@dataclass(frozen=True)
class ByTiles:
    """What can be said about chance if one of two images does not state its noise."""

    mean_z: Values
    """By channel, standard errors by which the means differ: that of `Difference.ratio_error`."""
    explained: float
    """Part of the squared difference that stated errors make, in [0, 1]. The rest is the other image's noise,
    or a difference."""

    @property
    def means_agree(self) -> bool:
        """Within the bound of images whose noise is known."""
        return bool(np.all(np.abs(self.mean_z) <= MEAN_BOUND))


def compare_by_tiles(image: Estimate, reference: Estimate) -> Difference:
    """Compare two images, of which one states its noise. ValueError if they differ in shape.

    The error of the means' ratio comes from how much the difference scatters from tile to tile, an eighth of
    the image wide: noise of both images does that, also where a filter spreads it over some pixels, and so
    does a difference that varies over the image. That makes the error too large where there is such a
    difference, not too small. Below 16 tiles nothing is said.
    """
    found = compare(Estimate(image.mean), Estimate(reference.mean))
    known = image.variance if image.variance is not None else reference.variance
    edge = max(_TILE, min(image.mean.shape[:2]) // 8)
    rows, columns = (size // edge for size in image.mean.shape[:2])
    if known is None or rows * columns < _MIN_TILES:
        return found
    difference = image.mean - reference.mean
    whole = difference[: rows * edge, : columns * edge]
    tiles = whole.reshape(rows, edge, columns, edge, -1).mean(axis=(1, 3)).reshape(rows * columns, -1)
    error = tiles.std(axis=0, ddof=1) / np.sqrt(len(tiles))
    off = difference.mean(axis=(0, 1))
    t = np.divide(off, error, out=np.where(off == 0.0, 0.0, np.inf), where=error > 0)
    # As many standard errors as have Student's probability.
    z = np.sign(t) * -special.ndtri(np.maximum(special.stdtr(len(tiles) - 1, -np.abs(t)), 1e-300))
    squares = float(np.sum(difference**2))
    explained = min(1.0, float(np.sum(known)) / squares) if squares > 0 else 1.0
    ratio_error = error / np.abs(reference.mean.mean(axis=(0, 1)))
    return replace(found, ratio_error=ratio_error, by_tiles=ByTiles(z, explained))


def compare(image: Estimate, reference: Estimate) -> Difference:
    """Compare two images of the same shape. ValueError if they have not."""
    if image.mean.shape != reference.mean.shape:
        raise ValueError(f"images of different shapes, {image.mean.shape} and {reference.mean.shape}")
    scale = reference.mean**2 + _LEVEL * np.mean(reference.mean, axis=(0, 1)) ** 2
    squares = np.divide((image.mean - reference.mean) ** 2, scale, out=np.zeros_like(scale), where=scale > 0)
    kept = np.sort(squares, axis=None)[: squares.size - int(_TRIMMED * squares.size)]
    means = [each.mean.mean(axis=(0, 1)) for each in (image, reference)]
    ratio = np.divide(means[0], means[1], out=np.full_like(means[0], np.nan), where=means[1] != 0)
    known = [each.variance * each.correlation for each in (image, reference) if each.variance is not None]
    error = verdict = None
    if known:
        total = np.sum(known, axis=0)
        count = total.shape[0] * total.shape[1]
        error = np.sqrt(total.sum(axis=(0, 1))) / count / np.abs(means[1])
        verdict = _verdict(image, reference)
    return Difference(float(squares.mean()), float(kept.mean()), ratio, error, verdict)


def _verdict(image: Estimate, reference: Estimate) -> Verdict:
    difference = image.mean - reference.mean
    rounding = _ROUNDING * float(np.abs(reference.mean).max())
    parts = [(each.variance, each.degrees) for each in (image, reference) if each.variance is not None]
    pixels = difference.shape[0] * difference.shape[1]
    p = _p_values(difference, parts, rounding)
    explained = float(np.mean(p > sidak(pixels)))
    of_sums = [
        (each.variance * each.correlation, each.degrees)
        for each in (image, reference)
        if each.variance is not None
    ]
    tiles = _p_values(
        _tile_sums(difference),
        [(_tile_sums(variance), degrees) for variance, degrees in of_sums],
        rounding * _TILE**2,
        # Each of a tile's values has its own degrees of freedom; of unequal ones a quarter counts, at least.
        spread=_TILE**2 / 4,
    )
    total = np.sum([variance for variance, _ in of_sums], axis=0).sum(axis=(0, 1))
    off = difference.sum(axis=(0, 1))
    mean_z = np.divide(
        off, np.sqrt(total), out=np.where(np.abs(off) > rounding * pixels, np.inf, 0.0), where=total > 0
    )
    smallest = max(float(tiles.min()), np.finfo(float).tiny)
    return Verdict(explained, sidak(tiles.size) / smallest, mean_z)


def sidak(count: int) -> float:
    """The p-value that the smallest of `count` independent ones exceeds with 1 - SIGNIFICANCE."""
    return float(-np.expm1(np.log1p(-SIGNIFICANCE) / count))


def _p_values(
    difference: Values, parts: list[tuple[Values, float]], rounding: float, spread: float = 1.0
) -> Values:
    """Two-sided, by Student's t with the degrees of freedom of Welch and Satterthwaite."""
    variance: Values = np.sum([part for part, _ in parts], axis=0)
    weighed: Values = np.sum([part**2 / (degrees * spread) for part, degrees in parts], axis=0)
    degrees = np.divide(variance**2, weighed, out=np.full_like(variance, np.inf), where=weighed > 0)
    z = np.divide(np.abs(difference), np.sqrt(variance), out=np.zeros_like(variance), where=variance > 0)
    p = np.where(np.isfinite(degrees), 2 * special.stdtr(np.minimum(degrees, 1e9), -z), 2 * special.ndtr(-z))
    return np.where(variance > 0, p, np.where(np.abs(difference) <= rounding, 1.0, 0.0))


def _tile_sums(values: Values) -> Values:
    """Sums over 8 x 8 pixels; the rest at the right and the bottom is added to the last tiles."""
    rows, columns = (np.arange(0, max(size - _TILE, 0) + 1, _TILE) for size in values.shape[:2])
    summed: Values = np.add.reduceat(np.add.reduceat(values, rows, axis=0), columns, axis=1)
    return summed
