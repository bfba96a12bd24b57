"""A furnished room behind a window, made for this comparison.

Walls of plaster, a floor of boards and a carpet have textures; table, chairs, shelf and sofa are boxes, some
lacquered; light comes by a window from the sky with its sun, and by a lamp under the ceiling.
"""

from pathlib import Path

import numpy as np

from bench.peer.pieces import Vec, box, diffuse, quad, textured
from bench.peer.sky import SKY, write_grey, write_sky
from bench.programs import Channel
from bench.scenes import Document

_WIDTH, _HEIGHT, _DEPTH = 4.0, 2.6, 5.0
"""Metres: x, y, z; the camera stands at the near end of z."""

_WINDOW = (0.9, 2.1, 1.5, 3.3)
"""In the wall at x = 0: y from and to, z from and to."""

_BOARDS, _PLASTER, _WEAVE = "boards.exr", "plaster.exr", "weave.exr"
_TEXELS = 256


def room(folder: Path) -> Document:
    """The document; its pictures go into the folder."""
    write_sky(folder / SKY)
    for name, picture in ((_BOARDS, _boards()), (_PLASTER, _plaster()), (_WEAVE, _weave())):
        write_grey(folder / name, picture)
    return {
        "nocturne": 1,
        "sensor": {
            "type": "pinhole",
            "position": [3.2, 1.5, 4.8],
            "look_at": [1.5, 0.9, 1.2],
            "up": [0, 1, 0],
            "vertical_field_of_view_degrees": 62,
        },
        "surfaces": [*_walls(), *_furniture(), _lamp()],
        "environment": {"asset": SKY, "luminance": 5000, "up": [0, 1, 0], "forward": [0, 0, 1]},
    }


def _walls() -> list[Document]:
    plaster, ceiling = textured(_PLASTER, 0.75), diffuse(0.8)
    x, y, z = [_WIDTH, 0, 0], [0, _HEIGHT, 0], [0, 0, _DEPTH]
    low, high, near, far = _WINDOW
    beside: list[tuple[Vec, Vec, Vec]] = [
        ([0, 0, 0], [0, low, 0], z),
        ([0, high, 0], [0, _HEIGHT - high, 0], z),
        ([0, low, 0], [0, high - low, 0], [0, 0, near]),
        ([0, low, far], [0, high - low, 0], [0, 0, _DEPTH - far]),
    ]
    return [
        quad([0, 0, 0], z, x, textured(_BOARDS, 0.55)),
        quad([0, _HEIGHT, 0], x, z, ceiling),
        quad([0, 0, 0], x, y, plaster),
        quad([0, 0, _DEPTH], y, x, plaster),
        quad([_WIDTH, 0, 0], z, y, plaster),
        *(quad(corner, u, v, plaster) for corner, u, v in beside),
    ]


def _furniture() -> list[Document]:
    lacquer = {"type": "coated_diffuse", "index": 1.5, "reflectance": 0.35}
    wood, cloth, weave = diffuse(0.3), diffuse(0.5), textured(_WEAVE, 0.6)
    table = [box([1.3, 0.7, 1.9], [2.5, 0.75, 2.7], lacquer)]
    table += [box([x, 0, z], [x + 0.06, 0.699, z + 0.06], wood) for x in (1.32, 2.4) for z in (1.92, 2.6)]
    chairs = []
    for x, z in ((1.0, 2.1), (2.5, 2.1)):
        chairs += [box([x, 0.42, z], [x + 0.4, 0.46, z + 0.4], wood)]
        chairs += [
            box([x + a, 0, z + b], [x + a + 0.04, 0.419, z + b + 0.04], wood)
            for a in (0, 0.36)
            for b in (0, 0.36)
        ]
    sofa = [
        box([1.0, 0.001, 0.1], [3.0, 0.4, 0.9], cloth),
        box([1.0, 0.401, 0.1], [3.0, 0.85, 0.3], cloth),
    ]
    shelf = [
        box([3.6, 0.4 * level + 0.3, 1.0], [3.95, 0.4 * level + 0.33, 2.4], lacquer) for level in range(4)
    ]
    shelf += [
        box(
            [3.65, 0.4 * level + 0.331, 1.1 + 0.11 * book],
            [3.85, 0.4 * level + 0.58, 1.18 + 0.11 * book],
            diffuse(shade),
        )
        for level in range(3)
        for book, shade in enumerate((0.2, 0.5, 0.7, 0.3, 0.6, 0.15, 0.45))
    ]
    carpet = quad([0.9, 0.005, 1.2], [0, 0, 1.8], [2.4, 0, 0], weave)
    bowl = {"shape": {"type": "sphere", "centre": [1.9, 0.9, 2.3], "radius": 0.14}, "kernel": lacquer}
    return [carpet, *table, *chairs, *sofa, *shelf, bowl]


def _lamp() -> Document:
    lamp = quad([1.85, 2.4, 2.3], [0.3, 0, 0], [0, 0, 0.3], diffuse(0.5))
    return lamp | {"luminaire": {"radiance": {"illuminant": "A", "luminance": 8000}}}


def _boards() -> Channel:
    """Boards of different shades with dark joints."""
    random = np.random.default_rng(7)
    shades = random.uniform(0.6, 1.0, 8)
    row, column = np.mgrid[0:_TEXELS, 0:_TEXELS]
    joint = np.where(row % (_TEXELS // 8) < 2, 0.3, 1.0)
    grain = 1.0 - 0.12 * (0.5 + 0.5 * np.sin(column / 3.0 + row))
    picture: Channel = shades[row * 8 // _TEXELS] * joint * grain
    return picture


def _plaster() -> Channel:
    """Nearly even."""
    picture: Channel = np.random.default_rng(8).uniform(0.85, 1.0, (_TEXELS // 4, _TEXELS // 4))
    return picture


def _weave() -> Channel:
    """A pattern of stripes in both directions."""
    row, column = np.mgrid[0:_TEXELS, 0:_TEXELS]
    picture: Channel = 0.35 + 0.6 * (((row // 16) + (column // 16)) % 2)
    return picture
