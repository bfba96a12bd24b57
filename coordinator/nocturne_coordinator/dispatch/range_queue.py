"""The open ranges of one render, in the order in which they are to be published. Pure."""

from collections.abc import Callable, Set
from dataclasses import dataclass, field
from heapq import heappush


@dataclass(slots=True)
class FairShare:
    """One of those who share the workers: work given so far, divided by the weight."""

    weight: float
    virtual_time: float = 0.0


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
    ready: list[tuple[bool, int, int]]
    """Heap of (may wait, range to publish next, tile): earlier ranges first, so the whole frame is first."""
    owner: str
    share: FairShare
    cost: Callable[[int], float]
    """Of a range by its index, in any unit that all renders have in common."""
    again: list[tuple[int, int]] = field(default_factory=list)
    """Heap of (range, tile) to publish once more."""
    held: set[tuple[int, int]] = field(default_factory=set)
    blocked: set[int] = field(default_factory=set)
    """Tiles that are not in `ready`, because RANGES_AHEAD of their ranges are in flight, or all they should
    need."""
    first: frozenset[int] = frozenset()
    """Tiles that somebody wants to see first; empty: all are alike."""

    def make_ready(self, range_index: int, tile: int) -> None:
        """Every tile's first range goes before all others: there is always a whole frame."""
        may_wait = bool(self.first) and range_index > 0 and tile not in self.first
        heappush(self.ready, (may_wait, range_index, tile))

    def nowhere(self, tile: int, elsewhere: Set[int]) -> list[int]:
        """Open ranges of a tile that would never be published: neither `elsewhere` nor to come here."""
        # From here on each comes by itself; what lies before must be somewhere.
        comes = min((index for _, index, of in self.ready if of == tile), default=self.ranges)
        if tile in self.blocked:
            comes = min(comes, self.following[tile])
        somewhere = elsewhere | {index for index, of in self.again if of == tile}
        open_ranges = range(self.completed[tile], min(comes, self.ranges))
        return [index for index in open_ranges if index not in somewhere]
