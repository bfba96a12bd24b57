"""Responses whose readings tell a light's colour: how it renders colours, and what eyes do with it.

Cubic B-splines over `published.COLOUR_RANGE` with knots each 10 nm. Any weight that is smooth at that
scale, as products of observers and test colours are, is nearly a sum of them, so its integral with the
light is known from their readings, wherever the light's lines are. Ra of the CIE's lamps is right within
0.03, Rf within 0.01; of three lines of 1 nm Ra within 0.4. Means over bands of 10 nm give Ra of FL2 0.4 too
high.
"""

from functools import lru_cache

import numpy as np

from nocturne_scene.spectra import published
from nocturne_scene.spectra.published import Floats

STEP = 10
"""nm, between knots."""

_DEGREE = 3

COUNT = (published.COLOUR_RANGE[1] - published.COLOUR_RANGE[0]) // STEP + _DEGREE
"""As many as `nocturne_scene.responses.COLOUR` has."""


@lru_cache(maxsize=1)
def responses() -> Floats:
    """Shape (401, COUNT), at `colour_wavelengths`; not negative, of sum 1."""
    # So that what needs no colours starts without it.
    from scipy.interpolate import BSpline

    first, last = published.COLOUR_RANGE
    ends = [first] * _DEGREE, [last] * _DEGREE
    knots = np.concatenate([ends[0], np.arange(first, last + 1, STEP), ends[1]]).astype(np.float64)
    found = BSpline.design_matrix(published.colour_wavelengths(), knots, _DEGREE).toarray()
    return np.asarray(found, dtype=np.float64)


def on_basis(weights: Floats) -> Floats:
    """What readings are to be multiplied by to be integrals with these weights, shape (401, n): (COUNT, n);
    least squares."""
    return np.asarray(_inverse() @ weights, dtype=np.float64)


@lru_cache(maxsize=1)
def _inverse() -> Floats:
    return np.asarray(np.linalg.pinv(responses()), dtype=np.float64)
