"""Workers are shared by start-time fair queueing, among owners and among the renders of each."""

from collections import Counter
from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nocturne_coordinator.dispatch.range_queue import RangeQueue
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler

MAX_COST = 60.0
HOUR = 3600.0


def cost(tile: int, index: int) -> float:
    """Processor seconds, from one to 60."""
    return 1.0 + (tile * 7 + index * 13) % int(MAX_COST)


class Farm:
    """A scheduler whose jobs are done as soon as they are published."""

    def __init__(self) -> None:
        self.scheduler = Scheduler()
        self.given: Counter[str] = Counter()
        self.owner_of: dict[str, str] = {}
        self._entries = 0

    def add(self, render: str, owner: str, priority: float = 100.0, weight: float = 100.0) -> None:
        self.owner_of[render] = owner
        queues = [RangeQueue(bytearray(250)) for _ in range(64)]
        self.scheduler.add(render, queues, owner=owner, priority=priority, owner_weight=weight, cost=cost)

    def work(self, cpu_seconds: float, idle: set[str] = frozenset()) -> None:  # type: ignore[assignment]
        """Gives out so much; `idle` renders have nothing that anybody could do."""
        while cpu_seconds > 0.0:
            for key in self.scheduler.take(4, idle):
                cpu_seconds -= cost(key.tile_index, key.range_index)
                self._do(key)

    def _do(self, key: JobKey) -> None:
        self.given[key.render_id] += round(cost(key.tile_index, key.range_index))
        self._entries += 1
        self.scheduler.published(key, b"%d-0" % self._entries, 0.0)
        self.scheduler.received(key, 0.0)
        self.scheduler.completed(key.render_id, key.tile_index, key.range_index + 1)

    def of(self, owner: str) -> int:
        return sum(given for render, given in self.given.items() if self.owner_of[render] == owner)


def test_an_idle_render_saves_up_no_claim() -> None:
    """As an owner's only one that runs, for three hours, while somebody else works."""
    farm = Farm()
    farm.add("waits", "alice")
    farm.add("bobs", "bob")
    farm.work(3 * HOUR, {"waits"})
    before = farm.given["bobs"]
    farm.add("new", "alice")
    farm.work(HOUR, {"waits"})
    assert farm.given["new"] == pytest.approx(HOUR / 2, abs=2 * MAX_COST)
    assert farm.given["bobs"] - before == pytest.approx(HOUR / 2, abs=2 * MAX_COST)


def test_renders_of_an_owner_are_not_compared_with_others() -> None:
    """One of them waited while another owner's render, of low priority, went on for hours."""
    farm = Farm()
    farm.add("bobs", "bob", priority=1.0)
    farm.add("first", "alice")
    farm.add("second", "alice")
    farm.work(HOUR, {"second"})
    before = farm.given["first"]
    farm.work(HOUR)
    assert farm.given["first"] - before == pytest.approx(HOUR / 4, abs=2 * MAX_COST)
    assert farm.given["second"] == pytest.approx(HOUR / 4, abs=2 * MAX_COST)


def test_who_leaves_and_comes_again_is_not_ahead() -> None:
    """An owner whose every render is over after one job gets no more than its share."""
    farm = Farm()
    farm.add("bobs", "bob")
    for number in range(200):
        farm.add(f"r{number}", "alice")
        farm.work(4 * MAX_COST)
        farm.scheduler.remove(f"r{number}")
    assert farm.of("alice") == pytest.approx(farm.of("bob"), abs=2 * MAX_COST)


RENDERS = {"a1": ("a", 100.0), "a2": ("a", 300.0), "b1": ("b", 50.0), "b2": ("b", 50.0), "c1": ("c", 1.0)}
WEIGHTS = {"a": 100.0, "b": 200.0, "c": 50.0}
PHASES = st.lists(
    st.tuples(st.sets(st.sampled_from(sorted(RENDERS)), max_size=4), st.floats(60.0, HOUR)),
    min_size=2,
    max_size=8,
)


@settings(max_examples=30, deadline=None)
@given(PHASES)
def test_whoever_has_work_gets_its_share_in_every_phase(phases: list[tuple[set[str], float]]) -> None:
    """Of two that always have work, the work by weight differs by one job of each at most, whatever was
    before (Goyal, Vin, Cheng 1996, theorem 1)."""
    farm = Farm()
    for render, (owner, priority) in RENDERS.items():
        farm.add(render, owner, priority, WEIGHTS[owner])
    for idle, seconds in phases:
        before = farm.given.copy()
        farm.work(seconds, idle)
        got = farm.given - before
        busy = [render for render in RENDERS if render not in idle]
        for one, other in combinations(busy, 2):
            if RENDERS[one][0] == RENDERS[other][0]:
                _check_even(got[one], RENDERS[one][1], got[other], RENDERS[other][1])
        owners = sorted({RENDERS[render][0] for render in busy})
        of = {owner: sum(got[render] for render in busy if RENDERS[render][0] == owner) for owner in owners}
        for one, other in combinations(owners, 2):
            _check_even(of[one], WEIGHTS[one], of[other], WEIGHTS[other])


def _check_even(one: float, weight: float, other: float, other_weight: float) -> None:
    assert abs(one / weight - other / other_weight) <= MAX_COST / weight + MAX_COST / other_weight + 1e-9
