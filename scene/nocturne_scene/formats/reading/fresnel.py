"""Fresnel's equations."""

import numpy as np
from numpy.typing import NDArray


def reflectance_of(cosine: NDArray[np.float64], index: float) -> NDArray[np.float64]:
    """Of unpolarised light at a cosine in [0, 1]; 1 beyond the critical angle.

    `index`: behind the surface, relative to before it.
    """
    squared = 1 - (1 - cosine**2) / index**2
    refracted = np.sqrt(np.maximum(squared, 0))
    parallel = (index * cosine - refracted) / (index * cosine + refracted)
    across = (cosine - index * refracted) / (cosine + index * refracted)
    return np.where(squared > 0, (parallel**2 + across**2) / 2, 1.0)
