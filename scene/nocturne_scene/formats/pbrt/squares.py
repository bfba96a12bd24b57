"""The sphere on a square, areas kept: P. Clarberg, "Fast equal-area mapping of the (hemi)sphere using SIMD",
Journal of Graphics Tools 13(3), 2008. pbrt keeps skies as such pictures, and shows each pixel as it is.

The middle of the square is +z and its corners are -z; +x and +y point along its rows and columns.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.spectra.published import SRGB_LUMINANCE
from nocturne_scene.textures.pictures import UnusableImageError

Array = NDArray[np.float64]

# Directions across and down that a pixel is the mean of.
_PARTS = 4

# Of a picture that is made: with twice as many columns, the most that an environment map has.
_MAX_ROWS = 4096

# Of a square that is made: the more pixels, the narrower are the seams between texels.
_MAX_SQUARE = 2048
_FINER_PARTS = 8


def direction(u: Array, v: Array) -> Array:
    """Unit vectors, shape (..., 3), of places in [0, 1]^2."""
    across, down = 2 * u - 1, 2 * v - 1
    a, b = np.abs(across), np.abs(down)
    below = a + b > 1
    # The triangles at the corners are those around the middle, folded over.
    a, b = np.where(below, 1 - b, a), np.where(below, 1 - a, b)
    radius = a + b
    angle = np.pi / 2 * np.divide(b, radius, out=np.zeros_like(b), where=radius > 0)
    height = 1 - radius**2
    flat = radius * np.sqrt(np.maximum(2 - radius**2, 0))
    return np.stack(
        [
            np.copysign(flat * np.cos(angle), across),
            np.copysign(flat * np.sin(angle), down),
            np.where(below, -height, height),
        ],
        axis=-1,
    )


def place(directions: Array) -> tuple[Array, Array]:
    """Where in [0, 1]^2 unit vectors of shape (..., 3) are."""
    x, y, z = (directions[..., axis] for axis in range(3))
    radius = np.sqrt(np.maximum(1 - np.abs(z), 0))
    b = radius * np.arctan2(np.abs(y), np.abs(x)) * 2 / np.pi
    a = radius - b
    a, b = np.where(z < 0, 1 - b, a), np.where(z < 0, 1 - a, b)
    return (np.copysign(a, x) + 1) / 2, (np.copysign(b, y) + 1) / 2


def illuminance(pixels: NDArray[np.float32]) -> float:
    """lx of what faces +z under a square picture whose white has 1 cd/m2, as pbrt-v4 counts it.

    It takes 2 pi over the pixels' number for a pixel's solid angle (Light::Create in lights.cpp), half of
    the true one: a sky of that "illuminance" gives twice as much.
    """
    rows, columns = pixels.shape[:2]
    u, v = np.meshgrid((np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows)
    cosine = np.maximum(direction(u, v)[..., 2], 0.0)
    luminance = pixels.astype(np.float64) @ np.array(SRGB_LUMINANCE)
    return float(2 * np.pi / (rows * columns) * np.sum(cosine * luminance))


def latitudes(pixels: NDArray[np.float32]) -> Array:
    """A square picture as one of latitudes and longitudes, with twice as many columns as rows.

    Raises UnusableImageError for a picture that is no square.
    """
    rows, columns = pixels.shape[:2]
    if rows != columns:
        raise UnusableImageError(f"{columns} x {rows} pixels; expected a square, as pbrt-v4 keeps skies")
    # From the middle to the left and the right: from azimuth pi to -pi.
    count = min(rows, _MAX_ROWS)
    azimuth = np.pi * (1 - (np.arange(2 * count * _PARTS) + 0.5) / (count * _PARTS))
    edges = np.cos(np.pi * np.arange(count + 1) / count)
    found = []
    for top, bottom in pairwise(edges):
        z = (top + (bottom - top) * (np.arange(_PARTS) + 0.5) / _PARTS)[:, None]
        flat = np.sqrt(1 - z**2)
        circle = np.stack(np.broadcast_arrays(flat * np.cos(azimuth), flat * np.sin(azimuth), z), axis=-1)
        u, v = place(circle)
        at = (np.minimum((rows * each).astype(int), rows - 1) for each in (v, u))
        seen = pixels[tuple(at)].astype(np.float64)
        found.append(seen.reshape(_PARTS, 2 * count, _PARTS, 3).mean(axis=(0, 2)))
    return np.stack(found)


def equal_area_square(texels: Array) -> Array:
    """The square of an environment map's texels, each pixel the mean of the texels that it shows."""
    rows, columns = texels.shape[:2]
    size = min(_MAX_SQUARE, 2 ** math.ceil(math.log2(4 * math.sqrt(rows * columns))))
    across = (np.arange(_FINER_PARTS * size) + 0.5) / (_FINER_PARTS * size)
    found = []
    for row in across.reshape(size, _FINER_PARTS):
        directions = direction(*np.meshgrid(across, row))
        azimuth = np.arctan2(directions[..., 1], directions[..., 0])
        at = (
            (rows * (1 - directions[..., 2]) / 2).astype(int),
            (columns * (0.5 - azimuth / (2 * np.pi))).astype(int),
        )
        seen = texels[np.minimum(at[0], rows - 1), np.minimum(at[1], columns - 1)]
        found.append(seen.reshape(_FINER_PARTS, size, _FINER_PARTS, 3).mean(axis=(0, 2)))
    return np.stack(found)
