"""The coordinator's side of the queue: reads and writes the streams for the core, notices when Redis forgot,
tries again."""

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from nocturne_coordinator.clock import Clock
from nocturne_coordinator.crash_points import crash_point
from nocturne_coordinator.dispatch.events import (
    Event,
    JobsFound,
    Moment,
    RedisEmptied,
    StreamIsReady,
    WorkersSeen,
)
from nocturne_coordinator.dispatch.planned_render import render_of
from nocturne_coordinator.errors import QueueError
from nocturne_coordinator.queue.job_queue import FIRST, JobQueue, ResultEntry, Session
from nocturne_coordinator.queue.worker_status import worker_row

_log = logging.getLogger(__name__)

_ATTEND_SECONDS = 1.0
_WORKERS_SHARE = 0.05
_WORKERS_SECONDS = 4.0
"""Part of all time that looking at workers may take, and the longest between two looks: a status that is not
renewed is to be seen in its last six seconds (see liveness.py)."""

_MIN_WAIT = 0.1
_MAX_WAIT = 2.0


@dataclass(slots=True)
class _Backlog:
    """Results on the stream from before some renders were taken up."""

    renders: set[str]
    """Theirs are wanted, though they were read before."""
    left: int
    """Entries still to be read."""
    at: bytes = FIRST


class Dispatcher:
    """Talks to Redis for the coordinator. No method raises for trouble with Redis: it is only waited out."""

    def __init__(
        self, queue: JobQueue, session: Session, tell: Callable[[Event], None], clock: Clock
    ) -> None:
        """`tell`: gives an event to the core and carries out its instructions."""
        self._queue = queue
        self._session = session
        self._tell = tell
        self._clock = clock
        self._last_result = FIRST
        self._results_done: list[bytes] = []
        self._jobs_done: list[bytes] = []
        self._jobs_stopped: list[bytes] = []
        self._newcomers: set[str] = set()
        self._backlog: _Backlog | None = None
        self._without_jobs: Mapping[str, str] = {}
        self._machines_changed = True
        self._wait = _MIN_WAIT
        self._next_attempt = 0.0
        self._next_attend = 0.0
        self._next_workers = 0.0
        self.in_step = False
        """Redis answers, and the stream's entries are known."""
        self.results_waiting = 0
        self.longest_wait = 0.0
        """Seconds that a result was on the stream before it was read, at most, since this was set to 0."""

    # --- instructions ---

    def publish(self, jobs: tuple[bytes, ...], quick: bool = False) -> list[bytes]:
        """Puts jobs on the stream at once, or on that of quick copies; QueueError."""
        return self._queue.publish(jobs, quick)

    def tell_workers(self, reasons: Mapping[str, str]) -> None:
        """That they get no jobs, from the next round on, and why."""
        if reasons != self._without_jobs:
            self._next_attend = 0.0
        self._without_jobs = reasons

    def take_up(self, render_id: str) -> None:
        """Entries left by others on a render's streams are to be used before anything is published."""
        self._newcomers.add(render_id)

    def machines_changed(self) -> None:
        """Others may sign on from the next round on."""
        self._machines_changed = True
        self._next_attend = 0.0

    def acknowledge(self, results: tuple[bytes, ...]) -> None:
        """Results to delete."""
        self._results_done.extend(results)

    def withdraw(self, jobs: tuple[bytes, ...], stop: bool) -> None:
        """Jobs to take off the stream; `stop`: who works on one need not end it."""
        self._jobs_done.extend(jobs)
        if stop:
            self._jobs_stopped.extend(jobs)

    def leave(self) -> None:
        """Deletes entries that are to be deleted, and gives the lease on Redis back."""
        try:
            self._delete()
            self._queue.give_up_session(self._session)
        except QueueError as trouble:
            _log.info("the lease on Redis runs out by itself: %s", trouble)

    # --- rounds ---

    def exchange(self, publish: bool, wait_ms: int) -> list[ResultEntry] | None:
        """One round: tidy up, let the core fill the window, read results. None while Redis can't be talked
        to."""
        at = self._clock.moment()
        if at.now < self._next_attempt:
            return None
        try:
            if at.now >= self._next_attend or not self.in_step:
                self._attend(at)
            self._delete()
            if self._newcomers and self._backlog is None:
                self._take_up(at)
            if self._backlog is not None:
                entries = self._read_backlog(self._backlog)
            else:
                if publish:
                    self._tell(StreamIsReady(at))
                entries = self._queue.results(self._last_result, wait_ms)
                if entries:
                    self._last_result = entries[-1][0]
                    # Entries are named by the milliseconds at which they came.
                    waited = self._clock.moment().unix - _place(entries[0][0])[0] / 1000
                    self.longest_wait = max(self.longest_wait, waited)
        except QueueError as trouble:
            self._lost_touch(at, trouble)
            return None
        self._wait = _MIN_WAIT
        return entries

    def _take_up(self, at: Moment) -> None:
        """Makes use of entries on the streams before anything is published a second time."""
        self._find_jobs(at)
        left = self._queue.results_waiting()
        self._backlog = _Backlog(self._newcomers, left) if left else None
        self._newcomers = set()

    def _find_jobs(self, at: Moment) -> None:
        self._tell(JobsFound(at, tuple(self._queue.jobs())))

    def _read_backlog(self, backlog: _Backlog) -> list[ResultEntry]:
        """Some more of it: the renders' own, and entries that nobody here has read."""
        batch = self._queue.results(backlog.at, 0)
        backlog.left -= len(batch)
        if backlog.left <= 0 or not batch:
            self._backlog = None
        if not batch:
            return []
        backlog.at = batch[-1][0]
        read = _place(self._last_result)
        entries = [
            each for each in batch if _place(each.entry) > read or render_of(each.data) in backlog.renders
        ]
        if _place(backlog.at) > read:
            self._last_result = backlog.at
        return entries

    def _lost_touch(self, at: Moment, trouble: QueueError) -> None:
        if self.in_step or self._wait == _MIN_WAIT:
            _log.warning("Redis: %s; trying again", trouble)
        self.in_step = False
        self._next_attempt = at.now + self._wait
        self._wait = min(2 * self._wait, _MAX_WAIT)

    def _attend(self, at: Moment) -> None:
        ours = self._queue.attend(self._session)
        if not ours:
            self._tell(RedisEmptied(at))
            self._last_result = FIRST
            self._backlog = None
            self._results_done.clear()
            self._jobs_done.clear()
            self._jobs_stopped.clear()
        if self._machines_changed or not ours or not self.in_step:
            self._queue.admit_machines()
            self._machines_changed = False
        if not ours or not self.in_step:
            self._find_jobs(at)
            _log.info("Redis: in step")
        self.in_step = True
        if at.now >= self._next_workers:
            self._look_at_workers(at)
            took = self._clock.moment().now - at.now
            self._next_workers = at.now + min(_WORKERS_SECONDS, took / _WORKERS_SHARE)
        if self._without_jobs:
            self._queue.keep_in_quarantine(self._without_jobs)
        self._next_attend = at.now + _ATTEND_SECONDS

    def _look_at_workers(self, at: Moment) -> None:
        found = [(worker_row(name, status, at.unix), left) for name, status, left in self._queue.workers()]
        rows = tuple(row for row, _ in found if row is not None)
        left = {row.id: left for row, left in found if row is not None}
        holders = tuple(self._queue.holders())
        self._tell(WorkersSeen(at, rows, left, holders, self._queue.jobs_waiting()))
        self.results_waiting = self._queue.results_waiting()

    def _delete(self) -> None:
        if self._results_done:
            self._queue.delete_results(self._results_done)
            self._results_done.clear()
            crash_point("after-acknowledge")
        if self._jobs_stopped:
            self._queue.stop_jobs(self._jobs_stopped)
            self._jobs_stopped.clear()
        if self._jobs_done:
            self._queue.delete_jobs(self._jobs_done)
            self._jobs_done.clear()


def _place(entry: bytes) -> tuple[int, int]:
    """Of an entry on its stream; later ones are greater."""
    milliseconds, _, number = entry.partition(b"-")
    return int(milliseconds), int(number)
