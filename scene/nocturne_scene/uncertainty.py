"""Means and their errors, of pixels and of regions, in X, Y, Z, chromaticity and further responses.

The one formula of API, command line, page and comparisons; docs/explanation/units-and-errors.md explains it.
Long: pixels and regions share it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.pixel_errors import covariance_of_means, one_more_find, variance_of_mean
from nocturne_scene.response_correlations import correlations_of_tiles, matrix
from nocturne_scene.responses import is_signed, light_of
from nocturne_scene.tile_sums import (
    BLOCK,
    PAIR_FIRST,
    PAIR_SECOND,
    PIXEL_PAIRS,
    PIXEL_SQUARES,
    PRODUCTS,
    PRODUCTS_PAIRS,
    PRODUCTS_SQUARES,
    XYZ_SUMS,
    Counts,
    Values,
    block_sums,
    tile_sums,
)

CONFIDENCE = 1.96
"""Standard errors to each side of a 95 % interval, where these are well known."""
_UPPER = 0.975
"""Quantile at the upper end of a 95 % interval."""

# The factors of each of PRODUCTS.
_FIRST_FACTORS, _SECOND_FACTORS = [*PRODUCTS_SQUARES, *PAIR_FIRST], [*PRODUCTS_SQUARES, *PAIR_SECOND]
_Y = 1


@dataclass(frozen=True, slots=True, eq=False)
class ImageMoments:
    """Means of an image's pixels, or of some of its rows of tiles, and the known moments of their errors."""

    mean: Values
    """Shape (height, width, 3 or more): X, Y, Z, further responses."""
    variance: Values
    """Of the mean, same shape; 0 where there is none or below two samples, NaN where it was not kept."""
    one_more: Values
    """The addition to it for one more lit sample, same shape; see one_more_find."""
    covariance: Values
    """Of the means XY, XZ, YZ, shape (height, width, 3)."""
    block_covariance: Values
    """Of the sums of the mean X, Y, Z of each block's pixels, shape (blocks down, blocks across, 6): YY, XX,
    ZZ, XY, XZ, YZ."""
    tile_variance: Values
    """Of the sums of the mean X, Y, Z of each tile's pixels, shape (tiles down, tiles across, 3)."""
    tile_size: int
    samples: Counts
    """Shape (height, width)."""
    correlations: Values | None = None
    """Of all values in each tile, as `response_correlations` has them; None: not known, or no further
    responses."""


def moments_of(
    sums: Values,
    counts: Counts,
    block_products: Values,
    tile_products: Values,
    tile_size: int,
    further_responses: Sequence[str] = (),
) -> ImageMoments:
    """From sums as `nocturne_scene.tile_sums` has them, of whole tiles whose pixels have as many samples.

    Products have the shapes (blocks down, blocks across, 6) and (tiles down, tiles across, 6 or more). Names
    of further responses are needed where some are Stokes parameters.
    """
    further = (sums.shape[-1] - XYZ_SUMS) // 2
    n = counts[..., None]
    values = [0, 1, 2, *range(XYZ_SUMS, XYZ_SUMS + further)]
    squares = [*PIXEL_SQUARES, *range(XYZ_SUMS + further, XYZ_SUMS + 2 * further)]
    blocks = block_sums(sums[..., values] if further else sums[..., :3])
    factors = blocks[..., _FIRST_FACTORS], blocks[..., _SECOND_FACTORS]
    of_blocks = covariance_of_means(block_products, *factors, n[::BLOCK, ::BLOCK])
    of_blocks[..., :3] = np.maximum(of_blocks[..., :3], 0.0)
    mean = sums[..., values] / np.maximum(n, 1)
    of_tiles, of_tile_samples = tile_sums(blocks, tile_size), counts[::tile_size, ::tile_size]
    has_products = tile_products.shape[-1] > PRODUCTS
    together = correlations_of_tiles(of_tiles, tile_products, of_tile_samples) if has_products else None
    variance = variance_of_mean(sums[..., values], sums[..., squares], n)
    names = ["X", "Y", "Z", *further_responses]
    light = light_of(names) if any(map(is_signed, further_responses)) else None
    return ImageMoments(
        mean,
        variance,
        one_more_find(mean, variance, counts, light),
        covariance_of_means(sums[..., PIXEL_PAIRS], sums[..., PAIR_FIRST], sums[..., PAIR_SECOND], n),
        of_blocks,
        variance_of_mean(
            of_tiles[..., :3], tile_products[..., PRODUCTS_SQUARES], n[::tile_size, ::tile_size]
        ),
        tile_size,
        counts,
        together,
    )


class _Correlation:
    """How far errors of a region's pixels in one quantity go together, from what blocks and tiles have
    together."""

    def __init__(self) -> None:
        self._variance = self._of_blocks = self._of_tiles = 0.0
        self._pixels = 0

    def add(
        self,
        variance: Values,
        of_blocks: Values,
        of_tiles: Values,
        tile_size: int,
        chosen: NDArray[np.bool_],
    ) -> Values:
        """Variances of a quantity's means, and of their sums over blocks and tiles. A NaN was not
        kept, and counts as independent. Gives the part of each block's variance that is chosen."""
        whole, inside = block_sums(variance), block_sums(np.where(chosen, variance, 0.0))
        self._variance += float(np.sum(inside))
        self._of_blocks += float(np.sum(_ratio(of_blocks, whole) * inside))
        beyond = _ratio(of_tiles, tile_sums(of_blocks, tile_size))
        self._of_tiles += float(np.sum(beyond * tile_sums(inside, tile_size)))
        self._pixels += int(np.count_nonzero(chosen))
        return np.divide(inside, whole, out=np.zeros_like(whole), where=whole > 0.0)

    def part(self) -> float:
        """Of what a block's pixels share, a region's: less than a block has less of it. Neighbours have the
        most in common: 2 x 2 pixels that share by 16 have 0.4, and this says half."""
        return min(1.0, math.log(self._pixels) / math.log(BLOCK**2))

    def factor(self) -> float:
        """The variance of the region's mean over that of pixels that know nothing of each other; at least
        1."""
        if not self._variance > 0.0:
            return 1.0
        # More than a block has a part in what different blocks share, as its pairs of pixels are in different
        # blocks.
        apart = max(0.0, 1.0 - BLOCK**2 / self._pixels)
        within = max(0.0, self._of_blocks / self._variance - 1.0)
        beyond = max(0.0, self._of_tiles / self._variance - 1.0)
        return (1.0 + self.part() * within) * (1.0 + apart * beyond)


def _ratio(variance: Values, independent: Values) -> Values:
    """1 where it is not known, or nothing varies."""
    known = (independent > 0.0) & np.isfinite(variance)
    return np.divide(variance, independent, out=np.ones_like(independent), where=known)


def mean_y_error(
    y: Values, variance: Values, counts: Counts, products: tuple[Values, Values, int] | None = None
) -> float:
    """Standard error of the mean Y of whole tiles, from sums of Y and the variances of the pixels' means.

    `products`: of blocks, of tiles, and the edge of a tile; without, pixels are taken as independent.
    """
    total = float(np.sum(variance))
    if products is not None:
        block_products, tile_products, edge = products
        blocks = block_sums(y)
        # Squares of Y come first.
        of_blocks = variance_of_mean(blocks, block_products[..., 0], counts[::BLOCK, ::BLOCK])
        of_tiles = variance_of_mean(tile_sums(blocks, edge), tile_products[..., 0], counts[::edge, ::edge])
        correlation = _Correlation()
        correlation.add(variance, of_blocks, of_tiles, edge, counts > 0)
        total *= correlation.factor()
    return math.sqrt(total) / y.size


@dataclass(frozen=True, slots=True)
class RegionReading:
    """Means over a region's pixels that have samples, and their standard errors; NaN where unknown."""

    mean: tuple[float, ...]
    """X, Y, Z, further responses."""
    error: tuple[float, ...]
    chromaticity: tuple[float, float]
    """u', v' of CIE 1976; NaN in the dark."""
    chromaticity_error: tuple[float, float]
    correlation: float
    """How many times the variance of Y is that of pixels that know nothing of each other; at least 1."""
    coverage_factor: float
    """Standard errors to each side of a 95 % interval of Y: Student's t, as an error from few samples is
    itself uncertain. NaN where the error is unknown."""
    pixels: int
    zero_pixels: int
    """In which no sample found light."""
    samples: int
    """Of all pixels together."""
    samples_per_pixel: tuple[int, int]
    """Fewest and most."""
    correlations: Values | None = None
    """Of the errors of all values, shape (values, values), as far as tiles tell; None where they are not
    known."""
    own_variance: tuple[float, ...] = ()
    """Of the means, by the pixels' samples alone: those of sums of responses have the covariances of these
    very pixels. Empty where it is not known."""


class RegionSums:
    """Adds up a region's pixels, some rows of tiles after the other."""

    def __init__(self, values: int) -> None:
        """`values`: X, Y, Z and further responses."""
        self._mean = np.zeros(values)
        self._variance = np.zeros(values)
        self._one_more = np.zeros(values)
        # Of X, Y, Z: by pixels alone, and by sums over blocks, as PRODUCTS.
        self._covariance = np.zeros(PRODUCTS)
        self._of_blocks = np.zeros(PRODUCTS)
        self._correlations = [_Correlation() for _ in "XYZ"]
        self._pixels = self._unseen = self._samples = 0
        self._fewest, self._most = 2**63, 0
        self._blocks = self._squares_of_blocks = 0.0
        # Covariances of all values, as far as tiles tell.
        self._together: Values | None = np.zeros((values, values)) if values > len("XYZ") else None

    def add(self, image: ImageMoments, chosen: NDArray[np.bool_]) -> None:
        """`chosen`: which pixels of it; those without samples are left out."""
        chosen = chosen & (image.samples > 0)
        if not chosen.any():
            return
        self._mean += image.mean[chosen].sum(axis=0)
        self._variance += image.variance[chosen].sum(axis=0)
        self._one_more += image.one_more[chosen].sum(axis=0)
        self._covariance[PRODUCTS_PAIRS] += image.covariance[chosen].sum(axis=0)
        for index, correlation in enumerate(self._correlations):
            of_blocks = image.block_covariance[..., PRODUCTS_SQUARES[index]]
            inside = correlation.add(
                image.variance[..., index],
                of_blocks,
                image.tile_variance[..., index],
                image.tile_size,
                chosen,
            )
            if index == _Y:
                of_each = inside * np.nan_to_num(of_blocks)
                self._blocks += float(of_each.sum())
                self._squares_of_blocks += float(np.square(of_each).sum())
                self._of_blocks += np.nansum(image.block_covariance * inside[..., None], axis=(0, 1))
        self._add_together(image, chosen)
        samples = image.samples[chosen]
        self._pixels += len(samples)
        self._unseen += int(np.count_nonzero(image.mean[chosen][:, 1] <= 0.0))
        self._samples += int(samples.sum(dtype=np.uint64))
        self._fewest, self._most = min(self._fewest, int(samples.min())), max(self._most, int(samples.max()))

    def _add_together(self, image: ImageMoments, chosen: NDArray[np.bool_]) -> None:
        """What a region has of a tile goes together as the whole tile does."""
        if self._together is None:
            return
        if image.correlations is None:
            self._together = None
            return
        edge, values = image.tile_size, len(self._mean)
        for row, column in np.ndindex(image.correlations.shape[:2]):
            tile = np.s_[row * edge : (row + 1) * edge, column * edge : (column + 1) * edge]
            if chosen[tile].any():
                error = np.sqrt(image.variance[tile][chosen[tile]].sum(axis=0))
                correlation = matrix(image.correlations[row, column], values)
                self._together += correlation * error[:, None] * error[None, :]

    def _whole_correlations(self) -> Values | None:
        if self._together is None or not np.isfinite(self._together).all():
            return None
        error = np.sqrt(np.diagonal(self._together))
        both = error[:, None] * error[None, :]
        found: Values = np.divide(self._together, both, out=np.zeros_like(both), where=both > 0.0)
        np.fill_diagonal(found, 1.0)
        return found

    def reading(self) -> RegionReading | None:
        """None where no pixel has samples."""
        if not self._pixels:
            return None
        factors, n = [each.factor() for each in self._correlations], self._pixels
        mean = self._mean / n
        known = self._fewest > 1
        # Further responses are not kept for blocks.
        each_factor = np.array([*factors, *[max(factors)] * (len(mean) - 3)])
        # One find more in all of it, of the mean size.
        sums_variance = self._variance * each_factor + self._one_more / n
        variance = sums_variance / n**2 if known else np.full(len(mean), np.nan)
        covariance = self._covariances(variance)
        chromaticity, errors = chromaticity_of(mean, variance, covariance)
        return RegionReading(
            tuple(map(float, mean)),
            tuple(map(float, np.sqrt(variance))),
            chromaticity,
            errors,
            factors[_Y],
            self._coverage_factor(),
            n,
            self._unseen,
            self._samples,
            (self._fewest, self._most),
            self._whole_correlations() if known else None,
            tuple(map(float, self._variance / n**2)) if known else (),
        )

    def _coverage_factor(self) -> float:
        """By the effective degrees of freedom of a sum whose parts, the blocks, have n - 1 each: Welch and
        Satterthwaite, JCGM 100:2008 (GUM), equation G.2b."""
        # So that what reads no regions does without it.
        from scipy import special

        if self._fewest < 2:
            return math.nan
        alike = self._blocks**2 / self._squares_of_blocks if self._squares_of_blocks > 0.0 else 1.0
        return float(special.stdtrit((self._fewest - 1) * alike, _UPPER))

    def _covariances(self, variance: Values) -> Values:
        """Of the means XY, XZ, YZ, of which these are the variances: correlated as pixels alone are, and the
        more as blocks are the more the region is like one."""
        alone = self._covariance.copy()
        alone[PRODUCTS_SQUARES] = self._variance[:3]
        part = self._correlations[_Y].part()
        together = (1.0 - part) * alone + part * self._of_blocks if self._of_blocks[0] > 0.0 else alone
        found = []
        for one, other, product in zip(PAIR_FIRST, PAIR_SECOND, together[PRODUCTS_PAIRS], strict=True):
            both = math.sqrt(max(0.0, together[PRODUCTS_SQUARES[one]] * together[PRODUCTS_SQUARES[other]]))
            correlation = min(1.0, max(-1.0, product / both)) if both > 0.0 else 0.0
            found.append(correlation * math.sqrt(variance[one] * variance[other]))
        return np.array(found)


def chromaticity_of(
    mean: Values, variance: Values, covariance: Values
) -> tuple[tuple[float, float], tuple[float, float]]:
    """u' and v' (CIE 15:2018, 8.2.1) of X, Y, Z, and their standard errors, to first order in the errors.

    `covariance`: of XY, XZ, YZ. NaN in the dark.
    """
    x, y, z = (float(each) for each in mean[:3])
    whole = x + 15.0 * y + 3.0 * z
    if whole <= 0.0:
        return (math.nan, math.nan), (math.nan, math.nan)
    u, v = 4.0 * x / whole, 9.0 * y / whole
    matrix = np.diag(variance[:3])
    for one, other, value in zip(PAIR_FIRST, PAIR_SECOND, covariance, strict=True):
        matrix[one, other] = matrix[other, one] = value
    weights = np.array([1.0, 15.0, 3.0])
    slopes = (np.array([4.0, 0.0, 0.0]) - u * weights, np.array([0.0, 9.0, 0.0]) - v * weights)
    # A NaN stays one.
    first, second = (float(np.sqrt(np.maximum(0.0, slope @ matrix @ slope))) / whole for slope in slopes)
    return (u, v), (first, second)


def read_region(image: ImageMoments, chosen: NDArray[np.bool_] | None = None) -> RegionReading | None:
    """Of chosen pixels of an image, or of all; None where they have no samples."""
    sums = RegionSums(image.mean.shape[-1])
    sums.add(image, np.ones(image.samples.shape, dtype=np.bool_) if chosen is None else chosen)
    return sums.reading()
