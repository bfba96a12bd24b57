"""Which jobs to publish next. Pure: events in, instructions out, no I/O, no clock.

A range of a tile is planned, published, held (its result is here and waits for an earlier range) or merged;
docs/queue.md has the table. Kept here: for each running render how far each tile is, and what is in flight.
"""

from collections import deque
from dataclasses import dataclass, field
from heapq import heappop, heappush
from statistics import median
from typing import NamedTuple

from .limits import RANGES_AHEAD

SHORTEST_OVERDUE = 60.0
"""Seconds: six leases; workers claim a dead worker's jobs themselves long before."""

OVERDUE_FACTOR = 20.0
"""Times the median time from publishing to result."""

_REMEMBERED_TIMES = 101


class JobKey(NamedTuple):
    """One range of one tile of one render."""

    render_id: str
    tile_index: int
    range_index: int


@dataclass(frozen=True, slots=True)
class Published:
    """A job on the stream: its entry there and when it was put there (any clock, seconds)."""

    entry: bytes
    at: float


@dataclass(slots=True)
class _Queue:
    """The open ranges of one render."""

    ranges: int
    merged: list[int]
    """Per tile, ranges merged."""
    following: list[int]
    """Per tile, the range to publish next; those below it were published once."""
    ready: list[tuple[int, int]]
    """Heap of (range to publish next, tile): earlier ranges first, so the whole frame comes first."""
    again: list[tuple[int, int]] = field(default_factory=list)
    """Heap of (range, tile) to publish once more."""
    held: set[tuple[int, int]] = field(default_factory=set)
    blocked: set[int] = field(default_factory=set)
    """Tiles that are not in `ready`, because RANGES_AHEAD of their ranges are in flight."""


class Schedule:
    """The open work of all running renders."""

    def __init__(self) -> None:
        self._queues: dict[str, _Queue] = {}
        self._turns: deque[str] = deque()
        self._outstanding: dict[JobKey, Published] = {}
        self._held = 0
        self._times: deque[float] = deque(maxlen=_REMEMBERED_TIMES)

    # --- events ---

    def add(self, render_id: str, ranges: int, merged: list[int]) -> None:
        """A render runs from here on; `merged` holds each tile's merged ranges."""
        ready = [(done, tile) for tile, done in enumerate(merged) if done < ranges]
        ready.sort()
        self._queues[render_id] = _Queue(ranges, list(merged), list(merged), ready)
        self._turns.append(render_id)

    def remove(self, render_id: str) -> list[bytes]:
        """A render ended; gives the entries of its jobs, to be deleted from the stream."""
        queue = self._queues.pop(render_id, None)
        if queue is None:
            return []
        self._turns.remove(render_id)
        self._held -= len(queue.held)
        keys = [key for key in self._outstanding if key.render_id == render_id]
        return [self._outstanding.pop(key).entry for key in keys]

    def published(self, key: JobKey, entry: bytes, now: float) -> None:
        """A job is on the stream, by us now or by an earlier run."""
        self._outstanding[key] = Published(entry, now)

    def received(self, key: JobKey, now: float) -> None:
        """A job's result came and is usable; `merged` follows for what it completes."""
        published = self._outstanding.pop(key, None)
        if published is not None:
            self._times.append(now - published.at)
        queue = self._queues[key.render_id]
        place = (key.range_index, key.tile_index)
        if key.range_index >= queue.merged[key.tile_index] and place not in queue.held:
            queue.held.add(place)
            self._held += 1

    def merged(self, render_id: str, tile_index: int, ranges: int) -> None:
        """A tile's first `ranges` ranges are merged."""
        queue = self._queues[render_id]
        for index in range(queue.merged[tile_index], ranges):
            if (index, tile_index) in queue.held:
                queue.held.remove((index, tile_index))
                self._held -= 1
            self._outstanding.pop(JobKey(render_id, tile_index, index), None)
        queue.merged[tile_index] = ranges
        queue.following[tile_index] = max(queue.following[tile_index], ranges)
        if tile_index in queue.blocked:
            queue.blocked.remove(tile_index)
            heappush(queue.ready, (queue.following[tile_index], tile_index))

    def returned(self, key: JobKey) -> bytes | None:
        """A job is to be published again; gives its entry, if it is still on the stream."""
        published = self._outstanding.pop(key, None)
        if self._is_open(key):
            queue = self._queues[key.render_id]
            # What lies ahead of `following` gets its turn anyhow.
            if key.range_index < queue.following[key.tile_index]:
                heappush(queue.again, (key.range_index, key.tile_index))
        return None if published is None else published.entry

    def lost(self) -> None:
        """The stream was emptied: all that was on it is to be published again."""
        for key in list(self._outstanding):
            self.returned(key)

    # --- instructions ---

    @property
    def in_flight(self) -> int:
        """Jobs published and not yet merged; what waits for an earlier range counts, which bounds memory."""
        return len(self._outstanding) + self._held

    @property
    def typical_time(self) -> float:
        """Median seconds from publishing to result, lately; 0 before the first."""
        return median(self._times) if self._times else 0.0

    def take(self, count: int) -> list[JobKey]:
        """Up to `count` jobs to publish, round robin over renders; `published` must follow, or `returned`."""
        jobs: list[JobKey] = []
        idle = 0
        while len(jobs) < count and idle < len(self._turns):
            render_id = self._turns[0]
            self._turns.rotate(-1)
            key = self._next_of(render_id)
            if key is None:
                idle += 1
            else:
                idle = 0
                jobs.append(key)
        return jobs

    def overdue(self, now: float) -> list[JobKey]:
        """Jobs out for so long that something must have gone wrong."""
        latest = now - max(SHORTEST_OVERDUE, OVERDUE_FACTOR * self.typical_time)
        return [key for key, published in self._outstanding.items() if published.at < latest]

    def is_outstanding(self, key: JobKey) -> bool:
        return key in self._outstanding

    def entry_of(self, key: JobKey) -> bytes | None:
        """The entry of a job that is out."""
        published = self._outstanding.get(key)
        return None if published is None else published.entry

    def wants(self, key: JobKey) -> bool:
        """Whether a job found on the stream is worth tracing: open, and not out already."""
        return self._is_open(key) and key not in self._outstanding

    # --- inside ---

    def _is_open(self, key: JobKey) -> bool:
        """Planned, not merged, and its result is not here."""
        queue = self._queues.get(key.render_id)
        if queue is None or not 0 <= key.tile_index < len(queue.merged):
            return False
        return (
            queue.merged[key.tile_index] <= key.range_index < queue.ranges
            and (key.range_index, key.tile_index) not in queue.held
        )

    def _next_of(self, render_id: str) -> JobKey | None:
        queue = self._queues[render_id]
        while queue.again:
            range_index, tile = heappop(queue.again)
            if self.wants(key := JobKey(render_id, tile, range_index)):
                return key
        while queue.ready:
            range_index, tile = heappop(queue.ready)
            if range_index >= queue.merged[tile] + RANGES_AHEAD:
                queue.blocked.add(tile)
                continue
            queue.following[tile] = range_index + 1
            if range_index + 1 < queue.ranges:
                heappush(queue.ready, (range_index + 1, tile))
            if self.wants(key := JobKey(render_id, tile, range_index)):
                return key
        return None
