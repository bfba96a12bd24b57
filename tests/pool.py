"""A pool whose floor a small lamp lights through the water, seen from straight above.

Photons from the sensor meet the lamp by chance alone, so that a pilot guides them, for films from `FILM` and
`SAMPLES` on.
"""

import math
from typing import Any

FILM, SAMPLES = (65, 49), 768
WATER, LAMP, LOOK_AT = 0.7, (1.95, 1.25, 2.2), (1.5, 1.5)
"""Height of the water, middle of the lamp, and what the middle pixel shows of the floor, metres."""

_INDEX, _LAMP_EDGE = 1.33, 0.1


def pool() -> dict[str, Any]:
    """A scene document; z points up, the floor is at z = 0."""
    half = _LAMP_EDGE / 2
    x, y, z = LAMP
    return {
        "nocturne": 1,
        "name": "pool",
        "sensor": {
            "type": "pinhole",
            "position": [*LOOK_AT, 2.4],
            "look_at": [*LOOK_AT, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": 40,
        },
        "surfaces": [
            _grey([0, 0, 0], [3, 0, 0], [0, 3, 0]),
            {
                "shape": {"type": "box", "minimum": [0.1, 0.1, -0.1], "maximum": [2.9, 2.9, WATER]},
                "kernel": {"type": "dielectric", "index": _INDEX},
            },
            {
                "shape": _quad([x - half, y - half, z], [0, _LAMP_EDGE, 0], [_LAMP_EDGE, 0, 0]),
                "kernel": {"type": "lambertian", "reflectance": 0},
                "luminaire": {"radiance": {"illuminant": "A", "luminance": 50_000}},
            },
        ],
    }


def light_at_the_middle() -> tuple[float, float, float]:
    """The direction from the floor at LOOK_AT in which the lamp's middle is seen through the water.

    By Snell's law, and bisection.
    """
    dx, dy = LAMP[0] - LOOK_AT[0], LAMP[1] - LOOK_AT[1]
    away = math.hypot(dx, dy)
    low, high = 0.0, away
    for _ in range(60):
        through = (low + high) / 2  # of the way away, below the surface
        below = through / math.hypot(through, WATER)
        above = (away - through) / math.hypot(away - through, LAMP[2] - WATER)
        low, high = (through, high) if _INDEX * below < above else (low, through)
    length = math.hypot(low, WATER)
    return dx / away * low / length, dy / away * low / length, WATER / length


def _grey(corner: list[float], edge_u: list[float], edge_v: list[float]) -> dict[str, Any]:
    return {
        "shape": _quad(corner, edge_u, edge_v),
        "kernel": {"type": "lambertian", "reflectance": 0.5},
    }


def _quad(corner: list[float], edge_u: list[float], edge_v: list[float]) -> dict[str, Any]:
    return {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v}
