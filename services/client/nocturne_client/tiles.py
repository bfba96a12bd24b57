"""Committed tiles as the service sends them, decoded: docs/reference/api.md, "Tiles"."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nocturne_client.errors import NocturneClientError

_MAGIC = b"NXY1"
_HEADER = struct.Struct("<7I")
_TILE = struct.Struct("<4I")


@dataclass(frozen=True)
class Tile:
    """A rectangle of the film, and what its pixels have now."""

    x: int
    y: int
    samples: int
    invalid_samples: int
    pixels: npt.NDArray[np.float32]
    """Shape (height, width, 4): X, Y (cd/m2), Z, standard error of Y."""


@dataclass(frozen=True)
class TileAnswer:
    """What changed."""

    width: int
    height: int
    tiles: Sequence[Tile]
    more: bool
    cursor: str
    """To ask for what changes after this."""


def decode_tiles(content: bytes) -> TileAnswer:
    """Raises NocturneClientError where the bytes are no such answer."""
    try:
        return _decode(content)
    except (struct.error, ValueError) as error:
        raise NocturneClientError(f"the service's tiles can't be read: {error}") from error


def _decode(content: bytes) -> TileAnswer:
    if content[:4] != _MAGIC:
        raise ValueError("they don't begin with NXY1")
    width, height, size, count, more, revision, last = _HEADER.unpack_from(content, 4)
    columns = -(-width // size)
    offset, tiles = 4 + _HEADER.size, []
    for _ in range(count):
        index, samples, invalid_samples, _ = _TILE.unpack_from(content, offset)
        row, column = divmod(index, columns)
        x, y = column * size, row * size
        shape = (min(size, height - y), min(size, width - x), 4)
        offset += _TILE.size
        pixels = np.frombuffer(content, "<f4", shape[0] * shape[1] * 4, offset).reshape(shape)
        offset += pixels.nbytes
        tiles.append(Tile(x, y, samples, invalid_samples, pixels))
    return TileAnswer(width, height, tiles, bool(more), f"{revision}.{last}")
