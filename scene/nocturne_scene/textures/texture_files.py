"""Texture files: all levels of a picture as raw numbers, which the tracer maps into memory.

`worker/src/textures/texture_file.h` says how they lie. Equal pictures give equal bytes: nothing goes into a
file but its numbers.
"""

import struct
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

VERSION = 1

Pixels = NDArray[np.float32]
_Level = NDArray[np.uint8] | NDArray[np.float16] | NDArray[np.float32]

_HEADER = struct.Struct("<8s7I")
_MAGIC = b"NOCTEXEL"
_STRIP = 64
_ALIGNMENT = 64
_TABLE = 4 * 256
_HALF, _FLOAT = "<f2", "<f4"
# By bytes of a number.
_NUMBERS: dict[int, str] = {1: "u1", 2: _HALF, 4: _FLOAT}


def packed(values: Pixels, *, narrow: bool) -> bytes:
    """The file of a picture of shape (height, width, 1 or 3).

    Of numbers of half where it is `narrow`; else of float, but for the finest level where half loses nothing.
    """
    with np.errstate(over="ignore"):
        first = values.astype(_HALF)
    coarser = _HALF if narrow else _FLOAT
    if not narrow and not np.array_equal(first, values):
        return _file(values, values, coarser)
    return _file(first, values, coarser)


def packed_codes(codes: NDArray[np.uint8], table: Pixels) -> bytes:
    """The same of codes of 8 bits and what the 256 of them stand for, which are numbers of half.

    Coarser levels are means of `table`'s numbers, in half.
    """
    return _file(codes, table[codes], _HALF, table.astype(_HALF).astype(_FLOAT).tobytes())


def finest(content: bytes) -> Pixels:
    """Read the finest level of a file that `packed` or `packed_codes` made: (height, width, 1 or 3)."""
    _, version, width, height, channels, size, _, _ = _HEADER.unpack_from(content)
    if content[:8] != _MAGIC or version != VERSION:
        raise ValueError("no texture file of this version")
    first = _aligned(_HEADER.size + (_TABLE if size == 1 else 0))
    across, strips = min(width, _STRIP), -(-width // _STRIP)
    shape = (strips, height + 1, across + 1, channels)
    stored = np.frombuffer(content, _NUMBERS[size], int(np.prod(shape)), first).reshape(shape)
    level = stored[:, :height, :across].swapaxes(0, 1).reshape(height, -1, channels)[:, :width]
    if size == 1:
        return np.frombuffer(content, "<f4", 256, _HEADER.size)[level]
    return level.astype(np.float32)


def _file(finest_level: _Level, values: Pixels, coarser: str, table: bytes = b"") -> bytes:
    height, width, channels = values.shape
    sizes = (finest_level.itemsize, np.dtype(coarser).itemsize)
    count = max(width, height).bit_length()
    content = bytearray(_HEADER.pack(_MAGIC, VERSION, width, height, channels, *sizes, count) + table)
    level = finest_level
    while True:
        content += bytes(_aligned(len(content)) - len(content))
        for strip in _strips(level):
            content += strip.tobytes()
        if values.shape[:2] == (1, 1):
            return bytes(content)
        values = _coarser(values)
        level = values.astype(coarser)


def _aligned(size: int) -> int:
    return -(-size // _ALIGNMENT) * _ALIGNMENT


def _strips(level: _Level) -> Iterator[_Level]:
    """Columns with the one to the right of them and the row below: where the level ends, its first."""
    height, width, channels = level.shape
    across = min(width, _STRIP)
    for left in range(0, width, _STRIP):
        columns = np.arange(left, min(left + across, width) + 1) % width
        strip = np.zeros((height + 1, across + 1, channels), level.dtype)
        strip[:height, : len(columns)] = level[:, columns]
        strip[height] = strip[0]
        yield strip


def _coarser(values: Pixels) -> Pixels:
    """Half as wide and as high, rounded down.

    Means of 2 x 2 pixels; where an edge is odd, the picture interpolated in the middles of the new pixels.
    The numbers have the bits that OpenImageIO's make_texture gives them.
    """
    half = np.float32(0.5)
    if values.shape[0] % 2 == 0 and values.shape[1] % 2 == 0:
        rows = values[:, ::2] * half + values[:, 1::2] * half
        return np.asarray(rows[::2] * half + rows[1::2] * half, np.float32)
    above, below, down = _middles(values.shape[0])
    left, right, across = _middles(values.shape[1])
    down, across, one = down[:, None, None], across[:, None], np.float32(1.0)
    top, bottom = (
        values[rows][:, left] * (one - across) + values[rows][:, right] * across for rows in (above, below)
    )
    return np.asarray(top * (one - down) + bottom * down, np.float32)


def _middles(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp], Pixels]:
    """Along an edge: which two pixels are next to the middles of new ones, and the part of the second."""
    coarse = max(count // 2, 1)
    along = (np.arange(coarse, dtype=np.float32) + np.float32(0.5)) * np.float32(1.0 / coarse)
    place = along * np.float32(count) - np.float32(0.5)
    first = np.floor(place)
    at = first.astype(np.intp)
    return np.maximum(at, 0), np.minimum(at + 1, count - 1), place - first
