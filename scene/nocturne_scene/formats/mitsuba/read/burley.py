"""Means of Mitsuba's principled lobes in even light, by quadrature.

Its diffuse lobe, its flat one and its sheen are those of B. Burley, "Physically-Based Shading at Disney"
(SIGGRAPH 2012 course, section 5.3), which ignore the glossy lobe. Where our kernel stands in their place,
these means give the base and the sheen that send back as much.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading.fresnel import reflectance_of
from nocturne_scene.formats.reading.rough_coats import unit_interval

Array = NDArray[np.float64]

_COSINES, _AZIMUTHS = 24, 48

SHEEN_ROUGHNESS = 0.5
"""Of our fuzz where it stands for Burley's sheen: the width at which both look most alike by eye."""


@lru_cache(maxsize=1)
def _pairs() -> tuple[Array, Array, Array, Array]:
    """Cosines of two directions and of the angle between each and their half vector; weights of sum 1."""
    nodes, weights = unit_interval(_COSINES)
    azimuths = np.pi * (np.arange(_AZIMUTHS) + 0.5) / _AZIMUTHS
    o, i, phi = np.meshgrid(nodes, nodes, azimuths, indexing="ij")
    between = o * i + np.sqrt((1 - o**2) * (1 - i**2)) * np.cos(phi)
    each = 2 * nodes * weights
    weight = each[:, None, None] * each[None, :, None] / _AZIMUTHS
    return o, i, np.sqrt(0.5 * (1 + between)), np.broadcast_to(weight, o.shape)


def _schlick(cosine: Array) -> Array:
    return np.asarray((1 - cosine) ** 5)


def diffuse_albedo(roughness: float, flatness: float) -> float:
    """Of a white base."""
    o, i, half, weight = _pairs()
    fo, fi, retro = _schlick(o), _schlick(i), 2 * roughness * half**2
    lobe = (1 - 0.5 * fo) * (1 - 0.5 * fi) + retro * (fo + fi + fo * fi * (retro - 1))
    flat = (1 + fo * (retro / 2 - 1)) * (1 + fi * (retro / 2 - 1))
    flat = 1.25 * (flat * (1 / (o + i) - 0.5) + 0.5)
    return float(np.sum(weight * (lobe + flatness * (flat - lobe))))


def sheen_albedo() -> float:
    """Of white sheen there over that of white sheen here."""
    o, i, half, weight = _pairs()
    theirs = np.pi * _schlick(half)
    # worker/src/kernels/sheen.h
    power = 1 / SHEEN_ROUGHNESS**2
    across = np.sqrt(np.clip(1 - ((o + i) / (2 * half)) ** 2, 0.0, 1.0))
    ours = np.pi * (2 + power) * across**power / (2 * np.pi) / (4 * (o + i - o * i))
    return float(np.sum(weight * theirs) / np.sum(weight * ours))


def passing(roughness: float, index: float) -> float:
    """What our dielectric lets through to its base, of even light."""
    return 1 - _glossy(roughness, index)[0]


def lost_between_facets(roughness: float, index: float) -> float:
    """What our glossy lobe sends back of even light, and theirs does not: its facets shadow on their own."""
    _, ours, theirs = _glossy(roughness, index)
    return ours - theirs


@lru_cache(maxsize=64)
def _glossy(roughness: float, index: float) -> tuple[float, float, float]:
    """Means over even light: E of principled.h, what single facets send back here, and there."""
    alpha = max(1e-4, roughness**2)
    cosines, weights = unit_interval(_COSINES)
    s, across = cosines[:, None], np.cos(np.pi * cosines[None, :])
    slope = alpha * np.sqrt(1 - s**2) / s
    down = 1 / np.sqrt(1 + slope**2)
    found = []
    for o in cosines:
        facing = down * (o + np.sqrt(1 - o**2) * slope * across)
        seen = np.where(facing > 0, facing / down, 0.0) * s * weights[:, None] * weights
        seen = seen / seen.sum()
        i = np.clip(2 * facing * down - o, 1e-9, 1.0)
        long_o, long_i = (np.sqrt(alpha**2 * (1 - z**2) + z**2) for z in (o, i))
        above = 2 * facing * down > o
        together = np.where(above, i * (o + long_o) / (i * long_o + o * long_i), 0.0)
        alone = np.where(above, 2 * i / (i + long_i), 0.0)
        fresnel = seen * reflectance_of(np.clip(facing, 1e-9, 1.0), index)
        found.append(
            (np.sum(fresnel) * np.sum(seen * together), np.sum(fresnel * together), np.sum(fresnel * alone))
        )
    e, ours, theirs = (2 * weights * cosines) @ np.array(found)
    return float(e), float(ours), float(theirs)
