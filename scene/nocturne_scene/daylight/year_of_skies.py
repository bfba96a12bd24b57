"""What sky and Sun shine on each hour of a weather file, by patches."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.daylight import perez
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.solar_position import sun_at
from nocturne_scene.daylight.weather_files import WeatherYear
from nocturne_scene.spectra.published import Floats

_LOWEST_SUN = 89.0
"""Degrees from the zenith: in an hour with the Sun on the horizon the sky is that of a Sun just above."""
_TOGETHER = 512
"""Hours whose skies are made at once."""


@dataclass(frozen=True)
class YearOfSkies:
    """Of the hours in which there is any light, in their order."""

    hours: NDArray[np.intp]
    """Their numbers in the year."""
    luminances: Floats
    """By hour and patch, cd/m2: the first is that of the ground beyond the scene."""
    sun_towards: Floats
    """Unit vectors to the east, to the north and up."""
    sun_illuminance: Floats
    """Across the beam, lx; 0 without Sun."""

    @property
    def sunny(self) -> NDArray[np.intp]:
        """Which of these hours have the Sun."""
        return np.flatnonzero(self.sun_illuminance > 0.0)


def skies_of(year: WeatherYear, patches: Patches, ground_reflectance: float) -> YearOfSkies:
    """The skies of Perez, Seals and Michalsky 1993. The Sun is where it is in the middle of each hour."""
    sun = sun_at(year.julian_days, year.place)
    hours = np.flatnonzero(year.diffuse_horizontal > 0.0)
    zenith, towards = sun.zenith[hours], sun.towards()[hours]
    direct = np.where(zenith < 90.0, year.direct_normal[hours], 0.0)
    sky = perez.sky_of(
        perez.Weather(
            direct_normal=direct,
            diffuse_horizontal=year.diffuse_horizontal[hours],
            sun_zenith=np.minimum(zenith, _LOWEST_SUN),
            distance=sun.distance[hours],
            dew_point=year.dew_point[hours],
        )
    )
    points = patches.points
    cosines = patches.solid_angles[1:] * points[..., 2].mean(axis=1)
    luminances = np.zeros((len(hours), patches.count))
    for first in range(0, len(hours), _TOGETHER):
        some = slice(first, first + _TOGETHER)
        from_sun = np.einsum("ptk,hk->hpt", points, towards[some])
        found = perez.relative_luminance(sky.parameters[some, None, None], points[..., 2], from_sun)
        means = found.mean(axis=-1)
        means[~np.any(means > 0.0, axis=-1)] = 1.0
        wanted = sky.diffuse_illuminance[some] / np.maximum(means @ cosines, 1e-12)
        luminances[some, 1:] = wanted[:, None] * means
    level = sky.diffuse_illuminance + sky.direct_illuminance * np.maximum(0.0, np.cos(np.radians(zenith)))
    luminances[:, 0] = ground_reflectance * level / np.pi
    return YearOfSkies(hours, luminances, towards, sky.direct_illuminance)
