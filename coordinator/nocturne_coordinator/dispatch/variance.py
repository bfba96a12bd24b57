"""How far a pixel's mean may be off, from its sums. Pure."""

import numpy as np
import numpy.typing as npt
from nocturne_scene import uncertainty

from nocturne_coordinator.dispatch.merge import Counts, Sums

Pixels = npt.NDArray[np.float64]


def variance_of_mean(sums: Sums, counts: Counts) -> Pixels:
    """Estimated variance of each pixel's mean Y, shape (height, width); 0 below two samples."""
    return uncertainty.variance_of_mean(sums[..., 1], sums[..., 3], counts)
