"""Any order, repetition and loss of partials gives the sums of merging in order, bit for bit."""

import random
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nocturne.v1 import job_pb2
from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.audit import Auditor
from nocturne_coordinator.dispatch.merge import Accumulator, MergeResult, RangeSums
from nocturne_coordinator.dispatch.range_queue import InvalidTransition, RangeQueue, RangeState
from nocturne_coordinator.dispatch.records import OpenRender, RenderState, TileRow, Totals, WorkerRow
from nocturne_coordinator.dispatch.result_handler import ResultHandler
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import MIN_OVERDUE, OVERDUE_FACTOR, JobKey, Scheduler
from nocturne_coordinator.dispatch.state import Settings, State
from nocturne_scene.ranges import make_schedule
from nocturne_scene.tile_sums import TileSums, numbers_in, split

from tests.coordinator.simulated_worker import WORKER, simulated_result, simulated_sums


def tile_range(index: int, value: float = 1.0) -> RangeSums:
    sums = TileSums.zeros(1, 1, 2)
    sums.assign(split(np.full(numbers_in(1, 1, 2), value), 1, 1, 2))
    return RangeSums(index, sums, 1, 1, 0, 0.0, b"%d" % index)


@given(
    order=st.permutations(range(limits.RANGES_AHEAD)),
    repeats=st.lists(st.integers(0, limits.RANGES_AHEAD - 1), max_size=5),
    values=st.lists(st.floats(0, 1e20), min_size=limits.RANGES_AHEAD, max_size=limits.RANGES_AHEAD),
)
def test_a_tile_adds_in_sample_order(order: list[int], repeats: list[int], values: list[float]) -> None:
    tile = Accumulator(TileSums.zeros(1, 1, 2))
    merged = []
    for index in [*order, *repeats]:
        merged += [each.index for each in tile.offer(tile_range(index, values[index]))[1]]
    assert merged == list(range(limits.RANGES_AHEAD))
    in_order = 0.0
    for value in values:
        in_order += value
    assert np.all(np.frombuffer(tile.sums.encode()) == in_order)
    assert not tile.waiting


def test_a_tile_says_what_became_of_a_range() -> None:
    tile = Accumulator(TileSums.zeros(1, 1, 2))
    assert tile.offer(tile_range(1))[0] is MergeResult.EARLY
    assert tile.offer(tile_range(1))[0] is MergeResult.DUPLICATE
    assert tile.offer(tile_range(limits.RANGES_AHEAD))[0] is MergeResult.TOO_EARLY
    verdict, released, surplus = tile.offer(tile_range(0))
    assert (verdict, [each.index for each in released], surplus) == (MergeResult.MERGED, [0, 1], [])
    assert tile.offer(tile_range(0))[0] is MergeResult.DUPLICATE


class Session:
    """Renders, scheduler and intake without I/O: the coordinator's core, and a stream that can be lost."""

    def __init__(
        self,
        samples: int,
        tiles: list[TileRow] | None = None,
        further_responses: Sequence[str] = (),
        settings: Settings | None = None,
    ) -> None:
        self._further_responses = len(further_responses)
        schedule = make_schedule(70, 33, samples, further_responses)
        row = OpenRender("r", RenderState.RUNNING, schedule, "5c" * 32, job_pb2.ENGINE_CURRENT, Totals())
        self.render = RunningRender(row, tiles or [])
        self.scheduler = Scheduler()
        self.scheduler.add("r", self.render.range_queues())
        state = State(settings or Settings(), self.scheduler, Auditor(0.0, 0.0), {"r": self.render})
        state.fleet.seen((WorkerRow(WORKER, job_pb2.ENGINE_CURRENT, 1, 0, 0, 0.0, 0, 0.0, 0.0),))
        self.intake = ResultHandler(state)
        self.stream: dict[JobKey, bytes] = {}
        self.entries = 0
        self.failed: dict[str, str] = {}
        self.lines: list[str] = []

    def fill(self, window: int) -> None:
        for key in self.scheduler.take(window - self.scheduler.in_flight):
            assert key not in self.stream
            self.entries += 1
            self.scheduler.published(key, b"%d" % self.entries, 0.0)
            self.stream[key] = b"%d" % self.entries
        # One more for each tile, where all that is in flight waits for earlier ranges.
        assert self.scheduler.in_flight <= window + len(self.render.film.queues)

    def deliver(self, data: bytes) -> list[bytes]:
        outcome = self.intake.take(b"0-1", data, 1.0, 0.5)
        gone = set(outcome.withdrawn)
        self.stream = {key: entry for key, entry in self.stream.items() if entry not in gone}
        self.failed |= outcome.failed
        self.lines += [line.message for line in outcome.lines]
        return outcome.to_acknowledge

    def result(self, key: JobKey) -> job_pb2.JobResult:
        planned = self.render.planned
        job = planned.job(key.tile_index, planned.ranges[key.range_index])
        return simulated_result(job, further_responses=self._further_responses)

    def check_sums(self) -> None:
        planned = self.render.planned
        for index, tile in enumerate(self.render.film.queues):
            height, width, _ = tile.sums.pixels.shape
            total = TileSums.zeros(width, height, self._further_responses)
            for position in range(tile.merged):
                job = planned.job(index, planned.ranges[position])
                total += simulated_sums(job, self._further_responses)
            assert tile.sums.encode() == total.encode()


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**32),
    samples=st.integers(1, 70),
    window=st.integers(1, 40),
    responses=st.sampled_from([[], ["rod"], ["rod", "far-red", "S"]]),
)
def test_any_faults_give_every_range_once(seed: int, samples: int, window: int, responses: list[str]) -> None:
    chance = random.Random(seed)
    session = Session(samples, further_responses=responses)
    delivered: list[bytes] = []
    for _ in range(10_000):
        session.fill(window)
        if session.render.film.complete:
            break
        match chance.choices(["finish", "repeat", "lose", "restart"], [90, 10, 1, 1])[0]:
            case "finish" if session.stream:
                key = chance.choice(list(session.stream))
                del session.stream[key]
                delivered.append(session.result(key).SerializeToString())
                session.deliver(delivered[-1])
            case "repeat" if delivered:
                session.deliver(chance.choice(delivered))
            case "lose":
                session.stream.clear()
                session.scheduler.lost()
            case "restart":
                film = session.render.film
                tiles = [
                    TileRow(index, film.samples(index), film.tile_bytes(index))
                    for index, tile in enumerate(film.queues)
                    if tile.merged
                ]
                session = Session(samples, tiles, responses)
        session.check_sums()
    assert session.render.film.complete
    assert np.all(session.render.film.counts == samples)


def test_the_whole_frame_comes_first() -> None:
    session = Session(samples=32)
    taken = session.scheduler.take(1000)
    # Two ranges of a tile follow each other after that: they are merged and written together.
    assert [key.range_index for key in taken] == [0] * 6 + [1, 2] * 6 + [3] * 6
    # Four ranges are planned: all may be in flight, and no more than that.
    assert len(taken) == 6 * min(4, limits.RANGES_AHEAD)


def test_two_ranges_of_a_tile_come_together_however_fast_results_come() -> None:
    tiles = 60
    scheduler = Scheduler()
    scheduler.add("a", [RangeQueue(bytearray(20)) for _ in range(tiles)])
    for first in ([0], [1, 2], [3, 4]):
        given = scheduler.take(len(first) * tiles)
        assert given == [JobKey("a", tile, index) for tile in range(tiles) for index in first]
        for key in given:
            scheduler.received(key, 0.0)
            scheduler.completed("a", key.tile_index, key.range_index + 1)


def test_a_slow_tile_does_not_stop_the_others() -> None:
    session = Session(samples=5000)
    while len(session.stream) < limits.RANGES_AHEAD:
        session.fill(16)
        for key in [key for key in session.stream if key.tile_index != 0]:
            del session.stream[key]
            session.deliver(session.result(key).SerializeToString())
    assert all(tile.merged > limits.RANGES_AHEAD for tile in session.render.film.queues[1:])


def test_renders_take_turns() -> None:
    scheduler = Scheduler()
    scheduler.add("a", [RangeQueue(bytearray(3)) for _ in range(2)])
    scheduler.add("b", [RangeQueue(bytearray(3)) for _ in range(2)])
    assert [key.render_id for key in scheduler.take(6)] == ["a", "b"] * 3
    for key in scheduler.take(1):
        scheduler.published(key, b"7-0", 0.0)
        assert scheduler.remove(key.render_id) == [b"7-0"]
    # Three of the other's are about to be published.
    assert scheduler.in_flight == 3


def test_a_range_goes_only_where_the_table_leads() -> None:
    scheduler = Scheduler()
    scheduler.add("a", [RangeQueue(bytearray(2))])
    key = JobKey("a", 0, 0)
    assert scheduler.take(2) == [key, JobKey("a", 0, 1)]
    with pytest.raises(InvalidTransition, match="tile=0 range=0 is PUBLISHED and can't become COMPLETED"):
        scheduler.completed("a", 0, 1)
    assert scheduler.state_of(key) is RangeState.PUBLISHED
    scheduler.received(key, 0.0)
    # A second result of a range changes nothing.
    scheduler.received(key, 0.0)
    assert (scheduler.state_of(key), scheduler.in_flight) == (RangeState.HELD, 2)
    scheduler.completed("a", 0, 1)
    scheduler.committed("a", [0])
    assert scheduler.returned(key) == []
    assert scheduler.finish_tile("a", 0, RangeState.FAILED) == []
    assert scheduler.state_of(key) is RangeState.COMMITTED
    assert scheduler.state_of(JobKey("a", 0, 1)) is RangeState.FAILED
    assert scheduler.state_of(JobKey("a", 0, 2)) is None
    assert (scheduler.in_flight, scheduler.take(5)) == (0, [])


def test_overdue_follows_the_typical_time() -> None:
    scheduler = Scheduler()
    scheduler.add("a", [RangeQueue(bytearray(1)) for _ in range(2)])
    first, second = scheduler.take(2)
    scheduler.published(first, b"1-0", 0.0)
    scheduler.published(second, b"2-0", 0.0)
    assert scheduler.overdue(MIN_OVERDUE - 1) == []
    scheduler.received(first, 10.0)
    assert scheduler.overdue(OVERDUE_FACTOR * 10.0 - 1) == []
    assert scheduler.overdue(OVERDUE_FACTOR * 10.0 + 1) == [second]
    assert scheduler.returned(second) == [b"2-0"]
    assert scheduler.take(5) == [second]


def test_a_window_full_of_later_ranges_makes_room_for_the_first() -> None:
    """Found by the search of all interleavings: merged but uncommitted ranges are lost with the coordinator,
    and Redis still has later ranges of the same tiles, as many as the window holds."""
    scheduler = Scheduler()
    scheduler.add("r", [RangeQueue(bytearray(10)) for _ in range(2)])
    later = [JobKey("r", tile, index) for tile in range(2) for index in (1, 2, 3)]
    for key in later:
        scheduler.published(key, b"1", 0.0)
    assert scheduler.take(0) == []
    for key in later:
        scheduler.received(key, 1.0)
    assert scheduler.in_flight == len(later)
    first = [JobKey("r", 0, 0), JobKey("r", 1, 0)]
    assert scheduler.take(0) == first
    for key in first:
        scheduler.published(key, b"2", 1.0)
    assert scheduler.take(0) == []
    for tile in range(2):
        scheduler.received(JobKey("r", tile, 0), 2.0)
        scheduler.completed("r", tile, 4)
    assert scheduler.in_flight == 0
    assert scheduler.take(2) == [JobKey("r", 0, 4), JobKey("r", 1, 4)]
