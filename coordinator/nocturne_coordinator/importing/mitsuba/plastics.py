"""A base under a coat that lets colour saturate, as one that does not.

Under a coat of relative index n light bounces between base and coat: of a base of reflectance R leaves
R / (1 - R E), E being what the coat reflects back inside of evenly distributed light. Mitsuba's plastics
without `nonlinear` say R / (1 - E) instead, so they are the coated diffuse kernel with another base: from
R' / (1 - R' E) = R / (1 - e) follows R' = R / (1 - e + R E). e is the E that Mitsuba computes: for rough
coats the mean of 64 values, both ends among them, which is 1.5 % too small and makes them 2 % darker.
"""

import numpy as np
from numpy.typing import NDArray

from nocturne_coordinator.importing.scene_writer import Json
from nocturne_coordinator.scene import rgb_spectra

# nm between the knots of the base's table: smooth spectra are straight lines in between.
_STEP = 5.0


# Cosines from 0 to 1 at which Mitsuba's roughplastic looks.
_COSINES = 64


def linear_base(reflectance: Json, index: float, *, rough: bool) -> Json:
    """The base R' of a coat; a rough one's E is taken as a smooth one's."""
    inside = inner_reflectance(index)
    theirs = inner_mean(index) if rough else inside

    def changed(value: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.clip(value / (1 - theirs + value * inside), 0.0, 1.0)

    if isinstance(reflectance, float):
        return float(changed(np.array(reflectance)))
    if "table" in reflectance:
        knots = np.array(reflectance["table"])
        # Between the knots R' is no straight line.
        at = np.union1d(knots[:, 0], np.arange(knots[0, 0], knots[-1, 0], _STEP))
        values = changed(np.interp(at, knots[:, 0], knots[:, 1]))
        return reflectance | {"table": np.stack([at, values], 1).tolist()}
    at = np.arange(360.0, 830.0 + _STEP, _STEP)
    values = rgb_spectra.spectra_of(rgb_spectra.rgb_to_coefficients(np.array(reflectance["rgb"])), at)
    return {"table": np.stack([at, changed(values)], 1).tolist()}


def inner_reflectance(index: float) -> float:
    """Of evenly distributed light from inside: 1 - (1 - E_out) / n^2, E_out that of light from outside."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    cosine, weight = 0.5 * (nodes + 1), 0.5 * weights
    outer = float(np.sum(2 * weight * cosine * _fresnel(cosine, index)))
    return 1 - (1 - outer) / index**2


def inner_mean(index: float) -> float:
    """The same as a mean of few values."""
    cosine = np.maximum(np.linspace(0.0, 1.0, _COSINES), 1e-6)
    return float(np.mean(2 * cosine * _fresnel(cosine, 1 / index)))


def _fresnel(cosine: NDArray[np.float64], index: float) -> NDArray[np.float64]:
    """Fresnel's reflectance, unpolarised, from outside; 1 beyond the critical angle."""
    squared = 1 - (1 - cosine**2) / index**2
    refracted = np.sqrt(np.maximum(squared, 0))
    parallel = (index * cosine - refracted) / (index * cosine + refracted)
    across = (cosine - index * refracted) / (cosine + index * refracted)
    return np.where(squared > 0, (parallel**2 + across**2) / 2, 1.0)
