"""Sums of made-up samples, as a tracer would add them up."""

import numpy as np
import numpy.typing as npt
from nocturne_scene.tile_sums import XYZ_SUMS, TileSums, block_sums, blocks_in, factors_of_tile

Values = npt.NDArray[np.float64]


def sums_of(samples: Values) -> TileSums:
    """`samples`: shape (samples, height, width, values), the values of X, Y, Z and further responses."""
    _, height, width, values = samples.shape
    sums = TileSums.zeros(width, height, values - 3)
    further = samples[..., 3:]
    products = _products(samples[..., :3])
    sums.pixels[...] = np.concatenate([samples[..., :3], products, further, further**2], axis=-1).sum(axis=0)
    blocks = np.array([block_sums(each) for each in samples[..., :3]])
    sums.block_products[...] = _products(blocks.reshape(-1, blocks_in(height), blocks_in(width), 3)).sum(
        axis=0
    )
    of_tile = samples.sum(axis=(1, 2))
    one, other = factors_of_tile(values - 3)
    sums.tile_products[...] = (of_tile[:, one] * of_tile[:, other]).sum(axis=0)
    return sums


def sums_of_independent(first: Values, spread: Values, samples: int) -> TileSums:
    """Sums that samples can have whose pixels know nothing of each other.

    `first`: sums of X, Y, Z and further responses, shape (height, width, values); `spread`: of each pixel,
    the mean square of the samples over the square of their mean, at least 1.
    """
    height, width, values = first.shape
    sums = TileSums.zeros(width, height, values - 3)
    scale = (spread / samples)[..., None]
    squares = _products(first[..., :3]) * scale
    further = first[..., 3:]
    sums.pixels[..., :3], sums.pixels[..., 3:XYZ_SUMS] = first[..., :3], squares
    sums.pixels[..., XYZ_SUMS:] = np.concatenate([further, further**2 * scale], axis=-1)
    noise = block_sums(squares - _products(first[..., :3]) / samples)
    blocks = block_sums(first[..., :3])
    sums.block_products[...] = _products(blocks) / samples + noise
    one, other = factors_of_tile(values - 3)
    of_tile = first.sum(axis=(0, 1))
    of_noise = (first[..., one] * first[..., other] * (scale - 1.0 / samples)).sum(axis=(0, 1))
    sums.tile_products[...] = of_tile[one] * of_tile[other] / samples + of_noise
    return sums


def _products(xyz: Values) -> Values:
    x, y, z = np.moveaxis(xyz, -1, 0)
    return np.stack([y * y, x * x, z * z, x * y, x * z, y * z], axis=-1)
