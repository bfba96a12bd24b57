"""What a rough coat lets through: in Mitsuba's roughplastic, and in the coated diffuse kernel.

Both send T(wi) T(wo) R / (pi n^2 (1 - R E)) off the base, and differ in T and E. In the kernel all that the
first facet does not reflect goes through. In Mitsuba light, reflected or refracted, counts only as far as it
then gets by the other facets, from outside and from inside; the rest is lost.
Facets: B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading.fresnel import reflectance_of

Array = NDArray[np.float64]

# Of alpha in Mitsuba.
_LEAST = 1e-4
_NODES = 64


@dataclass(frozen=True)
class Facets:
    """Normals of one alpha: "ggx" or "beckmann"."""

    alpha: float
    distribution: str

    def means(self, cosine: Array, index: float) -> tuple[Array, Array, Array]:
        """Of light that comes at such cosines (positive): over the facets that it sees.

        Returns the reflected part; how much of that passes the other facets; and how much of the
        refracted light does. `index`: behind the surface, relative to before it.
        """
        nodes, weights = unit_interval(_NODES)
        # Facets are seen by D(m) G1 (w . m) / w.z. As many of them lie beyond a slope as s^2: its square root
        # makes the integrand a smooth function.
        s, u = nodes[:, None], nodes[None, :]
        alpha = max(self.alpha, _LEAST)
        slope = alpha * (np.sqrt(1 - s**2) / s if self.distribution == "ggx" else np.sqrt(-2 * np.log(s)))
        across = np.cos(np.pi * u)
        found = []
        for each in np.maximum(cosine, 1e-6):
            sine = np.sqrt(1 - each**2)
            down = 1 / np.sqrt(1 + slope**2)
            facing = down * (each + sine * slope * across)
            seen = np.where(facing > 0, facing / (each * down), 0.0) * 2 * s
            seen = seen * weights[:, None] * weights
            seen = seen / seen.sum()
            held = np.clip(facing, 1e-9, 1.0)
            share = reflectance_of(held, index)
            mirrored = 2 * facing * down - each
            cosine_in = np.sqrt(np.maximum(1 - (1 - held**2) / index**2, 0.0))
            refracted = (cosine_in - facing / index) * down + each / index
            back = share * np.where(mirrored > 0, self._passing(mirrored), 0.0)
            through = (1 - share) * np.where(refracted > 0, self._passing(refracted), 0.0)
            found.append([np.sum(seen * part) for part in (share, back, through)])
        share, back, through = np.array(found).T
        return share, back, through

    def _passing(self, cosine: Array) -> Array:
        """Smith's term for one direction; Walter et al., eq. 27 and 34."""
        held = np.clip(cosine, 1e-9, 1.0)
        tangent = np.maximum(np.sqrt(1 - held**2) / held * max(self.alpha, _LEAST), 1e-9)
        if self.distribution == "ggx":
            return np.asarray(2 / (1 + np.sqrt(1 + tangent**2)))
        a = 1 / tangent
        return np.where(a < 1.6, (3.535 * a + 2.181 * a**2) / (1 + 2.276 * a + 2.577 * a**2), 1.0)


def unit_interval(count: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss and Legendre's rule on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (nodes + 1), 0.5 * weights
