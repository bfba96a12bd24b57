"""Committed tiles as little-endian floats: what a viewer needs of an image that grows, and no more.

An answer is a header of eight uint32 (the bytes "NXY1", width and height of the film, edge of a tile, number
of tiles here, whether there are more, revision and index of the last one here) and then, for each tile, four
uint32 (index, samples, invalid samples, revision) and its pixels, row by row: float32 X, Y, Z and the
standard error of Y, the same numbers that the EXR has.
"""

import asyncio
import struct
from collections import OrderedDict
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.merge import Sums
from nocturne_coordinator.output.images import mean_xyz
from nocturne_coordinator.store.rows import TileChange
from nocturne_scene.compare.images import Picture
from nocturne_scene.errors import InputError
from nocturne_scene.pixel_errors import pixel_variance
from nocturne_scene.ranges import TileGrid
from nocturne_scene.tile_sums import decode

from nocturne_api.limits import TILE_ANSWERS_KEPT, TILES_ANSWER_BYTES

MEDIA_TYPE = "application/vnd.nocturne.tiles"

_MAGIC = b"NXY1"
_PIXEL_BYTES = 16
_LARGEST = 2**32 - 1
_LONGEST = len(str(_LARGEST))


@dataclass(frozen=True, order=True)
class Cursor:
    """How far a viewer is: it has all tiles up to this one, ordered by revision, then index."""

    revision: int = 0
    tile_index: int = 0

    def __str__(self) -> str:
        return f"{self.revision}.{self.tile_index}"

    @classmethod
    def of(cls, text: str) -> "Cursor":
        """From "REVISION.TILE", empty for the beginning; raises InputError."""
        if not text:
            return cls()
        revision, _, tile_index = text.partition(".")
        if not (
            revision.isascii() and revision.isdecimal() and tile_index.isascii() and tile_index.isdecimal()
        ):
            raise InputError.at("query.since", "expected REVISION.TILE, as an answer's ETag has it")
        # Python refuses to read thousands of digits.
        if max(len(revision), len(tile_index)) <= _LONGEST:
            cursor = cls(int(revision), int(tile_index))
            if max(cursor.revision, cursor.tile_index) <= _LARGEST:
                return cursor
        raise InputError.at("query.since", f"expected numbers up to {_LARGEST}")


@dataclass(frozen=True)
class Tiles:
    """An answer, and where the next one goes on."""

    content: bytes
    end: Cursor


def tiles_per_answer(schedule: job_pb2.RangeSchedule) -> int:
    """So many that an answer has about TILES_ANSWER_BYTES; at least one."""
    return max(1, TILES_ANSWER_BYTES // (_PIXEL_BYTES * schedule.tile_size**2))


def encode(
    schedule: job_pb2.RangeSchedule, since: Cursor, tiles: Sequence[tuple[TileChange, bytes]], more: bool
) -> Tiles:
    """`tiles` with their sums, in the order of revision and index; `more` of them wait."""
    grid, further = TileGrid.of(schedule), len(schedule.further_responses)
    end = Cursor(tiles[-1][0].revision, tiles[-1][0].tile_index) if tiles else since
    film = (schedule.width, schedule.height, schedule.tile_size)
    parts = [_MAGIC, struct.pack("<7I", *film, len(tiles), more, end.revision, end.tile_index)]
    for change, sums in tiles:
        tile = grid.tile(change.tile_index)
        invalid_samples = min(change.invalid_samples, _LARGEST)
        parts.append(struct.pack("<4I", change.tile_index, change.samples, invalid_samples, change.revision))
        parts.append(_pixels(decode(sums, tile.width, tile.height, further).pixels, change.samples))
    return Tiles(b"".join(parts), end)


def encode_picture(picture: Picture, edge: int) -> bytes:
    """An image file as an answer with all of its tiles, of revision 0; of 1 sample where it tells none."""
    height, width, _ = picture.xyz.shape
    pixels = np.zeros((height, width, 4), dtype="<f4")
    pixels[..., :3] = picture.xyz
    if picture.y_error is not None:
        pixels[..., 3] = picture.y_error
    samples = np.ones((height, width)) if picture.samples is None else picture.samples
    corners = [(y, x) for y in range(0, height, edge) for x in range(0, width, edge)]
    parts = [_MAGIC, struct.pack("<7I", width, height, edge, len(corners), False, 0, len(corners) - 1)]
    for index, (y, x) in enumerate(corners):
        parts.append(struct.pack("<4I", index, min(max(int(samples[y, x]), 0), _LARGEST), 0, 0))
        parts.append(pixels[y : y + edge, x : x + edge].tobytes())
    return b"".join(parts)


def _pixels(sums: Sums, samples: int) -> bytes:
    counts = np.full(sums.shape[:2], samples, dtype=np.uint32)
    pixels = np.empty((*counts.shape, 4), dtype="<f4")
    pixels[..., :3] = mean_xyz(sums, counts)
    pixels[..., 3] = np.sqrt(pixel_variance(sums[..., 1], sums[..., 3], counts))
    return pixels.tobytes()


def runs(indices: Sequence[int]) -> list[tuple[int, int]]:
    """Numbers as first and last of runs without gaps."""
    found: list[tuple[int, int]] = []
    for index in sorted(set(indices)):
        if found and found[-1][1] == index - 1:
            found[-1] = (found[-1][0], index)
        else:
            found.append((index, index))
    return found


class TileAnswers:
    """The last answers: watchers of one render ask for the same tiles at about the same time."""

    def __init__(self, make: Callable[[str, Cursor], Coroutine[Any, Any, Tiles]]) -> None:
        self._make = make
        self._kept: OrderedDict[tuple[str, Cursor, int], asyncio.Task[Tiles]] = OrderedDict()

    async def get(self, render_id: str, since: Cursor, sequence: int) -> Tiles:
        """What changed since the cursor in a render whose sequence is `sequence`."""
        key = (render_id, since, sequence)
        task = self._kept.get(key)
        if task is None or (task.done() and (task.cancelled() or task.exception())):
            task = self._kept[key] = asyncio.create_task(self._make(render_id, since))
        self._kept.move_to_end(key)
        while len(self._kept) > TILE_ANSWERS_KEPT:
            self._kept.popitem(last=False)
        # Others may wait for the same when this caller goes away.
        return await asyncio.shield(task)
