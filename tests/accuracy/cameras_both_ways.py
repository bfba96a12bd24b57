"""Scenes that a camera sees by photons from it alone, and with photons from the luminaires, too.

Lamps are large, so that photons from the camera find them by themselves.
"""

from dataclasses import dataclass
from typing import Any

from nocturne_scene.validation.documents import BLACK, diffuse, disc, quad, sphere, surface

from tests.accuracy.scenes import bowl
from tests.accuracy.tracing import Document

_FLOOR = surface(quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), diffuse(0.6))
_GLASS = {"type": "dielectric", "index": "N-BK7", "absorption": 0.5}
_SILVER = {"type": "conductor", "index": "Ag"}


@dataclass(frozen=True)
class SeenBothWays:
    document: Document
    pixels: tuple[int, int] = (16, 16)
    """Edges are multiples of 8."""
    samples: int = 512
    """Half of them are taken in `make test`, twice as many in `make accuracy`."""


def _scene(sensor: Document, surfaces: list[Document], **further: Any) -> Document:
    return {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, **further}


def _pinhole(**further: Any) -> Document:
    return {
        "type": "pinhole",
        "position": [0.2, 1.2, 1.8],
        "look_at": [0, 0.1, 0],
        "vertical_field_of_view_degrees": 40,
    } | further


def _bowl(kernel: Document) -> Document:
    """A part of a sphere around [0, 1, 0] that looks down, dark from outside."""
    both_sides = {"type": "two_sided", "front": kernel, "back": diffuse(0.3)}
    placed = {"rotate": {"axis": [1, 0, 0], "degrees": 90}, "translate": [0, 1, 0]}
    return surface(bowl(0.4, 1.2, 12, 32), both_sides) | placed


_LAMP_IN_BOWL = surface(sphere([0, 1.15, 0], 0.2), diffuse(0.2), 1.0)
_LAMP_ABOVE = surface(disc([0.1, 1.6, 0.1], [0, -1, 0], 0.25, 32), radiance=1.0)
_BALL = surface(sphere([0, 0.45, 0], 0.25), _GLASS)
_SIEVE = surface(
    quad([-0.5, 0.4, -0.96], [1, 0, 0], [0, 0.8, 0]),
    {"type": "mask", "kernel": diffuse(0.7), "opacity": 0.5},
)
_WALL = surface(quad([-1, 0, -1], [2, 0, 0], [0, 1, 0]), diffuse(0.5))


def _fog(sensor: Document) -> Document:
    """A lamp inside a ball of glass, which fog surrounds; the camera is in the fog."""
    box = {"type": "box", "minimum": [-1, -0.1, -1], "maximum": [1, 2, 2]}
    fog = {"scattering": 0.6, "absorption": 0.1, "phase": {"type": "henyey_greenstein", "g": 0.5}}
    return _scene(
        sensor,
        [
            _FLOOR,
            surface(sphere([0, 0.6, 0], 0.3), _GLASS),
            surface(sphere([0, 0.6, 0], 0.15), diffuse(0.0), 1.0),
            {"shape": box, "interior": {"media": ["fog"]}},
        ],
        media={"fog": fog},
    )


def _fogged_housing() -> Document:
    """A lamp in a ball of glass full of fog, which is near to it and far, and in a white bowl."""
    glass = surface(sphere([0, 0.6, 0], 0.3), _GLASS) | {"interior": {"media": ["fog"]}}
    both_sides = {"type": "two_sided", "front": diffuse(0.8), "back": diffuse(0.3)}
    placed = {"rotate": {"axis": [1, 0, 0], "degrees": 90}, "translate": [0, 0.62, 0]}
    shade = surface(bowl(0.34, 1.2, 12, 32), both_sides) | placed
    fog = {"scattering": 8.0, "phase": {"type": "henyey_greenstein", "g": 0.5}}
    lamp = surface(sphere([0, 0.6, 0], 0.2), diffuse(0.2), 1.0)
    return _scene(_pinhole(), [_FLOOR, glass, lamp, shade], media={"fog": fog})


def _lamp_at_a_wall(*more: Document) -> Document:
    """A lamp so close to a wall that much of its light is scattered close to it first. No surface transmits
    light, so without `more` the tracer only traces shadow rays to the lamp."""
    lamp = surface(quad([-0.3, 0.5, -0.93], [0.6, 0, 0], [0, 0.6, 0.1]), BLACK, 1.0, two_sided=True)
    ball = surface(sphere([0.3, 0.2, -0.2], 0.2), _SILVER)
    return _scene(_pinhole(), [_FLOOR, _WALL, ball, lamp, *more])


def _panes() -> Document:
    """A pane above a ball of glass, another before half of the camera, and a mirror that is half there."""
    pane = {"type": "thin_pane", "index": 1.5, "transmittance": 0.9}
    sieve = {"type": "mask", "kernel": _SILVER, "opacity": 0.5}
    return _scene(
        {
            "type": "orthographic",
            "position": [0.2, 1.2, 1.8],
            "look_at": [0, 0.1, 0],
            "height": 1.2,
        },
        [
            _FLOOR,
            _LAMP_ABOVE,
            _BALL,
            surface(quad([-0.5, 0.9, -0.5], [0, 0, 1], [1, 0, 0]), pane),
            surface(quad([-0.4, 0.01, -0.2], [0, 0, 0.6], [0.3, 0.1, 0]), sieve),
            surface(quad([0.2, 0.6, 1.0], [0.6, 0, 0], [0, 0.6, 0.2]), pane),
        ],
    )


def _case() -> Document:
    """A lamp in a case of panes, above a floor with a smooth coat; panes with holes next to it."""
    pane = {"type": "thin_pane", "index": 1.8, "transmittance": 0.95}
    paint = {"type": "coated_diffuse", "reflectance": 0.5, "index": 1.8}
    case = {"type": "box", "minimum": [-0.4, 0.7, -0.4], "maximum": [0.4, 1.5, 0.4]}
    return _scene(
        _pinhole(),
        [
            surface(quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), paint),
            _WALL,
            surface(case, pane),
            surface(sphere([0, 1.1, 0], 0.25), diffuse(0.2), 1.0),
            surface(
                quad([-0.9, 0.2, -0.3], [0, 0.6, 0.3], [0.5, 0, 0]),
                {"type": "mask", "kernel": pane, "opacity": 0.5},
            ),
        ],
    )


def _distant() -> Document:
    """A wide Sun and an even sky, through a ball of glass."""
    sun = {"direction": [0.3, 1, 0.1], "angular_diameter_degrees": 24, "radiance": 20.0}
    return _scene(_pinhole(), [_FLOOR, _BALL], distant=[sun], environment={"radiance": 0.2})


def _moving() -> Document:
    """A lamp, a ball and a camera that move."""
    ball = _BALL | {"motion": {"translate": [0.2, 0, 0]}}
    lamp = surface(sphere([0, 1.5, 0], 0.2), radiance=1.0) | {"motion": {"translate": [-0.4, 0, 0.2]}}
    camera = _pinhole(motion={"translate": [0.05, 0, 0]})
    return _scene(camera, [_FLOOR, ball, lamp, _WALL])


def _rough_metal() -> Document:
    """White floors between walls of rough metal under an even sky: most light has met a floor, then metal and
    a floor again. Nothing is clear."""
    metal = _SILVER | {"roughness": 0.2}
    walls = {"type": "two_sided", "front": metal, "back": metal}
    return _scene(
        _pinhole(),
        [
            surface(quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), diffuse(0.9)),
            surface(quad([-1, 0, -1], [2, 0, 0], [0, 1, 0.3]), walls),
            surface(quad([-1, 0, -1], [0, 0, 2], [0.3, 1, 0]), walls),
            surface(quad([1, 0, -1], [0, 0, 2], [-0.3, 1, 0]), walls),
        ],
        environment={"radiance": 1.0},
    )


_LENS = {"type": "thin_lens", "lens_radius": 0.1, "focus_distance": 1.5}
_PANORAMA = {"type": "panorama", "position": [0.5, 0.5, 0.5], "look_at": [0, 0.3, 0]}

SCENES = {
    "bowl": SeenBothWays(_scene(_pinhole(), [_FLOOR, _WALL, _bowl(_SILVER), _LAMP_IN_BOWL])),
    "rough bowl": SeenBothWays(
        _scene(_pinhole(), [_FLOOR, _WALL, _bowl(_SILVER | {"roughness": 0.2}), _LAMP_IN_BOWL])
    ),
    "ball, lens": SeenBothWays(_scene(_pinhole(**_LENS), [_FLOOR, _LAMP_ABOVE, _BALL, _WALL])),
    "ball, all around": SeenBothWays(_scene(_PANORAMA, [_FLOOR, _LAMP_ABOVE, _BALL, _WALL]), (32, 16)),
    "lamp in glass in fog": SeenBothWays(_fog(_pinhole()), samples=1024),
    "lamp in a fogged housing": SeenBothWays(_fogged_housing(), samples=1024),
    "lamp at a wall": SeenBothWays(_lamp_at_a_wall()),
    "lamp at a wall behind holes": SeenBothWays(_lamp_at_a_wall(_SIEVE)),
    "panes": SeenBothWays(_panes()),
    "lamp in a case": SeenBothWays(_case()),
    "Sun and sky": SeenBothWays(_distant()),
    "motion": SeenBothWays(_moving()),
    "rough metal": SeenBothWays(_rough_metal(), samples=1024),
}
