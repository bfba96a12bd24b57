"""Environment maps for renderers that interpolate between pixels, which the tracer does not."""

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

from nocturne_coordinator.blobs import BlobStore
from nocturne_coordinator.exporting.compiled import Array
from nocturne_coordinator.scene.environment_maps import equal_area_rows, opened

# Pixels of the picture that is made: the more, the narrower are the seams between texels.
_MOST_PIXELS = 2**22
_FINEST = 16
_PARTS = 8


def texels_of(sha256: str, blobs: BlobStore) -> Array:
    """What the tracer makes of a map: rows of equal steps of height, linear sRGB, (rows, columns, 3)."""
    with opened(blobs.path(sha256)) as picture:
        pixels = np.asarray(picture.read_image(0, 0, 0, 3, oiio.FLOAT), dtype=np.float32)
        rows = np.maximum(pixels.reshape(picture.spec().height, picture.spec().width, 3), 0)
    return np.stack(list(equal_area_rows(iter(rows), len(rows))))


def latitudes_with_poles(texels: Array) -> Array:
    """The same texels as a finer picture whose rows are equal steps of angle, the first and last on the
    poles, and whose columns are areas.
    """
    rows, columns = texels.shape[:2]
    finer = max(1, min(_FINEST, int(np.sqrt(_MOST_PIXELS / (rows * columns)))))
    # A row is the mean of what is nearer to it than to its neighbours.
    parts = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    steps = np.clip(np.arange(finer * rows + 1)[:, None] + parts, 0, finer * rows)
    row = (rows * (1 - np.cos(np.pi * steps / (finer * rows))) / 2).astype(int)
    means = texels[np.minimum(row, rows - 1)].mean(axis=1)
    return np.asarray(np.repeat(means, finer, axis=1))
