"""All memories that a coordinator may have of a render of one tile, by number, and how it reacts in each.

Reactions are worked out once with the real render, scheduler and result handler, and remembered.
"""

import copy
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch import state as core_state
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.quick_entries import QUICK, is_quick
from nocturne_coordinator.dispatch.range_queue import RangeState
from nocturne_coordinator.dispatch.records import OpenRender, RenderState, TileRow, Totals
from nocturne_coordinator.dispatch.result_handler import ResultHandler
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler
from nocturne_scene.ranges import make_schedule
from nocturne_scene.tile_sums import TileSums

from tests.coordinator.simulated_worker import simulated_result, simulated_sums

WINDOW = 2
"""Jobs in flight."""


class Work:
    """The render: one pixel, with its sums computed beforehand."""

    def __init__(self, ranges: int) -> None:
        self.ranges = ranges
        self.schedule = make_schedule(1, 1, _SAMPLES[ranges])
        self.row = OpenRender(
            "r", RenderState.RUNNING, self.schedule, "5c" * 32, job_pb2.ENGINE_CURRENT, Totals()
        )
        self.planned = PlannedRender("r", self.schedule, b"\x5c" * 32, job_pb2.ENGINE_CURRENT)
        assert len(self.planned.ranges) == ranges
        jobs = [self.planned.job(0, self.planned.ranges[index]) for index in range(ranges)]
        self.results = [simulated_result(job).SerializeToString() for job in jobs]
        self.stopped = [_stopped(job).SerializeToString() for job in jobs]
        """Reports of quick copies that were stopped."""
        self.keys = [JobKey("r", 0, index) for index in range(ranges)]
        total = TileSums.zeros(1, 1)
        self.prefixes = [total.encode()]
        for job in jobs:
            total += simulated_sums(job)
            self.prefixes.append(total.encode())

    def samples(self, merged: int) -> int:
        return self.schedule.range_ends[merged - 1] if merged else 0

    def render_at(self, committed: int) -> RunningRender:
        tiles = []
        if committed:
            tiles = [TileRow(0, self.samples(committed), self.prefixes[committed])]
        return RunningRender(replace(self.row, totals=Totals()), tiles)

    def check(self, render: RunningRender) -> None:
        """WentWrong unless the sums are those of the first ranges in order, each once."""
        tile = render.film.queues[0]
        if tile.sums.encode() != self.prefixes[tile.merged]:
            raise WentWrong("sums that are not those of the first ranges in order")
        if render.totals.photons != self.samples(tile.merged):
            raise WentWrong("photons that are not those of the merged ranges")


_SAMPLES = {2: 6, 3: 14}
"""By the number of ranges; the last one is cut."""


class WentWrong(Exception):
    """A state that must not be."""


@dataclass(frozen=True)
class Core:
    """A coordinator's memory of the render. Never changed once it is known; what changes is a copy.

    Entries on both streams are called by their range, as it never knows two of one.
    """

    render: RunningRender
    scheduler: Scheduler
    saved: int = field(init=False)
    """Ranges that it knows to be committed."""
    merged: int = field(init=False)
    out: frozenset[int] = field(init=False)
    """Ranges that it knows to be published."""
    quick: frozenset[int] = field(init=False)
    """Those of which it knows a quick copy, too."""

    def __post_init__(self) -> None:
        tile = self.render.film.queues[0]
        object.__setattr__(self, "merged", tile.merged)
        object.__setattr__(self, "saved", self.states.count(RangeState.COMMITTED))
        out = frozenset(key.range_index for key in self.scheduler.entries().values())
        object.__setattr__(self, "out", out)
        entries = self.scheduler.entries().items()
        quick = frozenset(key.range_index for entry, key in entries if is_quick(entry))
        object.__setattr__(self, "quick", quick)

    @property
    def states(self) -> bytes:
        """Of its ranges; all else that it remembers of them is an index of these."""
        return bytes(self.scheduler._queues["r"].queues[0].states)

    def copied(self) -> tuple[RunningRender, Scheduler]:
        # What never changes is shared.
        memo = {id(each): each for each in (self.render.planned, self.render.planned.schedule)}
        return copy.deepcopy((self.render, self.scheduler), memo)


class Reaction(NamedTuple):
    """What a coordinator does, and its number afterwards; all by range."""

    number: int
    published: tuple[int, ...] = ()
    withdrawn: tuple[int, ...] = ()
    to_acknowledge: tuple[int, ...] = ()
    copied: tuple[int, ...] = ()
    withdrawn_quick: tuple[int, ...] = ()


def _stopped(job: job_pb2.Job) -> job_pb2.JobResult:
    quick = job_pb2.Job()
    quick.CopyFrom(job)
    quick.quick = True
    return job_pb2.JobResult(job=quick, worker_id="w", failure="it was stopped", stopped_too_long=True)


class Cores:
    """All memories that a coordinator may have, by number, and how they react."""

    def __init__(self, work: Work) -> None:
        self._work = work
        self.all: list[Core] = []
        self._numbers: dict[tuple[bytes, frozenset[int]], int] = {}
        self._known: dict[tuple[object, ...], Reaction] = {}

    def start(self, committed: int, found: tuple[int, ...]) -> Reaction:
        """A core that takes the render up, and finds jobs of these ranges; it withdraws those that it does
        not need."""
        event = ("start", committed, found)
        if event not in self._known:
            render = self._work.render_at(committed)
            scheduler = Scheduler()
            scheduler.add("r", render.range_queues())
            # As `Window.adopt`.
            states = render.range_queues()[0].states
            wanted = [index for index in found if states[index] == RangeState.PLANNED]
            for index in wanted:
                scheduler.published(self._work.keys[index], b"%d" % index, 0.0)
            unwanted = tuple(index for index in found if index not in wanted)
            self._known[event] = Reaction(self._number(Core(render, scheduler)), withdrawn=unwanted)
        return self._known[event]

    def publish(self, number: int) -> Reaction:
        """Fills the window."""
        event = ("publish", number)
        if event not in self._known:
            core = self.all[number]
            render, scheduler = core.copied()
            keys = scheduler.take(WINDOW - scheduler.in_flight)
            for key in keys:
                scheduler.published(key, b"%d" % key.range_index, 0.0)
            after = self._number(Core(render, scheduler)) if keys else number
            self._known[event] = Reaction(after, published=tuple(key.range_index for key in keys))
        return self._known[event]

    def copy(self, number: int, index: int) -> Reaction:
        """Publishes a quick copy of a job that is out."""
        event = ("copy", number, index)
        if event not in self._known:
            render, scheduler = self.all[number].copied()
            scheduler.copied(self._work.keys[index], QUICK + b"%d" % index)
            self._known[event] = Reaction(self._number(Core(render, scheduler)), copied=(index,))
        return self._known[event]

    def receive(self, number: int, index: int) -> Reaction:
        """Takes a result in."""
        return self._take(number, index, self._work.results[index])

    def stopped(self, number: int, index: int) -> Reaction:
        """Hears that a quick copy was stopped."""
        return self._take(number, index, self._work.stopped[index])

    def _take(self, number: int, index: int, data: bytes) -> Reaction:
        event = ("take", number, index, data)
        if event not in self._known:
            core = self.all[number]
            render, scheduler = core.copied()
            state = core_state.State(core_state.Settings(), scheduler, Auditor(0.0, 0.0), {"r": render})
            outcome = ResultHandler(state).take(b"%d" % index, data, 1.0, 0.5)
            withdrawn = outcome.withdrawn
            self._known[event] = Reaction(
                self._number(Core(render, scheduler)),
                withdrawn=tuple(int(entry) for entry in withdrawn if not is_quick(entry)),
                to_acknowledge=tuple(map(int, outcome.to_acknowledge)),
                withdrawn_quick=tuple(
                    int(entry.removeprefix(QUICK)) for entry in withdrawn if is_quick(entry)
                ),
            )
        return self._known[event]

    def saved(self, number: int) -> int:
        """The merged ranges are committed."""
        event = ("saved", number)
        if event not in self._known:
            core = self.all[number]
            render, scheduler = core.copied()
            scheduler.committed("r", [0])
            self._known[event] = Reaction(self._number(Core(render, scheduler)))
        return self._known[event].number

    def redis_lost(self, number: int) -> int:
        event = ("lost", number)
        if event not in self._known:
            core = self.all[number]
            render, scheduler = core.copied()
            scheduler.lost()
            self._known[event] = Reaction(self._number(Core(render, scheduler)))
        return self._known[event].number

    def _number(self, core: Core) -> int:
        key = core.states, core.quick
        if key not in self._numbers:
            self._work.check(core.render)
            self._numbers[key] = len(self.all)
            self.all.append(core)
        return self._numbers[key]
