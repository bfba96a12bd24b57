"""Which jobs are on the stream: keeps the window full, makes use of entries found there, takes back overdue
jobs. Pure."""

from collections.abc import Collection

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.events import JobsFound, Moment, WorkersSeen
from nocturne_coordinator.dispatch.instructions import (
    INFO,
    WARNING,
    IsOpen,
    Log,
    Publish,
    PublishExclusions,
    Steps,
    Withdraw,
)
from nocturne_coordinator.dispatch.liveness import Sign
from nocturne_coordinator.dispatch.planned_render import RejectedResult
from nocturne_coordinator.dispatch.quick_copies import QuickCopies
from nocturne_coordinator.dispatch.quick_entries import is_quick
from nocturne_coordinator.dispatch.range_queue import RangeState
from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.dispatch.state import State
from nocturne_coordinator.errors import QueueError

_OVERDUE_SECONDS = 5.0
"""Between two looks for jobs that are overdue, or less, where they are so sooner."""

_AUDIT_PART = 8
"""One audit for so many places of the window, at most, in one round."""

_MAX_PUBLISH = 500
"""Jobs published before results are read again."""


class Window:
    """The jobs in flight."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._next_overdue = 0.0
        self.quick_copies = QuickCopies(state)

    @property
    def size(self) -> int:
        """Jobs in flight that there should be."""
        fleet = self._state.fleet
        wanted = max(limits.MIN_WINDOW, round(fleet.share * limits.JOBS_PER_THREAD * fleet.threads))
        return min(wanted, limits.MAX_WINDOW)

    def workers_seen(self, event: WorkersSeen) -> Steps[None]:
        """Notes who is there, and who died with a job in hand."""
        state, fleet = self._state, self._state.fleet
        for worker, reason in fleet.seen(event.workers).items():
            yield Log(WARNING, f"worker={worker} gets no jobs: {reason}")
        signs = {row.id: Sign(row.started, event.left_ms[row.id]) for row in event.workers}
        entries = state.scheduler.entries()
        lost = fleet.liveness.look(signs, list(event.holders), entries)
        self.quick_copies.seen(event.holders, {**state.auditor.entries(), **entries})
        ours = state.scheduler.outstanding + state.auditor.outstanding
        fleet.jobs_of_others = max(0, event.jobs_waiting - ours)
        state.lost += lost
        state.auditor.look(lambda render: fleet.live(state.renders[render].floating_point_profile))
        yield PublishExclusions(fleet.without_jobs())

    def emptied(self) -> None:
        """All that was on the stream is to be published again."""
        self._state.scheduler.lost()
        self._state.auditor.lost()

    def adopt(self, event: JobsFound) -> Steps[None]:
        """Makes use of jobs that an earlier run, or a call whose answer was lost, left on the stream."""
        scheduler = self._state.scheduler
        known = {*scheduler.entries(), *self._state.auditor.entries()}
        adopted = 0
        # Copies, and jobs of renders that nobody works on.
        surplus: list[bytes] = []
        unwanted: list[bytes] = []
        for entry, data in event.jobs:
            key = self._key_of(data)
            is_wanted = key is not None and scheduler.state_of(key) is RangeState.PLANNED
            # A quick copy alone might come to no end.
            if key is not None and is_wanted and not is_quick(entry):
                scheduler.published(key, entry, event.at.now)
                adopted += 1
            elif key is None:
                if not (yield from self._is_others(data)):
                    unwanted.append(entry)
            elif entry not in known:
                surplus.append(entry)
        if surplus:
            yield Withdraw(tuple(surplus))
        if unwanted:
            yield Withdraw(tuple(unwanted), stop=True)
        yield Log(INFO, f"{adopted} jobs found on the stream")

    def fill(self, at: Moment) -> Steps[None]:
        """Publishes until the window is full. QueueError where Redis failed: what became of the jobs is found
        out by the next JobsFound."""
        if self._state.folder_trouble:
            return
        if self._state.fleet.threads and at.now >= self._next_overdue:
            yield from self._return_overdue(at)
        scheduler, threads = self._state.scheduler, self._state.fleet.threads
        quick = self.quick_copies.renders(at.now)
        keys = self._next_jobs(quick)
        try:
            entries = yield from self._publish(keys)
        except QueueError:
            # Some may be on the stream; they are adopted when Redis answers again.
            for key in keys:
                scheduler.returned(key)
            raise
        for key, entry in zip(keys, entries, strict=True):
            scheduler.published(key, entry, at.now)
        yield from self._fill_audits(at)
        idle = threads - scheduler.outstanding - self._state.fleet.jobs_of_others
        if not keys and idle > 0:
            slow = scheduler.slow(at.now, idle)
            # Should it fail, no copy is known: it is taken off the stream when Redis answers again.
            for key, entry in zip(slow, (yield from self._publish(slow)), strict=True):
                yield Log(INFO, f"{key} is slow; an idle worker gets it as well")
                scheduler.copied(key, entry)
        yield from self._fill_quick(quick, at)

    def _next_jobs(self, quick: list[str]) -> list[JobKey]:
        """Jobs to publish; of renders that may have quick copies also where the window is full of others'."""
        scheduler, not_wanted = self._state.scheduler, self._not_wanted()
        keys = scheduler.take(min(self.size - scheduler.in_flight, _MAX_PUBLISH), not_wanted)
        for renders, room in self.quick_copies.rooms_ahead(quick, keys):
            keys += scheduler.take(room, {*not_wanted, *(self._state.renders.keys() - renders)})
        return keys

    def _fill_quick(self, renders: list[str], at: Moment) -> Steps[None]:
        keys = self.quick_copies.wanted(renders, at.now)
        # Should it fail, no copy is known: it is taken off the stream when Redis answers again.
        for key, entry in zip(keys, (yield from self._publish(keys, quick=True)), strict=True):
            self.quick_copies.copied(key, entry, at.now)

    def _fill_audits(self, at: Moment) -> Steps[None]:
        auditor = self._state.auditor
        keys = auditor.take(max(1, self.size // _AUDIT_PART))
        try:
            entries = yield from self._publish(keys)
        except QueueError:
            for key in keys:
                auditor.returned(key)
            raise
        for key, entry in zip(keys, entries, strict=True):
            auditor.published(key, entry, at.now)

    def _publish(self, keys: list[JobKey], quick: bool = False) -> Steps[list[bytes]]:
        if not keys:
            return []
        jobs = tuple(self._job_bytes(key, quick) for key in keys)
        entries: list[bytes] = yield Publish(tuple(keys), jobs, quick)
        return entries

    def _return_overdue(self, at: Moment) -> Steps[None]:
        self._next_overdue = at.now + min(_OVERDUE_SECONDS, self._state.settings.overdue_seconds)
        scheduler, auditor = self._state.scheduler, self._state.auditor
        entries = []
        for key in scheduler.overdue(at.now):
            yield Log(WARNING, f"{key} is overdue; published again")
            entries += scheduler.returned(key)
        for key in auditor.overdue(at.now):
            entries += auditor.returned(key)
        if entries:
            yield Withdraw(tuple(entries))

    def _not_wanted(self) -> Collection[str]:
        """Renders whose jobs would only fill the window."""
        return {*self._without_workers(), *self._state.needs_audits_only}

    def _without_workers(self) -> list[str]:
        """Renders that no worker can work on though some are there."""
        machines = self._state.fleet.votes_by_profile
        if not machines:
            return []
        return [
            render.id
            for render in self._state.renders.values()
            if render.floating_point_profile and not machines.get(render.floating_point_profile)
        ]

    def _is_others(self, data: bytes) -> Steps[bool]:
        """Whether a job is of a render that another coordinator works on, or will."""
        try:
            render_id = job_pb2.Job.FromString(data).render_id
        except DecodeError:
            return False
        if render_id in self._state.renders:
            return False
        is_open: bool = yield IsOpen(render_id)
        return is_open

    def _key_of(self, data: bytes) -> JobKey | None:
        try:
            job = job_pb2.Job.FromString(data)
            render = self._state.renders.get(job.render_id)
            planned = render.planned.find(job) if render else None
        except (DecodeError, RejectedResult):
            return None
        return JobKey(job.render_id, job.tile_index, planned.index) if planned else None

    def _job_bytes(self, key: JobKey, quick: bool) -> bytes:
        render = self._state.renders[key.render_id]
        planned = render.planned.ranges_of(key.tile_index)[key.range_index]
        job = render.planned.job(key.tile_index, planned)
        job.floating_point_profile = render.floating_point_profile
        job.max_cpu_seconds = limits.QUICK_CPU_SECONDS if quick else render.max_cpu_seconds(planned)
        job.quick = quick
        return job.SerializeToString()
