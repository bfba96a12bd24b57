"""Which jobs to publish next. Pure: events in, instructions out, no I/O, no clock.

Kept here: for each running render the state of every range (`RangeState`), and the entries of jobs that are
out. One file, though long: each event changes both, so the events stand together.
"""

from collections import deque
from collections.abc import Callable, Collection, Iterable, Sequence, Set
from dataclasses import dataclass
from statistics import median
from typing import NamedTuple

from nocturne_coordinator.dispatch.quick_entries import is_quick
from nocturne_coordinator.dispatch.range_queue import (
    IN_FLIGHT,
    STATES,
    FairShare,
    RangeQueue,
    RangeState,
    RenderQueues,
)
from nocturne_coordinator.limits import DEFAULT_PRIORITY

MIN_OVERDUE = 60.0
"""Seconds: six leases; workers claim a dead worker's jobs themselves long before."""

OVERDUE_FACTOR = 20.0
"""Times the median time from publishing to result."""

MIN_SLOW = 1.0
"""Seconds, and the factor times the median: a job that is out for longer may be given to an idle worker as
well."""

SLOW_FACTOR = 3.0

_REMEMBERED_TIMES = 101


class JobKey(NamedTuple):
    """One range of one queue of one render."""

    render_id: str
    tile_index: int
    """Of the queue: the tile's, or that after the last, of forward photons."""
    range_index: int

    def __str__(self) -> str:
        """As it stands in logs."""
        return f"render={self.render_id} tile={self.tile_index} range={self.range_index}"


@dataclass(slots=True)
class Published:
    """A job on the stream: its entries there, copies last, and when the first was put there (any clock,
    seconds)."""

    entries: list[bytes]
    at: float

    @property
    def has_quick(self) -> bool:
        """Whether one of them is a quick copy."""
        return any(map(is_quick, self.entries))

    def without_quick(self) -> list[bytes]:
        """Forgets quick copies; gives their entries."""
        gone = [entry for entry in self.entries if is_quick(entry)]
        self.entries = [entry for entry in self.entries if not is_quick(entry)]
        return gone


class Scheduler:
    """The open work of all running renders."""

    def __init__(self, shortest_overdue: float = MIN_OVERDUE) -> None:
        """`shortest_overdue`: seconds that a job is out, at least, before it is overdue."""
        self._shortest_overdue = shortest_overdue
        self._queues: dict[str, RenderQueues] = {}
        self._farm = FairShare(1.0)
        self._owners: dict[str, FairShare] = {}
        self._outstanding: dict[JobKey, Published] = {}
        self._times: deque[float] = deque(maxlen=_REMEMBERED_TIMES)

    # --- events ---

    def add(
        self,
        render_id: str,
        queues: Sequence[RangeQueue],
        *,
        owner: str = "",
        priority: float = DEFAULT_PRIORITY,
        owner_weight: float = DEFAULT_PRIORITY,
        cost: Callable[[int, int], float] = lambda *_: 1.0,
    ) -> None:
        """A render runs from here on; its queues are kept and changed here.

        Owners share the workers by their weight, and an owner's renders share by priority what the owner
        gets.
        """
        self._owners.setdefault(owner, FairShare(owner_weight)).weight = owner_weight
        self._queues[render_id] = RenderQueues(render_id, queues, owner, FairShare(priority), cost)

    def replan(self, render_id: str, kept: Sequence[int], queues: list[RangeQueue]) -> list[bytes]:
        """The render has other ranges, of each queue the first `kept` as before; gives the entries of jobs
        that are not needed any more, to be deleted from the stream."""
        render = self._queues[render_id]
        for most, before, queue in zip(kept, render.queues, queues, strict=True):
            now = queue.states
            for index, state in enumerate(before.states[:most]):
                if now[index] == RangeState.COMMITTED or (not now[index] and state in IN_FLIGHT):
                    now[index] = state
        render.take(queues)
        gone = [key for key in self._outstanding if key.render_id == render_id]
        gone = [key for key in gone if self.state_of(key) is not RangeState.PUBLISHED]
        return [entry for key in gone for entry in self._outstanding.pop(key).entries]

    def set_priority(self, render_id: str, priority: float) -> None:
        """The render's weight among its owner's renders from now on."""
        self._queues[render_id].share.weight = priority

    def set_first(self, render_id: str, tiles: frozenset[int]) -> None:
        """These tiles go before the render's others from now on; none: all are alike."""
        queue = self._queues[render_id]
        if queue.first != tiles:
            queue.order(tiles)

    def remove(self, render_id: str) -> list[bytes]:
        """A render ended; gives the entries of its jobs, to be deleted from the stream."""
        queue = self._queues.pop(render_id, None)
        if queue is None:
            return []
        at_work = {other.owner for other in self._queues.values()}
        # Who had more than its share by now does not lose that by coming again.
        for owner in [each for each in self._owners if each not in at_work]:
            if self._owners[owner].finish <= self._farm.now:
                del self._owners[owner]
        keys = [key for key in self._outstanding if key.render_id == render_id]
        return [entry for key in keys for entry in self._outstanding.pop(key).entries]

    def published(self, key: JobKey, entry: bytes, now: float) -> None:
        """A job is on the stream, by us now or by an earlier run."""
        if self.state_of(key) is RangeState.PLANNED:
            self._move(key, RangeState.PUBLISHED)
        self._outstanding[key] = Published([entry], now)

    def copied(self, key: JobKey, entry: bytes) -> None:
        """A job that is out is on the stream once more."""
        self._outstanding[key].entries.append(entry)

    def stopped_quick(self, key: JobKey) -> list[bytes]:
        """A quick copy came to no end; gives its entries, the job itself stays out."""
        published = self._outstanding.get(key)
        return published.without_quick() if published else []

    def received(self, key: JobKey, now: float) -> list[bytes]:
        """A job's result came and is usable; `completed` follows for its range. Gives copies to
        delete."""
        if self.state_of(key) not in (RangeState.PLANNED, RangeState.PUBLISHED):
            return []
        if key in self._outstanding:
            self._times.append(now - self._outstanding[key].at)
        entries = self._move(key, RangeState.HELD)
        return entries if len(entries) > 1 else []

    def completed(self, render_id: str, tile_index: int, ranges: int) -> None:
        """A tile's first `ranges` ranges are completed."""
        for index in range(self._queues[render_id].queues[tile_index].done, ranges):
            self._move(JobKey(render_id, tile_index, index), RangeState.COMPLETED)

    def committed(self, render_id: str, tiles: Iterable[int]) -> None:
        """All completed ranges of these tiles are committed."""
        for tile in tiles:
            while (index := self._queues[render_id].queues[tile].states.find(RangeState.COMPLETED)) >= 0:
                self._move(JobKey(render_id, tile, index), RangeState.COMMITTED)

    def expect(self, render_id: str, tile_index: int, ranges: int) -> None:
        """How many ranges the tile is expected to need in all; only those are published."""
        self._queues[render_id].expect(tile_index, ranges)

    def finish_tile(self, render_id: str, tile_index: int, state: RangeState) -> list[bytes]:
        """A tile gets no more samples, its other ranges this state; gives the entries of its jobs, to be
        deleted from the stream."""
        queue = self._queues[render_id].queues[tile_index]
        rest = range(queue.done, len(queue.states))
        return [entry for index in rest for entry in self._move(JobKey(render_id, tile_index, index), state)]

    def returned(self, key: JobKey) -> list[bytes]:
        """A job that is out is to be published again; gives its entries that are still on the stream."""
        is_out = self.state_of(key) is RangeState.PUBLISHED
        return self._move(key, RangeState.PLANNED) if is_out else []

    def charge(self, render_id: str, cost: float) -> None:
        """A render has cost that much for nothing, in the unit of `cost`: the others come before it for as
        long."""
        share, owner = self._queues[render_id].share, self._owners[self._queues[render_id].owner]
        share.finish += cost / share.weight
        owner.finish += cost / owner.weight

    def lost(self) -> None:
        """The stream was emptied: all that was on it is to be published again."""
        for key in list(self._outstanding):
            self.returned(key)

    # --- instructions ---

    @property
    def in_flight(self) -> int:
        """Jobs published and not yet completed; what waits for an earlier range counts, which bounds
        memory."""
        return sum(queue.in_flight for queue in self._queues.values())

    @property
    def typical_time(self) -> float:
        """Median seconds from publishing to result, lately; 0 before the first."""
        return median(self._times) if self._times else 0.0

    @property
    def outstanding(self) -> int:
        """Jobs on the stream."""
        return len(self._outstanding)

    def take(self, count: int, but: Collection[str] = ()) -> list[JobKey]:
        """Up to `count` jobs to publish, shared by weight; `published` must follow, or `returned`.

        `but`: renders that are left out, as nobody is there who could work on them.

        Where there is no room, and most ranges in flight wait for earlier ones, the earlier ones are given
        out, whatever the count: nothing else would ever make room.
        """
        if count <= 0:
            return self._waited_for() if self.in_flight > 2 * len(self._outstanding) else []
        jobs: list[JobKey] = []
        able = {render_id: queue for render_id, queue in self._queues.items() if render_id not in but}
        while len(jobs) < count and able:
            render_id, queue = min(able.items(), key=self._start)
            key = self._next_of(render_id)
            if key is None:
                del able[render_id]
                continue
            cost, owner = queue.cost(key.tile_index, key.range_index), self._owners[queue.owner]
            queue.share.give(owner, cost)
            owner.give(self._farm, cost)
            jobs.append(key)
        return jobs

    def _waited_for(self) -> list[JobKey]:
        """The next ranges of tiles whose later ones are here, if they are not out."""
        found = [
            key
            for render_id, render in self._queues.items()
            for tile, queue in enumerate(render.queues)
            if RangeState.HELD in queue.states
            and self.state_of(key := JobKey(render_id, tile, queue.done)) is RangeState.PLANNED
        ]
        for key in found:
            self._move(key, RangeState.PUBLISHED)
        return found

    def _start(self, item: tuple[str, RenderQueues]) -> tuple[float, str, float]:
        # As `FairShare.start` has it, for each render and job.
        queue = item[1]
        name, share = queue.owner, queue.share
        owner, farm = self._owners[name], self._farm.now
        finish, own = share.finish, owner.now
        return (
            farm if farm > owner.finish else owner.finish,
            name,
            own if own > finish else finish,
        )

    def slow(self, now: float, count: int) -> list[JobKey]:
        """Up to `count` jobs that are out for much longer than others and have no copy yet, oldest first."""
        latest = now - max(MIN_SLOW, SLOW_FACTOR * self.typical_time)
        found = [
            (published.at, key)
            for key, published in self._outstanding.items()
            if published.at < latest and sum(not is_quick(entry) for entry in published.entries) == 1
        ]
        return [key for _, key in sorted(found)[:count]]

    def out(self, renders: Collection[str]) -> list[tuple[JobKey, Published]]:
        """The jobs of these renders that are out."""
        return [each for each in self._outstanding.items() if each[0].render_id in renders]

    def overdue(self, now: float) -> list[JobKey]:
        """Jobs out for so long that something must have gone wrong."""
        latest = now - max(self._shortest_overdue, OVERDUE_FACTOR * self.typical_time)
        return [key for key, published in self._outstanding.items() if published.at < latest]

    def state_of(self, key: JobKey) -> RangeState | None:
        """None: it is no range of a running render."""
        try:
            return STATES[self._queues[key.render_id].queues[key.tile_index].states[key.range_index]]
        except (KeyError, IndexError):
            return None

    def entries(self) -> dict[bytes, JobKey]:
        """The jobs that are out, by their entries."""
        return {entry: key for key, published in self._outstanding.items() for entry in published.entries}

    def render_ids(self) -> Set[str]:
        """The running renders."""
        return self._queues.keys()

    def problem(self) -> str:
        """The first fault in the indexes of the ranges' states, empty if there is none; for tests."""
        for render_id, render in self._queues.items():
            if problem := render.problem():
                return problem
            keys = {key[1:] for key in self._outstanding if key.render_id == render_id}
            for tile, queue in enumerate(render.queues):
                out = {index for index, state in enumerate(queue.states) if state == RangeState.PUBLISHED}
                if out != {index for of, index in keys if of == tile}:
                    return f"render={render_id} tile={tile}: ranges {sorted(out)} are out, by other entries"
        return ""

    # --- inside ---

    def _move(self, key: JobKey, to: RangeState) -> list[bytes]:
        """Brings a range to another state; gives the entries of its job, if it was out."""
        self._queues[key.render_id].move(key.tile_index, key.range_index, to)
        published = self._outstanding.pop(key, None)
        return published.entries if published else []

    def _next_of(self, render_id: str) -> JobKey | None:
        found = self._queues[render_id].pop()
        if found is None:
            return None
        key = JobKey(render_id, *found)
        self._move(key, RangeState.PUBLISHED)
        return key
