"""A second method for slabs of media: independent random walks, without geometry, in double precision."""

from functools import cache

import numpy as np
import numpy.typing as npt


@cache
def slab(
    albedo: float, g: float, thickness: float, photons: int = 400_000, seed: int = 1
) -> tuple[float, float]:
    """Transmittance of a slab for light along its normal, and its standard error.

    Henyey-Greenstein phase function (inverted as in Witt, Astrophysical Journal Suppl. 35, 1977); a photon's
    weight is multiplied by the albedo at every collision, and it ends by leaving.
    """
    random = np.random.default_rng(seed)
    depth, cosine, weight = np.zeros(photons), np.ones(photons), np.ones(photons)
    through = np.zeros(photons)
    alive = np.arange(photons)
    while alive.size:
        depth[alive] += cosine[alive] * random.exponential(size=alive.size)
        out = depth[alive] > thickness
        through[alive[out]] = weight[alive[out]]
        alive = alive[~out & (depth[alive] > 0.0) & (weight[alive] > 1e-9)]
        weight[alive] *= albedo
        turn = _henyey_greenstein(g, random.random(alive.size))
        sines = np.sqrt(np.maximum(0.0, 1.0 - cosine[alive] ** 2) * np.maximum(0.0, 1.0 - turn**2))
        cosine[alive] = cosine[alive] * turn + sines * np.cos(2.0 * np.pi * random.random(alive.size))
    return float(through.mean()), float(through.std(ddof=1) / photons**0.5)


def _henyey_greenstein(g: float, u: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    if g == 0.0:
        return 1.0 - 2.0 * u
    share = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
    cosine: npt.NDArray[np.float64] = np.clip((1.0 + g * g - share * share) / (2.0 * g), -1.0, 1.0)
    return cosine
