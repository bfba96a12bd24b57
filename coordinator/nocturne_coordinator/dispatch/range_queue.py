"""The ranges of one render, in a queue for each tile and one for forward photons: the state of each, and the
order in which planned ones are published. Pure."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from heapq import heapify, heappop, heappush

from nocturne_coordinator.limits import RANGES_AHEAD

TOGETHER = 2
"""Ranges of a tile, after its first, that are given out one after the other: short ones are then merged while
the tile's sums are at hand. More would leave other tiles behind for too long (decision 0131)."""


class RangeState(IntEnum):
    """Where a range stands; coordinator/README.md says where its samples are."""

    PLANNED = 0
    PUBLISHED = 1
    """Its job is on the stream, or is being put there."""
    HELD = 2
    """Its result is here, and waits for an earlier range."""
    COMPLETED = 3
    """Its result is in the film."""
    COMMITTED = 4
    FAILED = 5
    """Its queue has failed, and gets no more samples."""
    UNNEEDED = 6
    """No more of its queue are needed."""


STATES = tuple(RangeState)
"""By their numbers, which is quicker than the class."""

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
    """One of those who share the workers, by start-time fair queueing (Goyal, Vin, Cheng 1996): work is
    counted from when it was last wanted, so who is idle saves up no claim."""

    weight: float
    finish: float = 0.0
    """Where the work given so far ends, divided by the weight."""
    now: float = 0.0
    """Where the last work began of those who share what this one gets."""

    def start(self, among: "FairShare") -> float:
        """Where its next work begins, of those who share what `among` gets."""
        return max(among.now, self.finish)

    def give(self, among: "FairShare", cost: float) -> None:
        """It gets work, from here on."""
        among.now = self.start(among)
        self.finish = among.now + cost / self.weight


@dataclass(slots=True)
class RangeQueue:
    """The ranges of a tile, or of forward photons, in order."""

    states: bytearray
    """Of each range. All else that is known of ranges is an index or a count of these."""
    horizon: int = -1
    """Ranges that are expected to be needed; -1: all."""
    ahead: int = RANGES_AHEAD
    """How many may be in flight or wait."""
    turns: Sequence[int] | None = None
    """Of each range, that of tiles which begins as late, where all kinds go on together; None: its index."""
    following: int = field(default=-1, init=False)
    """The range to publish next; -1: none is planned, `ahead` of them are in flight, or all that should be
    needed."""

    def __post_init__(self) -> None:
        if self.horizon < 0:
            self.horizon = len(self.states)
        self.following = self.next()

    @property
    def done(self) -> int:
        """How many of the first ranges are completed or committed."""
        return self.states.count(_COMPLETED) + self.states.count(_COMMITTED)

    def next(self) -> int:
        """What `following` should be."""
        done = self.done
        return self.states.find(_PLANNED, done, min(done + self.ahead, self.horizon))

    def turn(self, index: int) -> tuple[int, bool]:
        """When a range is to be published: with the first of those that come together. Forward photons go
        before tiles, as they take longest."""
        turn = self.turns[index] if self.turns else index
        return turn - (turn - 1) % TOGETHER if turn > 0 else 0, self.turns is None


@dataclass(slots=True)
class RenderQueues:
    """The queues of one render."""

    render_id: str
    queues: Sequence[RangeQueue]
    owner: str
    share: FairShare
    cost: Callable[[int, int], float]
    """Of a queue's range, by the indices of both, in any unit that all renders have in common."""
    ready: list[tuple[bool, int, bool, int, int]] = field(init=False)
    """Heap of (may wait, turn, queue, range to publish next): earlier ranges first, so the whole frame is
    first. An entry counts while `following` names its range."""
    first: frozenset[int] = field(init=False)
    """Queues that somebody wants to see first; empty: all are alike."""
    in_flight: int = 0
    """Ranges that are published or held."""

    def __post_init__(self) -> None:
        self._order(frozenset())

    def take(self, queues: Sequence[RangeQueue]) -> None:
        """Other ranges in the place of all."""
        self.queues = queues
        self.in_flight = sum(queue.states.count(each) for queue in queues for each in IN_FLIGHT)
        self.order(self.first)

    def order(self, first: frozenset[int]) -> None:
        """Rebuilds the heap, with these queues before the others."""
        for queue in self.queues:
            queue.following = queue.next()
        self._order(first)

    def _order(self, first: frozenset[int]) -> None:
        self.first, self.ready = first, []
        for number, queue in enumerate(self.queues):
            if queue.following >= 0:
                self.ready.append(self._entry(number, queue.following))
        heapify(self.ready)

    def expect(self, number: int, ranges: int) -> None:
        """How many ranges of a queue are expected to be needed."""
        self.queues[number].horizon = ranges
        self._follow(number)

    def move(self, number: int, index: int, to: RangeState) -> None:
        """Brings a range to another state; InvalidTransition where none leads there."""
        states = self.queues[number].states
        before = STATES[states[index]]
        if to not in _TRANSITIONS.get(before, ()):
            place = f"render={self.render_id} tile={number} range={index}"
            raise InvalidTransition(f"{place} is {before.name} and can't become {to.name}")
        states[index] = to
        self.in_flight += (to in IN_FLIGHT) - (before in IN_FLIGHT)
        # A result that is kept, and a commit, change neither what is planned nor how many are done.
        if (before is _PUBLISHED and to is not _HELD) or (before is not _PUBLISHED and to is not _COMMITTED):
            self._follow(number)

    def pop(self) -> tuple[int, int] | None:
        """Queue and range to publish next, if there is one; it is to be moved to published."""
        while self.ready:
            *_, number, index = heappop(self.ready)
            if self.queues[number].following == index:
                return number, index
        return None

    def problem(self) -> str:
        """The first fault in the indexes, empty if there is none; for tests."""
        entries = {(number, index) for *_, number, index in self.ready}
        for number, queue in enumerate(self.queues):
            index = queue.following
            if index != queue.next() or (index >= 0 and (number, index) not in entries):
                return f"render={self.render_id} tile={number} range={index} would never be published"
        in_flight = sum(queue.states.count(each) for queue in self.queues for each in IN_FLIGHT)
        return (
            "" if in_flight == self.in_flight else f"render={self.render_id} has {in_flight} ranges in flight"
        )

    def _follow(self, number: int) -> None:
        """Puts the queue in the heap with the range to publish next, unless it is there."""
        queue = self.queues[number]
        index = queue.next()
        if index == queue.following:
            return
        queue.following = index
        if index >= 0:
            heappush(self.ready, self._entry(number, index))

    def _entry(self, number: int, index: int) -> tuple[bool, int, bool, int, int]:
        # Every tile's first range goes before all others: there is always a whole frame.
        may_wait = bool(self.first) and index > 0 and number not in self.first
        return may_wait, *self.queues[number].turn(index), number, index
