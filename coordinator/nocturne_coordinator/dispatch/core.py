"""The coordinator's decisions: events in, instructions out. No clock, no queue, no database, no files. Pure.

    steps = core.handle(event)      # then one instruction after the other, each with its answer, to the end

`Coordinator` is the shell that does so with a real queue and store; `replay.py` does it with a file, tests
with a world in memory. The parts: `window.py` (jobs out), `result_handler.py` (results in), `commits.py`,
`admission.py` (renders that come and go), `endings.py`; they share `state.py`."""

from nocturne_coordinator.dispatch.admission import Admission
from nocturne_coordinator.dispatch.commits import Commits
from nocturne_coordinator.dispatch.endings import Endings
from nocturne_coordinator.dispatch.events import (
    Event,
    JobsFound,
    Moment,
    RedisEmptied,
    RenderLost,
    RendersSeen,
    ResultCame,
    Stopping,
    StreamIsReady,
    Tick,
    WorkersSeen,
)
from nocturne_coordinator.dispatch.instructions import (
    ERROR,
    IsOpen,
    Log,
    PublishExclusions,
    Steps,
    Withdraw,
)
from nocturne_coordinator.dispatch.result_handler import Outcome, ResultHandler
from nocturne_coordinator.dispatch.state import Settings, State
from nocturne_coordinator.dispatch.validation import validate_state
from nocturne_coordinator.dispatch.window import Window

_FIRST_LIGHT_SECONDS = 0.05
"""From a render's first result to its commit: somebody may be waiting to see that it is the right scene."""

_MIN_ROUND = 0.005
_MAX_ROUND = 0.05
_ROUNDS_PER_JOB = 3.0
"""Results that come one by one are taken together, which costs less; yet the window is filled several times
in the time that a job takes through it, so no worker waits for that."""


class Core:
    """One coordinator's mind."""

    def __init__(self, settings: Settings) -> None:
        self.state = State.of(settings)
        self.window = Window(self.state)
        self.results = ResultHandler(self.state)
        self._commits = Commits(self.state)
        self._admission = Admission(self.state, self._commits)
        self._endings = Endings(self.state, self._commits, self._admission)

    @property
    def shortest_round(self) -> float:
        """Seconds from one reading of results to the next."""
        wanted = self.state.scheduler.typical_time / _ROUNDS_PER_JOB
        return min(max(wanted, _MIN_ROUND), _MAX_ROUND)

    def handle(self, event: Event) -> Steps[None]:
        """The instructions that follow from an event. QueueError comes through where Redis failed in them."""
        match event:
            case Tick():
                yield from self._tick(event.at)
            case ResultCame():
                outcome = self.results.take(event.entry, event.data, event.at.now, event.draw, event.refusal)
                yield from self._follow(outcome)
            case StreamIsReady():
                yield from self.window.fill(event.at)
            case WorkersSeen():
                yield from self.window.workers_seen(event)
            case JobsFound():
                yield from self.window.adopt(event)
            case RedisEmptied():
                self.window.emptied()
            case RendersSeen():
                yield from self._admission.follow(event)
            case RenderLost():
                yield from self._commits.lose(event.render_id)
            case Stopping():
                yield from self._commits.commit(event.at)

    def _tick(self, at: Moment) -> Steps[None]:
        while self.state.lost:
            yield from self._follow(self.results.lost_worker(*self.state.lost.pop(), at.now))
        yield from self._admission.load()
        yield from self._admission.restart_minority_profile_renders(at)
        yield from self._admission.cut_long_ranges(at)
        yield from self._endings.finish(at)
        state = self.state
        if any(render.is_unseen for render in state.renders.values()):
            state.next_commit = min(state.next_commit, at.now + _FIRST_LIGHT_SECONDS)
        if at.now >= state.next_commit:
            yield from self._commits.commit(at)
        if state.owed and not state.folder_trouble:
            yield from self._commits.write_owed(at)

    def _follow(self, outcome: Outcome) -> Steps[None]:
        """Does what a result calls for."""
        yield from outcome.lines
        if outcome.unknown_render:
            if (yield IsOpen(outcome.unknown_render)):
                return
            # Ended or cancelled a moment ago, most likely.
            self.state.to_acknowledge.setdefault("", []).extend(outcome.to_acknowledge)
            return
        if outcome.to_acknowledge:
            self.state.to_acknowledge.setdefault(outcome.render_id, []).extend(outcome.to_acknowledge)
        if outcome.withdrawn:
            yield Withdraw(tuple(outcome.withdrawn))
        self.state.failed.update(outcome.failed)
        yield from outcome.bundles
        fleet = self.state.fleet
        for each in outcome.quarantined:
            if each.mismatched or each.worker not in fleet.quarantined:
                self.state.owed.append(each)
                fleet.quarantined = {**fleet.quarantined, each.worker: each.reason}
                yield Log(ERROR, f"worker={each.worker} is in quarantine: {each.reason}")
                yield PublishExclusions(fleet.without_jobs())

    def validate_state(self) -> None:
        """InvalidState if a range is in two places or in none, or a bound is passed; for tests."""
        validate_state(self.state, self.window.size)
