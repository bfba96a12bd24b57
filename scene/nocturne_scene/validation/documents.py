"""Scene documents for readings that are known: bodies, lamps, meters, and slabs of media."""

from typing import Any

import numpy as np

Document = dict[str, Any]

GREY = {"wavelengths": "uniform", "responses": {"grey": 1.0}}
"""Fields of a sensor whose `grey` channel has no noise from wavelengths where light is grey: per nanometre,
times RANGE_NM."""

RANGE_NM = 830.0 - 360.0


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


# Slabs of media. Radiances are relative to an even light of radiance 1. A sensor that looks at a slab along
# one direction, with even light on one side, reads the slab's total reflectance or transmittance for light
# that comes from that direction (reciprocity). A flat film on the slab's face, which looks at it, reads pi
# times that for diffuse light.

WIDTH = 100.0
"""Half the edge of a slab, in free paths; at least ten thicknesses."""

EDGE = 1e-4
"""Of a reading: what a sensor sees past the slab's edge. The truths are of slabs without one."""


def medium(albedo: float, g: float = 0.0, extinction: float = 1.0, **more: Any) -> Document:
    """A grey Henyey-Greenstein medium."""
    phase = {"type": "henyey_greenstein", "g": g}
    made: Document = {"scattering": albedo * extinction, "absorption": (1.0 - albedo) * extinction}
    return made | ({"phase": phase} if g and albedo else {}) | more


def slab(thickness: float, half_edge: float, name: str = "fog", **more: Any) -> Document:
    """Across the z axis, from 0 down to -thickness."""
    shape = {
        "type": "box",
        "minimum": [-half_edge, -half_edge, -thickness],
        "maximum": [half_edge, half_edge, 0.0],
    }
    return {"shape": shape, "interior": {"media": [name]}, **more}


def screen(z: float, half_edge: float, radiance: float) -> Document:
    """A black square across the z axis that shines on both sides."""
    made: Document = {
        "shape": quad([-half_edge, -half_edge, z], [2 * half_edge, 0, 0], [0, 2 * half_edge, 0]),
        "kernel": BLACK,
    }
    return made | ({"luminaire": {"radiance": radiance, "two_sided": True}} if radiance else {})


def along(degrees: float, distance: float, diameter: float = 1e-3) -> Document:
    """A radiance meter above the origin that looks at it, at an angle to the z axis."""
    angle = np.radians(degrees)
    return {
        "type": "radiance_meter",
        "position": [float(distance * np.sin(angle)), 0.0, float(distance * np.cos(angle))],
        "look_at": [0.0, 0.0, 0.0],
        "up": [0, 1, 0],
        "diameter": diameter,
        "cone_degrees": 0.01,
    }


def from_above(z: float) -> Document:
    """A small film just above the slab, that faces it."""
    return film([0, 0, z], [0, 0, -1], 1e-3)


def lit_slab(fog: Document, thickness: float, sensor: Document, *, below: bool, **more: Any) -> Document:
    """A slab with even light from below or from above, and darkness on the other side.

    Even light is an environment; a black square covers the dark side.
    """
    half_edge = max(WIDTH, 10.0 * thickness)
    # So wide that no light comes in between.
    dark = screen(3.0 if below else -thickness - 1.0, 1e6, 0.0)
    document = measured_scene(sensor, [slab(thickness, half_edge, **more), dark])
    return document | {"media": {"fog": fog}, "environment": {"radiance": 1.0}}


def sun(zenith: float, azimuth: float = 0.0, **light: Any) -> Document:
    """A small disc at infinity; degrees, azimuth from x towards y. Irradiance 1 unless `light` says other."""
    zenith, azimuth = np.radians(zenith), np.radians(azimuth)
    across = float(np.sin(zenith))
    direction = [across * float(np.cos(azimuth)), across * float(np.sin(azimuth)), float(np.cos(zenith))]
    return {"direction": direction, "angular_diameter_degrees": 0.01, **(light or {"irradiance": 1.0})}
