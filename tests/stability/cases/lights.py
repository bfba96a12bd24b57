"""Lamps that are tiny, bright, black or hidden in one texel."""

from collections.abc import Callable
from math import cos, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO
from nocturne_scene.validation.documents import sphere

from tests.accuracy.tracing import Document
from tests.stability.build import FURNACE_SOURCE, beam, diffuse, film, furnace, lit, quad, surface, walls
from tests.stability.case import Case

_AIM = "aim at luminaires: the estimators two_photons, mixture or split, or forward photons"
_POLE = "a map with more rows, or a disc in $.distant: rows become steps of equal height, coarse at the poles"
_FLOOR = surface(quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), diffuse(1.0))
"""White, so that its radiance is the irradiance over pi."""


def _tiny(radius: float) -> Case:
    ball = surface(sphere([0, 0, 1], radius), radiance=1.0 / radius**2)
    return Case(
        f"lamp of radius {radius:g} at 1 m",
        "a lamp of constant power above a white floor, ever smaller",
        lit(beam(45.0), [_FLOOR, ball], sky=None),
        1.0,
        "sphere above a plane: irradiance pi L r^2 / d^2",
        samples=512,
        remedy=_AIM,
    )


def _sun(degrees: float) -> Case:
    document = lit(beam(45.0), [_FLOOR], sky=None)
    document["distant"] = [_disc(degrees, [0, 0, 1])]
    return Case(
        f"sun of {degrees:g} degrees",
        "a disc at infinity of constant irradiance on a white floor, ever smaller",
        document,
        1.0 / pi,
        "irradiance as given, over pi",
        samples=512,
        remedy=_AIM,
    )


def _low_sun(elevation: float) -> Case:
    angle = radians(elevation)
    document = lit(beam(45.0), [_FLOOR], sky=None)
    document["distant"] = [_disc(0.1, [cos(angle), 0.0, sin(angle)])]
    return Case(
        f"sun {elevation:g} degrees high",
        "light that all but misses the floor",
        document,
        sin(angle) / pi,
        "sine of the elevation, over pi",
        allowed=1e-3,
        samples=512,
        remedy=_AIM,
    )


def _disc(degrees: float, towards: list[float]) -> Document:
    return {"direction": towards, "angular_diameter_degrees": degrees, "irradiance": 1.0}


def _film_in_the_sun() -> Case:
    document = lit(film([0, 0, 0.1], [0, 0, 1], 0.5), [_FLOOR], sky=None)
    document["distant"] = [_disc(0.533, [0, 0, 1])]
    return Case(
        "film in the sun",
        "of the photons that leave a film by cosine one in 46000 meets the sun",
        document,
        1.0,
        "irradiance as given",
        samples=512,
        remedy=_AIM,
    )


def _film_under_a_lamp() -> Case:
    """Of radius 1 mm, 1 m above."""
    # So small that its pixels are alike: by their scatter a fault is seen.
    at = (np.arange(200) + 0.5) / 200 * 0.01
    squares = 1.0 + at[:, None] ** 2 + at[None, :] ** 2
    return Case(
        "film under a lamp of 1 mm",
        "of the photons that leave a film by cosine one in a million meets the lamp",
        lit(
            film([0, 0, 0], [0, 0, 1], 0.02), [surface(sphere([0, 0, 1], 1e-3), radiance=1e6 / pi)], sky=None
        ),
        float((squares**-1.5).mean()),
        "inverse square and the film's cosine: mean of (1 + x^2 + y^2)^-1.5 over the film",
        allowed=1e-4,
        samples=512,
        remedy=_AIM,
    )


def _black_lamp() -> Case:
    """One of the lamps is black: nothing may divide by its power."""
    room = walls([0, 0, 0], 1.0, diffuse(0.5), 1.0)
    document = lit(film([0.5, 0.5, 0.5], [0, 0, 1], 0.5), room, None)
    # Outside of the box, where it changes nothing.
    document["surfaces"].append(surface(quad([3, 3, 3], [1, 0, 0], [0, 1, 0]), diffuse(0.5), 1e-30))
    return Case(
        "lamp without light",
        "a lamp of radiance 1e-30 among others",
        document,
        2.0 * pi,
        FURNACE_SOURCE,
    )


def _flush() -> Case:
    """A lamp exactly in the plane of a wall."""
    document = lit(film([0.5, 0.5, 0.5], [0, 0, 1], 0.5), walls([0, 0, 0], 1.0, diffuse(0.5), 1.0), None)
    document["surfaces"].append(surface(quad([0.25, 0.25, 1.0], [0, 0.5, 0], [0.5, 0, 0]), diffuse(0.5), 1.0))
    return Case(
        "lamp in the plane of a wall",
        "of two lamps in one place a photon meets one",
        document,
        2.0 * pi,
        FURNACE_SOURCE + "; both are alike",
        remedy="let the lamp stand in front of the wall",
    )


def _sky_map(name: str, stress: str, grey: Callable[[], Any], remedy: str = "") -> Case:
    """A white floor under a map whose pole is above it."""
    floor = surface(quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), diffuse(1.0))
    camera = {"type": "orthographic", "position": [0, 1, 1], "look_at": [0, 0, 0], "height": 1e-3}
    document = lit(camera, [floor], sky=None)
    document["environment"] = {"asset": "map.exr", "luminance": 683.0 * 106.856895}
    return Case(
        name,
        stress,
        document,
        _upward(grey()) / pi,
        "sum over texels of radiance times cosine times solid angle, over pi",
        files=lambda folder: _write(folder / "map.exr", grey()),
        samples=512,
        allowed=1e-4,
        remedy=remedy,
    )


_ROWS, _COLUMNS = 128, 256


def _one_texel(row: int, contrast: float) -> Any:
    grey = np.ones((_ROWS, _COLUMNS))
    grey[row, 77] = contrast
    return grey


def _pole_row() -> Any:
    grey = np.zeros((_ROWS, _COLUMNS))
    grey[0] = 1.0
    return grey


def _upward(grey: Any) -> float:
    edges = np.linspace(0.0, pi, _ROWS + 1)
    heights = np.array([sin(edge) if edge <= pi / 2 else 1.0 for edge in edges]) ** 2
    # Integral of cosine over the solid angle of a texel: half of the difference of squared sines, by azimuth.
    weights = 0.5 * np.diff(heights) * 2.0 * pi / _COLUMNS
    return float((grey * weights[:, None]).sum())


def _write(path: Path, grey: Any) -> None:
    image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(_COLUMNS, _ROWS, 3, OpenImageIO.FLOAT))
    image.set_pixels(OpenImageIO.ROI(), np.repeat(grey[..., None], 3, axis=2).astype(np.float32))
    if not image.write(str(path)):
        raise OSError(f"{path}: {image.geterror()}")


def _lens() -> Case:
    """A lens as wide as the room."""
    document: Document = furnace(0.5)
    document["sensor"] = {
        "type": "thin_lens",
        "position": [0.5, 0.5, 0.5],
        "look_at": [0.5, 0.5, 1.0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 120,
        "lens_radius": 0.45,
        "focus_distance": 0.01,
    }
    return Case(
        "lens as wide as the room",
        "f/0.01, focused on itself",
        document,
        2.0,
        "energy balance: radiance L / (1 - albedo) in a closed box",
    )


CASES = [
    *map(_tiny, (1e-1, 1e-3, 1e-5)),
    *map(_sun, (0.533, 0.01)),
    _low_sun(1.0),
    _film_in_the_sun(),
    _film_under_a_lamp(),
    _black_lamp(),
    _flush(),
    _sky_map("one texel of 1e6", "a map of contrast 1e6", lambda: _one_texel(40, 1e6), _AIM),
    _sky_map(
        "one texel of 1e6 at the pole",
        "the bright texel is a sliver of 1e-6 sr that touches the pole",
        lambda: _one_texel(0, 1e6),
        _POLE,
    ),
    _sky_map("only the pole's row", "a map that is black but for its first row", _pole_row, _POLE),
    _lens(),
]
