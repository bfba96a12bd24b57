"""Where a render's picture goes while it is watched: a terminal that shows images, a running tev, or both.

Each asks the service for what changed since it last did, when it has time to: nothing queues up for a slow
one.
"""

import time
from collections.abc import Callable
from typing import BinaryIO, Protocol

import numpy as np
import numpy.typing as npt

from nocturne_client.client import Client
from nocturne_client.models import Render
from nocturne_client.preview.colour import shown
from nocturne_client.preview.graphics import Graphics
from nocturne_client.preview.terminal import picture
from nocturne_client.preview.tev import Tev
from nocturne_client.tiles import Tile

_EDGE = 400
"""Pixels of a picture in a terminal: about half of a usual window."""

_INTERVAL_S = 1.0
_HOME, _CLEAR, _CLEAR_REST = b"\x1b[H", b"\x1b[2J", b"\x1b[J"


class Sink(Protocol):
    """Takes the new parts of a render."""

    is_terminal: bool
    """It paints the terminal, so that a progress bar has no place there."""

    def show(self, render: Render) -> None:
        """A state of the render, with its newest pixels."""


class TevSink:
    """Keeps an image in tev up to date."""

    is_terminal = False

    def __init__(self, client: Client, tev: Tev) -> None:
        self._client = client
        self._tev = tev
        self._cursor = ""

    def show(self, render: Render) -> None:
        if not self._cursor:
            self._tev.create(f"{render.name} {render.id}", render.width, render.height)
        self._cursor = fetch(self._client, render.id, self._cursor, self._tev.update)


class TerminalSink:
    """Paints the picture and a line of text at the top of a terminal, at most once a second."""

    is_terminal = True

    def __init__(
        self, client: Client, graphics: Graphics, output: BinaryIO, about: Callable[[Render], str]
    ) -> None:
        self._client = client
        self._graphics = graphics
        self._output = output
        self._about = about
        self._cursor = ""
        self._next = 0.0
        self._xyz: npt.NDArray[np.float32] | None = None

    def show(self, render: Render) -> None:
        if time.monotonic() < self._next and not render.has_ended:
            return
        if self._xyz is None:
            self._xyz = np.zeros((render.height, render.width, 3), dtype=np.float32)
            self._output.write(_CLEAR)
        self._cursor = fetch(self._client, render.id, self._cursor, self._take)
        image = picture(shown(reduced(self._xyz, _EDGE)), self._graphics)
        text = f"{render.name}: {self._about(render)}\n"
        self._output.write(_HOME + image + text.encode(errors="replace") + _CLEAR_REST)
        self._output.flush()
        self._next = time.monotonic() + _INTERVAL_S

    def _take(self, tiles: list[Tile]) -> None:
        assert self._xyz is not None  # noqa: S101 - made before
        for tile in tiles:
            height, width = tile.pixels.shape[:2]
            self._xyz[tile.y : tile.y + height, tile.x : tile.x + width] = tile.pixels[..., :3]


def fetch(client: Client, render_id: str, since: str, take: Callable[[list[Tile]], None]) -> str:
    """All that changed since the cursor; gives the next one."""
    while True:
        answer = client.tiles(render_id, since)
        take(list(answer.tiles))
        since = answer.cursor
        if not answer.more:
            return since


def reduced(xyz: npt.NDArray[np.float32], edge: int) -> npt.NDArray[np.float32]:
    """Means of squares of pixels, so that no side is longer than `edge`."""
    size = -(-max(xyz.shape[:2]) // edge)
    height, width = (max(1, length // size) for length in xyz.shape[:2])
    rows, columns = min(size, xyz.shape[0]), min(size, xyz.shape[1])
    squares = xyz[: height * rows, : width * columns].reshape(height, rows, width, columns, 3)
    means: npt.NDArray[np.float32] = squares.mean(axis=(1, 3))
    return means
