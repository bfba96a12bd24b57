"""The ordered merge of one queue of ranges, of a tile or of forward photons: each exactly once, in order, in
float64. Pure.

Floating-point addition depends on its order, so a range that comes early waits for those before it: the sums
are then, bit for bit, those of one process that traces the ranges one after the other.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from nocturne_scene.photon_sums import PackedPhotons
from nocturne_scene.tile_sums import TileSums

from nocturne_coordinator.limits import RANGES_AHEAD

Sums = npt.NDArray[np.float64]
"""Shape (height, width, sums_per_pixel): sums over samples, in the order of nocturne_scene.tile_sums."""

Counts = npt.NDArray[np.uint32]
"""Shape (height, width): samples in a film's sums."""


@dataclass(frozen=True, slots=True)
class RangeSums:
    """The checked partial result of one range."""

    index: int
    """Of the range in its schedule."""
    sums: TileSums | PackedPhotons
    photons: int
    rays: int
    invalid_samples: int
    cpu_seconds: float
    entry: bytes
    """The result stream's entry that brought it."""
    worker: str = ""
    """Who traced it."""
    truncated_paths: int = 0


class MergeResult(Enum):
    """What became of an offered range."""

    MERGED = "merged"
    EARLY = "early"
    """Waits for an earlier range."""
    DUPLICATE = "duplicate"
    """Is merged or waits already."""
    TOO_EARLY = "too early"
    """Is further ahead than anything that should be in flight; was not kept, is to be traced again."""


class Offered(NamedTuple):
    """What became of an offered range."""

    verdict: MergeResult
    released: list[RangeSums]
    """Merged now: it and those that waited for it."""
    surplus: list[RangeSums]
    """Waited, and are of no use: no more are needed."""


def never(_: "Accumulator") -> bool:
    """It goes on to its last planned range."""
    return False


@dataclass(slots=True)
class Accumulator:
    """Sums of the first `merged` ranges, and ranges that wait."""

    sums: TileSums
    """May be views into the film's arrays; changed in place."""
    ahead: int = RANGES_AHEAD
    """Ranges that may be in flight or wait."""
    merged: int = 0
    waiting: dict[int, RangeSums] = field(default_factory=dict)
    closed: bool = False
    """Gets no more samples."""

    def offer(self, offered: RangeSums, enough: Callable[["Accumulator"], bool] = never) -> Offered:
        """Takes a range. `enough` is asked at the end of each merged range: whether that was the
        last."""
        if self.closed or offered.index < self.merged or offered.index in self.waiting:
            return Offered(MergeResult.DUPLICATE, [], [])
        if offered.index >= self.merged + self.ahead:
            return Offered(MergeResult.TOO_EARLY, [], [])
        self.waiting[offered.index] = offered
        released = []
        while not self.closed and (following := self.waiting.pop(self.merged, None)) is not None:
            self.sums += following.sums.unpacked()
            self.merged += 1
            released.append(following)
            self.closed = enough(self)
        surplus = self.close() if self.closed else []
        return Offered(MergeResult.MERGED if released else MergeResult.EARLY, released, surplus)

    def close(self) -> list[RangeSums]:
        """No more samples from here on; gives what waited."""
        self.closed = True
        surplus = list(self.waiting.values())
        self.waiting.clear()
        return surplus
