"""Sums of made-up samples, as a tracer would add them up."""

import numpy as np
import numpy.typing as npt
from nocturne_scene.tile_sums import XYZ_SUMS, TileSums, blocks_in
from nocturne_scene.uncertainty import block_sums

Values = npt.NDArray[np.float64]


def sums_of(samples: Values) -> TileSums:
    """`samples`: shape (samples, height, width, values), the values of X, Y, Z and further responses."""
    _, height, width, values = samples.shape
    sums = TileSums.zeros(width, height, values - 3)
    x, y, z = (samples[..., index] for index in range(3))
    further = samples[..., 3:]
    products = np.stack([x, y, z, y * y, x * x, z * z, x * y, x * z, y * z], axis=-1)
    sums.pixels[...] = np.concatenate([products, further, further**2], axis=-1).sum(axis=0)
    blocks = np.array([block_sums(each) for each in y]).reshape(-1, blocks_in(height), blocks_in(width))
    sums.block_squares[...] = (blocks**2).sum(axis=0)
    sums.tile_squares[...] = (blocks.sum(axis=(1, 2)) ** 2).sum()
    return sums


def sums_of_independent(first: Values, spread: Values, samples: int) -> TileSums:
    """Sums that samples can have whose pixels know nothing of each other.

    `first`: sums of X, Y, Z and further responses, shape (height, width, values); `spread`: of each pixel,
    the mean square of what is drawn over the square of its mean, at least 1.
    """
    height, width, values = first.shape
    sums = TileSums.zeros(width, height, values - 3)
    x, y, z = (first[..., index] for index in range(3))
    scale = (spread / samples)[..., None]
    squares = np.stack([y * y, x * x, z * z, x * y, x * z, y * z], axis=-1) * scale
    further = first[..., 3:]
    sums.pixels[..., :3], sums.pixels[..., 3:XYZ_SUMS] = first[..., :3], squares
    sums.pixels[..., XYZ_SUMS:] = np.concatenate([further, further**2 * scale], axis=-1)
    blocks, noise = block_sums(y), block_sums(squares[..., 0] - y * y / samples)
    sums.block_squares[...] = blocks**2 / samples + noise
    sums.tile_squares[...] = blocks.sum() ** 2 / samples + noise.sum()
    return sums
