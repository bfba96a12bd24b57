"""Forty scenes of small bright lights and of surfaces that focus their light: each of five lights with each
of eight objects, near or on a wide floor."""

from itertools import product
from math import cos, radians, sin
from typing import Any

from bench.scenes import Document

_NEAR, _WIDE = 2.0, 20.0
"""Half an edge of the floor, m."""

_GLASS = {"type": "dielectric", "index": 1.5}
_SILVER = {"type": "conductor", "index": "Ag"}
_BRUSHED = {"type": "conductor", "index": "Al", "roughness_u": 0.02, "roughness_v": 0.15}


def _ball(centre: list[float], radius: float, kernel: Document) -> Document:
    return {"shape": {"type": "sphere", "centre": centre, "radius": radius}, "kernel": kernel}


def _box(minimum: list[float], maximum: list[float], kernel: Document) -> Document:
    return {"shape": {"type": "box", "minimum": minimum, "maximum": maximum}, "kernel": kernel}


def _facets(kernel: Document) -> Document:
    """An octahedron that stands on one of its corners."""
    x, z = 0.35, 0.3
    vertices = [[x, 0.4, 0], [-x, 0.4, 0], [0, 0.4, z], [0, 0.4, -z], [0, 0.75, 0], [0, 0.05, 0]]
    triangles = [
        [0, 4, 2], [2, 4, 1], [1, 4, 3], [3, 4, 0], [2, 5, 0], [1, 5, 2], [3, 5, 1], [0, 5, 3],
    ]  # fmt: skip
    return {"shape": {"type": "mesh", "vertices": vertices, "triangles": triangles}, "kernel": kernel}


def _mirror(kernel: Document) -> Document:
    """A square that leans back behind the floor's middle."""
    shape = {"type": "quad", "corner": [-0.4, 0.05, 0.5], "edge_u": [0, 0.6, 0.4], "edge_v": [0.8, 0, 0]}
    return {"shape": shape, "kernel": {"type": "two_sided", "front": kernel, "back": kernel}}


_THINGS: dict[str, list[Document]] = {
    "a ball of glass": [_ball([0, 0.45, 0], 0.4, _GLASS)],
    "a ball of silver": [_ball([0, 0.45, 0], 0.4, _SILVER)],
    "brushed metal": [_mirror(_BRUSHED)],
    "a mirror": [_mirror(_SILVER)],
    "facets of glass": [_facets(_GLASS)],
    "a basin": [_box([-0.6, 0.05, -0.6], [0.6, 0.4, 0.6], {"type": "dielectric", "index": 1.33})],
    "two balls, one behind the other": [
        _ball([-0.15, 0.3, 0.2], 0.2, _GLASS),
        _ball([0.25, 0.3, -0.2], 0.2, _SILVER),
    ],
    "a small ball far off": [_ball([0.9, 0.12, 0.7], 0.08, _GLASS)],
}


def _sun(degrees: float) -> Document:
    """Of constant irradiance."""
    solid_angle = 3.14159265 * sin(radians(degrees / 2.0)) ** 2
    towards = [0.5, 0.8, 0.3]
    disc = {"direction": towards, "angular_diameter_degrees": degrees, "radiance": 10.0 / solid_angle}
    return {"distant": [disc], "environment": {"radiance": 0.5}}


def _lamps(*surfaces: Document) -> Document:
    return {"surfaces": list(surfaces), "environment": {"radiance": 0.05}}


def _shining(shape: Document, radiance: float) -> Document:
    return {
        "shape": shape,
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": radiance},
    }


_LENS = [_ball([0.5, 1.35, 0.3], 0.08, _GLASS)]
_LIGHTS: dict[str, Document] = {
    "the Sun": _sun(0.53),
    "a sun of 0.1 degrees": _sun(0.1),
    "a ball of 1 mm": _lamps(_shining({"type": "sphere", "centre": [0.5, 1.6, 0.3], "radius": 5e-4}, 1e7)),
    "a filament": _lamps(
        _shining(
            {"type": "quad", "corner": [0.5, 1.6, 0.3], "edge_u": [0.02, 0, 0], "edge_v": [0, 0, 5e-4]}, 1e6
        )
    ),
    "a LED behind a lens": _lamps(
        _shining(
            {"type": "quad", "corner": [0.4995, 1.5, 0.2995], "edge_u": [1e-3, 0, 0], "edge_v": [0, 0, 1e-3]},
            1e7,
        ),
        *_LENS,
    ),
}


def rare_scenes() -> dict[str, Document]:
    """By name. A camera looks down at the floor around the thing."""
    scenes: dict[str, Document] = {}
    for number, (light, thing) in enumerate(product(_LIGHTS, _THINGS)):
        half = _WIDE if number % 2 else _NEAR
        floor: Document = {
            "shape": {
                "type": "quad",
                "corner": [-half, 0, -half],
                "edge_u": [0, 0, 2 * half],
                "edge_v": [2 * half, 0, 0],
            },
            "kernel": {"type": "lambertian", "reflectance": 0.5},
        }
        tilt = radians(35.0 + 5.0 * (number % 5))
        position = [0.0, 4.0 * sin(tilt), -4.0 * cos(tilt)]
        sensor: dict[str, Any] = {
            "type": "pinhole",
            "position": position,
            "look_at": [0, 0.2, 0],
            "vertical_field_of_view_degrees": 40,
        }
        lit = _LIGHTS[light]
        scenes[f"{thing}, {light}, floor of {2 * half:g} m"] = {
            "nocturne": 1,
            "sensor": sensor,
            **lit,
            "surfaces": [floor, *_THINGS[thing], *lit.get("surfaces", [])],
        }
    return scenes


def gatherers(scene: Document) -> list[Document]:
    """Directions towards all that mirrors or refracts, lenses of lamps among them, for photons from lamps."""
    found = [each for each in scene["surfaces"] if each["kernel"]["type"] != "lambertian"]
    return [{"shape": each["shape"]} for each in found]
