"""Metals of which only a colour is known."""

from collections.abc import Sequence

import numpy as np

from nocturne_scene.compile import spectra
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra import indices

# What reflects all has no index.
_MOST = 0.999

FROM_RGB = (
    "three numbers for an index became a smooth spectrum, twice the largest times a reflectance, as pbrt does"
)
"""A note for indices of which only RGB is known."""


def part_of_rgb(rgb: Sequence[float]) -> Json:
    """n or k of three numbers, not negative, as pbrt-v4 takes them: `colours.coefficient`.

    Mitsuba 3 takes them by channel in its RGB variants; its spectral ones (3.9.1) hold both at 1, so that all
    metals look alike. It is no measured metal: copper of n = (0.200, 0.924, 1.102) and k = (3.912, 2.452,
    2.142) has the colour (0.98, 0.62, 0.51) at normal incidence, and Fresnel's equations by channel give
    (0.95, 0.62, 0.51).
    """
    return colours.coefficient(rgb)


def of_colour(reflectance: Json) -> Json:
    """An index whose reflectance at normal incidence is that: of n = 1 it is k^2 / (4 + k^2).

    In even light it reflects 2 % less than Schlick's approximation where that is 0.8, 1 % more where it is
    0.5, and 19 % more where it is 0.2.
    """
    at = colours.knots(reflectance)
    held = np.clip(colours.values_of(reflectance, at), 0.0, _MOST)
    return {"n": 1.0, "k": colours.table(at, 2 * np.sqrt(held / (1 - held)))}


def colour_under(index: Json, outside: float) -> Json:
    """What a metal of an index reflects at normal incidence under a medium, by Fresnel's equations."""
    at = colours.SMOOTH
    if isinstance(index, str):
        n, k = (spectra.evaluate(each, at) for each in indices.compile_metal(index))
    else:
        n, k = (colours.values_of(index[name], at) for name in ("n", "k"))
    return colours.table(at, ((n - outside) ** 2 + k**2) / ((n + outside) ** 2 + k**2))
