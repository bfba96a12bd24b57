"""Means of Mitsuba's principled lobes in even light, by quadrature.

Its diffuse lobe, its flat one and its sheen are those of B. Burley, "Physically-Based Shading at Disney"
(SIGGRAPH 2012 course, section 5.3), which do not know of the glossy lobe beside them. Where our kernel
stands in their place, these means tell what base and what sheen send back as much.
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
    nodes, weights = unit_interval(_COSINES)
    return float(1 - np.sum(2 * weights * nodes * _reflected(nodes, max(1e-4, roughness**2), index)))


def _reflected(cosines: Array, alpha: float, index: float) -> Array:
    """E of principled.h: Fresnel's mean over the facets that are seen, times what white ones send back."""
    nodes, weights = unit_interval(_COSINES)
    s, across = nodes[:, None], np.cos(np.pi * nodes[None, :])
    slope = alpha * np.sqrt(1 - s**2) / s
    down = 1 / np.sqrt(1 + slope**2)
    found = []
    for o in cosines:
        facing = down * (o + np.sqrt(1 - o**2) * slope * across)
        seen = np.where(facing > 0, facing / down, 0.0) * s * weights[:, None] * weights
        seen = seen / seen.sum()
        i = np.clip(2 * facing * down - o, 1e-9, 1.0)
        long_o, long_i = (np.sqrt(alpha**2 * (1 - z**2) + z**2) for z in (o, i))
        passes = np.where(2 * facing * down > o, i * (o + long_o) / (i * long_o + o * long_i), 0.0)
        fresnel = reflectance_of(np.clip(facing, 1e-9, 1.0), index)
        found.append(np.sum(seen * fresnel) * np.sum(seen * passes))
    return np.array(found)
