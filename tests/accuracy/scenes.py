"""Scene documents for these tests."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from tests.accuracy.meters import GREY
from tests.accuracy.tracing import Document

_CORNELL = Path(__file__).parents[2] / "examples" / "cornell" / "scene.json"


def cornell(tracing: Document, **sensor: Any) -> Document:
    """The Cornell box, with other methods of tracing and another sensor.

    The field of view is 36 degrees instead of 39.3: no pixel looks past the box's front edges, where light
    comes through slivers of a pixel, so seldom that sums are far from normal.
    """
    document: Document = json.loads(_CORNELL.read_text())
    document["sensor"] |= {"vertical_field_of_view_degrees": 36.0, **sensor}
    document["tracing"] = tracing
    return document


def furnace(albedo: float, radiance: float) -> Document:
    """A closed box, seen from inside; all its walls scatter and emit. Traced as by default."""
    walls = [
        # Corner and edges: the normal edge_u x edge_v points inwards.
        ([0, 0, 0], [0, 1, 0], [0, 0, 1]),
        ([1, 0, 0], [0, 0, 1], [0, 1, 0]),
        ([0, 0, 0], [0, 0, 1], [1, 0, 0]),
        ([0, 1, 0], [1, 0, 0], [0, 0, 1]),
        ([0, 0, 0], [1, 0, 0], [0, 1, 0]),
        ([0, 0, 1], [0, 1, 0], [1, 0, 0]),
    ]
    return {
        "nocturne": 1,
        "spectra": {"glow": radiance, "wall": albedo},
        "kernels": {"wall": {"type": "lambertian", "reflectance": "wall"}},
        "sensor": {
            "type": "pinhole",
            "position": [0.3, 0.4, 0.2],
            "look_at": [0.7, 0.5, 0.8],
            "vertical_field_of_view_degrees": 70,
        },
        "surfaces": [
            {
                "shape": {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v},
                "kernel": "wall",
                "luminaire": {"radiance": "glow"},
            }
            for corner, edge_u, edge_v in walls
        ],
    }


BLACK = {"type": "lambertian", "reflectance": 0}


def diffuse(reflectance: float) -> Document:
    return {"type": "lambertian", "reflectance": reflectance}


def surface(shape: Document, kernel: Document = BLACK, radiance: float = 0.0, **luminaire: Any) -> Document:
    """One that may emit the same grey radiance everywhere."""
    made: Document = {"shape": shape, "kernel": kernel}
    return made | ({"luminaire": {"radiance": radiance, **luminaire}} if radiance else {})


def disc(centre: list[float], normal: list[float], radius: float, segments: int = 1024) -> Document:
    """Its area is too small by a part of 6e-6."""
    return {"type": "disc", "centre": centre, "normal": normal, "radius": radius, "segments": segments}


def quad(corner: list[float], edge_u: list[float], edge_v: list[float]) -> Document:
    return {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v}


def sphere(centre: list[float], radius: float) -> Document:
    return {"type": "sphere", "centre": centre, "radius": radius}


def ring(inner: float, outer: float, z: float, segments: int = 1024) -> Document:
    """Around the z axis: a plane with a round opening."""
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    flat = np.concatenate([inner * circle, outer * circle])
    here = np.arange(segments)
    after = (here + 1) % segments
    triangles = np.concatenate(
        [
            np.column_stack([here, here + segments, after]),
            np.column_stack([after, here + segments, after + segments]),
        ]
    )
    vertices = np.column_stack([flat, np.full(2 * segments, z)])
    return {"type": "mesh", "vertices": vertices.tolist(), "triangles": triangles.tolist()}


def bowl(radius: float, opening: float, rings: int, segments: int) -> Document:
    """A part of a sphere around the origin, up to the angle `opening` (radians) from -z, seen from inside."""
    tilts = np.linspace(0.0, opening, rings + 1)[1:]
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles), np.ones(segments)])
    vertices = [[0.0, 0.0, -radius]]
    for tilt in tilts:
        vertices += (radius * around * [np.sin(tilt), np.sin(tilt), -np.cos(tilt)]).tolist()
    after = [(i + 1) % segments for i in range(segments)]
    triangles = [[0, 1 + i, 1 + after[i]] for i in range(segments)]
    for ring in range(rings - 1):
        a, b = 1 + ring * segments, 1 + (ring + 1) * segments
        for i in range(segments):
            triangles += [[a + i, b + i, b + after[i]], [a + i, b + after[i], a + after[i]]]
    return {"type": "mesh", "vertices": vertices, "triangles": triangles}


def measured_scene(sensor: Document, surfaces: list[Document], **tracing: Any) -> Document:
    """A document whose sensor has a `grey` channel."""
    return {"nocturne": 1, "sensor": {**GREY, **sensor}, "surfaces": surfaces, "tracing": tracing}


def film(position: list[float], normal: list[float], height: float, **more: Any) -> Document:
    """An irradiance meter."""
    return {"type": "irradiance_meter", "position": position, "normal": normal, "height": height, **more}


def box(minimum: list[float], maximum: list[float]) -> Document:
    return {"type": "box", "minimum": minimum, "maximum": maximum}


Point = tuple[list[float], list[float]]
"""Where, and the unit normal."""

_TILE = 1e-4
"""Edge, m."""

TILE_OFF_PLANE = 1e-5
"""How far a tile is in front of the wall that it is on, m."""


def white_tile(point: Point) -> tuple[Document, Document]:
    """A small white surface at a point, and a sensor that reads its radiance: irradiance over pi."""
    place, normal = (np.array(vector, dtype=float) for vector in point)
    across = np.eye(3)[np.abs(normal).argmin()]
    u = np.cross(normal, across)
    u *= _TILE / np.linalg.norm(u)
    v = np.cross(normal, u)
    centre = place + TILE_OFF_PLANE * normal
    corner = centre - 0.5 * (u + v)
    meter = {
        "type": "radiance_meter",
        "position": (centre + 0.01 * normal).tolist(),
        "look_at": centre.tolist(),
        "up": u.tolist(),
        "diameter": 0.2 * _TILE,
        "cone_degrees": 0.1,
    }
    return surface(quad(corner.tolist(), u.tolist(), v.tolist()), diffuse(1.0)), meter
