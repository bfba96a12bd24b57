"""The coordinator: follows the data folder, sends jobs out, merges what comes back, commits, shows.

One thread, one loop. What is merged is committed about once a second, and only then are the results deleted
from Redis; so whatever is killed whenever, open work is what is planned and not committed.
"""

import logging
import sqlite3
import threading
import time

from nocturne.v1 import job_pb2

from . import limits
from .crash_points import crash_point
from .data_folder import DataFolder
from .intake import Intake
from .job_queue import JobQueue
from .merge import XYZ_SUMS
from .pictures import Pictures
from .running_render import RunningRender
from .schedule import Schedule
from .store.ledger import Ledger, OpenRender
from .store.rows import RenderState
from .traffic import Traffic

_log = logging.getLogger(__name__)

_LOOK_SECONDS = 0.2
COMMIT_SECONDS = 1.0
"""Work lost with the coordinator, at most; a commit of a whole 512 x 512 film costs 15 ms."""

_MIRROR_SECONDS = 2.0
_WAIT_MILLISECONDS = 100
_SHORTEST_ROUND = 0.005
_LONGEST_ROUND = 0.05
_ROUNDS_PER_JOB = 3.0
"""Results that come one by one are taken together, which costs less; yet the window is filled several times
in the time that a job takes through it, so no worker waits for that."""


class Coordinator:
    """Works on one data folder through one Redis until told to stop."""

    def __init__(
        self, folder: DataFolder, ledger: Ledger, queue: JobQueue, commit_seconds: float = COMMIT_SECONDS
    ) -> None:
        self._commit_seconds = commit_seconds
        self._folder = folder
        self._ledger = ledger
        self._renders: dict[str, RunningRender] = {}
        self._schedule = Schedule()
        self._intake = Intake(self._renders, self._schedule)
        self._traffic = Traffic(queue, self._renders, self._schedule)
        self._pictures = Pictures(folder, ledger)
        self._settled: list[bytes] = []
        self._failed: dict[str, str] = {}
        self._folder_trouble = False
        self._seen_changes = -1
        self._next_look = 0.0
        self._next_commit = 0.0
        self._next_mirror = 0.0
        self._next_finish = 0.0

    def run(self, stop: threading.Event) -> None:
        """Works until `stop`; then commits what is merged. OwnershipLost if another has the folder."""
        while not stop.is_set():
            begun = time.monotonic()
            if not self._round(begun):
                stop.wait(_LOOK_SECONDS / 2)
            stop.wait(max(0.0, begun + self._shortest_round() - time.monotonic()))
        self._guarded_commit(time.monotonic())
        self._traffic.exchange(time.monotonic(), time.time(), publish=False, wait_ms=1)
        _log.info("stopped; %d renders wait to be resumed", len(self._renders))

    def _shortest_round(self) -> float:
        """Seconds."""
        wanted = self._schedule.typical_time / _ROUNDS_PER_JOB
        return min(max(wanted, _SHORTEST_ROUND), _LONGEST_ROUND)

    def _round(self, now: float) -> bool:
        """One turn of the loop; False if Redis did not answer."""
        if now >= self._next_look:
            self._look_at_folder(now)
        publish = not self._folder_trouble
        entries = self._traffic.exchange(now, time.time(), publish, _WAIT_MILLISECONDS)
        for entry, data in entries or []:
            self._take(entry, data, time.monotonic())
        now = time.monotonic()
        self._finish(now)
        if now >= self._next_commit:
            self._guarded_commit(now)
        return entries is not None

    # --- renders that come and go ---

    def _look_at_folder(self, now: float) -> None:
        self._next_look = now + _LOOK_SECONDS
        try:
            if now >= self._next_mirror:
                self._mirror_workers(now)
            changes = self._folder.change_counter()
            if changes == self._seen_changes:
                return
            self._follow_folder()
            self._pictures.finish_ended()
            self._seen_changes = changes
        except (sqlite3.Error, OSError) as trouble:
            _log.error("the data folder can't be used: %s; trying again", trouble)

    def _mirror_workers(self, now: float) -> None:
        self._next_mirror = now + _MIRROR_SECONDS
        if self._traffic.workers:
            self._ledger.mirror_workers(self._traffic.workers)

    def _follow_folder(self) -> None:
        open_renders = self._ledger.open_renders()
        still_open = {row.id for row in open_renders}
        for render_id in [render_id for render_id in self._renders if render_id not in still_open]:
            _log.info("render=%s cancelled", render_id)
            self._drop(render_id)
        for row in open_renders:
            if row.id not in self._renders:
                self._admit(row)

    def _admit(self, row: OpenRender) -> None:
        """Resumes a render, or starts it if there is room."""
        if row.engine != job_pb2.ENGINE_CURRENT:
            self._end(
                row.id,
                RenderState.FAILED,
                f"It was made for engine {row.engine}; this service traces with engine "
                f"{job_pb2.ENGINE_CURRENT}, whose bits differ. Submit it again.",
            )
            return
        if row.state is RenderState.QUEUED and not (
            self._has_room(row) and self._ledger.start(row.id, time.time())
        ):
            return
        try:
            render = RunningRender(row, self._ledger.tiles(row.id))
        except ValueError as error:
            self._end(row.id, RenderState.FAILED, f"Its committed samples can't be read: {error}")
            return
        self._renders[row.id] = render
        self._schedule.add(row.id, len(render.planned.ranges), render.merged_ranges)
        _log.info(
            "render=%s %s; %d of %d ranges are merged",
            row.id,
            "resumed" if render.totals.ranges else "started",
            render.totals.ranges,
            len(render.planned.ranges) * render.planned.grid.count,
        )

    def _has_room(self, row: OpenRender) -> bool:
        if not self._renders:
            return True
        held = sum(render.film.sums.size for render in self._renders.values())
        wanted = row.plan.width * row.plan.height * (XYZ_SUMS + len(row.plan.further_responses))
        return len(self._renders) < limits.MAXIMUM_RUNNING and held + wanted <= limits.MAXIMUM_RUNNING_SUMS

    def _drop(self, render_id: str) -> None:
        self._traffic.withdraw(self._schedule.remove(render_id))
        self._settled.extend(self._renders.pop(render_id).waiting_entries())

    def _end(self, render_id: str, state: RenderState, reason: str) -> None:
        self._ledger.end(render_id, state, reason, time.time())
        _log.info("render=%s %s %s", render_id, state.value, reason)

    # --- results ---

    def _take(self, entry: bytes, data: bytes, now: float) -> None:
        outcome = self._intake.take(entry, data, now)
        self._settled.extend(outcome.settled)
        self._traffic.withdraw(outcome.withdrawn)
        self._failed.update(outcome.failed)

    def _finish(self, now: float) -> None:
        """Ends the renders whose last range was merged, and those that failed."""
        complete = [render for render in self._renders.values() if render.film.complete]
        if now < self._next_finish or not (complete or self._failed):
            return
        self._next_finish = now + self._commit_seconds
        if not self._guarded_commit(now):
            return
        try:
            self._end_failed()
            for render in complete:
                self._end_complete(render)
        except (sqlite3.Error, OSError) as trouble:
            self._report(trouble)
        else:
            self._next_finish = now

    def _end_failed(self) -> None:
        while self._failed:
            render_id, reason = next(iter(self._failed.items()))
            if render_id in self._renders:
                self._end(render_id, RenderState.FAILED, reason)
                self._drop(render_id)
            del self._failed[render_id]

    def _end_complete(self, render: RunningRender) -> None:
        """Images first, then the state: who sees SUCCEEDED finds them."""
        if render.id not in self._renders:
            return
        self._pictures.finish(render)
        self._end(render.id, RenderState.SUCCEEDED, "")
        self._drop(render.id)

    # --- commits ---

    def _guarded_commit(self, now: float) -> bool:
        """Commits what changed; on trouble says so, and all stays as it is until the next time."""
        self._next_commit = now + self._commit_seconds
        try:
            self._commit(now)
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
        changed = [(render, changes) for render in self._renders.values() if (changes := render.changes(now))]
        if changed:
            crash_point("before-commit")
            self._ledger.commit([changes for _, changes in changed])
            crash_point("after-commit")
            for render, _ in changed:
                render.committed()
        self._traffic.acknowledge(self._settled)
        self._settled = []
        self._pictures.refresh(self._renders.values())
