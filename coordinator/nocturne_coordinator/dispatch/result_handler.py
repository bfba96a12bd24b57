"""Entries of the results stream: checked, merged, audited or refused. Pure; raises for no input."""

from dataclasses import dataclass, field

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.failure_policy import PoisonedJob
from nocturne_coordinator.dispatch.instructions import DEBUG, ERROR, WARNING, Log, Quarantine, WriteBundle
from nocturne_coordinator.dispatch.merge import MergeResult, RangeSums
from nocturne_coordinator.dispatch.planned_render import RejectedResult
from nocturne_coordinator.dispatch.profiles import profile_of, refusal_of
from nocturne_coordinator.dispatch.range_queue import RangeState
from nocturne_coordinator.dispatch.records import FailedTile
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.dispatch.state import State
from nocturne_coordinator.enrolment import machine_of, reason_of, token_of
from nocturne_coordinator.limits import (
    MAX_FAILED_TILES,
    MAX_REASON,
    QUICK_CPU_SECONDS,
    QUICK_REFUSED_SECONDS,
)

_MAX_NAME = 256


@dataclass(slots=True)
class Outcome:
    """The consequences of results that were taken in."""

    to_acknowledge: list[bytes] = field(default_factory=list)
    """Result entries of no more use, once all that is merged by now is committed."""
    render_id: str = ""
    """The running render that they are of; empty: of none."""
    withdrawn: list[bytes] = field(default_factory=list)
    """Job entries to take off the stream: they are published again, or not needed any more."""
    bundles: list[WriteBundle] = field(default_factory=list)
    """Of tiles that get no more samples."""
    failed: dict[str, str] = field(default_factory=dict)
    """Renders that can't be done, and why."""
    quarantined: list[Quarantine] = field(default_factory=list)
    """Workers whose results are not taken any more."""
    unknown_render: str = ""
    """Not running here: whether the result is of use to another coordinator is to be asked."""
    lines: list[Log] = field(default_factory=list)
    """For the log."""


class ResultHandler:
    """Takes results into the films of the running renders."""

    def __init__(self, state: State) -> None:
        self._state = state
        self.refused = 0
        """Results that were not what a worker of ours sends."""
        self.merged = 0
        """Ranges merged since the start."""

    def take(self, entry: bytes, data: bytes, now: float, draw: float, refusal: str = "") -> Outcome:
        """One entry of the results stream; an early one is settled when it is merged. `draw`: see
        ResultCame."""
        outcome = Outcome()
        if refusal:
            self._refuse(entry, refusal, outcome)
            return outcome
        try:
            result = job_pb2.JobResult.FromString(data)
        except DecodeError:
            self._refuse(entry, "it is no JobResult", outcome)
            return outcome
        render = self._state.renders.get(result.job.render_id)
        if render is None:
            outcome.unknown_render = result.job.render_id[:_MAX_NAME]
            outcome.lines.append(Log(DEBUG, f"render={outcome.unknown_render} is not running here"))
            outcome.to_acknowledge.append(entry)
            return outcome
        outcome.render_id = render.id
        self._take_for(render, entry, result, now, draw, outcome)
        return outcome

    def lost_worker(self, key: JobKey, worker: str, now: float) -> Outcome:
        """A worker's process ended without a word while it had a job."""
        outcome = Outcome(render_id=key.render_id)
        if key.render_id in self._state.renders:
            self._fail(
                self._state.renders[key.render_id],
                key,
                machine_of(worker),
                f"worker {worker} died of it",
                now,
                outcome,
                died=True,
            )
        return outcome

    def _take_for(
        self,
        render: RunningRender,
        entry: bytes,
        result: job_pb2.JobResult,
        now: float,
        draw: float,
        outcome: Outcome,
    ) -> None:
        worker = machine_of(result.worker_id[:_MAX_NAME])
        try:
            planned = render.planned.find(result.job)
        except RejectedResult as refusal:
            self._refuse_of(render, entry, f"worker={worker}: {refusal}", outcome)
            return
        key = JobKey(render.id, result.job.tile_index, planned.index)
        if reason_of(worker, self._state.fleet.quarantined):
            self._refuse_of(render, entry, f"worker={worker} is in quarantine", outcome)
            self._give_back(key, outcome)
            return
        floating_point_profile = profile_of(result.floating_point_profile)
        if reason := refusal_of(
            render.floating_point_profile, floating_point_profile, self._state.fleet.votes_by_profile
        ):
            self._refuse_of(render, entry, f"worker={worker} has {reason}", outcome)
            self._give_back(key, outcome)
            return
        # The first jobs of a render have none.
        if result.job.floating_point_profile not in ("", render.floating_point_profile):
            reason = f"worker={worker}: the job has another floating-point profile"
            self._refuse_of(render, entry, reason, outcome)
            return
        if result.WhichOneof("outcome") == "failure":
            outcome.to_acknowledge.append(entry)
            stop = self._stopped_quick if result.job.quick else self._stopped
            fail = stop if result.stopped_too_long else self._fail
            fail(render, key, worker, result.failure[:MAX_REASON], now, outcome)
            return
        partial = result.partial
        try:
            sums = render.planned.check_partial(partial, result.job)
        except RejectedResult as refusal:
            self._refuse_of(render, entry, f"worker={worker}: {refusal}", outcome)
            self._fail(render, key, worker, f"worker {worker} sent {refusal}", now, outcome)
            return
        render.floating_point_profile = floating_point_profile
        offered = RangeSums(
            planned.index,
            sums,
            partial.photons,
            partial.rays,
            partial.invalid_samples,
            partial.cpu_seconds,
            entry,
            worker,
            partial.truncated_paths,
        )
        self._merge(render, key, offered, now, draw, outcome, partial)

    def _stopped(
        self, render: RunningRender, key: JobKey, worker: str, reason: str, now: float, outcome: Outcome
    ) -> None:
        """A worker stopped a job beyond its processor time: shorter ones take its place, if they can."""
        # By our own figures: what the worker says it took might be anything.
        cpu_seconds = render.max_cpu_seconds(render.planned.ranges_of(key.tile_index)[key.range_index])
        self._state.scheduler.charge(render.id, cpu_seconds)
        if render.stopped_too_long(key.tile_index, key.range_index, cpu_seconds):
            outcome.lines.append(Log(WARNING, f"{key} took too long at worker={worker}; it is cut"))
            self._give_back(key, outcome)
        else:
            self._fail(render, key, worker, reason, now, outcome)

    def _stopped_quick(
        self, render: RunningRender, key: JobKey, worker: str, _: str, now: float, outcome: Outcome
    ) -> None:
        """That says nothing of the range, whose job is out as well; its owner has had a second for it."""
        state = self._state
        state.scheduler.charge(render.id, QUICK_CPU_SECONDS)
        render.gets_quick_copies = False
        state.no_quick_copies[render.row.owner] = now + QUICK_REFUSED_SECONDS
        outcome.withdrawn.extend(state.scheduler.stopped_quick(key))
        outcome.withdrawn.extend(state.auditor.stopped_quick(key))
        outcome.lines.append(Log(DEBUG, f"{key} took too long for a quick copy at worker={worker}"))

    def _merge(
        self,
        render: RunningRender,
        key: JobKey,
        offered: RangeSums,
        now: float,
        draw: float,
        outcome: Outcome,
        partial: job_pb2.Partial,
    ) -> None:
        verdict, released, surplus = render.offer(key.tile_index, offered, now)
        if verdict is MergeResult.TOO_EARLY:
            self._give_back(key, outcome)
        else:
            outcome.withdrawn.extend(self._state.scheduler.received(key, now))
        waiting = render.film.queues[key.tile_index].waiting.get(key.range_index)
        if verdict is MergeResult.DUPLICATE and waiting is not None and waiting.entry == offered.entry:
            # The stream is read again from its start, and this very entry is still to be merged.
            return
        if verdict is MergeResult.DUPLICATE:
            self._compare(render, key, offered.worker, partial, now, outcome)
        elif verdict is not MergeResult.TOO_EARLY:
            self._state.auditor.accepted(
                key,
                offered.worker,
                partial,
                lambda: self._state.fleet.live(render.floating_point_profile),
                draw,
            )
            for guilty in self._state.failure_policy.succeeded(key, offered.worker, now):
                reason = "It failed at three jobs that other workers could do."
                outcome.quarantined.append(Quarantine(guilty, reason, mismatched=False))
        if verdict in (MergeResult.TOO_EARLY, MergeResult.DUPLICATE):
            outcome.to_acknowledge.append(offered.entry)
        if released:
            self.merged += len(released)
            if key.tile_index != render.planned.photon_index:
                outcome.to_acknowledge.extend(each.entry for each in (*released, *surplus))
            self._update_scheduler(render, key.tile_index, released[-1].index + 1, outcome)

    def _update_scheduler(
        self, render: RunningRender, tile_index: int, merged: int, outcome: Outcome
    ) -> None:
        scheduler = self._state.scheduler
        scheduler.completed(render.id, tile_index, merged)
        if render.film.queues[tile_index].closed:
            outcome.withdrawn.extend(scheduler.finish_tile(render.id, tile_index, RangeState.UNNEEDED))
        else:
            scheduler.expect(render.id, tile_index, render.film.horizon(tile_index))

    def _compare(
        self,
        render: RunningRender,
        key: JobKey,
        worker: str,
        partial: job_pb2.Partial,
        now: float,
        outcome: Outcome,
    ) -> None:
        live = self._state.fleet.live(render.floating_point_profile)
        finding = self._state.auditor.again(key, worker, partial, live)
        outcome.withdrawn.extend(finding.withdrawn)
        if finding.agreed:
            render.count_audited()
        for worker, proof in finding.mismatching.items():
            place = f"tile {key.tile_index}, range {key.range_index} of {render.id}"
            reason = f"{proof}: {place}."
            outcome.quarantined.append(Quarantine(worker, reason, mismatched=True))
            if self._state.failure_policy.mismatched(worker, now):
                reason = "Three of its machines were found faulty within a day."
                outcome.quarantined.append(Quarantine(token_of(worker), reason, mismatched=False))

    def _fail(
        self,
        render: RunningRender,
        key: JobKey,
        worker: str,
        reason: str,
        now: float,
        outcome: Outcome,
        died: bool = False,
    ) -> None:
        scheduler = self._state.scheduler
        state = scheduler.state_of(key)
        # Of those that have copies one may die while the job waits to be published again.
        if state is not RangeState.PUBLISHED and not (died and state is RangeState.PLANNED):
            # It was done elsewhere meanwhile; or it was an audit, which somebody else has to do.
            outcome.withdrawn.extend(self._state.auditor.returned(key))
            return
        outcome.lines.append(Log(WARNING, f"{key} failed at worker={worker}: {reason}"))
        verdict = self._state.failure_policy.failed(
            key, worker, reason, self._state.fleet.live(render.floating_point_profile), now, died
        )
        if verdict is not None:
            self._fail_tile(render, key, verdict, outcome)
        else:
            self._give_back(key, outcome)

    def _fail_tile(self, render: RunningRender, key: JobKey, verdict: PoisonedJob, outcome: Outcome) -> None:
        planned = render.planned.ranges_of(key.tile_index)[key.range_index]
        failed = FailedTile(key.tile_index, planned.first, planned.end, verdict.reason, verdict.workers)
        outcome.to_acknowledge.extend(each.entry for each in render.fail_tile(failed))
        scheduler = self._state.scheduler
        outcome.withdrawn.extend(scheduler.finish_tile(render.id, key.tile_index, RangeState.FAILED))
        outcome.bundles.append(WriteBundle(render.id, failed))
        line = f"render={render.id} tile={key.tile_index} failed: {verdict.reason}"
        outcome.lines.append(Log(ERROR, line))
        if self._is_failure(render):
            outcome.failed[render.id] = verdict.reason

    def _is_failure(self, render: RunningRender) -> bool:
        """One owner of enrolled machines can spoil tiles, which a resumed render tries again; no more."""
        owners = {token_of(machine) for machine in render.failed_on}
        believed = not self._state.settings.enrolled or len(owners) > 1
        planned = render.planned
        # Where forward photons bring all light, there is nothing without them.
        most = min(MAX_FAILED_TILES, planned.grid.count if planned.ranges else 1)
        return believed and len(render.failed_tiles) >= most

    def _refuse_of(self, render: RunningRender, entry: bytes, reason: str, outcome: Outcome) -> None:
        render.count_refused()
        self._refuse(entry, f"render={render.id} {reason}", outcome)

    def _refuse(self, entry: bytes, reason: str, outcome: Outcome) -> None:
        self.refused += 1
        line = f"result {entry.decode()} refused ({self.refused} so far): {reason}"
        outcome.lines.append(Log(WARNING, line))
        outcome.to_acknowledge.append(entry)

    def _give_back(self, key: JobKey, outcome: Outcome) -> None:
        outcome.withdrawn.extend(self._state.scheduler.returned(key))
        outcome.withdrawn.extend(self._state.auditor.returned(key))
