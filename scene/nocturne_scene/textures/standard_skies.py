"""The CIE standard general sky: how bright each direction is, relative to the zenith.

CIE S 011/E:2003 (ISO 15469:2004), "Spatial distribution of daylight - CIE standard general sky": luminance is
the product of a gradation phi(Z) from the zenith to the horizon and an indicatrix f(chi) of the angle from
the Sun, each with its value for the zenith taken out. Fifteen types, after Kittler, Perez and Darula (1997);
the sixteenth is the older overcast sky of Moon and Spencer (1942).
"""

import math
from collections.abc import Callable

import numpy as np

from nocturne_scene.spectra.published import Floats

OVERCAST = 16
"""The type of the older overcast sky, (1 + 2 cos Z) / 3."""

_GRADATION = {
    1: (4.0, -0.70),
    2: (1.1, -0.80),
    3: (0.0, -1.0),
    4: (-1.0, -0.55),
    5: (-1.0, -0.32),
    6: (-1.0, -0.15),
}
_INDICATRIX = {
    1: (0.0, -1.0, 0.0),
    2: (2.0, -1.5, 0.15),
    3: (5.0, -2.5, 0.30),
    4: (10.0, -3.0, 0.45),
    5: (16.0, -3.0, 0.30),
    6: (24.0, -2.8, 0.15),
}
# Table 1 of the standard: groups of gradation and indicatrix by type.
_GROUPS = {
    1: (1, 1),
    2: (1, 2),
    3: (2, 1),
    4: (2, 2),
    5: (3, 1),
    6: (3, 2),
    7: (3, 3),
    8: (3, 4),
    9: (4, 2),
    10: (4, 3),
    11: (4, 4),
    12: (5, 4),
    13: (5, 5),
    14: (6, 5),
    15: (6, 6),
}

_PARTS = 4
"""Points along each edge of a texel whose mean it is."""


def needs_sun(kind: int) -> bool:
    """Whether the luminance depends on where the Sun is."""
    return kind != OVERCAST and _GROUPS[kind][1] != 1


def relative_luminance(kind: int, cos_zenith: Floats, cos_from_sun: Floats, cos_sun: float) -> Floats:
    """Luminance over that of the zenith, at angles with these cosines, `cos_zenith` above 0.

    `cos_sun`: of the Sun's own angle from the zenith.
    """
    if kind == OVERCAST:
        return np.asarray((1 + 2 * cos_zenith) / 3, dtype=np.float64)
    gradation, indicatrix = _GROUPS[kind]
    a, b = _GRADATION[gradation]
    c, d, e = _INDICATRIX[indicatrix]

    def phi(cosine: Floats) -> Floats:
        return np.asarray(1 + a * np.exp(b / cosine), dtype=np.float64)

    def f(cosine: Floats) -> Floats:
        angle = np.arccos(np.clip(cosine, -1.0, 1.0))
        return np.asarray(
            1 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2)) + e * cosine**2, dtype=np.float64
        )

    at_zenith = float(phi(np.ones(1))[0] * f(np.full(1, cos_sun))[0])
    return np.asarray(phi(cos_zenith) * f(cos_from_sun) / at_zenith, dtype=np.float64)


def texels(kind: int, cos_sun: float, rows: int, columns: int) -> Floats:
    """Luminances of a standard sky, relative to its zenith: see `mean_texels`."""
    return mean_texels(
        lambda cos_zenith, cos_from_sun: relative_luminance(kind, cos_zenith, cos_from_sun, cos_sun),
        cos_sun,
        rows,
        columns,
    )


def mean_texels(
    luminance: Callable[[Floats, Floats], Floats], cos_sun: float, rows: int, columns: int
) -> Floats:
    """Means of an equal-area map, shape (rows, columns); 0 below the horizon.

    `luminance`: of directions at angles with these cosines from the zenith and from the Sun. Rows are equal
    steps of z from 1 to -1, columns equal steps of azimuth from the Sun's. `rows` is even.
    """
    upper = rows // 2 * _PARTS
    z = 1 - (np.arange(upper) + 0.5) / upper
    azimuth = 2 * np.pi * (np.arange(columns * _PARTS) + 0.5) / (columns * _PARTS)
    sin_sun = np.sqrt(max(0.0, 1 - cos_sun**2))
    from_sun = cos_sun * z[:, None] + sin_sun * np.sqrt(1 - z**2)[:, None] * np.cos(azimuth)
    values = luminance(np.broadcast_to(z[:, None], from_sun.shape), from_sun)
    means = values.reshape(rows // 2, _PARTS, columns, _PARTS).mean(axis=(1, 3))
    return np.concatenate([means, np.zeros_like(means)])


def illuminance(luminances: Floats) -> float:
    """That of the ground below such a map, lx for cd/m2: the integral of luminance times cosine."""
    rows = len(luminances)
    z = 1 - 2 * (np.arange(rows) + 0.5) / rows
    whole: float = np.sum(luminances * np.maximum(z, 0.0)[:, None]) * 4 * math.pi
    return whole / luminances.size
