"""The coordinator: passes events of the data folder and Redis to the core, and carries out its instructions.

One thread, one loop. Merged results are committed about once a second, and only then are the results deleted
from Redis; so whatever is killed whenever, the open work is all planned ranges that are not committed.
Several may share a folder: each render is leased to one of them, and every write checks the lease's fence.
All decisions are those of `dispatch.core`."""

import logging
from collections.abc import Callable

from nocturne_coordinator.clock import Clock
from nocturne_coordinator.crash_points import crash_point
from nocturne_coordinator.dispatch.core import Core
from nocturne_coordinator.dispatch.events import Event, RenderLost, RendersSeen, ResultCame, Stopping, Tick
from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.errors import LeaseLost, QueueError, StoreUnavailable
from nocturne_coordinator.event_log import EventLog
from nocturne_coordinator.executor import Executor
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.queue.dispatcher import Dispatcher
from nocturne_coordinator.queue.job_queue import JobQueue, ResultEntry, Session
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.database import DatabaseTrouble
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.traces import Traces

_log = logging.getLogger(__name__)

_LOOK_SECONDS, _MAX_LOOK_SECONDS = 0.05, 0.5
_LOOK_REST = 9.0
"""Pauses between two looks at the folder, for which a new render waits: in times of what the last one took,
within these bounds."""

_REDIS_SECONDS = 0.1
"""Between two tries to reach it."""

_MIRROR_SECONDS = 2.0
_FOLLOW_SECONDS = 5.0
"""Renders that wait are looked at so often though nothing changes: their time may come."""

_WAIT_MILLISECONDS = 50


class Coordinator:
    """Works on one data folder through one Redis until told to stop."""

    def __init__(
        self,
        folder: DataFolder,
        ledger: Ledger,
        previews: Previews,
        queue: JobQueue,
        session: Session,
        settings: Settings,
        clock: Clock,
        event_log: EventLog | None = None,
        traces: Traces | None = None,
    ) -> None:
        """`settings.number` must be the ledger's."""
        self._folder = folder
        self._ledger = ledger
        self._clock = clock
        self._event_log = event_log
        self._guard = queue.guard
        self._traces = traces or Traces()
        self.core = Core(settings)
        self.core.state.fleet.quarantined = ledger.workers.quarantined()
        self._dispatcher = Dispatcher(queue, session, self.tell, clock)
        self._executor = Executor(
            ledger, previews, self._dispatcher, self.core.state.renders, clock, self._traces
        )
        self._coordinators = 1
        self._mirrored: tuple[WorkerRow, ...] = ()
        self._seen_changes = -1
        self._next_look = 0.0
        self._asked_to_look = False
        self._next_follow = 0.0
        self._next_mirror = 0.0

    def run(self, turned: Callable[[], None] = lambda: None) -> None:
        """Works until the clock says stop; then commits merged results. OwnershipLost: it is another's.

        `turned` is called in every turn of the loop, as a sign of life.
        """
        while not self._clock.stopping:
            turned()
            self.round()
        self.tell(Stopping(self._clock.moment()))
        self._dispatcher.leave()
        try:
            self._ledger.leases.resign()
        except (DatabaseTrouble, OSError) as trouble:
            _log.info("the leases on renders run out by themselves: %s", trouble)
        _log.info("stopped; %d renders wait to be resumed", len(self.core.state.renders))

    def look_again(self) -> None:
        """At the data folder, in the next turn of the loop."""
        self._asked_to_look = True

    def round(self) -> None:
        """One turn of the loop, with the pause after it."""
        begun = self._clock.moment().now
        if self._asked_to_look:
            self._asked_to_look, self._executor.wants_look, self._next_look = False, True, begun
            _log.info("looks at the data folder again, as SIGHUP asks")
        if begun >= self._next_look:
            self._look_at_folder()
            looked = self._clock.moment().now
            pause = max(_LOOK_SECONDS, _LOOK_REST * (looked - begun))
            self._next_look = looked + min(_MAX_LOOK_SECONDS, pause)
        entries = self._dispatcher.exchange(True, _WAIT_MILLISECONDS)
        for entry in entries or []:
            self._take(entry)
        self.tell(Tick(self._clock.moment()))
        if entries is None:
            self._clock.wait(_REDIS_SECONDS)
        self._clock.wait(begun + self.core.shortest_round - self._clock.moment().now)

    def tell(self, event: Event) -> None:
        """Gives an event to the core, and carries out all its instructions. QueueError if Redis fails in
        it."""
        steps = self.core.handle(event)
        if self._event_log is not None:
            steps = self._event_log.recorded(event, steps)
        try:
            instruction = next(steps)
            while True:
                try:
                    answer = self._executor.carry_out(instruction)
                except (LeaseLost, StoreUnavailable, QueueError) as trouble:
                    instruction = steps.throw(trouble)
                else:
                    instruction = steps.send(answer)
        except StopIteration:
            return

    def _take(self, result: ResultEntry) -> None:
        crash_point("received")
        self._traces.came(result.data)
        merged = self.core.results.merged
        # Here, not when it is read: a batch is many times what a processor's cache holds.
        refusal = self._guard.refusal(result.data, result.machine, result.signature) if self._guard else ""
        self.tell(ResultCame(self._clock.moment(), result.entry, result.data, self._clock.random(), refusal))
        if self.core.results.merged > merged:
            crash_point("merged")

    # --- the folder ---

    def _look_at_folder(self) -> None:
        at = self._clock.moment()
        try:
            if at.now >= self._next_mirror:
                self._next_mirror = at.now + min(_MIRROR_SECONDS, self._ledger.leases.lease_seconds / 5)
                self._mirror_workers()
            changes = self._folder.change_counter()
            if changes == self._seen_changes and at.now < self._next_follow and not self._executor.wants_look:
                return
            self._next_follow = at.now + _FOLLOW_SECONDS
            self._executor.wants_look = False
            self._look_at_machines()
            rows, quarantined = tuple(self._ledger.renders.all()), self._ledger.workers.quarantined()
            drained = self._ledger.workers.drained()
            self.tell(RendersSeen(self._clock.moment(), rows, quarantined, self._coordinators, drained))
            if not self._executor.wants_look:
                self._executor.show_ended()
                self._seen_changes = changes
        except LeaseLost as lost:
            self.tell(RenderLost(at, lost.render_id))
        except (DatabaseTrouble, OSError) as trouble:
            self._executor.wants_look = True
            _log.error("the data folder can't be used: %s; trying again", trouble)

    def _look_at_machines(self) -> None:
        """Notices which machines enrolled, or are not to work any more."""
        if self._guard is None:
            return
        machines = self._folder.machines.keys()
        if machines != self._guard.machines:
            _log.info("machines enrolled: %s", ", ".join(machines) or "none")
            self._guard.machines = machines
            self._dispatcher.machines_changed()

    def _mirror_workers(self) -> None:
        """Renews our lease on renders, and shows in the folder who works."""
        unix = self._clock.moment().unix
        coordinators = self._ledger.leases.renew(unix)
        if coordinators != self._coordinators:
            _log.info("%d coordinators work on the folder", coordinators)
            self._coordinators = coordinators
            self._executor.wants_look = True
        fleet = self.core.state.fleet
        if (fleet.workers or self._dispatcher.in_step) and fleet.workers is not self._mirrored:
            at_work = [(key.render_id, key.tile_index, worker) for key, worker in fleet.liveness.at_work]
            self._ledger.workers.mirror(list(fleet.workers), at_work, unix)
            self._mirrored = fleet.workers
        self._ledger.write_meters(self._meters(unix))
        self._dispatcher.longest_wait = 0.0

    def _meters(self, unix: float) -> dict[str, float]:
        state = self.core.state
        return {
            "coordinator_seen": unix,
            "redis_in_step": float(self._dispatcher.in_step),
            "folder_trouble": float(state.folder_trouble),
            "worker_threads": state.fleet.threads,
            "machines": state.fleet.alike,
            "jobs_in_flight": state.scheduler.in_flight,
            "jobs_published": state.scheduler.outstanding,
            "quick_copies": self.core.window.quick_copies.made,
            "results_waiting": self._dispatcher.results_waiting,
            "result_seconds": self._dispatcher.longest_wait,
            "results_refused": self.core.results.refused,
            "job_seconds": state.scheduler.typical_time,
            "audits_agreed": state.auditor.agreed,
            "audits_differing": state.auditor.mismatches,
            "audits_given_up": state.auditor.given_up,
        }
