"""Lamps without a size that throw a picture: three lamps, red, green and blue, with a photometric file each.

Light adds up, so that what the three show together is the picture. A photometric file has intensities over
the angle from the axis and about it; they are taken from the picture by bilinear interpolation.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.lamps import ball
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.photometry.ies import write as write_photometry
from nocturne_scene.photometry.intensities import Photometry
from nocturne_scene.spectra.published import SRGB_LUMINANCE

Array = NDArray[np.float64]

# Angles from the axis and about it, at least and at most: a file stays below two megabytes.
_ALONG, _AROUND = (128, 256), (360, 720)
# Digits of intensities, of the largest one.
_DIGITS = 6

# How much larger each sphere is than the one inside of it.
_APART = 1.01


def beam(
    writer: SceneWriter,
    to_world: Array,
    radius: float,
    widest: float,
    values: Callable[[Array, Array], Array],
    pixels: int,
    name: str,
    *,
    flat: bool = False,
) -> list[Json]:
    """Surfaces that together have an intensity by direction.

    `values`: linear sRGB, (1, 1, 1) being 1 cd, of directions (x, y, 1) in the lamp's frame. `widest`: the
    largest distance of (x, y) from the axis that is lit. `pixels`: along an edge of the picture. `flat`:
    white is equal energy instead of D65.
    """
    along, around = (int(np.clip(pixels, *bounds)) for bounds in (_ALONG, _AROUND))
    distance = np.linspace(0.0, widest, along)
    degrees = np.degrees(np.arctan(distance))
    azimuth = np.linspace(0.0, 2 * np.pi, around + 1)
    # Horizontal angles increase counter-clockwise for someone who looks along the axis.
    x, y = np.cos(azimuth)[:, None] * distance, -np.sin(azimuth)[:, None] * distance
    rgb = values(x, y)
    grey = bool(np.all(rgb == rgb[..., :1]))
    axes = to_world[:3, :3] / np.linalg.norm(to_world[:3, :3], axis=0)
    end = np.array([degrees[-1] + 1e-3, 180.0])
    dark = np.zeros((around + 1, len(end)))
    found: list[Json] = []
    for channel, (spectrum, part) in enumerate(_lights(grey=grey, flat=flat)):
        candela = np.concatenate([part * rgb[..., channel], dark], axis=1)
        if not np.max(candela) > 0:
            continue
        candela = np.round(candela, _DIGITS - int(np.ceil(np.log10(np.max(candela)))))
        lamp = Photometry(np.concatenate([degrees, end]), np.degrees(azimuth), candela)
        number = len(writer.document.get("surfaces", [])) + len(found)
        asset = writer.file(writer.unused_file("lamps", f"{name}-{number}", ".ies"), write_photometry(lamp))
        profile = {"asset": asset, "axis": axes[:, 2].tolist(), "zero": axes[:, 0].tolist()}
        luminaire = {"radiance": spectrum, "profile": profile}
        found.append(ball(to_world[:3, 3], radius * _APART ** len(found), luminaire, name))
    return found


def _lights(*, grey: bool, flat: bool) -> list[tuple[Json, float]]:
    """Spectra of the lamps, and how much of white's luminance each has."""
    if grey:
        return [(1.0 if flat else colours.light([1.0, 1.0, 1.0], 1.0), 1.0)]
    primaries = np.eye(3).tolist()
    if not flat:
        return [
            (colours.light(colour, 1.0), part) for colour, part in zip(primaries, SRGB_LUMINANCE, strict=True)
        ]
    found = []
    for colour in primaries:
        spectrum = colours.coefficient(colour)
        found.append((spectrum, colours.luminance_of(spectrum) / colours.luminance_of(1.0)))
    return found


def looked_up(picture: Array, u: Array, v: Array) -> Array:
    """Values of a picture of shape (rows, columns, 3) at places in [0, 1]^2, v down; zero beyond."""
    rows, columns = picture.shape[:2]
    x, y = np.clip(u, 0, 1) * columns - 0.5, np.clip(v, 0, 1) * rows - 0.5
    left, top = np.floor(x), np.floor(y)
    across, down = (x - left)[..., None], (y - top)[..., None]
    column = [np.clip(left + step, 0, columns - 1).astype(int) for step in (0, 1)]
    row = [np.clip(top + step, 0, rows - 1).astype(int) for step in (0, 1)]
    upper, lower = (
        (1 - across) * picture[each, column[0]] + across * picture[each, column[1]] for each in row
    )
    inside = (np.abs(u - 0.5) <= 0.5) & (np.abs(v - 0.5) <= 0.5)
    return np.asarray(((1 - down) * upper + down * lower) * inside[..., None])
