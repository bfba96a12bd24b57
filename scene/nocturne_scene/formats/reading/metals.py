"""Metals of which only a colour is known."""

import numpy as np

from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.scene_writer import Json

# What reflects all has no index.
_MOST = 0.999


def of_colour(reflectance: Json) -> Json:
    """An index whose reflectance at normal incidence is that: of n = 1 it is k^2 / (4 + k^2).

    In even light it reflects 2 % less than Schlick's approximation where that is 0.8, 1 % more where it is
    0.5, and 19 % more where it is 0.2.
    """
    at = colours.knots(reflectance)
    held = np.clip(colours.values_of(reflectance, at), 0.0, _MOST)
    return {"n": 1.0, "k": colours.table(at, 2 * np.sqrt(held / (1 - held)))}
