"""Texture files read number by number, as worker/src/textures/texture_file.h says how they lie."""

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

Level = NDArray[np.float32]


def levels_of(content: bytes) -> list[Level]:
    """All levels, the finest first, of shape (height, width, channels); the padding around them is
    checked."""
    magic, version, width, height, channels, finest, coarser, count = struct.unpack_from("<8s7I", content)
    assert (magic, version) == (b"NOCTEXEL", 1)
    table = np.frombuffer(content, "<f4", 256, 36) if finest == 1 else None
    at = 36 if table is None else 36 + 1024
    found: list[Level] = []
    for level in range(count):
        size = finest if level == 0 else coarser
        shape = (max(height >> level, 1), max(width >> level, 1), channels)
        at = -(-at // 64) * 64
        numbers, at = _level(content, at, size, shape)
        found.append(table[numbers] if size == 1 and table is not None else numbers.astype(np.float32))
    assert at == len(content)
    return found


def _level(content: bytes, at: int, size: int, shape: tuple[int, int, int]) -> tuple[Any, int]:
    height, width, channels = shape
    level = np.empty(shape, {1: "u1", 2: "<f2", 4: "<f4"}[size])
    around = []
    across = min(width, 64)
    for left in range(0, width, 64):
        for y in range(height + 1):
            row = np.frombuffer(content, level.dtype, (across + 1) * channels, at).reshape(-1, channels)
            at += row.nbytes
            for x, texel in enumerate(row, left):
                if x < min(left + across, width) and y < height:
                    level[y, x] = texel
                elif x <= width:
                    around.append((y % height, x % width, texel))
                else:
                    assert not texel.any()
    assert all(np.array_equal(level[y, x], texel) for y, x, texel in around)
    return level, at
