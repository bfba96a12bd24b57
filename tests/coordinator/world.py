"""A service in memory: the real coordinator on a queue, a store and workers that live by a virtual clock.

A second here costs milliseconds. After every event the core's state is validated, and with every commit the
sums are compared with those of the first ranges in order, bit for bit."""

import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from nocturne.v1 import job_pb2
from nocturne_coordinator.coordinator import Coordinator
from nocturne_coordinator.dispatch.events import Event
from nocturne_coordinator.dispatch.records import (
    OpenRender,
    RenderState,
)
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.event_log import EventLog
from nocturne_coordinator.queue.job_queue import Session
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule
from nocturne_scene.tile_sums import TileSums

from tests.coordinator.memory_queue import MemoryQueue, VirtualClock, Worker
from tests.coordinator.memory_store import SCENE, MemoryLedger, MemoryPreviews, Store
from tests.coordinator.simulated_worker import Alter, simulated_sums, unaltered


class CheckedCoordinator(Coordinator):
    """Validates the core's state after every event."""

    def tell(self, event: Event) -> None:
        super().tell(event)
        self.core.validate_state()


class Crashed(BaseException):
    """As if by SIGKILL."""


class World:
    """A folder, a Redis, coordinators and workers."""

    def __init__(
        self, seed: int = 1, settings: Settings | None = None, event_log: Path | None = None
    ) -> None:
        self.chance = random.Random(seed)
        self.clock = VirtualClock(seed)
        self.queue = MemoryQueue(self.clock)
        self.store = Store(self.clock)
        self.settings = settings or Settings(commit_seconds=0.1)
        self.coordinators: list[CheckedCoordinator] = []
        self._event_log = event_log
        self._logs: list[EventLog] = []
        self._runs = 0
        self._names = 0

    # --- parts ---

    def start(self) -> CheckedCoordinator:
        """Another coordinator, in addition to the running ones; alone, it is the folder's next owner."""
        self._runs += 1
        ledger = MemoryLedger(self.store, alone=not self.coordinators)
        settings = replace(self.settings, number=ledger.leases.number)
        log = None
        if self._event_log is not None:
            log = EventLog(self._event_log, settings, ledger.workers.quarantined())
            self._logs.append(log)
        session = Session("folder", 1, f"run {self._runs}")
        coordinator = CheckedCoordinator(
            *(self.store, ledger, MemoryPreviews(self.store, ledger), self.queue, session),
            *(settings, self.clock, log),
        )
        self.coordinators.append(coordinator)
        return coordinator

    def kill(self, coordinator: CheckedCoordinator | None = None) -> None:
        """SIGKILL for a coordinator."""
        self.coordinators.remove(coordinator or self.coordinators[0])

    def close_log(self) -> None:
        for log in self._logs:
            log.close()

    def worker(
        self,
        alter: Alter = unaltered,
        delay: float = 0.02,
        lease: float = 1.0,
        dies: Callable[[job_pb2.JobResult], bool] = lambda _: False,
        profile: str = "",
        machine: str = "",
    ) -> Worker:
        self._names += 1
        name = f"{machine}/w{self._names}" if machine else f"w{self._names}"
        return Worker(name, self.queue, self.clock, alter, delay, lease, dies, profile)

    @property
    def workers(self) -> list[Worker]:
        return self.clock.workers

    def create(
        self,
        samples: int = 60,
        stop: StopConditions = EVERYTHING,
        width: int = 34,
        height: int = 3,
        profile: str = "",
        owner: str = "",
    ) -> str:
        """A render of two tiles, unless told otherwise; gives its id."""
        render_id = f"r{len(self.store.stored)}"
        schedule = make_schedule(width, height, samples)
        new = NewRender(render_id, "", SCENE, "{}", width, height, samples, schedule, stop, owner=owner)
        made = self.store.renders.create(replace(new, floating_point_profile=profile))
        # Not at random, so that each run of a test is the same.
        self.store.database.execute("DELETE FROM blob_use WHERE render_id = ?", (made.id,))
        self.store.change(made.id, id=render_id)
        return render_id

    # --- time ---

    def round(self) -> None:
        """One turn of every coordinator, or a while without any."""
        for coordinator in list(self.coordinators):
            coordinator.round()
        if not self.coordinators:
            self.clock.wait(0.05)

    def run(self, seconds: float) -> None:
        until = self.clock.now + seconds
        while self.clock.now < until:
            self.round()

    def run_until(self, true: Callable[[], bool], seconds: float = 60.0) -> None:
        """Fails the test if it does not become true in that time, by the virtual clock."""
        until = self.clock.now + seconds
        while not true():
            assert self.clock.now < until, "did not happen in time"
            self.round()

    # --- invariants ---

    def row(self, render_id: str) -> OpenRender:
        return self.store.stored[render_id].row

    def done(self, render_id: str) -> int:
        return self.store.stored[render_id].ranges_done

    def half_done(self, render_id: str) -> bool:
        return self.done(render_id) >= self.store.stored[render_id].ranges_planned // 3

    def check_sums(self, render_id: str) -> None:
        """The committed sums equal the first ranges, merged one after the other, in every bit (I1 to I3)."""
        stored, tiles = self.store.stored[render_id], self.store.stored[render_id].tiles
        planned, samples = stored.planned, 0
        for index, row in tiles.items():
            tile = planned.grid.tile(index)
            total = TileSums.zeros(tile.width, tile.height)
            for position in range(planned.ranges.merged_at(row.samples)):
                total += simulated_sums(planned.job(index, planned.ranges[position]))
            assert row.sums == total.encode()
            samples += row.samples * tile.width * tile.height
        assert stored.row.totals.photons == samples
        if stored.row.state.has_image and tiles:
            assert {index: (row.samples, row.sums) for index, row in tiles.items()} == {
                index: each for index, each in self.store.images[render_id].items() if each[0]
            }

    def check_survived(self, *render_ids: str, seconds: float = 120.0) -> None:
        """The renders succeed, with all samples, and nothing is left in Redis."""
        for render_id in render_ids:
            self.run_until(lambda render_id=render_id: self.row(render_id).state.ended, seconds)  # type: ignore[misc]
            stored = self.store.stored[render_id]
            assert stored.row.state is RenderState.SUCCEEDED, stored.reason
            last = stored.row.schedule.range_ends[-1]
            assert {index: tile.samples for index, tile in stored.tiles.items()} == dict.fromkeys(
                range(stored.planned.grid.count), last
            )
            self.check_sums(render_id)
        self.check_nothing_left()

    def check_nothing_left(self) -> None:
        self.run_until(lambda: not self.queue.job_stream and not self.queue.result_stream, 30.0)
