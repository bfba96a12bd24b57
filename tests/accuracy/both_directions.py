"""Scenes that are measured by adjoint and by forward photons, and must read the same: short documents."""

import json
from dataclasses import dataclass
from math import pi
from pathlib import Path

from nocturne_scene.validation.documents import (
    BLACK,
    diffuse,
    disc,
    film,
    measured_scene,
    quad,
    sphere,
    surface,
)

from tests.accuracy.scenes import bowl
from tests.accuracy.tracing import Document

_SCENES = Path(__file__).parents[2] / "examples"

_SF11 = {"type": "dielectric", "index": "N-SF11"}
_SMOKED = _SF11 | {"absorption": 3.0}
"""Light trapped by total reflection in a block of clear glass would cost a thousand rays."""


@dataclass(frozen=True)
class BothDirections:
    document: Document
    pixels: tuple[int, int]
    """Edges are multiples of 8."""
    samples: dict[str, int]
    """Per pixel, by direction; the time is about the same."""


def _plain() -> Document:
    """A lamp and a red wall next to a film, with a box that shades a part of it."""
    wall = {"type": "lambertian", "reflectance": {"rgb": [0.7, 0.2, 0.1]}}
    return measured_scene(
        film([0, 0, 0], [0, 0, 1], 1.0, up=[0, 1, 0]),
        [
            surface(disc([0.2, 0.1, 1.0], [0, 0, -1], 0.3, 64), radiance=1.0),
            surface(quad([0.6, -0.6, 0], [0, 0, 1], [0, 1.2, 0]), wall),
            surface({"type": "box", "minimum": [-0.3, -0.1, 0.2], "maximum": [-0.1, 0.1, 0.4]}, diffuse(0.5)),
        ],
    )


def _growing() -> Document:
    """A lamp that grows from half its size to twice, while the shutter is open."""
    growth = {"placements": [{"scale": 0.5}, {"scale": 2.0}]}
    lamp = surface(quad([-0.1, -0.1, 0], [0, 0.2, 0], [0.2, 0, 0]), radiance=1.0)
    return measured_scene(
        film([0, 0, -0.6], [0, 0, 1], 1.0, up=[0, 1, 0]),
        [lamp | {"motion": growth}, surface(quad([0.7, -0.6, -0.6], [0, 0, 1], [0, 1.2, 0]), diffuse(0.7))],
    )


def _prism() -> Document:
    """The example: a lamp through a prism of dense flint on a film, a spectrum with soft edges."""
    document: Document = json.loads((_SCENES / "both_directions" / "scene.json").read_text())
    return document


def _mirror(sensor: Document) -> Document:
    """A small sphere of light near the focus of a concave mirror, a part of a sphere."""
    silver = {"type": "conductor", "index": "Ag"}
    return measured_scene(
        sensor,
        [
            surface(bowl(0.2, 0.9, 24, 64), silver),
            surface(sphere([0, 0, -0.1], 0.04), BLACK, 1.0),
        ],
    )


def _port() -> Document:
    """The inside of an integrating sphere whose port, a square, has the film."""
    return measured_scene(
        film([0, 0, 0.95], [0, 0, -1], 0.4, up=[0, 1, 0]),
        [
            surface(sphere([0, 0, 0], 1.0), diffuse(0.9)),
            surface(quad([-0.25, -0.25, 0.951], [0, 0.5, 0], [0.5, 0, 0])),
            surface(sphere([0.3, 0, -0.3], 0.3), diffuse(0.5), 1.0 / pi),
        ],
    )


def _inside_glass() -> Document:
    """A lamp inside a block of glass, on a film outside: radiance is n^2 times as large within."""
    return measured_scene(
        film([0, 0, -0.3], [0, 0, 1], 0.8, up=[0, 1, 0]),
        [
            surface({"type": "box", "minimum": [-0.3, -0.3, -0.2], "maximum": [0.3, 0.3, 0.3]}, _SMOKED),
            surface(sphere([0.05, 0, 0], 0.1), diffuse(0.3), 1.0),
        ],
    )


def _film_inside_glass() -> Document:
    """A film inside a block of glass, below a lamp outside."""
    return measured_scene(
        film([0, 0, 0], [0, 0, 1], 0.4, up=[0, 1, 0]),
        [
            surface({"type": "box", "minimum": [-0.3, -0.3, -0.2], "maximum": [0.3, 0.3, 0.3]}, _SMOKED),
            surface(disc([0.1, 0, 0.6], [0, 0, -1], 0.2, 64), radiance=1.0),
        ],
    )


_INTENSITY = {"type": "intensity_meter", "position": [0, 0, -0.1], "lamp_radius": 0.25, "axis": [0, 0, 1]}

SCENES = {
    "plain": BothDirections(_plain(), (16, 16), {"adjoint": 1024, "forward": 2048}),
    "growing lamp": BothDirections(_growing(), (8, 8), {"adjoint": 1024, "forward": 2048}),
    "prism": BothDirections(_prism(), (8, 8), {"adjoint": 65536, "forward": 65536}),
    "mirror, film": BothDirections(
        _mirror(film([0, 0, 0.3], [0, 0, -1], 0.4, up=[0, 1, 0])),
        (8, 8),
        {"adjoint": 4096, "forward": 2048},
    ),
    "mirror, intensity": BothDirections(_mirror(_INTENSITY), (8, 8), {"adjoint": 4096, "forward": 1024}),
    "port": BothDirections(_port(), (8, 8), {"adjoint": 512, "forward": 2048}),
    "lamp in glass": BothDirections(_inside_glass(), (8, 8), {"adjoint": 16384, "forward": 8192}),
    "film in glass": BothDirections(_film_inside_glass(), (8, 8), {"adjoint": 8192, "forward": 4096}),
}
