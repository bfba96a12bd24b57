"""How errors of X, Y, Z and further responses go together, by tiles: what quantities made of many responses,
such as colour rendering, need for their own errors.

Of each tile there is a correlation for each pair of values, of the errors of their means over the tile's
pixels: the second value with the first, the third with both, and so on. Images have them as an attribute,
float32, little endian, in base64 (as worker/src/image/write_exr.cpp writes it).
"""

import base64
import binascii

import numpy as np

from nocturne_scene.pixel_errors import covariance_of_means
from nocturne_scene.tile_sums import Counts, Values, factors_of_tile

ATTRIBUTE = "nocturne:correlations"

MOST = 2**22
"""Numbers in an image's attribute; of larger films and more responses there is none."""


def correlations_of_tiles(of_tiles: Values, products: Values, counts: Counts) -> Values:
    """From sums of all values over tiles, shape (down, across, values), tiles' products and samples."""
    values = of_tiles.shape[-1]
    one, other = factors_of_tile(values - len("XYZ"))
    n = counts[..., None]
    found = covariance_of_means(products, of_tiles[..., one], of_tiles[..., other], n)
    whole = np.zeros((*found.shape[:2], values, values))
    whole[..., one, other] = whole[..., other, one] = found
    errors = np.sqrt(np.maximum(np.diagonal(whole, axis1=-2, axis2=-1), 0.0))
    both = errors[..., :, None] * errors[..., None, :]
    whole = np.divide(whole, both, out=np.zeros_like(whole), where=both > 0.0)
    below: Values = np.clip(whole[..., *np.tril_indices(values, -1)], -1.0, 1.0)
    return below


def matrix(correlations: Values, values: int) -> Values:
    """Of one tile, whole."""
    found = np.eye(values)
    rows, columns = np.tril_indices(values, -1)
    found[rows, columns] = found[columns, rows] = correlations
    return found


def encode(correlations: Values) -> str:
    """Empty where these are too many."""
    if correlations.size > MOST:
        return ""
    return base64.b64encode(correlations.astype("<f4").tobytes()).decode("ascii")


def decode(text: str, shape: tuple[int, int], values: int) -> Values | None:
    """Of so many tiles down and across; None where there are none."""
    try:
        found = np.frombuffer(base64.b64decode(text, validate=True), dtype="<f4")
    except (binascii.Error, ValueError):
        return None
    pairs = values * (values - 1) // 2
    if found.size == 0 or found.size != shape[0] * shape[1] * pairs:
        return None
    return found.reshape(*shape, pairs).astype(np.float64)
