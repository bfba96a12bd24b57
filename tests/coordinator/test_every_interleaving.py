"""All orders in which jobs, results, commits and crashes can happen, on the coordinator's own code.

A breadth-first walk over the states of one tile with three ranges: two workers without crashes, one with a
crash; two with one in `make soak`. A crash is that of a worker, of the coordinator, or of Redis with all that
is in it. In every state the sums are those of the first ranges in order, each once, and what is committed
never goes back; from every state the render can be finished.
"""

import copy
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.audit import Auditor
from nocturne_coordinator.faults import Faults
from nocturne_coordinator.intake import Intake
from nocturne_coordinator.plan import make_plan
from nocturne_coordinator.planned_render import PlannedRender
from nocturne_coordinator.running_render import RunningRender
from nocturne_coordinator.schedule import JobKey, Schedule
from nocturne_coordinator.store.ledger import OpenRender, TileRow, Totals
from nocturne_coordinator.store.rows import RenderState

from tests.coordinator.simulated_worker import simulated_result, simulated_sums

RANGES = 3
PLAN = make_plan(1, 1, 4 * RANGES + 2)
ROW = OpenRender("r", RenderState.RUNNING, PLAN, "5c" * 32, job_pb2.ENGINE_CURRENT, Totals())
PLANNED = PlannedRender("r", PLAN, bytes.fromhex(ROW.scene_sha256), job_pb2.ENGINE_CURRENT)
assert len(PLANNED.ranges) == RANGES
JOBS = [PLANNED.job(0, PLANNED.ranges[index]) for index in range(RANGES)]
RESULTS = [simulated_result(job).SerializeToString() for job in JOBS]
PREFIXES = [np.zeros((1, 1, 4))]
for _job in JOBS:
    PREFIXES.append(PREFIXES[-1] + simulated_sums(_job))
KEYS = [JobKey("r", 0, index) for index in range(RANGES)]


@dataclass
class Core:
    """The coordinator in memory: its real render, schedule and intake."""

    render: RunningRender
    schedule: Schedule
    intake: Intake
    read: int = 0
    """Results read of those on the stream."""
    settled: list[int] = field(default_factory=list)
    """Results to delete after the commit."""
    committed: bool = True
    """Nothing is merged that is not committed."""


def core_at(merged: int) -> Core:
    """As it starts on what is committed."""
    tiles = [TileRow(0, PLAN.range_ends[merged - 1], PREFIXES[merged].tobytes())] if merged else []
    render = RunningRender(replace(ROW, totals=Totals()), tiles)
    schedule = Schedule()
    schedule.add("r", RANGES, render.merged_ranges)
    return Core(render, schedule, Intake({"r": render}, schedule, Auditor(0.0, 0.0), Faults()))


@dataclass
class State:
    """Everything: coordinator, what Redis has, what is on disk, who works on what."""

    core: Core
    committed: int = 0
    """Ranges in the data folder."""
    jobs: dict[int, int] = field(default_factory=dict)
    """The stream: entry to range."""
    held: dict[int, int] = field(default_factory=dict)
    """Entries given out: who has the claim."""
    working: list[tuple[int, int] | None] = field(default_factory=list)
    """Entry and range that each worker traces; it may have lost the claim."""
    results: list[tuple[int, int]] = field(default_factory=list)
    """The other stream: number and range."""
    deleted: set[int] = field(default_factory=set)
    entries: int = 0
    crashes: int = 0
    """That may still happen."""

    def key(self) -> tuple[object, ...]:
        """What tells it from other states, with entries numbered by their order."""
        core, schedule = self.core, self.core.schedule
        names = {entry: place for place, entry in enumerate(sorted({*self.jobs, *self.held}))}
        tile = core.render.film.tiles[0]
        queue = schedule._queues["r"]
        live = [range_ for number, range_ in self.results if number not in self.deleted]
        return (
            self.committed,
            tile.merged,
            tuple(sorted(tile.waiting)),
            core.read - (len(self.results) - len(live)),
            core.committed,
            tuple(sorted(place for place, (number, _) in enumerate(self.results) if number in core.settled)),
            tuple(live),
            tuple(sorted((names[entry], range_) for entry, range_ in self.jobs.items())),
            tuple(sorted((names[entry], worker) for entry, worker in self.held.items())),
            tuple(None if job is None else (names.get(job[0], -1), job[1]) for job in self.working),
            tuple(
                sorted(
                    (key.range_index, names.get(int(entry), -1)) for entry, key in schedule.entries().items()
                )
            ),
            tuple(sorted(queue.again)),
            tuple(queue.following),
            tuple(sorted(queue.ready)),
            self.crashes,
        )

    def clone(self, *, core_changes: bool = True) -> "State":
        """A copy; the coordinator's render and schedule, which are most of it, only where they are to
        change."""
        core = self.core
        if not core_changes:
            return self._with(replace(core, settled=list(core.settled)))
        # What never changes is shared.
        render = core.render
        memo = {id(each): each for each in (render.planned, PLAN)}
        fresh = copy.deepcopy((render, core.schedule), memo)
        intake = Intake({"r": fresh[0]}, fresh[1], Auditor(0.0, 0.0), Faults())
        return self._with(Core(*fresh, intake, core.read, list(core.settled), core.committed))

    def _with(self, core: Core) -> "State":
        return State(
            core,
            self.committed,
            dict(self.jobs),
            dict(self.held),
            list(self.working),
            list(self.results),
            set(self.deleted),
            self.entries,
            self.crashes,
        )

    @property
    def finished(self) -> bool:
        return self.committed == RANGES

    def check(self) -> None:
        tile = self.core.render.film.tiles[0]
        assert np.array_equal(tile.sums, PREFIXES[tile.merged])
        assert self.committed <= tile.merged
        assert self.core.render.totals.photons == (PLAN.range_ends[tile.merged - 1] if tile.merged else 0)


def steps(state: State) -> Iterator[State]:
    """Every state that can come next."""
    yield from _publish(state)
    yield from _receive(state)
    yield from _commit(state)
    for worker in range(len(state.working)):
        yield from _work(state, worker)
    if state.crashes:
        yield from _crash(state)


def _publish(state: State) -> Iterator[State]:
    after = state.clone()
    taken = after.core.schedule.take(2 - after.core.schedule.in_flight)
    for key in taken:
        after.entries += 1
        after.jobs[after.entries] = key.range_index
        after.core.schedule.published(key, b"%d" % after.entries, 0.0)
    if taken:
        yield after


def _receive(state: State) -> Iterator[State]:
    if state.core.read >= len(state.results):
        return
    after = state.clone()
    core = after.core
    number, range_index = after.results[core.read]
    core.read += 1
    if number not in after.deleted:
        outcome = core.intake.take(b"%d" % number, RESULTS[range_index], 1.0)
        core.settled.extend(int(entry) for entry in outcome.settled)
        for entry in outcome.withdrawn:
            after.jobs.pop(int(entry), None)
        core.committed = core.render.film.tiles[0].merged == after.committed
    yield after


def _commit(state: State) -> Iterator[State]:
    if not state.core.committed:
        after = state.clone(core_changes=False)
        after.committed = after.core.render.film.tiles[0].merged
        after.core.committed = True
        yield after
    elif state.core.settled:
        after = state.clone(core_changes=False)
        after.deleted.update(after.core.settled)
        after.core.settled.clear()
        yield after


def _work(state: State, worker: int) -> Iterator[State]:
    job = state.working[worker]
    if job is None:
        for entry, range_index in state.jobs.items():
            # One that somebody has may be taken over at any time: leases run out while their holders still
            # work.
            if state.held.get(entry) != worker:
                after = state.clone(core_changes=False)
                after.held[entry] = worker
                after.working[worker] = (entry, range_index)
                yield after
                if entry not in state.held:
                    break
        return
    after = state.clone(core_changes=False)
    entry, range_index = job
    after.working[worker] = None
    after.entries += 1
    after.results.append((after.entries, range_index))
    after.jobs.pop(entry, None)
    after.held.pop(entry, None)
    yield after


def _crash(state: State) -> Iterator[State]:
    for worker in range(len(state.working)):
        if state.working[worker] is not None:
            after = state.clone(core_changes=False)
            after.crashes -= 1
            after.working[worker] = None
            # Its claims stay, of a process that is no more; who comes after it may take them over.
            after.held = {entry: -1 if who == worker else who for entry, who in after.held.items()}
            yield after
    after = state.clone(core_changes=False)
    after.crashes -= 1
    after.core = core_at(after.committed)
    _adopt(after)
    yield after
    after = state.clone()
    after.crashes -= 1
    after.jobs.clear()
    after.held.clear()
    after.results.clear()
    after.core.read = 0
    after.core.settled.clear()
    after.core.schedule.lost()
    yield after


def _adopt(state: State) -> None:
    """What `Traffic` does with the jobs that it finds."""
    for entry, range_index in list(state.jobs.items()):
        if state.core.schedule.wants(KEYS[range_index]):
            state.core.schedule.published(KEYS[range_index], b"%d" % entry, 0.0)
        else:
            del state.jobs[entry]


@pytest.mark.parametrize(
    ("workers", "crashes", "at_least"),
    [(2, 0, 1_000), (1, 1, 1_000), pytest.param(2, 1, 20_000, marks=pytest.mark.soak)],
)
def test_no_order_of_things_counts_a_range_twice_or_never(workers: int, crashes: int, at_least: int) -> None:
    first = State(core_at(0), working=[None] * workers, crashes=crashes)
    seen = {first.key(): 0}
    before: list[list[int]] = [[]]
    finished = []
    waiting = deque([first])
    while waiting:
        state = waiting.popleft()
        number = seen[state.key()]
        state.check()
        if state.finished:
            finished.append(number)
            continue
        for after in steps(state):
            assert after.committed >= state.committed
            key = after.key()
            if key not in seen:
                seen[key] = len(before)
                before.append([])
                waiting.append(after)
            before[seen[key]].append(number)
    # Backwards from the finished ones: every state can get there.
    reached = set(finished)
    waiting_numbers = deque(finished)
    while waiting_numbers:
        for number in before[waiting_numbers.popleft()]:
            if number not in reached:
                reached.add(number)
                waiting_numbers.append(number)
    assert len(reached) == len(before)
    # So that nobody makes the walk short by mistake.
    assert len(before) > at_least
