"""Skies of Radiance: `source` primitives, and the brightness functions that gensky and gendaylit write.

Radiance's own skybright.cal and perezlum.cal are repeated, with their blend of sky and ground at the horizon:
its overcast sky is not quite the CIE's.
"""

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.radiance.read.materials import EFFICACY
from nocturne_scene.formats.radiance.read.primitives import Primitive

Values = NDArray[np.float64]

FUNCTION = ("skybr", "skybright.cal")
"""Of gensky."""
ALL_WEATHER = ("skybright", "perezlum.cal")
"""Of gendaylit."""
ROWS = 512
"""Of a picture of the sky."""


def brightness(function: Primitive, towards: Values) -> Values:
    """Of a brightfunc of skybright.cal or perezlum.cal, at unit vectors with z up. Raises InputError."""
    given = function.numbers
    if function.texts[:2] == ALL_WEATHER and len(given) == 10:
        sky = _all_weather(np.array(given[2:7]), np.array(given[7:]), towards)
        return _blended(given[0] * sky, given[1], towards[..., 2])
    if function.texts[:2] != FUNCTION or len(given) not in (3, 7):
        raise InputError.at(
            function.place,
            f"the function {' '.join(function.texts)} is not read; read are those of gensky and gendaylit",
        )
    kind, zenith, ground = given[:3]
    up = np.clip(towards[..., 2], -1.0, 1.0)
    if kind not in (1.0, 2.0, 3.0, 4.0) or (kind in (1.0, 4.0) and len(given) != 7):
        raise InputError.at(function.place, f"a sky of kind {kind:g} with {len(given)} numbers is not known")
    if kind == 2.0:
        sky = zenith * (1.0 + 2.0 * up) / 3.0
    elif kind == 3.0:
        sky = np.full_like(up, zenith)
    else:
        sky = zenith * _with_sun(kind, np.array(given[4:7]), towards) / given[3]
    return _blended(sky, ground, up)


def _blended(sky: Values, ground: float, up: Values) -> Values:
    """Of sky and ground, by how far from the horizon the direction is."""
    raised = np.clip(up, -1.0, 1.0) + 1.01
    above, below = raised**10, raised**-10
    return np.asarray((above * sky + below * ground) / (above + below))


def _all_weather(fit: Values, sun: Values, towards: Values) -> Values:
    """Relative luminance of the sky of Perez, Seals and Michalsky (1993), with their a to e."""
    up = np.clip(towards[..., 2], -1.0, 1.0)
    cosine = np.clip(towards @ sun, -1.0, 1.0)
    gradation = 1.0 + fit[0] * np.exp(fit[1] / np.maximum(up, 0.01))
    return np.asarray(gradation * (1.0 + fit[2] * np.exp(fit[3] * np.arccos(cosine)) + fit[4] * cosine**2))


def _with_sun(kind: float, sun: Values, towards: Values) -> Values:
    """Relative luminance of the clear (1) or the intermediate sky (4)."""
    up = np.clip(towards[..., 2], -1.0, 1.0)
    cosine = np.clip(towards @ sun, -1.0, 1.0)
    from_sun, from_zenith = np.arccos(cosine), np.arccos(up)
    sun_from_zenith = float(np.arccos(np.clip(sun[2], -1.0, 1.0)))
    if kind == 1.0:
        haze = np.where(up > 0.01, 1.0 - np.exp(-0.32 / np.maximum(up, 0.01)), 1.0)
        return np.asarray((0.91 + 10.0 * np.exp(-3.0 * from_sun) + 0.45 * cosine**2) * haze)
    gradation = (1.35 * np.sin(5.631 - 3.59 * from_zenith) + 3.12) * np.sin(4.396 - 2.6 * sun_from_zenith)
    fall = -0.563 * ((2.629 - from_zenith) * (1.562 - sun_from_zenith) + 0.812)
    return np.asarray((gradation + 6.37 - from_zenith) / 2.326 * np.exp(from_sun * fall))


def picture(parts: list[tuple[Primitive, Primitive, Primitive | None]]) -> Values:
    """Luminances in all directions, rows from above to below, north in the middle; in the colours of the
    glows. `parts`: sources, their glows, and what these are multiplied by."""
    polar = np.pi * (np.arange(ROWS) + 0.5) / ROWS
    azimuth = 2.0 * np.pi * (np.arange(2 * ROWS) + 0.5) / (2 * ROWS) - np.pi
    across = np.sin(polar)[:, None]
    vectors = (across * np.sin(azimuth), across * np.cos(azimuth), np.cos(polar)[:, None])
    towards = np.stack(np.broadcast_arrays(*vectors), axis=-1)
    found = np.zeros((*towards.shape[:2], 3))
    for source, glow, function in parts:
        x, y, z, angle = source.need(4)
        axis = np.array([x, y, z]) / np.linalg.norm([x, y, z])
        inside = towards @ axis >= np.cos(np.deg2rad(0.5 * min(angle, 360.0)))
        level = np.ones(towards.shape[:2]) if function is None else brightness(function, towards)
        found[inside] = (level[..., None] * np.array(glow.numbers[:3]))[inside]
    return np.asarray(EFFICACY * np.maximum(found, 0.0))
