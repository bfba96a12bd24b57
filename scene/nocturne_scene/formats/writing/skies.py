"""Environment maps as other renderers have them."""

import math

import numpy as np

from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.formats.pbrt.read import squares
from nocturne_scene.formats.writing.tables import Array
from nocturne_scene.textures.environment_maps import equal_area_rows, interpolated, read_whole

# Pixels of the picture that is made: the more, the narrower are the seams between texels.
_MAX_PIXELS = 2**22
_MAX_SQUARE = 2048
_FINEST = 16
_PARTS = 8


def texels_of(environment: EnvironmentMap, blobs: BlobStore) -> Array:
    """What the tracer makes of a map: rows of equal steps of height, linear sRGB, (rows, columns, 3)."""
    pixels = read_whole(blobs.path(environment.asset.removeprefix("sha256:")))
    rows, count = iter(pixels), len(pixels)
    if environment.pixels == "points":
        rows, count, _ = interpolated(pixels)
    return np.stack(list(equal_area_rows(rows, count)))


def equal_area_square(texels: Array) -> Array:
    """The same texels as a finer square, each pixel the mean of what it shows of them."""
    rows, columns = texels.shape[:2]
    size = min(_MAX_SQUARE, 2 ** math.ceil(math.log2(4 * math.sqrt(rows * columns))))
    across = (np.arange(_PARTS * size) + 0.5) / (_PARTS * size)
    found = []
    for row in across.reshape(size, _PARTS):
        directions = squares.direction(*np.meshgrid(across, row))
        azimuth = np.arctan2(directions[..., 1], directions[..., 0])
        at = (
            (rows * (1 - directions[..., 2]) / 2).astype(int),
            (columns * (0.5 - azimuth / (2 * np.pi))).astype(int),
        )
        seen = texels[np.minimum(at[0], rows - 1), np.minimum(at[1], columns - 1)]
        found.append(seen.reshape(_PARTS, size, _PARTS, 3).mean(axis=(0, 2)))
    return np.stack(found)


def latitudes_with_poles(texels: Array) -> Array:
    """The same texels as a finer picture whose rows are equal steps of angle, the first and last on the
    poles, and whose columns are areas.
    """
    rows, columns = texels.shape[:2]
    finer = max(1, min(_FINEST, int(np.sqrt(_MAX_PIXELS / (rows * columns)))))
    # A row is the mean of what is nearer to it than to its neighbours.
    parts = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    steps = np.clip(np.arange(finer * rows + 1)[:, None] + parts, 0, finer * rows)
    row = (rows * (1 - np.cos(np.pi * steps / (finer * rows))) / 2).astype(int)
    means = texels[np.minimum(row, rows - 1)].mean(axis=1)
    return np.asarray(np.repeat(means, finer, axis=1))
