"""Scenes that both renderers can show, as documents of ours."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bench.peer.planes import planes
from bench.peer.room import room
from bench.peer.sky import SKY, write_sky
from bench.scenes import Document, cornell

CHART = "BabelColor Average"
"""Mean spectral reflectances of 30 ColorCheckers, measured by D. Pascale (BabelColor)."""

_COLUMNS, _ROWS = 6, 4


@dataclass(frozen=True)
class Scene:
    """A document, what to show of it, and its files."""

    write: Callable[[Path], Document]
    """Gives the document; files that it names go into the folder."""
    width: int
    height: int
    rounds: int = 1
    """So many times as many frames are measured: more where rare bright samples decide about the error."""


def scenes() -> dict[str, Scene]:
    """By name."""
    return {
        "cornell": Scene(lambda _: cornell(), 128, 128),
        "chart": Scene(lambda _: chart(), 96, 64),
        "spheres": Scene(spheres, 128, 96, rounds=4),
        "room": Scene(room, 160, 120),
        "planes": Scene(planes, 128, 96),
    }


def chart() -> Document:
    """24 Lambertian patches that fill the image, under a uniform sky of D65."""
    # Late: it takes a second, and warns that Matplotlib is not there.
    import colour

    patches = colour.SDS_COLOURCHECKERS[CHART]
    surfaces = [
        {
            "shape": {
                "type": "quad",
                "corner": [column - _COLUMNS / 2, _ROWS / 2 - 1 - row, 0],
                "edge_u": [1, 0, 0],
                "edge_v": [0, 1, 0],
            },
            "kernel": {"type": "lambertian", "reflectance": {"table": _table(patch)}},
        }
        for (row, column), patch in zip(np.ndindex(_ROWS, _COLUMNS), patches.values(), strict=True)
    ]
    return {
        "nocturne": 1,
        "sensor": {
            "type": "orthographic",
            "position": [0, 0, 5],
            "look_at": [0, 0, 0],
            "up": [0, 1, 0],
            "height": _ROWS,
        },
        "surfaces": surfaces,
        "environment": {"radiance": {"illuminant": "D65", "luminance": 1000}},
    }


def spheres(folder: Path) -> Document:
    """Three rough metal balls and a plastic one on a grey floor, under the sky of `write_sky`."""
    write_sky(folder / SKY)
    kernels: list[dict[str, Any]] = [
        {"type": "conductor", "index": "Cu", "roughness": 0.05},
        {"type": "conductor", "index": "Au", "roughness": 0.1},
        {"type": "conductor", "index": "Al", "roughness": 0.2},
        {
            "type": "coated_diffuse",
            "index": 1.5,
            "reflectance": {"table": [[400, 0.05], [600, 0.4], [700, 0.6]]},
        },
    ]
    balls = [
        {"shape": {"type": "sphere", "centre": [2.2 * place - 3.3, 1, 0], "radius": 1}, "kernel": kernel}
        for place, kernel in enumerate(kernels)
    ]
    floor = {
        "shape": {"type": "quad", "corner": [-8, 0, 8], "edge_u": [16, 0, 0], "edge_v": [0, 0, -16]},
        "kernel": {"type": "lambertian", "reflectance": 0.5},
    }
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 3, -9],
            "look_at": [0, 0.9, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": 45,
        },
        "surfaces": [floor, *balls],
        "environment": {"asset": SKY, "luminance": 1000, "up": [0, 1, 0], "forward": [0, 0, 1]},
    }


def _table(patch: Any) -> list[list[float]]:
    return [[float(at), float(value)] for at, value in zip(patch.wavelengths, patch.values, strict=True)]
