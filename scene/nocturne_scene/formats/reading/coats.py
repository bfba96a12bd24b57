"""The base under a coat, so that as much light leaves it as in another renderer.

Under a coat of relative index n light bounces between base and coat: of a base of reflectance R leaves
R / (1 - R E), E being what the coat reflects back inside of evenly distributed light. glTF, whose base colour
is R, and Mitsuba's plastics without `nonlinear` let no colour saturate and say R / (1 - e) instead, with the
e of the other renderer. Mitsuba's rough coats lose light besides (rough_coats.py): on the way in and on the
way out a factor c. So all are the coated diffuse kernel with another base: from
R' / (1 - R' E) = c^2 R / (1 - e) = G follows R' = G / (1 + G E).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading.fresnel import reflectance_of
from nocturne_scene.formats.reading.rough_coats import Facets, unit_interval
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra import rgb as rgb_spectra

# nm between the knots of the base's table: smooth spectra are straight lines in between.
_STEP = 5.0
# Cosines from 0 to 1 at which Mitsuba's roughplastic looks.
_COSINES = 64

# Of the mean over cosines.
_NODES, _WEIGHTS = unit_interval(100)


@dataclass(frozen=True)
class Coat:
    """What a base's light meets."""

    inside: float
    """E: the part of evenly distributed light that the kernel's coat reflects back."""
    theirs: float
    """e: the same in the other renderer."""
    passing: float = 1.0
    """c^2: of evenly distributed light, what the other coat lets in and out again, over what ours does."""

    def changed(self, value: NDArray[np.float64], *, linear: bool) -> NDArray[np.float64]:
        """R' of R, held at 1."""
        gain = self.passing * value / (1 - (self.theirs if linear else value * self.theirs))
        return np.clip(gain / (1 + gain * self.inside), 0.0, 1.0)


def smooth_coat(index: float) -> Coat:
    """Of a relative index."""
    inside = _inside(_mean(reflectance_of(_NODES, index)), index)
    return Coat(inside, inside)


@lru_cache(maxsize=4096)  # Every shape that refers to a material asks for it again.
def rough_coat(index: float, alpha: float, distribution: str) -> Coat:
    """The same with facets of Mitsuba's. The kernel's coat lets through what GGX facets of that alpha do."""
    ours, _, _ = Facets(alpha, "ggx").means(_NODES, index)
    facets = Facets(alpha, distribution)
    _, _, through = facets.means(_NODES, index)
    # Both ends among so few values: 1.5 % too small for a smooth coat.
    cosines = np.linspace(0.0, 1.0, _COSINES)
    _, back, _ = facets.means(cosines, 1 / index)
    return Coat(
        inside=_inside(_mean(ours), index),
        theirs=float(np.mean(2 * cosines * back)),
        passing=(_mean(through) / (1 - _mean(ours))) ** 2,
    )


def base_under(coat: Coat, reflectance: Json, *, linear: bool) -> Json:
    """The base R' for the R of a number, a table or a colour."""
    if isinstance(reflectance, float):
        return float(coat.changed(np.array(reflectance), linear=linear))
    if "table" in reflectance:
        knots = np.array(reflectance["table"])
        # Between the knots R' is no straight line.
        at = np.union1d(knots[:, 0], np.arange(knots[0, 0], knots[-1, 0], _STEP))
        values = coat.changed(np.interp(at, knots[:, 0], knots[:, 1]), linear=linear)
        return reflectance | {"table": np.stack([at, values], 1).tolist()}
    at = np.arange(360.0, 830.0 + _STEP, _STEP)
    values = rgb_spectra.spectra_of(rgb_spectra.rgb_to_coefficients(np.array(reflectance["rgb"])), at)
    return {"table": np.stack([at, coat.changed(values, linear=linear)], 1).tolist()}


def _mean(values: NDArray[np.float64]) -> float:
    """Of evenly distributed light that comes at _NODES."""
    return float(np.sum(2 * _WEIGHTS * _NODES * values))


def _inside(outer: float, index: float) -> float:
    """The reflectance inside, from that outside: as much light is let through in both directions."""
    return 1 - (1 - outer) / index**2
