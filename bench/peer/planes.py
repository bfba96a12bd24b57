"""A floor and a wall with textures under one lamp: nearly all of the light is direct."""

from pathlib import Path

import numpy as np

from bench.peer.pieces import diffuse, quad, textured
from bench.peer.sky import write_grey
from bench.programs import Channel
from bench.scenes import Document

_TEXTURE = "waves.exr"
_TEXELS, _WAVES = 256, 4


def planes(folder: Path) -> Document:
    """The document; its texture goes into the folder."""
    write_grey(folder / _TEXTURE, _waves())
    waves = textured(_TEXTURE, 0.8)
    lamp = quad([-0.4, 3, -0.9], [0.8, 0, 0], [0, 0, 0.8], diffuse(0.0))
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
            quad([-3, 0, 3], [6, 0, 0], [0, 0, -6], waves),
            quad([-3, 0, -3], [6, 0, 0], [0, 4, 0], waves),
            lamp | {"luminaire": {"radiance": {"illuminant": "A", "luminance": 10_000}}},
        ],
    }


def _waves() -> Channel:
    """Light and dark in turns, without edges: one renderer blurs those that pixels do not resolve."""
    at = np.cos(2 * np.pi * _WAVES * (np.arange(_TEXELS) + 0.5) / _TEXELS)
    waves: Channel = 0.6 + 0.4 * at[:, None] * at[None, :]
    return waves
