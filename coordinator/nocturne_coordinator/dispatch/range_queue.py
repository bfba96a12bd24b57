"""The ranges of one render: the state of each, and the order in which planned ones are published. Pure."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from heapq import heappop, heappush

from nocturne_coordinator.limits import RANGES_AHEAD

TOGETHER = 2
"""Ranges of a tile, after its first, that are given out one after the other: short ones are then merged while
the tile's sums are at hand. More would leave other tiles behind for too long (decision 0131)."""


class RangeState(IntEnum):
    """Where a range of a tile stands; docs/explanation/queue.md says where its samples are."""

    PLANNED = 0
    PUBLISHED = 1
    """Its job is on the stream, or is being put there."""
    HELD = 2
    """Its result is here, and waits for an earlier range."""
    COMPLETED = 3
    """Its result is in the film."""
    COMMITTED = 4
    FAILED = 5
    """Its tile has failed, and gets no more samples."""
    UNNEEDED = 6
    """Its tile has all the samples that it needs."""


_PLANNED, _PUBLISHED, _HELD, _COMPLETED, _COMMITTED, *_CLOSED = RangeState

_TRANSITIONS = {
    # Held at once: the result of an earlier job comes late.
    _PLANNED: {_PUBLISHED, _HELD, *_CLOSED},
    _PUBLISHED: {_PLANNED, _HELD, *_CLOSED},
    _HELD: {_COMPLETED, *_CLOSED},
    _COMPLETED: {_COMMITTED},
}
"""By state, those that may follow."""

IN_FLIGHT = (_PUBLISHED, _HELD)


class InvalidTransition(AssertionError):
    """A range cannot go from its state to the one that was asked for; names all three."""


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
    """The ranges of one render."""

    render_id: str
    states: list[bytearray]
    """Per tile, the state of each range. All else that is known of ranges is an index or a count of these."""
    horizon: list[int]
    """Per tile, the ranges that it is expected to need."""
    owner: str
    share: FairShare
    cost: Callable[[int, int], float]
    """Of a tile's range, by the indices of both, in any unit that all renders have in common."""
    forward: ForwardRanges | None = None
    ready: list[tuple[bool, int, bool, int, int]] = field(init=False)
    """Heap of (may wait, turn, is a tile, tile, range to publish next): earlier ranges first, so the whole
    frame is first. Ranges of forward photons go before those of tiles, as they take longest. An entry counts
    while `following` names its range."""
    following: list[int] = field(init=False)
    """Per tile, the range to publish next; -1: none is planned, RANGES_AHEAD of them are in flight, or all
    that the tile should need."""
    first: frozenset[int] = field(init=False)
    """Tiles that somebody wants to see first; empty: all are alike."""
    in_flight: int = 0
    """Ranges that are published or held."""

    def __post_init__(self) -> None:
        self.order(frozenset())

    def order(self, first: frozenset[int]) -> None:
        """Rebuilds the heap, with these tiles before the others."""
        self.first, self.ready, self.following = first, [], [-1] * len(self.states)
        for tile in range(len(self.states)):
            self._follow(tile)

    def expect(self, tile: int, ranges: int) -> None:
        """How many ranges the tile is expected to need."""
        self.horizon[tile] = ranges
        self._follow(tile)

    def done(self, tile: int) -> int:
        """How many of a tile's first ranges are completed or committed."""
        return self.states[tile].count(_COMPLETED) + self.states[tile].count(_COMMITTED)

    def move(self, tile: int, index: int, to: RangeState) -> None:
        """Brings a range to another state; InvalidTransition where none leads there."""
        before = RangeState(self.states[tile][index])
        if to not in _TRANSITIONS.get(before, ()):
            place = f"render={self.render_id} tile={tile} range={index}"
            raise InvalidTransition(f"{place} is {before.name} and can't become {to.name}")
        self.states[tile][index] = to
        self.in_flight += (to in IN_FLIGHT) - (before in IN_FLIGHT)
        self._follow(tile)

    def pop(self) -> tuple[int, int] | None:
        """Tile and range to publish next, if there is one; it is to be moved to published."""
        while self.ready:
            *_, tile, index = heappop(self.ready)
            if self.following[tile] == index:
                return tile, index
        return None

    def problem(self) -> str:
        """The first fault in the indexes, empty if there is none; for tests."""
        entries = {(tile, index) for *_, tile, index in self.ready}
        for tile, index in enumerate(self.following):
            if index != self._next_of(tile) or (index >= 0 and (tile, index) not in entries):
                return f"render={self.render_id} tile={tile} range={index} would never be published"
        in_flight = sum(states.count(each) for states in self.states for each in IN_FLIGHT)
        return (
            "" if in_flight == self.in_flight else f"render={self.render_id} has {in_flight} ranges in flight"
        )

    def _follow(self, tile: int) -> None:
        """Puts the tile in the heap with the range to publish next, unless it is there."""
        index = self._next_of(tile)
        if index == self.following[tile]:
            return
        self.following[tile] = index
        if index >= 0:
            # Every tile's first range goes before all others: there is always a whole frame.
            may_wait = bool(self.first) and index > 0 and tile not in self.first
            forward = self._forward(tile)
            turn = forward.turns[index] if forward else index
            if turn > 0:
                # The first of those that come together.
                turn -= (turn - 1) % TOGETHER
            heappush(self.ready, (may_wait, turn, forward is None, tile, index))

    def _next_of(self, tile: int) -> int:
        done, forward = self.done(tile), self._forward(tile)
        ahead = forward.ahead if forward else RANGES_AHEAD
        return self.states[tile].find(_PLANNED, done, min(done + ahead, self.horizon[tile]))

    def _forward(self, tile: int) -> ForwardRanges | None:
        return self.forward if self.forward and tile == self.forward.tile else None
