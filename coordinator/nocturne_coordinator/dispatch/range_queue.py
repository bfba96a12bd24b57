"""The open ranges of one render, in the order in which they are to be published. Pure."""

from collections.abc import Callable, Set
from dataclasses import dataclass, field
from heapq import heappush

from nocturne_coordinator.limits import RANGES_AHEAD

TOGETHER, TOGETHER_IN_FLOOD = 2, 8
"""Ranges of a tile, after its first, that are given out one after the other."""


@dataclass(slots=True)
class FairShare:
    """One of those who share the workers: work given so far, divided by the weight."""

    weight: float
    virtual_time: float = 0.0


@dataclass(frozen=True, slots=True)
class ForwardRanges:
    """Ranges of forward photons, which are those of a tile after the last."""

    tile: int
    turns: list[int]
    """Of each, the range of tiles whose samples begin as late: both kinds go on together."""
    ahead: int
    """How many may be in flight or wait."""


@dataclass(slots=True)
class RangeQueue:
    """The open ranges of one render."""

    ranges: int
    completed: list[int]
    """Per tile, ranges completed."""
    following: list[int]
    """Per tile, the range to publish next; those below it were published once."""
    horizon: list[int]
    """Per tile, the ranges that it is expected to need."""
    ready: list[tuple[bool, int, bool, int, int]]
    """Heap of (may wait, turn, is a tile, tile, range to publish next): earlier ranges first, so the whole
    frame is first. Of forward photons before those of tiles, as they take longest."""
    owner: str
    share: FairShare
    cost: Callable[[int, int], float]
    """Of a tile's range, by the indices of both, in any unit that all renders have in common."""
    forward: ForwardRanges | None = None
    again: list[tuple[int, int]] = field(default_factory=list)
    """Heap of (range, tile) to publish once more."""
    held: set[tuple[int, int]] = field(default_factory=set)
    blocked: set[int] = field(default_factory=set)
    """Tiles that are not in `ready`, because RANGES_AHEAD of their ranges are in flight, or all they should
    need."""
    first: frozenset[int] = frozenset()
    """Tiles that somebody wants to see first; empty: all are alike."""
    together: int = TOGETHER
    """Of later ranges, how many of a tile come one after the other: short ones are then merged while the
    tile's sums are at hand, and written once for all of them."""

    def make_ready(self, range_index: int, tile: int) -> None:
        """Every tile's first range goes before all others: there is always a whole frame."""
        may_wait = bool(self.first) and range_index > 0 and tile not in self.first
        forward = self.forward if self._is_forward(tile) else None
        turn = self._turn_of(forward.turns[range_index] if forward else range_index)
        heappush(self.ready, (may_wait, turn, forward is None, tile, range_index))

    def _turn_of(self, range_index: int) -> int:
        """The first of those that come together, so that runs of any length go before each other as they
        should."""
        return 1 + (range_index - 1) // self.together * self.together if range_index else 0

    def ranges_of(self, tile: int) -> int:
        """How many a tile has, or forward photons."""
        return len(self.forward.turns) if self.forward and self._is_forward(tile) else self.ranges

    def ahead_of(self, tile: int) -> int:
        """How many of them may be in flight or wait."""
        return self.forward.ahead if self.forward and self._is_forward(tile) else RANGES_AHEAD

    def _is_forward(self, tile: int) -> bool:
        return self.forward is not None and tile == self.forward.tile

    def nowhere(self, tile: int, elsewhere: Set[int]) -> list[int]:
        """Open ranges of a tile that would never be published: neither `elsewhere` nor to come here."""
        # From here on each comes by itself; what lies before must be somewhere.
        comes = min((index for *_, of, index in self.ready if of == tile), default=self.ranges_of(tile))
        if tile in self.blocked:
            comes = min(comes, self.following[tile])
        somewhere = elsewhere | {index for index, of in self.again if of == tile}
        open_ranges = range(self.completed[tile], min(comes, self.ranges_of(tile)))
        return [index for index in open_ranges if index not in somewhere]
