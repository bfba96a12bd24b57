"""Small scenes whose light is hard to find for photons that know only kernels and luminaires.

Each is a trap for a method: light comes through a keyhole, via the ceiling alone, from one of
many lamps whose others stand behind a wall, through glass, by a mirror or a polished floor, or through
fog.
"""

from collections.abc import Callable, Sequence
from typing import Any

from bench.scenes import Document

Vector = Sequence[float]

_WALL = 0.7
"""Reflectance of walls."""


def _quad(
    corner: Vector, edge_u: Vector, edge_v: Vector, reflectance: float = _WALL, luminance: float = 0.0
) -> dict[str, Any]:
    """What emits does so to the side of the cross product of its edges."""
    surface: dict[str, Any] = {
        "shape": {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v},
        "kernel": {"type": "lambertian", "reflectance": reflectance},
    }
    if luminance:
        surface["luminaire"] = {"radiance": {"illuminant": "A", "luminance": luminance}}
    return surface


def _room(low: Vector, high: Vector) -> list[dict[str, Any]]:
    """A box without the wall at its largest x."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    x, y, z = [x1 - x0, 0, 0], [0, y1 - y0, 0], [0, 0, z1 - z0]
    return [
        _quad([x0, y0, z0], x, y, 0.5),
        _quad([x0, y0, z1], x, y, 0.8),
        _quad([x0, y0, z0], x, z),
        _quad([x0, y1, z0], x, z),
        _quad([x0, y0, z0], y, z),
    ]


def _wall_with_hole(x: float, low: Vector, high: Vector, hole_low: Vector, hole_high: Vector) -> list[Any]:
    """Across x; corners are (y, z)."""
    (y0, z0), (y1, z1), (a0, b0), (a1, b1) = low, high, hole_low, hole_high
    return [
        _quad([x, y0, z0], [0, a0 - y0, 0], [0, 0, z1 - z0]),
        _quad([x, a1, z0], [0, y1 - a1, 0], [0, 0, z1 - z0]),
        _quad([x, a0, z0], [0, a1 - a0, 0], [0, 0, b0 - z0]),
        _quad([x, a0, b1], [0, a1 - a0, 0], [0, 0, z1 - b1]),
    ]


def _camera(position: Vector, look_at: Vector) -> dict[str, Any]:
    return {
        "type": "pinhole",
        "position": position,
        "look_at": look_at,
        "up": [0, 0, 1],
        "vertical_field_of_view_degrees": 60,
    }


def _scene(camera: dict[str, Any], surfaces: list[Any]) -> Document:
    return {"nocturne": 1, "sensor": camera, "surfaces": surfaces}


def keyhole() -> Document:
    """Two rooms with a hole of 20 cm in the wall between: the lamp is in the other one."""
    surfaces = [
        *_room([0, 0, 0], [3, 3, 2.5]),
        *_room([6, 0, 0], [3, 3, 2.5]),
        *_wall_with_hole(3.0, [0, 0], [3, 2.5], [1.4, 1.1], [1.6, 1.3]),
        _quad([4.2, 1.2, 2.4], [0, 0.6, 0], [0.6, 0, 0], 0.0, 20_000),
    ]
    return _scene(_camera([2.8, 0.3, 1.6], [0.5, 2.2, 0.8]), surfaces)


def ceiling() -> Document:
    """A room whose lamp is turned to the ceiling."""
    surfaces = [
        *_room([0, 0, 0], [3, 3, 2.5]),
        _quad([3, 0, 0], [0, 3, 0], [0, 0, 2.5]),
        _quad([0.4, 2.2, 2.0], [0.2, 0, 0], [0, 0.2, 0], 0.0, 50_000),
        _quad([0.4, 2.2, 1.999], [0, 0.2, 0], [0.2, 0, 0], 0.0),
    ]
    return _scene(_camera([2.8, 0.3, 1.6], [0.5, 2.2, 0.8]), surfaces)


def lamps() -> Document:
    """Four hundred lamps behind a wall, and one in the room."""
    behind = [
        _quad([3.2 + 0.1 * (i % 20), 0.2 + 0.13 * (i // 20), 2.3], [0, 0.05, 0], [0.05, 0, 0], 0.0, 20_000)
        for i in range(400)
    ]
    surfaces = [
        *_room([0, 0, 0], [3, 3, 2.5]),
        *_room([6, 0, 0], [3, 3, 2.5]),
        _quad([3, 0, 0], [0, 3, 0], [0, 0, 2.5]),
        *behind,
        _quad([0.5, 2.0, 2.3], [0, 0.1, 0], [0.1, 0, 0], 0.0, 20_000),
    ]
    return _scene(_camera([2.8, 0.3, 1.6], [0.5, 2.2, 0.8]), surfaces)


def glass() -> Document:
    """A small lamp and a ball of glass on a table, in a dim room."""
    surfaces = [
        *_room([0, 0, 0], [3, 3, 2.5]),
        _quad([3, 0, 0], [0, 3, 0], [0, 0, 2.5]),
        {
            "shape": {"type": "sphere", "centre": [1.4, 1.5, 0.5], "radius": 0.3},
            "kernel": {"type": "dielectric", "index": 1.5168},
        },
        _quad([1.9, 1.2, 2.2], [0, 0.1, 0], [0.1, 0, 0], 0.0, 50_000),
    ]
    return _scene(_camera([2.8, 0.3, 1.6], [1.2, 1.6, 0.5]), surfaces)


def polished() -> Document:
    """A small lamp that shines down on a floor with a smooth coat, whose mirror lights the ceiling."""
    surfaces = [
        *_room([0, 0, 0], [3, 3, 2.5]),
        _quad([3, 0, 0], [0, 3, 0], [0, 0, 2.5]),
        _quad([0.4, 2.2, 2.0], [0, 0.05, 0], [0.05, 0, 0], 0.0, 500_000),
    ]
    surfaces[0]["kernel"] = {"type": "coated_diffuse", "reflectance": 0.3, "index": 1.5}
    return _scene(_camera([2.8, 0.3, 1.6], [0.5, 2.2, 0.8]), surfaces)


def panes() -> Document:
    """A room whose lamp hangs in a case of glass within another."""
    cases = [
        {
            "shape": {
                "type": "box",
                "minimum": [1.4 - r, 1.4 - r, 1.7 - r],
                "maximum": [1.6 + r, 1.6 + r, 1.9 + r],
            },
            "kernel": {"type": "thin_pane", "index": 1.5168},
        }
        for r in (0.1, 0.2)
    ]
    lamp = {
        "shape": {"type": "sphere", "centre": [1.5, 1.5, 1.8], "radius": 0.03},
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": {"illuminant": "A", "luminance": 100_000}},
    }
    surfaces = [*_room([0, 0, 0], [3, 3, 2.5]), _quad([3, 0, 0], [0, 3, 0], [0, 0, 2.5]), *cases, lamp]
    return _scene(_camera([2.8, 0.3, 1.6], [0.5, 2.2, 0.8]), surfaces)


def mirrored_glass() -> Document:
    """The caustic of a ball of glass, seen in a mirror on the wall."""
    mirror = _quad([0.01, 0.5, 0.2], [0, 2, 0], [0, 0, 1.8])
    mirror["kernel"] = {"type": "conductor", "index": "Al"}
    document = glass()
    document["surfaces"].append(mirror)
    document["sensor"] = _camera([2.0, 0.3, 1.6], [0.0, 1.2, 0.9])
    return document


def pool() -> Document:
    """A pool in a room, whose floor a small lamp lights through the water."""
    surfaces = [
        *_room([0, 0, 0], [3, 3, 2.5]),
        _quad([3, 0, 0], [0, 3, 0], [0, 0, 2.5]),
        {
            "shape": {"type": "box", "minimum": [0.1, 0.1, -0.1], "maximum": [2.9, 2.9, 0.7]},
            "kernel": {"type": "dielectric", "index": 1.33},
        },
        _quad([1.9, 1.2, 2.2], [0, 0.1, 0], [0.1, 0, 0], 0.0, 50_000),
    ]
    return _scene(_camera([2.8, 0.3, 1.6], [1.0, 1.8, 0.0]), surfaces)


def murky_pool() -> Document:
    """The same with murky water, which shows where its waves of light are."""
    document = pool()
    water = next(each for each in document["surfaces"] if each.get("kernel", {}).get("type") == "dielectric")
    water["interior"] = {"media": ["murk"]}
    document["media"] = {"murk": {"scattering": 0.4, "absorption": 0.1}}
    return document


def mirrored_sun() -> Document:
    """A floor in the shade, and a mirror that throws the Sun on it."""
    mirror = _quad([2, -1, 0], [0, 2, 0], [-0.2, 0, 2])
    mirror["kernel"] = {"type": "conductor", "index": "Al"}
    surfaces = [
        _quad([-3, -3, 0], [6, 0, 0], [0, 6, 0], 0.5),
        _quad([-1.5, -2, 0.1], [0, 4, 0], [0, 0, 3]),
        mirror,
    ]
    document = _scene(_camera([0.5, -4, 2.0], [0.5, 0, 0.2]), surfaces)
    sun = {"direction": [-1, 0, 0.9], "angular_diameter_degrees": 0.53}
    document["distant"] = [{**sun, "radiance": {"illuminant": "D65", "luminance": 1.6e9}}]
    document["environment"] = {"radiance": {"illuminant": "D65", "luminance": 3000}}
    return document


def fog() -> Document:
    """Thin fog in a yard, and a small lamp far off."""
    lamp = {
        "shape": {"type": "sphere", "centre": [0, 30, 4], "radius": 0.1},
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": {"illuminant": "A", "luminance": 1e7}},
    }
    bank = {
        "shape": {"type": "box", "minimum": [-20, -20, -0.5], "maximum": [20, 40, 12]},
        "interior": {"media": ["fog"]},
    }
    document = _scene(
        _camera([0, -2, 1.6], [0, 10, 2.0]), [_quad([-30, -30, 0], [60, 0, 0], [0, 80, 0], 0.2), bank, lamp]
    )
    document["media"] = {"fog": {"preset": "fog", "density": 0.2}}
    return document


TRAPS: dict[str, Callable[[], Document]] = {
    "keyhole": keyhole,
    "ceiling": ceiling,
    "lamps": lamps,
    "glass on a table": glass,
    "polished floor": polished,
    "lamp behind two panes": panes,
    "caustic in a mirror": mirrored_glass,
    "pool": pool,
    "murky pool": murky_pool,
    "Sun in a mirror": mirrored_sun,
    "fog with a far lamp": fog,
}
