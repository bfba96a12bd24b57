"""The coordinator: follows the data folder, sends jobs out, merges what comes back, commits, shows.

One thread, one loop. What is merged is committed about once a second, and only then are the results deleted
from Redis; so whatever is killed whenever, open work is what is planned and not committed. Several may share
a folder: each render is leased to one of them, and every write checks the lease's fence.
"""

import logging
import sqlite3
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping

from nocturne.v1 import job_pb2
from nocturne_scene.errors import NotFound
from nocturne_scene.ranges import XYZ_SUMS

from nocturne_coordinator import limits
from nocturne_coordinator.crash_points import crash_point
from nocturne_coordinator.dispatch.audit import MAX_WAIT, Auditor
from nocturne_coordinator.dispatch.failure_policy import FailurePolicy
from nocturne_coordinator.dispatch.profiles import should_start_anew, usual_profile
from nocturne_coordinator.dispatch.records import OpenRender, RenderState, WorkerRow
from nocturne_coordinator.dispatch.result_handler import Outcome, ResultHandler
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import MIN_OVERDUE, Scheduler
from nocturne_coordinator.dispatcher import Dispatcher
from nocturne_coordinator.errors import LeaseLost
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.queue.job_queue import JobQueue, Session
from nocturne_coordinator.store.bundle import write_bundle
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger

_log = logging.getLogger(__name__)

_LOOK_SECONDS = 0.2
COMMIT_SECONDS = 0.9
"""Work lost with the coordinator, at most; a commit of a whole 512 x 512 film costs 15 ms."""

_FIRST_LIGHT_SECONDS = 0.1
"""From a render's first result to its commit: somebody may be waiting to see that it is the right scene."""

_MIRROR_SECONDS = 2.0
_FOLLOW_SECONDS = 5.0
"""Renders that wait are looked at so often though nothing changes: their time may come."""

_LONELY_SECONDS = 10.0
"""How long audits at the end of a render wait for a worker that could settle them, while there is none."""

_ODD_SECONDS = 10.0
"""How long most workers must round otherwise than a render's before it is started anew: a worker's status
holds as long, so all that are there have been seen."""

_WAIT_MILLISECONDS = 100
_MIN_ROUND = 0.005
_MAX_ROUND = 0.05
_ROUNDS_PER_JOB = 3.0
"""Results that come one by one are taken together, which costs less; yet the window is filled several times
in the time that a job takes through it, so no worker waits for that."""


class Coordinator:
    """Works on one data folder through one Redis until told to stop."""

    def __init__(
        self,
        folder: DataFolder,
        ledger: Ledger,
        queue: JobQueue,
        session: Session,
        commit_seconds: float = COMMIT_SECONDS,
        auditor: Auditor | None = None,
        overdue_seconds: float = MIN_OVERDUE,
    ) -> None:
        self._commit_seconds = commit_seconds
        self._folder = folder
        self._ledger = ledger
        self._renders: dict[str, RunningRender] = {}
        self._scheduler = Scheduler(overdue_seconds)
        self._auditor = auditor or Auditor()
        self._failure_policy = FailurePolicy()
        others = self._is_open
        self._dispatcher = Dispatcher(queue, session, self._renders, self._scheduler, self._auditor, others)
        self._result_handler = ResultHandler(
            self._renders,
            self._scheduler,
            self._auditor,
            self._failure_policy,
            others,
            self._dispatcher.live,
            lambda: self._dispatcher.threads_by_profile,
        )
        self._quarantine(ledger.quarantined())
        self._previews = Previews(folder, ledger)
        self._settled: dict[str, list[bytes]] = {}
        """Result entries to delete after the next commit, by render; under no render's name, of none."""
        self._coordinators = 1
        self._mirrored: list[WorkerRow] = []
        self._failed: dict[str, str] = {}
        self._audits_end: dict[str, float] = {}
        self._odd_since: dict[str, float] = {}
        """Renders that most workers can't help with, and since when."""
        self._folder_trouble = False
        self._seen_changes = -1
        self._next_look = 0.0
        self._next_follow = 0.0
        self._next_commit = 0.0
        self._next_mirror = 0.0
        self._next_finish = 0.0

    def run(self, stop: threading.Event, turned: Callable[[], None] = lambda: None) -> None:
        """Works until `stop`; then commits what is merged. OwnershipLost if another has the folder.

        `turned` is called in every turn of the loop, as a sign of life.
        """
        while not stop.is_set():
            begun = time.monotonic()
            turned()
            if not self._round(begun):
                stop.wait(_LOOK_SECONDS / 2)
            stop.wait(max(0.0, begun + self._shortest_round() - time.monotonic()))
        self._guarded_commit(time.monotonic())
        self._dispatcher.exchange(time.monotonic(), time.time(), publish=False, wait_ms=1)
        self._dispatcher.leave()
        self._resign()
        _log.info("stopped; %d renders wait to be resumed", len(self._renders))

    def _resign(self) -> None:
        try:
            self._ledger.resign()
        except (sqlite3.Error, OSError) as trouble:
            _log.info("the leases on renders run out by themselves: %s", trouble)

    def _is_open(self, render_id: str) -> bool:
        """Whether messages of a render that is not here may be of use to another coordinator, or later."""
        try:
            return self._ledger.is_open(render_id)
        except sqlite3.Error:
            return True

    def _shortest_round(self) -> float:
        """Seconds."""
        wanted = self._scheduler.typical_time / _ROUNDS_PER_JOB
        return min(max(wanted, _MIN_ROUND), _MAX_ROUND)

    def _round(self, now: float) -> bool:
        """One turn of the loop; False if Redis did not answer."""
        if now >= self._next_look:
            self._look_at_folder(now)
        publish = not self._folder_trouble
        entries = self._dispatcher.exchange(now, time.time(), publish, _WAIT_MILLISECONDS)
        for entry, data in entries or []:
            self._follow(self._result_handler.take(entry, data, time.monotonic()))
        while self._dispatcher.lost:
            self._follow(self._result_handler.lost_worker(*self._dispatcher.lost.pop()))
        now = time.monotonic()
        self._finish(now)
        if any(render.is_unseen for render in self._renders.values()):
            self._next_commit = min(self._next_commit, now + _FIRST_LIGHT_SECONDS)
        if now >= self._next_commit:
            self._guarded_commit(now)
        return entries is not None

    # --- renders that come and go ---

    def _look_at_folder(self, now: float) -> None:
        self._next_look = now + _LOOK_SECONDS
        try:
            if now >= self._next_mirror:
                self._mirror_workers(now)
            self._start_odd_ones_anew(now)
            changes = self._folder.change_counter()
            if changes == self._seen_changes and now < self._next_follow:
                return
            self._next_follow = now + _FOLLOW_SECONDS
            if not self._follow_folder(now):
                return
            self._previews.finish_ended()
            self._seen_changes = changes
        except LeaseLost as lost:
            self._lose(lost.render_id)
        except (sqlite3.Error, OSError) as trouble:
            _log.error("the data folder can't be used: %s; trying again", trouble)

    def _mirror_workers(self, now: float) -> None:
        self._next_mirror = now + min(_MIRROR_SECONDS, self._ledger.lease_seconds / 5)
        coordinators = self._ledger.renew(time.time())
        if coordinators != self._coordinators:
            _log.info("%d coordinators work on the folder", coordinators)
            self._coordinators = coordinators
            self._seen_changes = -1
        workers = self._dispatcher.workers
        if (workers or self._dispatcher.in_step) and workers is not self._mirrored:
            at_work = [(key.render_id, key.tile_index, worker) for key, worker in self._dispatcher.at_work]
            self._ledger.mirror_workers(workers, at_work, time.time())
            self._mirrored = workers
        self._ledger.write_meters(
            {
                "coordinator_seen": time.time(),
                "redis_in_step": float(self._dispatcher.in_step),
                "folder_trouble": float(self._folder_trouble),
                "worker_threads": self._dispatcher.threads,
                "jobs_in_flight": self._scheduler.in_flight,
                "jobs_published": self._scheduler.outstanding,
                "results_waiting": self._dispatcher.results_waiting,
                "result_seconds": self._dispatcher.longest_wait,
                "results_refused": self._result_handler.refused,
                "job_seconds": self._scheduler.typical_time,
                "audits_agreed": self._auditor.agreed,
                "audits_differing": self._auditor.mismatches,
                "audits_given_up": self._auditor.given_up,
            }
        )
        self._dispatcher.longest_wait = 0.0

    def _follow_folder(self, now: float) -> bool:
        """Takes renders up and lets them go as the folder says; False if that has to wait."""
        self._quarantine(self._ledger.quarantined())
        rows = {row.id: row for row in self._ledger.open_renders()}
        for render in [each for each in self._renders.values() if _is_lost(each, rows)]:
            self._lose(render.id)
        changed = [
            render.id
            for render in self._renders.values()
            if render.id not in rows or not rows[render.id].asks_the_same(render.row)
        ]
        # What is merged of them is kept, unless they were cancelled.
        if changed and not self._guarded_commit(now):
            return False
        # A commit may have found one of them lost.
        for render_id in [each for each in changed if each in self._renders]:
            _log.info("render=%s %s", render_id, "has other schedules" if render_id in rows else "let go")
            self._drop(render_id)
        part = -(-len(rows) // self._coordinators)
        self._pass_on(part)
        for row in self._ledger.open_renders() if changed else rows.values():
            if row.id in self._renders:
                self._scheduler.set_priority(row.id, row.priority)
                self._look_first(row)
                if row.state is RenderState.QUEUED:
                    # Paused and resumed between two looks: it runs as before.
                    self._ledger.start(row.id, self._renders[row.id].row.fence, time.time())
            elif row.holder in (0, self._ledger.number) and len(self._renders) < part:
                self._admit(row)
        self._dispatcher.share = _share_of(self._renders, rows.values())
        classes = {render.id: render.floating_point_profile for render in self._renders.values()}
        self._dispatcher.set_profiles(
            {classes.get(row.id, row.floating_point_profile) for row in rows.values()}
        )
        return True

    def _start_odd_ones_anew(self, now: float) -> None:
        """A render whose first worker rounds as few others do, so that these can't help, loses its start."""
        for render in list(self._renders.values()):
            threads, cpu_seconds = self._dispatcher.threads_by_profile, render.totals.cpu_seconds
            # A replay is asked for with that very class.
            fixed = bool(render.row.stop.tile_samples)
            if fixed or not should_start_anew(render.floating_point_profile, threads, cpu_seconds):
                self._odd_since.pop(render.id, None)
            elif now - self._odd_since.setdefault(render.id, now) >= _ODD_SECONDS:
                if not self._guarded_commit(now) or render.id not in self._renders:
                    continue
                _log.warning(
                    "render=%s is started anew: it has floating-point profile %s, most workers %s",
                    *(render.id, render.floating_point_profile, usual_profile(threads)),
                )
                self._ledger.start_anew(render.id, render.row.fence)
                self._drop(render.id)
                self._seen_changes = -1

    def _pass_on(self, part: int) -> None:
        """Leaves the youngest renders to other coordinators that have fewer."""
        surplus = list(self._renders)[part:]
        if surplus and self._guarded_commit(time.monotonic()):
            for render_id in [each for each in surplus if each in self._renders]:
                _log.info("render=%s is left to another coordinator", render_id)
                self._drop(render_id, jobs_stay=True)

    def _lose(self, render_id: str) -> None:
        """Another coordinator has the render, or its sums were changed: jobs and results are not ours any
        more. Those of a render that was deleted are nobody's."""
        is_open = self._is_open(render_id)
        if render_id in self._renders:
            _log.warning("render=%s is not ours any more; what was not committed is done again", render_id)
            self._drop(render_id, jobs_stay=is_open)
        results = self._settled.pop(render_id, [])
        if not is_open:
            self._dispatcher.acknowledge(results)
        # It may be ours to take again.
        self._seen_changes = -1

    def _quarantine(self, workers: dict[str, str]) -> None:
        self._result_handler.quarantined = workers
        self._dispatcher.quarantined = workers

    def _admit(self, row: OpenRender) -> None:
        """Resumes a render, or starts it if there is room."""
        if row.state is RenderState.QUEUED and not self._has_room(row):
            return
        taken = self._ledger.take(row.id)
        if taken is not None and taken.state in (RenderState.QUEUED, RenderState.RUNNING):
            self._work_on(taken)

    def _work_on(self, row: OpenRender) -> None:
        """A render that is leased to us."""
        if row.engine != job_pb2.ENGINE_CURRENT:
            self._end(
                row,
                RenderState.FAILED,
                f"It was made for engine {row.engine}; this service traces with engine "
                f"{job_pb2.ENGINE_CURRENT}, whose bits differ. Submit it again.",
            )
            return
        if row.state is RenderState.QUEUED and 0.0 < row.stop.until <= time.time() and not row.totals.photons:
            text = row.stop.until_text or "the time"
            reason = f"{text} came before there was room to start it."
            self._end(row, RenderState.STOPPED_EARLY, reason)
            return
        if row.state is RenderState.QUEUED and not self._ledger.start(row.id, row.fence, time.time()):
            return
        try:
            render = RunningRender(row, self._ledger.tiles(row.id), time.monotonic())
        except ValueError as error:
            self._end(row, RenderState.FAILED, f"Its committed samples can't be read: {error}")
            return
        self._renders[row.id] = render
        self._scheduler.add(
            row.id,
            len(render.planned.ranges),
            render.merged_ranges,
            horizon=[render.film.horizon(index) for index in range(len(render.film.tiles))],
            owner=row.owner,
            priority=row.priority,
            owner_weight=row.owner_weight,
            cost=render.cost,
        )
        if row.fence > 1:
            self._dispatcher.welcome(row.id)
        self._look_first(row)
        _log.info(
            "render=%s %s; %d of %d ranges are merged",
            row.id,
            "resumed" if render.totals.ranges else "started",
            render.totals.ranges,
            len(render.planned.ranges) * render.planned.grid.count,
        )

    def _look_first(self, row: OpenRender) -> None:
        grid = self._renders[row.id].planned.grid
        self._scheduler.set_first(row.id, row.look_first.tiles(grid) if row.look_first else frozenset())

    def _has_room(self, row: OpenRender) -> bool:
        if not self._renders:
            return True
        held = sum(render.film.sums.size for render in self._renders.values())
        wanted = row.schedule.width * row.schedule.height * (XYZ_SUMS + len(row.schedule.further_responses))
        return len(self._renders) < limits.MAX_RUNNING and held + wanted <= limits.MAX_RUNNING_SUMS

    def _drop(self, render_id: str, jobs_stay: bool = False) -> None:
        """Works on the render no more. `jobs_stay`: another coordinator will want its jobs and results."""
        jobs = [*self._scheduler.remove(render_id), *self._auditor.forget(render_id)]
        self._failure_policy.forget(render_id)
        self._audits_end.pop(render_id, None)
        self._odd_since.pop(render_id, None)
        render = self._renders.pop(render_id)
        if not jobs_stay:
            self._dispatcher.withdraw(jobs)
            self._settled.setdefault(render_id, []).extend(render.waiting_entries())
        try:
            self._ledger.let_go(render_id, render.row.fence)
        except (sqlite3.Error, OSError) as trouble:
            _log.info("render=%s: the lease runs out by itself: %s", render_id, trouble)

    def _end(self, render: OpenRender, state: RenderState, reason: str) -> None:
        if self._ledger.end(render, state, reason, time.time()):
            _log.info("render=%s %s %s", render.id, state.value, reason)
        else:
            # Somebody wants something else of it; the next look at the folder tells what.
            self._seen_changes = -1

    # --- results ---

    def _follow(self, outcome: Outcome) -> None:
        """Does what a result calls for."""
        self._settled.setdefault(outcome.render_id, []).extend(outcome.settled)
        self._dispatcher.withdraw(outcome.withdrawn)
        self._failed.update(outcome.failed)
        for render_id, failed in outcome.failed_tiles:
            render = self._renders[render_id]
            try:
                write_bundle(self._folder, render.planned, failed)
            except (OSError, NotFound) as trouble:
                _log.error("render=%s tile=%d has no bundle: %s", render_id, failed.tile_index, trouble)
        for worker in outcome.quarantined.keys() - self._dispatcher.quarantined.keys():
            reason = outcome.quarantined[worker]
            self._put_in_quarantine(worker, reason, worker in outcome.liars)

    def _put_in_quarantine(self, worker: str, reason: str, lied: bool) -> None:
        _log.error("worker=%s is in quarantine: %s", worker, reason)
        self._quarantine({**self._dispatcher.quarantined, worker: reason})
        if not self._guarded_commit(time.monotonic()):
            # It is still incompatible here; should this process die now, another audit finds it.
            return
        self._ledger.quarantine(worker, reason, time.time())
        if lied:
            for render_id in self._ledger.distrust(worker):
                _log.error("render=%s tiles with work of worker=%s are traced anew", render_id, worker)
                if render_id in self._renders:
                    self._drop(render_id)
            self._seen_changes = -1

    def _finish(self, now: float) -> None:
        """Ends the renders that have all that was asked for, or whose time is over, and those that failed."""
        endings = [
            (render, *ending)
            for render in self._renders.values()
            if (ending := render.ending(now, time.time())) and self._audits_are_done(render, now)
        ]
        if now < self._next_finish or not (endings or self._failed):
            return
        self._next_finish = now + self._commit_seconds
        if not self._guarded_commit(now):
            return
        try:
            self._end_failed()
            for render, state, reason in endings:
                self._end_with_image(render, state, reason)
        except LeaseLost as lost:
            self._lose(lost.render_id)
        except (sqlite3.Error, OSError) as trouble:
            self._report(trouble)
        else:
            self._next_finish = now

    def _audits_are_done(self, render: RunningRender, now: float) -> bool:
        """Whether no audit of the render is open, or none that others than the audited worker could
        settle."""
        if not self._auditor.pending(render.id):
            return True
        witnesses = 3 if self._auditor.disputed(render.id) else 2
        if len(self._dispatcher.live(render.floating_point_profile)) < witnesses:
            return now >= self._audits_end.setdefault(render.id, now + _LONELY_SECONDS)
        return now >= self._audits_end.setdefault(render.id, now + MAX_WAIT)

    def _end_failed(self) -> None:
        while self._failed:
            render_id, reason = next(iter(self._failed.items()))
            if render_id in self._renders:
                self._end(self._renders[render_id].row, RenderState.FAILED, reason)
                self._drop(render_id)
            del self._failed[render_id]

    def _end_with_image(self, render: RunningRender, state: RenderState, reason: str) -> None:
        """Images first, then the state: who sees that it has ended finds them."""
        if render.id not in self._renders:
            return
        if render.totals.photons:
            self._previews.finish(render)
        disputed = self._auditor.disputed(render.id)
        if disputed:
            key, workers = disputed[0]
            state = RenderState.DEGRADED
            reason = (
                f"Workers {' and '.join(workers)} have different results of tile {key.tile_index}, "
                f"and there was no third one to tell who is right. {reason}"
            ).strip()
        self._end(render.row, state, reason)
        self._drop(render.id)

    # --- commits ---

    def _guarded_commit(self, now: float) -> bool:
        """Commits what changed; on trouble says so, and all stays as it is until the next time."""
        self._next_commit = now + self._commit_seconds
        try:
            self._commit(now)
        except LeaseLost as lost:
            self._lose(lost.render_id)
        except (sqlite3.Error, OSError) as trouble:
            self._report(trouble)
            return False
        self._folder_trouble = False
        return True

    def _report(self, trouble: Exception) -> None:
        # No new jobs until a commit works again: merged results pile up in Redis.
        self._folder_trouble = True
        _log.error("can't write to the data folder: %s; intake pauses, trying again", trouble)

    def _commit(self, now: float) -> None:
        changed = [
            (render, changes)
            for render in self._renders.values()
            if (changes := render.changes(now, time.time()))
        ]
        if changed:
            crash_point("before-commit")
            lost = self._ledger.commit([changes for _, changes in changed])
            crash_point("after-commit")
            for render, _ in changed:
                render.committed()
            for render_id in lost:
                self._lose(render_id)
        # Who has a render now may need a result that is only a duplicate here.
        fences = {each: self._renders[each].row.fence for each in self._settled if each in self._renders}
        for render_id in self._ledger.lost(fences):
            self._lose(render_id)
        for entries in self._settled.values():
            self._dispatcher.acknowledge(entries)
        self._settled = {}
        self._previews.refresh(self._renders.values())


def _is_lost(render: RunningRender, rows: Mapping[str, OpenRender]) -> bool:
    return render.id in rows and rows[render.id].fence != render.row.fence


def _share_of(ours: Mapping[str, RunningRender], rows: Iterable[OpenRender]) -> float:
    """What our renders should get of the workers: owners by their weight, an owner's renders by priority."""
    working = [row for row in rows if row.holder or row.id in ours]
    priorities: Counter[str] = Counter()
    for row in working:
        priorities[row.owner] += row.priority
    parts = {row.id: row.owner_weight * row.priority / priorities[row.owner] for row in working}
    whole = sum(parts.values())
    return sum(part for render_id, part in parts.items() if render_id in ours) / whole if whole else 1.0
