"""Roughness as pbrt-v3 has it."""

import math
from collections.abc import Sequence

# RoughnessToAlpha in src/core/microfacet.h of pbrt-v3: of the logarithm of a roughness of 0.001 or more.
_ALPHA = (1.62142, 0.819955, 0.1734, 0.0171201, 0.000640711)


def alpha_of(roughness: float, *, remap: bool) -> float:
    """Alpha of the microfacets, at most 1; 0 is polished."""
    if not remap or roughness == 0:
        return min(roughness, 1.0)
    x = math.log(max(roughness, 1e-3))
    return min(1.0, _polynomial(_ALPHA, x))


def _polynomial(coefficients: Sequence[float], x: float) -> float:
    return sum(coefficient * x**power for power, coefficient in enumerate(coefficients))
