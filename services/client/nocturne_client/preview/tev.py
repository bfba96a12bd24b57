"""Sends changed tiles to a running tev viewer, by its public protocol.

That is in github.com/Tom94/tev, src/python/ipc.py. A packet is its length, uint32 little-endian, itself
included; an operation, one byte; then fields: texts end with a zero byte, whole numbers are int32, offsets
and strides int64, pixels float32. Here 4 creates an image, 6 updates a rectangle of some of its channels.
"""

import socket
import struct
from collections.abc import Sequence
from types import TracebackType

import numpy as np
import numpy.typing as npt

from nocturne_client.errors import NocturneClientError
from nocturne_client.preview.colour import linear_srgb
from nocturne_client.tiles import Tile

DEFAULT_PORT = 14158
_CREATE = 4
_UPDATE = 6
_TIMEOUT_S = 10.0
_LAST_PORT = 65535

CHANNELS = ("R", "G", "B", "X", "Y", "Z", "Y.stderr")
"""Linear sRGB for the eye, and the measured quantities."""


class Tev:
    """A connection to tev, with one image of a render. Use it as a context manager."""

    def __init__(self, address: str) -> None:
        """`address`: HOST or HOST:PORT. Raises NocturneClientError where tev does not listen there."""
        host, _, port = address.rpartition(":") if ":" in address else (address, "", str(DEFAULT_PORT))
        try:
            if int(port) > _LAST_PORT:
                # Resolvers take it modulo 65536, where something else may listen.
                raise ValueError(f"there is no port {port}; expected at most {_LAST_PORT}")
            self._socket = socket.create_connection((host, int(port)), _TIMEOUT_S)
        except (OSError, ValueError, OverflowError) as error:
            raise NocturneClientError(
                f"no tev listens at {address}: {error}. Start tev, or say HOST:PORT."
            ) from error
        self._name = ""

    def __enter__(self) -> "Tev":
        return self

    def __exit__(
        self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None
    ) -> None:
        self._socket.close()

    def create(self, name: str, width: int, height: int) -> None:
        """An empty image; it comes to the front."""
        self._name = name
        channels = b"".join(_text(channel) for channel in CHANNELS)
        size = struct.pack("<3i", width, height, len(CHANNELS))
        self._send(struct.pack("<BB", _CREATE, 1) + _text(name) + size + channels)

    def update(self, tiles: Sequence[Tile]) -> None:
        """Pixels of these tiles; the image in front stays in front."""
        for tile in tiles:
            self._send(self._update_packet(tile))

    def _update_packet(self, tile: Tile) -> bytes:
        height, width = tile.pixels.shape[:2]
        count = len(CHANNELS)
        return b"".join(
            (
                struct.pack("<BB", _UPDATE, 0),
                _text(self._name),
                struct.pack("<i", count),
                *(_text(channel) for channel in CHANNELS),
                struct.pack("<4i", tile.x, tile.y, width, height),
                struct.pack(f"<{count}q", *range(count)),
                struct.pack(f"<{count}q", *[count] * count),
                _interleaved(tile.pixels).tobytes(),
            )
        )

    def _send(self, packet: bytes) -> None:
        try:
            self._socket.sendall(struct.pack("<I", len(packet) + 4) + packet)
        except OSError as error:
            raise NocturneClientError(f"tev does not listen any more: {error}") from error


def _interleaved(pixels: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """All channels of a pixel next to each other, in the order of CHANNELS."""
    both = np.concatenate([linear_srgb(pixels[..., :3]), pixels], axis=-1)
    return np.ascontiguousarray(both, dtype="<f4")


def _text(text: str) -> bytes:
    return text.replace("\0", " ").encode() + b"\0"
