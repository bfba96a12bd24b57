"""The ordered merge of one tile: every planned range exactly once, in sample order, in float64. Pure.

Floating-point addition depends on its order, so a range that comes early waits for those before it: the sums
are then, bit for bit, those of one process that traces the ranges one after the other.
"""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
import numpy.typing as npt

from .limits import RANGES_AHEAD

Sums = npt.NDArray[np.float64]
"""Shape (height, width, XYZ_SUMS or more): over samples, sums of X, Y, Z and Y squared, then of each further
response of the sensor."""

XYZ_SUMS = 4
"""Of a pixel without further responses."""

Counts = npt.NDArray[np.uint32]
"""Shape (height, width): samples in a film's sums."""


@dataclass(frozen=True, slots=True)
class RangeSums:
    """The checked partial result of one range of one tile."""

    index: int
    """Of the range in its plan."""
    sums: Sums
    photons: int
    rays: int
    rejected: int
    cpu_seconds: float
    entry: bytes
    """The result stream's entry that brought it."""


class Verdict(Enum):
    """What became of an offered range."""

    MERGED = "merged"
    EARLY = "early"
    """Waits for an earlier range."""
    DUPLICATE = "duplicate"
    """Is merged or waits already."""
    TOO_EARLY = "too early"
    """Is further ahead than anything that should be in flight; was not kept, is to be traced again."""


@dataclass(slots=True)
class TileState:
    """Sums of the first `merged` ranges, and ranges that wait."""

    sums: Sums
    """May be a view into the film's array; changed in place."""
    merged: int = 0
    waiting: dict[int, RangeSums] = field(default_factory=dict)

    def offer(self, offered: RangeSums) -> tuple[Verdict, list[RangeSums]]:
        """Takes a range; gives what became of it, and the ranges merged now: it and those it released."""
        if offered.index < self.merged or offered.index in self.waiting:
            return Verdict.DUPLICATE, []
        if offered.index >= self.merged + RANGES_AHEAD:
            return Verdict.TOO_EARLY, []
        self.waiting[offered.index] = offered
        released = []
        while (following := self.waiting.pop(self.merged, None)) is not None:
            self.sums += following.sums
            self.merged += 1
            released.append(following)
        return (Verdict.MERGED if released else Verdict.EARLY), released
