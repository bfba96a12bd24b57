"""Which jobs to publish next. Pure: events in, instructions out, no I/O, no clock.

A range of a tile is planned, published, held (its result is here and waits for an earlier range) or
completed; docs/explanation/queue.md has the table. Kept here: for each running render how far each tile is,
and what is in flight. One file, though long: each event changes both, so the events stand together.
"""

from collections import deque
from collections.abc import Callable, Collection, Iterable, Sequence, Set
from dataclasses import dataclass
from heapq import heappop, heappush
from statistics import median
from typing import NamedTuple

from nocturne_coordinator.dispatch.range_queue import (
    TOGETHER,
    TOGETHER_IN_FLOOD,
    FairShare,
    ForwardRanges,
    RangeQueue,
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

_FLOOD = 50
"""Results that come between two times that jobs are published: nearly as many as are read at once. The
workers wait for the coordinator then, and no range takes longer than it takes to merge it."""


class JobKey(NamedTuple):
    """One range of one tile of one render."""

    render_id: str
    tile_index: int
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


class Scheduler:
    """The open work of all running renders."""

    def __init__(self, shortest_overdue: float = MIN_OVERDUE) -> None:
        """`shortest_overdue`: seconds that a job is out, at least, before it is overdue."""
        self._shortest_overdue = shortest_overdue
        self._queues: dict[str, RangeQueue] = {}
        self._owners: dict[str, FairShare] = {}
        self._outstanding: dict[JobKey, Published] = {}
        self._held = 0
        self._times: deque[float] = deque(maxlen=_REMEMBERED_TIMES)
        self._came = 0
        """Results since jobs were last taken."""

    # --- events ---

    def add(
        self,
        render_id: str,
        ranges: int,
        completed: list[int],
        *,
        horizon: Sequence[int] = (),
        owner: str = "",
        priority: float = DEFAULT_PRIORITY,
        owner_weight: float = DEFAULT_PRIORITY,
        cost: Callable[[int, int], float] = lambda *_: 1.0,
        forward: ForwardRanges | None = None,
    ) -> None:
        """A render runs from here on; `completed` holds each tile's completed ranges, `ranges` for one that
        needs no more.

        `horizon`: what each tile is expected to need, all unless given. Owners share the workers by their
        weight, and an owner's renders share by priority what the owner gets.
        """
        share = self._owners.setdefault(owner, FairShare(owner_weight, _least(self._owners.values())))
        share.weight = owner_weight
        beside = [queue.share for queue in self._queues.values() if queue.owner == owner]
        self._queues[render_id] = RangeQueue(
            ranges,
            list(completed),
            list(completed),
            list(horizon) or [ranges] * len(completed),
            [],
            owner,
            FairShare(priority, _least(beside)),
            cost,
            forward,
        )
        queue = self._queues[render_id]
        for tile, done in enumerate(completed):
            if done < queue.ranges_of(tile):
                queue.make_ready(done, tile)

    def set_priority(self, render_id: str, priority: float) -> None:
        """The render's weight beside its owner's other renders from now on."""
        self._queues[render_id].share.weight = priority

    def set_first(self, render_id: str, tiles: frozenset[int]) -> None:
        """These tiles go before the render's others from now on; none: all are alike."""
        queue = self._queues[render_id]
        if queue.first == tiles:
            return
        queue.first = tiles
        before, queue.ready = queue.ready, []
        for *_, tile, range_index in before:
            queue.make_ready(range_index, tile)

    def remove(self, render_id: str) -> list[bytes]:
        """A render ended; gives the entries of its jobs, to be deleted from the stream."""
        queue = self._queues.pop(render_id, None)
        if queue is None:
            return []
        if all(other.owner != queue.owner for other in self._queues.values()):
            del self._owners[queue.owner]
        self._held -= len(queue.held)
        keys = [key for key in self._outstanding if key.render_id == render_id]
        return [entry for key in keys for entry in self._outstanding.pop(key).entries]

    def published(self, key: JobKey, entry: bytes, now: float) -> None:
        """A job is on the stream, by us now or by an earlier run."""
        self._outstanding[key] = Published([entry], now)

    def copied(self, key: JobKey, entry: bytes) -> None:
        """A job that is out is on the stream once more."""
        self._outstanding[key].entries.append(entry)

    def received(self, key: JobKey, now: float) -> list[bytes]:
        """A job's result came and is usable; `completed` follows for what it completes. Gives copies to
        delete."""
        self._came += 1
        published = self._outstanding.pop(key, None)
        if published is not None:
            self._times.append(now - published.at)
        queue = self._queues[key.render_id]
        place = (key.range_index, key.tile_index)
        if key.range_index >= queue.completed[key.tile_index] and place not in queue.held:
            queue.held.add(place)
            self._held += 1
        return published.entries if published is not None and len(published.entries) > 1 else []

    def completed(self, render_id: str, tile_index: int, ranges: int) -> None:
        """A tile's first `ranges` ranges are completed."""
        queue = self._queues[render_id]
        for index in range(queue.completed[tile_index], ranges):
            if (index, tile_index) in queue.held:
                queue.held.remove((index, tile_index))
                self._held -= 1
            self._outstanding.pop(JobKey(render_id, tile_index, index), None)
        queue.completed[tile_index] = ranges
        queue.following[tile_index] = max(queue.following[tile_index], ranges)
        self._unblock(queue, tile_index)

    def expect(self, render_id: str, tile_index: int, ranges: int) -> None:
        """How many ranges the tile is expected to need in all; only those are published."""
        queue = self._queues[render_id]
        queue.horizon[tile_index] = ranges
        self._unblock(queue, tile_index)

    def finish_tile(self, render_id: str, tile_index: int) -> list[bytes]:
        """A tile gets no more samples; gives the entries of its jobs, to be deleted from the stream."""
        queue = self._queues[render_id]
        done = queue.completed[tile_index]
        entries = []
        for index in range(done, min(done + queue.ahead_of(tile_index), queue.ranges_of(tile_index))):
            published = self._outstanding.pop(JobKey(render_id, tile_index, index), None)
            entries.extend(published.entries if published else [])
        self.completed(render_id, tile_index, queue.ranges_of(tile_index))
        return entries

    def returned(self, key: JobKey) -> list[bytes]:
        """A job is to be published again; gives its entries that are still on the stream."""
        published = self._outstanding.pop(key, None)
        if self._is_open(key):
            queue = self._queues[key.render_id]
            # What lies ahead of `following` gets its turn anyhow.
            if key.range_index < queue.following[key.tile_index]:
                heappush(queue.again, (key.range_index, key.tile_index))
        return [] if published is None else published.entries

    def charge(self, render_id: str, cost: float) -> None:
        """A render has cost that much for nothing, in the unit of `cost`: the others come before it for as
        long."""
        queue = self._queues[render_id]
        queue.share.virtual_time += cost / queue.share.weight
        owner = self._owners[queue.owner]
        owner.virtual_time += cost / owner.weight

    def lost(self) -> None:
        """The stream was emptied: all that was on it is to be published again."""
        for key in list(self._outstanding):
            self.returned(key)

    # --- instructions ---

    @property
    def in_flight(self) -> int:
        """Jobs published and not yet completed; what waits for an earlier range counts, which bounds
        memory."""
        return len(self._outstanding) + self._held

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

        Where there is no room, and most of what is in flight waits for earlier ranges, it is these, whatever
        the count: nothing else would ever make room.
        """
        together = TOGETHER_IN_FLOOD if self._came >= _FLOOD else TOGETHER
        self._came = 0
        for queue in self._queues.values():
            queue.together = together
        if count <= 0:
            return self._waited_for() if 2 * self._held > self.in_flight else []
        jobs: list[JobKey] = []
        able = {render_id: queue for render_id, queue in self._queues.items() if render_id not in but}
        while len(jobs) < count and able:
            render_id, queue = min(able.items(), key=self._passed)
            key = self._next_of(render_id)
            if key is None:
                del able[render_id]
                # Who has nothing to give out now saves up no claim on later.
                if able:
                    least = min((each.share for each in able.values()), key=lambda share: share.virtual_time)
                    queue.share.virtual_time = max(queue.share.virtual_time, least.virtual_time)
                continue
            self.charge(render_id, queue.cost(key.tile_index, key.range_index))
            jobs.append(key)
        return jobs

    def _waited_for(self) -> list[JobKey]:
        """The next ranges of tiles whose later ones are here, if they are not out."""
        found = {
            JobKey(render_id, tile, queue.completed[tile])
            for render_id, queue in self._queues.items()
            for _, tile in queue.held
        }
        return sorted(key for key in found if self.wants(key))

    def _passed(self, item: tuple[str, RangeQueue]) -> tuple[float, str, float]:
        queue = item[1]
        return self._owners[queue.owner].virtual_time, queue.owner, queue.share.virtual_time

    def slow(self, now: float, count: int) -> list[JobKey]:
        """Up to `count` jobs that are out for much longer than others and have no copy yet, oldest first."""
        latest = now - max(MIN_SLOW, SLOW_FACTOR * self.typical_time)
        found = [
            (published.at, key)
            for key, published in self._outstanding.items()
            if published.at < latest and len(published.entries) == 1
        ]
        return [key for _, key in sorted(found)[:count]]

    def overdue(self, now: float) -> list[JobKey]:
        """Jobs out for so long that something must have gone wrong."""
        latest = now - max(self._shortest_overdue, OVERDUE_FACTOR * self.typical_time)
        return [key for key, published in self._outstanding.items() if published.at < latest]

    def is_outstanding(self, key: JobKey) -> bool:
        return key in self._outstanding

    def has_entry(self, key: JobKey, entry: bytes) -> bool:
        """Whether a job is out with this entry."""
        published = self._outstanding.get(key)
        return published is not None and entry in published.entries

    def entries(self) -> dict[bytes, JobKey]:
        """The jobs that are out, by their entries."""
        return {entry: key for key, published in self._outstanding.items() for entry in published.entries}

    def wants(self, key: JobKey) -> bool:
        """Whether a job found on the stream is worth tracing: open, and not out already."""
        return self._is_open(key) and key not in self._outstanding

    def render_ids(self) -> Set[str]:
        """The running renders."""
        return self._queues.keys()

    def problem_of(
        self,
        render_id: str,
        merged: Sequence[int],
        closed: Sequence[bool],
        waiting: Sequence[Collection[int]],
    ) -> str:
        """What is wrong with the places of a render's ranges, empty if nothing is; for tests.

        Of each tile: ranges merged, whether it gets no more, and the ranges that wait for earlier ones.
        """
        queue = self._queues[render_id]
        if self._held != sum(len(each.held) for each in self._queues.values()):
            return "the number of ranges that wait"
        for tile, done in enumerate(queue.completed):
            if done != (queue.ranges_of(tile) if closed[tile] else merged[tile]):
                return f"tile {tile} has {merged[tile]} ranges, the scheduler says {done}"
            held = {index for index, of in queue.held if of == tile}
            if held != set(waiting[tile]):
                return f"tile {tile}: ranges {sorted(waiting[tile])} wait, the scheduler says {sorted(held)}"
            out = {key.range_index for key in self._outstanding if key[:2] == (render_id, tile)}
            if out & held or any(not done <= index < queue.ranges_of(tile) for index in out):
                return (
                    f"tile {tile}: ranges {sorted(out)} are published, {sorted(held)} wait, {done} are done"
                )
            if lost := queue.nowhere(tile, out | held):
                return f"tile {tile}: ranges {lost} are nowhere"
        return ""

    # --- inside ---

    @staticmethod
    def _unblock(queue: RangeQueue, tile_index: int) -> None:
        if tile_index in queue.blocked:
            queue.blocked.remove(tile_index)
            queue.make_ready(queue.following[tile_index], tile_index)

    def _is_open(self, key: JobKey) -> bool:
        """Planned, not completed, and its result is not here."""
        queue = self._queues.get(key.render_id)
        if queue is None or not 0 <= key.tile_index < len(queue.completed):
            return False
        return (
            queue.completed[key.tile_index] <= key.range_index < queue.ranges_of(key.tile_index)
            and (key.range_index, key.tile_index) not in queue.held
        )

    def _next_of(self, render_id: str) -> JobKey | None:
        queue = self._queues[render_id]
        while queue.again:
            range_index, tile = heappop(queue.again)
            if self.wants(key := JobKey(render_id, tile, range_index)):
                return key
        while queue.ready:
            *_, tile, range_index = heappop(queue.ready)
            if queue.completed[tile] >= queue.ranges_of(tile):
                continue
            if range_index >= min(queue.completed[tile] + queue.ahead_of(tile), queue.horizon[tile]):
                queue.blocked.add(tile)
                continue
            queue.following[tile] = range_index + 1
            if range_index + 1 < queue.ranges_of(tile):
                queue.make_ready(range_index + 1, tile)
            if self.wants(key := JobKey(render_id, tile, range_index)):
                return key
        return None


def _least(shares: Iterable[FairShare]) -> float:
    """Where who comes new begins: neither behind the others nor ahead of them."""
    return min((share.virtual_time for share in shares), default=0.0)
