"""The coordinator's side of the queue: keeps the window full, notices when Redis forgot, tries again."""

import logging
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from nocturne_coordinator import limits
from nocturne_coordinator.crash_points import crash_point
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.liveness import Liveness, Sign
from nocturne_coordinator.dispatch.planned_render import RefusedResult, render_of
from nocturne_coordinator.dispatch.profiles import incompatible, threads_by_profile
from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler
from nocturne_coordinator.queue.job_queue import FIRST, Entry, JobQueue, QueueError, Session
from nocturne_coordinator.queue.worker_status import worker_row

_log = logging.getLogger(__name__)

_ATTEND_SECONDS = 1.0
_WORKERS_SHARE = 0.05
_WORKERS_SECONDS = 4.0
"""Part of all time that looking at workers may take, and the longest between two looks: a status that is not
renewed is to be seen in its last six seconds (see lives.py)."""

_OVERDUE_SECONDS = 5.0
_MIN_WAIT = 0.1
_MAX_WAIT = 2.0
_AUDIT_PART = 8
"""One audit for so many places of the window, at most, in one round."""

_MAX_PUBLISH = 500
"""Jobs published before results are read again."""


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
        self,
        queue: JobQueue,
        session: Session,
        renders: dict[str, RunningRender],
        scheduler: Scheduler,
        auditor: Auditor,
        is_open: Callable[[str], bool] = lambda _: False,
    ) -> None:
        """Shares renders, scheduler and auditor with the coordinator. `is_open`: whether a render is some
        other coordinator's, or will be."""
        self._is_open = is_open
        self._queue = queue
        self._renders = renders
        self._scheduler = scheduler
        self._auditor = auditor
        self._liveness = Liveness()
        self._session = session
        self._last_result = FIRST
        self._results_done: list[bytes] = []
        self._jobs_done: list[bytes] = []
        self._newcomers: set[str] = set()
        self._backlog: _Backlog | None = None
        self._in_step = False
        self._wait = _MIN_WAIT
        self._next_attempt = 0.0
        self._next_attend = 0.0
        self._next_workers = 0.0
        self._next_overdue = 0.0
        self.quarantined: Mapping[str, str] = {}
        """Workers that are to take no jobs, and why."""
        self._profiles: Collection[str] = ()
        self.incompatible: Mapping[str, str] = {}
        """Workers that are to take no jobs though they are not in quarantine, and why."""
        self.threads = 0
        """Of all workers that take jobs."""
        self.threads_by_profile: Mapping[str, int] = {}
        """Of all that could, whatever the renders need."""
        self.workers: list[WorkerRow] = []
        self.lost: list[tuple[JobKey, str]] = []
        """Jobs with the workers that died having them; for the coordinator to take away."""
        self.results_waiting = 0
        self.longest_wait = 0.0
        """Seconds that a result was on the stream before it was read, at most, since this was set to 0."""
        self._live: dict[str, set[str]] = {}
        self._live_of: tuple[object, object, object] = (None, None, None)
        self.share = 1.0
        """Part of the workers that this coordinator's renders should get."""
        self._jobs_of_others = 0

    @property
    def in_step(self) -> bool:
        """Redis answers, and what is on the stream is known."""
        return self._in_step

    @property
    def at_work(self) -> list[tuple[JobKey, str]]:
        """Jobs and who has them."""
        return self._liveness.at_work

    def live(self, floating_point_profile: str = "") -> set[str]:
        """Names of the workers that take jobs; of one floating-point profile, unless it is empty."""
        # Asked for often, and long where there are thousands.
        now = (self.workers, self.quarantined, self.incompatible)
        if any(a is not b for a, b in zip(now, self._live_of, strict=True)):
            self._live, self._live_of = {"": set()}, now
            for worker in self.workers:
                if worker.id not in self.quarantined and worker.id not in self.incompatible:
                    self._live[""].add(worker.id)
                    self._live.setdefault(worker.floating_point_profile, set()).add(worker.id)
        return self._live.get(floating_point_profile, set())

    def set_profiles(self, classes: Collection[str]) -> None:
        """Floating-point profiles of all open renders of the folder, empty for one that has none yet."""
        if classes != self._profiles:
            self._profiles = classes
            self._incompatible()
            self._next_attend = 0.0

    def leave(self) -> None:
        """Gives the lease on Redis back."""
        try:
            self._queue.give_up_session(self._session)
        except QueueError as trouble:
            _log.info("the lease on Redis runs out by itself: %s", trouble)

    def welcome(self, render_id: str) -> None:
        """A render was taken up: what others left on the streams of it is to be made use of."""
        self._newcomers.add(render_id)

    def acknowledge(self, results: list[bytes]) -> None:
        """Results to delete: what they brought is committed, or is of no use."""
        self._results_done.extend(results)

    def withdraw(self, jobs: list[bytes]) -> None:
        """Jobs to take off the stream."""
        self._jobs_done.extend(jobs)

    def exchange(self, now: float, unix_time: float, publish: bool, wait_ms: int) -> list[Entry] | None:
        """One round: tidy up, fill the window, read results. None while Redis can't be talked to."""
        if now < self._next_attempt:
            return None
        try:
            if now >= self._next_attend or not self._in_step:
                self._attend(now, unix_time)
            self._delete()
            if self._newcomers and self._backlog is None:
                self._take_up(now)
            if self._backlog is not None:
                entries = self._read_backlog(self._backlog)
            else:
                if publish:
                    self._fill(now)
                entries = self._queue.results(self._last_result, wait_ms)
                if entries:
                    self._last_result = entries[-1][0]
                    # Entries are named by the milliseconds at which they came.
                    waited = time.time() - _place(entries[0][0])[0] / 1000
                    self.longest_wait = max(self.longest_wait, waited)
        except QueueError as trouble:
            self._lost_touch(now, trouble)
            return None
        self._wait = _MIN_WAIT
        return entries

    def _take_up(self, now: float) -> None:
        """Makes use of what is on the streams before anything is published a second time."""
        self._adopt(now)
        left = self._queue.results_waiting()
        self._backlog = _Backlog(self._newcomers, left) if left else None
        self._newcomers = set()

    def _read_backlog(self, backlog: _Backlog) -> list[Entry]:
        """Some more of it: the renders' own, and what nobody here has read."""
        batch = self._queue.results(backlog.at, 0)
        backlog.left -= len(batch)
        if backlog.left <= 0 or not batch:
            self._backlog = None
        if not batch:
            return []
        backlog.at = batch[-1][0]
        read = _place(self._last_result)
        entries = [
            (entry, data)
            for entry, data in batch
            if _place(entry) > read or render_of(data) in backlog.renders
        ]
        if _place(backlog.at) > read:
            self._last_result = backlog.at
        return entries

    def _lost_touch(self, now: float, trouble: QueueError) -> None:
        if self._in_step or self._wait == _MIN_WAIT:
            _log.warning("Redis: %s; trying again", trouble)
        self._in_step = False
        self._next_attempt = now + self._wait
        self._wait = min(2 * self._wait, _MAX_WAIT)

    def _attend(self, now: float, unix_time: float) -> None:
        ours = self._queue.attend(self._session)
        if not ours:
            self._scheduler.lost()
            self._auditor.lost()
            self._last_result = FIRST
            self._backlog = None
            self._results_done.clear()
            self._jobs_done.clear()
        if not ours or not self._in_step:
            adopted = self._adopt(now)
            _log.info("Redis: in step; %d jobs found on the stream", adopted)
        self._in_step = True
        if now >= self._next_workers:
            begun = time.monotonic()
            self._look_at_workers(unix_time)
            took = time.monotonic() - begun
            self._next_workers = now + min(_WORKERS_SECONDS, took / _WORKERS_SHARE)
        if self.quarantined or self.incompatible:
            self._queue.keep_in_quarantine({**self.incompatible, **self.quarantined})
        self._next_attend = now + _ATTEND_SECONDS
        if self.threads and now >= self._next_overdue:
            self._return_overdue(now)

    def _adopt(self, now: float) -> int:
        """Makes use of jobs that an earlier run, or a call whose answer was lost, left on the stream."""
        found = 0
        for entry, data in self._queue.jobs():
            key = self._key_of(data)
            if key is not None and self._scheduler.wants(key):
                self._scheduler.published(key, entry, now)
                found += 1
            elif key is None:
                if not self._is_others(data):
                    self._jobs_done.append(entry)
            elif not (self._scheduler.has_entry(key, entry) or self._auditor.has_entry(key, entry)):
                self._jobs_done.append(entry)
        return found

    def _is_others(self, data: bytes) -> bool:
        """Whether a job is of a render that another coordinator works on, or will."""
        try:
            render_id = job_pb2.Job.FromString(data).render_id
        except DecodeError:
            return False
        return render_id not in self._renders and self._is_open(render_id)

    def _key_of(self, data: bytes) -> JobKey | None:
        try:
            job = job_pb2.Job.FromString(data)
            render = self._renders.get(job.render_id)
            planned = render.planned.find(job) if render else None
        except (DecodeError, RefusedResult):
            return None
        return JobKey(job.render_id, job.tile_index, planned.index) if planned else None

    def _look_at_workers(self, unix_time: float) -> None:
        rows = [(worker_row(status, unix_time), left) for status, left in self._queue.workers()]
        self.workers = [row for row, _ in rows if row is not None]
        self.threads_by_profile = threads_by_profile(self.workers, self.quarantined)
        self._incompatible()
        live = self.live()
        self.threads = sum(each.threads for each in self.workers if each.id in live)
        signs = {row.id: Sign(row.started, left) for row, left in rows if row is not None}
        entries = self._scheduler.entries()
        self.lost.extend(self._liveness.look(signs, self._queue.holders(), entries))
        self.results_waiting = self._queue.results_waiting()
        ours = self._scheduler.outstanding + len(self._auditor.entries())
        self._jobs_of_others = max(0, self._queue.jobs_waiting() - ours)

    def _incompatible(self) -> None:
        found = incompatible(self.workers, self.quarantined, self._profiles)
        for worker in found.keys() - self.incompatible.keys():
            _log.warning("worker=%s gets no jobs: %s", worker, found[worker])
        self.incompatible = found

    def _return_overdue(self, now: float) -> None:
        self._next_overdue = now + _OVERDUE_SECONDS
        for key in self._scheduler.overdue(now):
            _log.warning("%s is overdue; published again", key)
            self._jobs_done.extend(self._scheduler.returned(key))
        for key in self._auditor.overdue(now):
            self._jobs_done.extend(self._auditor.returned(key))

    def _delete(self) -> None:
        if self._results_done:
            self._queue.delete_results(self._results_done)
            self._results_done.clear()
            crash_point("after-acknowledge")
        if self._jobs_done:
            self._queue.delete_jobs(self._jobs_done)
            self._jobs_done.clear()

    def _fill(self, now: float) -> None:
        """Publishes until the window is full."""
        wanted = min(self._window() - self._scheduler.in_flight, _MAX_PUBLISH)
        keys = self._scheduler.take(wanted, self._without_workers())
        try:
            entries = self._publish(keys)
        except QueueError:
            # Some may be on the stream; they are adopted when Redis answers again.
            for key in keys:
                self._scheduler.returned(key)
            raise
        for key, entry in zip(keys, entries, strict=True):
            self._scheduler.published(key, entry, now)
        self._fill_audits(now)
        idle = self.threads - self._scheduler.outstanding - self._jobs_of_others
        if not keys and idle > 0:
            slow = self._scheduler.slow(now, idle)
            # Should it fail, no copy is known: it is taken off the stream when Redis answers again.
            for key, entry in zip(slow, self._publish(slow), strict=True):
                _log.info("%s is slow; an idle worker gets it as well", key)
                self._scheduler.copied(key, entry)

    def _without_workers(self) -> list[str]:
        """Renders that no worker can work on though some are there: their jobs would fill the window."""
        if not self.threads_by_profile:
            return []
        return [
            render.id
            for render in self._renders.values()
            if render.floating_point_profile
            and not self.threads_by_profile.get(render.floating_point_profile)
        ]

    def _fill_audits(self, now: float) -> None:
        keys = self._auditor.take(max(1, self._window() // _AUDIT_PART))
        try:
            entries = self._publish(keys)
        except QueueError:
            for key in keys:
                self._auditor.returned(key)
            raise
        for key, entry in zip(keys, entries, strict=True):
            self._auditor.published(key, entry, now)

    def _publish(self, keys: list[JobKey]) -> list[bytes]:
        return self._queue.publish([self._job_bytes(key) for key in keys]) if keys else []

    def _window(self) -> int:
        wanted = max(limits.MIN_WINDOW, round(self.share * limits.JOBS_PER_THREAD * self.threads))
        return min(wanted, limits.MAX_WINDOW)

    def _job_bytes(self, key: JobKey) -> bytes:
        render = self._renders[key.render_id]
        job = render.planned.job(key.tile_index, render.planned.ranges[key.range_index])
        job.floating_point_profile = render.floating_point_profile
        return job.SerializeToString()


def _place(entry: bytes) -> tuple[int, int]:
    """Of an entry on its stream; later ones are greater."""
    milliseconds, _, number = entry.partition(b"-")
    return int(milliseconds), int(number)
