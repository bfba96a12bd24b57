"""What comes in on the results stream: checked, merged or refused. No I/O; raises for no input."""

import logging
from dataclasses import dataclass, field

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from .crash_points import crash_point
from .limits import MAXIMUM_ATTEMPTS, MAXIMUM_REASON, MAXIMUM_REFUSALS
from .merge import RangeSums, Verdict
from .planned_render import RefusedResult, check_partial
from .running_render import RunningRender
from .schedule import JobKey, Schedule

_log = logging.getLogger(__name__)


@dataclass(slots=True)
class Outcome:
    """What is to be done after some results were taken in."""

    settled: list[bytes] = field(default_factory=list)
    """Result entries of no more use, once all that is merged by now is committed."""
    withdrawn: list[bytes] = field(default_factory=list)
    """Job entries to take off the stream: they are published again."""
    failed: dict[str, str] = field(default_factory=dict)
    """Renders that can't be done, and why."""


class Intake:
    """Takes results into the films of the running renders."""

    def __init__(self, renders: dict[str, RunningRender], schedule: Schedule) -> None:
        """Shares both with the coordinator."""
        self._renders = renders
        self._schedule = schedule
        self.refused = 0
        """Results that were not what a worker of ours sends."""

    def take(self, entry: bytes, data: bytes, now: float) -> Outcome:
        """One entry of the results stream; an early one is settled when it is merged."""
        outcome = Outcome()
        try:
            result = job_pb2.JobResult.FromString(data)
        except DecodeError:
            self._refuse(entry, "it is no JobResult", outcome)
            return outcome
        render = self._renders.get(result.job.render_id)
        if render is None:
            # Ended or cancelled a moment ago, most likely.
            _log.debug("render=%s is not running; result dropped", result.job.render_id)
            outcome.settled.append(entry)
            return outcome
        self._take_for(render, entry, result, now, outcome)
        return outcome

    def _take_for(
        self, render: RunningRender, entry: bytes, result: job_pb2.JobResult, now: float, outcome: Outcome
    ) -> None:
        try:
            planned = render.planned.find(result.job)
        except RefusedResult as refusal:
            self._refuse(entry, f"render={render.id}: {refusal}", outcome)
            return
        key = JobKey(render.id, result.job.tile_index, planned.index)
        if result.WhichOneof("outcome") == "failure":
            self._fail(render, key, entry, result, outcome)
            return
        try:
            sums = check_partial(
                result.partial,
                result.job,
                render.planned.sums_per_pixel,
                render.planned.photons_per_sample,
            )
        except RefusedResult as refusal:
            self._refuse_for(render, key, entry, f"worker={result.worker_id[:80]}: {refusal}", outcome)
            return
        partial = result.partial
        offered = RangeSums(
            planned.index, sums, partial.photons, partial.rays, partial.rejected, partial.cpu_seconds, entry
        )
        self._merge(render, key, offered, now, outcome)

    def _merge(
        self, render: RunningRender, key: JobKey, offered: RangeSums, now: float, outcome: Outcome
    ) -> None:
        crash_point("received")
        verdict, released = render.offer(key.tile_index, offered, now)
        if verdict is Verdict.TOO_EARLY:
            self._give_back(key, outcome)
        else:
            self._schedule.received(key, now)
        if verdict in (Verdict.TOO_EARLY, Verdict.DUPLICATE):
            outcome.settled.append(offered.entry)
        if released:
            crash_point("merged")
            self._schedule.merged(render.id, key.tile_index, released[-1].index + 1)
            outcome.settled.extend(merged.entry for merged in released)

    def _fail(
        self, render: RunningRender, key: JobKey, entry: bytes, result: job_pb2.JobResult, outcome: Outcome
    ) -> None:
        outcome.settled.append(entry)
        if not self._schedule.is_outstanding(key):
            return
        render.failures[key] += 1
        reason = result.failure[:MAXIMUM_REASON]
        _log.warning(
            "render=%s %s failed at worker=%s: %s", render.id, key[1:], result.worker_id[:80], reason
        )
        if render.failures[key] >= MAXIMUM_ATTEMPTS:
            outcome.failed[render.id] = reason
        self._give_back(key, outcome)

    def _refuse_for(
        self, render: RunningRender, key: JobKey, entry: bytes, reason: str, outcome: Outcome
    ) -> None:
        self._refuse(entry, f"render={render.id} {reason}", outcome)
        if not self._schedule.is_outstanding(key):
            return
        render.refusals[key] += 1
        if render.refusals[key] >= MAXIMUM_REFUSALS:
            outcome.failed[render.id] = f"Workers keep sending results that can't be right: {reason}"
        self._give_back(key, outcome)

    def _refuse(self, entry: bytes, reason: str, outcome: Outcome) -> None:
        self.refused += 1
        _log.warning("result %s refused (%d so far): %s", entry.decode(), self.refused, reason)
        outcome.settled.append(entry)

    def _give_back(self, key: JobKey, outcome: Outcome) -> None:
        job_entry = self._schedule.returned(key)
        if job_entry is not None:
            outcome.withdrawn.append(job_entry)
