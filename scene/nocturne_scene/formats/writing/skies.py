"""Environment maps as other renderers have them."""

import numpy as np

from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.formats.writing.tables import Array
from nocturne_scene.textures.environment_maps import equal_area_rows, interpolated, read_whole

# Pixels of the picture that is made: the more, the narrower are the seams between texels.
_MAX_PIXELS = 2**22
_FINEST = 16
_PARTS = 8


def texels_of(environment: EnvironmentMap, blobs: BlobStore) -> Array:
    """What the tracer makes of a map: rows of equal steps of height, linear sRGB, (rows, columns, 3)."""
    pixels = read_whole(blobs.path(environment.asset.removeprefix("sha256:")))
    rows, count = iter(pixels), len(pixels)
    if environment.pixels == "points":
        rows, count, _ = interpolated(pixels)
    return np.stack(list(equal_area_rows(rows, count)))


def latitudes_with_poles(texels: Array) -> Array:
    """The same texels as a finer picture whose rows are equal steps of angle, the first and last on the
    poles, and whose columns are areas.
    """
    rows, columns = texels.shape[:2]
    finer = max(1, min(_FINEST, int(np.sqrt(_MAX_PIXELS / (rows * columns)))))
    # A row is the mean of the places that are nearer to it than to its neighbours.
    parts = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    steps = np.clip(np.arange(finer * rows + 1)[:, None] + parts, 0, finer * rows)
    row = (rows * (1 - np.cos(np.pi * steps / (finer * rows))) / 2).astype(int)
    means = texels[np.minimum(row, rows - 1)].mean(axis=1)
    return np.asarray(np.repeat(means, finer, axis=1))
