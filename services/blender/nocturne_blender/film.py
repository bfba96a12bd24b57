"""The image so far: tiles of a service, put together. The bytes: docs/reference/api.md, "Tiles"."""

import struct

import numpy as np
from numpy.typing import NDArray

_MAGIC = b"NXY1"
_HEADER = struct.Struct("<7I")
_TILE = struct.Struct("<4I")


class TiledImage:
    """X, Y, Z, the standard error of Y and the samples of each pixel; the bottom row first, as in Blender."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.xyz: NDArray[np.float32] = np.zeros((height, width, 3), np.float32)
        self.y_error: NDArray[np.float32] = np.zeros((height, width, 1), np.float32)
        self.samples: NDArray[np.float32] = np.zeros((height, width, 1), np.float32)
        self.cursor = ""

    def take(self, answer: bytes) -> bool:
        """Puts an answer's tiles in; tells whether the service has more of them. Raises ValueError."""
        if not answer:
            return False
        try:
            return self._take(answer)
        except struct.error as error:
            raise ValueError(f"the service's tiles can't be read: {error}") from error

    def _take(self, answer: bytes) -> bool:
        if answer[:4] != _MAGIC:
            raise ValueError("the service's tiles can't be read: they don't begin with NXY1")
        width, height, size, count, more, revision, last = _HEADER.unpack_from(answer, 4)
        if (width, height) != (self.width, self.height):
            raise ValueError(
                f"the service's image has {width} x {height} pixels, not {self.width} x {self.height}"
            )
        columns, offset = -(-width // size), 4 + _HEADER.size
        for _ in range(count):
            index, samples, _, _ = _TILE.unpack_from(answer, offset)
            offset += _TILE.size
            top, left = index // columns * size, index % columns * size
            rows, wide = min(size, height - top), min(size, width - left)
            values = np.frombuffer(answer, "<f4", rows * wide * 4, offset).reshape(rows, wide, 4)[::-1]
            offset += values.nbytes
            at = (slice(height - top - rows, height - top), slice(left, left + wide))
            self.xyz[at], self.y_error[at], self.samples[at] = values[..., :3], values[..., 3:], samples
        self.cursor = f"{revision}.{last}"
        return bool(more)
