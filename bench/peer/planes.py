"""A floor and a wall with textures under one lamp: nearly all of the light is direct."""

from pathlib import Path
from typing import Any

import numpy as np

from bench.peer.sky import write_grey
from bench.programs import Channel
from bench.scenes import Document

_TEXTURE = "waves.exr"
_TEXELS, _WAVES = 256, 4


def planes(folder: Path) -> Document:
    """The document; its texture goes into the folder."""
    write_grey(folder / _TEXTURE, _waves())
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [0, 1.6, 4.5],
            "look_at": [0, 0.9, 0],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": 45,
        },
        "surfaces": [
            _plane([-3, 0, 3], [6, 0, 0], [0, 0, -6]),
            _plane([-3, 0, -3], [6, 0, 0], [0, 4, 0]),
            {
                "shape": {
                    "type": "quad",
                    "corner": [-0.4, 3, -0.9],
                    "edge_u": [0.8, 0, 0],
                    "edge_v": [0, 0, 0.8],
                },
                "kernel": {"type": "lambertian", "reflectance": 0.0},
                "luminaire": {"radiance": {"illuminant": "A", "luminance": 10_000}},
            },
        ],
    }


def _plane(corner: list[float], edge_u: list[float], edge_v: list[float]) -> dict[str, Any]:
    texture = {"asset": _TEXTURE, "encoding": "linear"}
    return {
        "shape": {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v},
        "kernel": {
            "type": "lambertian",
            "reflectance": {"texture": texture, "spectrum": 0.8, "grey": True},
        },
    }


def _waves() -> Channel:
    """Light and dark in turns, without edges: one renderer blurs those that pixels do not resolve."""
    at = np.cos(2 * np.pi * _WAVES * (np.arange(_TEXELS) + 0.5) / _TEXELS)
    waves: Channel = 0.6 + 0.4 * at[:, None] * at[None, :]
    return waves
