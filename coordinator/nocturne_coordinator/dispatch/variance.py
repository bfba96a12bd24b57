"""How far a pixel's mean may be off, from its sums. Pure."""

import numpy as np
import numpy.typing as npt

from nocturne_coordinator.dispatch.merge import Counts, Sums

Pixels = npt.NDArray[np.float64]


def variance_of_mean(sums: Sums, counts: Counts) -> Pixels:
    """Estimated variance of each pixel's mean Y, shape (height, width); 0 below two samples."""
    n = np.maximum(counts, 2).astype(np.float64)
    y = sums[..., 1]
    variance: Pixels = np.maximum(0.0, (sums[..., 3] - y * y / n) / (n * (n - 1.0)))
    variance[counts < 2] = 0.0
    return variance
