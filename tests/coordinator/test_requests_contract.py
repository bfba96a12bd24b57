"""Requests of people and writes of a coordinator for one render, in all orders: no answer is broken. One
contract for the data folder and for its copy in memory, on which the service in memory runs."""

from collections.abc import Callable, Iterator
from itertools import permutations
from pathlib import Path

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.records import OpenRender, RenderState
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.errors import WrongState
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule, recut_schedule

from tests.coordinator.memory_queue import VirtualClock
from tests.coordinator.memory_store import MemoryLedger, Store

SAMPLES = 400
Stores = tuple[DataFolder, Ledger]


@pytest.fixture(params=["folder", "memory"])
def stores(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Stores]:
    if request.param == "memory":
        store = Store(VirtualClock(1))
        yield store, MemoryLedger(store, alone=True)
        return
    folder = DataFolder(tmp_path / "data")
    ownership = Ownership(folder.root, folder.database)
    yield folder, Ledger(folder.database, ownership)
    ownership.release()
    folder.close()


class Asked:
    """A render at work, with its invariants."""

    def __init__(self, stores: Stores, name: str) -> None:
        self._folder, self._ledger = stores
        schedule = make_schedule(8, 8, SAMPLES)
        new = NewRender(name, "", "5c" * 32, "{}", 8, 8, SAMPLES, schedule, StopConditions())
        self.id = self._folder.renders.create(new).id
        self.looked = self._look()
        assert self._ledger.commits.start(self.id, self.looked.fence, 1.0)
        self.samples, self.state, self.stop = SAMPLES, RenderState.RUNNING, StopConditions()

    def _look(self) -> OpenRender:
        found = self._ledger.renders.take(self.id)
        assert found is not None
        return found

    @property
    def schedule(self) -> job_pb2.RangeSchedule:
        return self._folder.renders.schedule(self.id)

    # --- possible events, each where the state allows it ---

    def look(self) -> None:
        """The coordinator sees the render as it is now."""
        self.looked = self._look()

    def recut(self) -> None:
        """The coordinator makes the ranges shorter of the schedule that it has seen."""
        before = self.schedule
        cut = recut_schedule(self.looked.schedule, 4, 8)
        if cut is None:
            return
        done = self._ledger.commits.recut(self.looked, cut)
        assert done == (self.state is RenderState.RUNNING and before == self.looked.schedule)
        assert self.schedule == (cut if done else before)

    def end(self) -> None:
        """The coordinator has all that it has seen asked for."""
        same = (self.schedule, self.stop) == (self.looked.schedule, self.looked.stop)
        done = self._ledger.commits.end(self.looked, RenderState.SUCCEEDED, "", 2.0)
        assert done == (same and self.state in (RenderState.RUNNING, RenderState.QUEUED))
        if done:
            self.state = RenderState.SUCCEEDED

    def extend(self) -> None:
        self._extend(2 * SAMPLES, self.stop)

    def ask_for_an_error(self) -> None:
        self._extend(self.samples, StopConditions(relative_error=0.01))

    def _extend(self, samples: int, stop: StopConditions) -> None:
        self._folder.requests.extend(self.id, samples, stop)
        if (samples, stop) != (self.samples, self.stop) and self.state.ended:
            self.state = RenderState.QUEUED
        self.samples, self.stop = samples, stop

    def cancel(self) -> None:
        self._folder.requests.cancel(self.id)
        if not self.state.ended:
            self.state = RenderState.CANCELLED

    def pause(self) -> None:
        if self.state.ended:
            with pytest.raises(WrongState):
                self._folder.requests.pause(self.id)
            return
        self._folder.requests.pause(self.id)
        self.state = RenderState.PAUSED

    def check(self) -> None:
        row = self._folder.renders.get(self.id)
        assert (row.state, row.samples, row.stop) == (self.state, self.samples, self.stop)
        assert self.schedule.range_ends[-1] == self.samples


HAPPENINGS: tuple[Callable[[Asked], None], ...] = (
    *(Asked.look, Asked.recut, Asked.end, Asked.extend),
    *(Asked.ask_for_an_error, Asked.cancel, Asked.pause),
)


@pytest.mark.parametrize("first", HAPPENINGS, ids=lambda each: each.__name__)
def test_nothing_that_was_answered_is_lost(stores: Stores, first: Callable[[Asked], None]) -> None:
    others = [each for each in HAPPENINGS if each is not first]
    for number, rest in enumerate(permutations(others, 3)):
        asked = Asked(stores, f"{number}")
        for happens in (first, *rest):
            happens(asked)
            asked.check()
