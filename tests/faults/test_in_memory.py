"""Rows of the fault matrix in memory: the real coordinator, and a queue, a store and workers by a virtual
clock.

Each runs in milliseconds, so each runs at every place and with many seeds; the state is validated after
every event. The same rows on real processes: the other files here. One file, though long: it is the matrix of
tests/faults/README.md in its order, to be read together with it."""

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.profiles import REDONE_SECONDS
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.replay import read_lines, replay
from nocturne_coordinator.store.worker_records import WorkerRecords
from nocturne_scene.ranges import extended_schedule

from tests.coordinator.simulated_worker import Shuffled, one_bit, rounds_otherwise
from tests.coordinator.test_result_handler import SPOILT
from tests.coordinator.world import Crashed, World
from tests.faults.test_lies import Flooder, Forger
from tests.fuzzing import seeds

POINTS = ("received", "merged", "before-commit", "after-commit", "after-acknowledge")
SEEDS = seeds(8)
MOST, ODD = "a" * 16, "b" * 16

Alter = Callable[[job_pb2.JobResult], list[job_pb2.JobResult | bytes]]


@pytest.fixture
def crash(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, int], None]:
    """Lets the coordinator die at the n-th passage of a point."""

    def at(place: str, passage: int) -> None:
        left = passage

        def crash_point(name: str) -> None:
            nonlocal left
            left -= name == place
            if left == 0 and name == place:
                raise Crashed

        for module in ("coordinator", "executor", "queue.dispatcher"):
            monkeypatch.setattr(f"nocturne_coordinator.{module}.crash_point", crash_point)

    return at


def running(
    seed: int = 1, workers: int = 2, samples: int = 200, settings: Settings | None = None
) -> tuple[World, str]:
    """A render, some workers, and a coordinator."""
    world = World(seed, settings)
    world.start()
    render = world.create(samples)
    for _ in range(workers):
        world.worker()
    return world, render


def half_way(seed: int = 1, workers: int = 2, samples: int = 200) -> tuple[World, str]:
    world, render = running(seed, workers, samples)
    world.run_until(lambda: world.half_done(render))
    assert world.row(render).state is RenderState.RUNNING
    return world, render


# --- workers ---


@pytest.mark.parametrize("seed", SEEDS)
def test_workers_are_killed_in_mid_job(seed: int) -> None:
    """W1, W7: again and again, at random times, and others come."""
    world, render = running(seed, 3, 400)
    for _ in range(8):
        world.run(world.chance.uniform(0.0, 0.3))
        world.chance.choice(world.workers).die()
        world.worker()
    world.check_survived(render)
    assert world.row(render).failed_tiles == ()
    assert world.store.bad_workers == []


@pytest.mark.parametrize("acknowledged_first", [False, True])
def test_killed_between_result_and_acknowledgement(acknowledged_first: bool) -> None:
    """W2: either half alone."""
    world, render = running(settings=Settings(commit_seconds=0.1, overdue_seconds=1.0), workers=0)
    world.run_until(lambda: len(world.queue.job_stream) > 3)
    dead = world.worker(delay=0.0)
    world.clock.workers.remove(dead)
    for _ in range(3):
        taken = world.queue.take("dead", 1.0)
        assert taken is not None
        if acknowledged_first:
            world.queue.pending.pop(taken[0])
        else:
            dead._finish(b"none", taken[1])
    world.worker()
    world.check_survived(render)


@pytest.mark.parametrize("workers", [1, 3, 5])
def test_a_job_that_fails_everywhere_is_given_up(workers: int) -> None:
    """W3: its tile fails, the render goes on, nobody is in quarantine."""

    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        if result.job.tile_index == 1 and result.job.first_sample == 8:
            return [job_pb2.JobResult(job=result.job, worker_id=result.worker_id, failure="a hole")]
        return [result]

    world = World()
    world.start()
    render = world.create(100)
    for _ in range(workers):
        world.worker(failing)
    world.run_until(lambda: world.row(render).state.ended)
    assert world.row(render).state is RenderState.DEGRADED
    assert {index: tile.samples for index, tile in world.store.stored[render].tiles.items()} == {0: 100, 1: 8}
    assert world.store.bad_workers == []
    assert [failed.tile_index for _, failed in world.store.bundles] == [1]
    world.check_sums(render)
    world.check_nothing_left()


def test_a_job_that_kills_is_given_up() -> None:
    """W3: three distinct workers die of it, and each is missed only when its status runs out."""

    def dies(result: job_pb2.JobResult) -> bool:
        return result.job.tile_index == 1 and result.job.first_sample == 8

    world = World()
    world.start()
    render = world.create(100)
    for _ in range(4):
        world.worker(dies=dies)
    world.run_until(lambda: world.row(render).state.ended, 120.0)
    assert world.row(render).state is RenderState.DEGRADED
    assert "died of it" in world.store.stored[render].reason
    world.check_sums(render)


def test_a_worker_that_fails_what_others_can_do_is_quarantined() -> None:
    """W3: it is the worker."""

    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        return [job_pb2.JobResult(job=result.job, worker_id=result.worker_id, failure="no memory")]

    world, render = running(samples=1000)
    bad = world.worker(failing)
    world.check_survived(render)
    assert world.store.bad_workers == [bad.name]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_worker_stands_still_for_three_leases(seed: int) -> None:
    """W4: its late result counts once or not at all."""
    world, render = running(seed, 2, 400)
    for _ in range(4):
        world.run(world.chance.uniform(0.0, 0.2))
        world.chance.choice(world.workers).stand_still(3.0)
    world.check_survived(render)


def test_a_slow_worker_does_not_hold_up_the_end() -> None:
    """W5: an idle worker gets its job as well."""
    world, render = running(workers=0)
    world.worker(delay=600.0, lease=1000.0)
    world.run_until(lambda: world.workers[0].has_job)
    world.worker()
    world.check_survived(render, seconds=60.0)
    assert world.workers[0].has_job


def test_all_workers_are_gone_for_ten_minutes() -> None:
    """W6: then others come."""
    world, render = half_way()
    for worker in list(world.workers):
        worker.die()
    world.run(600.0)
    assert world.row(render).state is RenderState.RUNNING
    assert world.coordinators[0].core.state.fleet.workers == ()
    world.worker()
    world.check_survived(render)
    assert world.store.bad_workers == []


def test_profiles_are_never_mixed() -> None:
    """W8: an odd worker that was first and alone is outvoted; it is not counted as faulty."""

    world = World()
    world.start()
    render = world.create(4000)
    world.worker(rounds_otherwise, delay=1.0, profile=ODD)
    world.run_until(lambda: world.done(render) > 1)
    assert world.row(render).floating_point_profile == ODD
    honest = {world.worker(profile=MOST, delay=0.5).name for _ in range(2)}
    world.run_until(lambda: world.row(render).floating_point_profile == MOST, 30.0)
    world.check_survived(render)
    assert set.union(*world.store.stored[render].contributors.values()) <= honest
    assert world.store.bad_workers == []
    # A replay of that profile waits for its worker.
    other = world.create(100, StopConditions(tile_samples=(100, 100)), profile="c" * 16)
    world.run(30.0)
    assert world.done(other) == 0
    world.worker(profile="c" * 16)
    world.check_survived(other)


def test_long_work_waits_for_its_profile() -> None:
    """W8: what took long is not thrown away."""

    def costs_much(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        result.partial.cpu_seconds = REDONE_SECONDS
        return [result]

    world = World()
    world.start()
    render = world.create(400)
    first = world.worker(costs_much, profile=ODD)
    world.run_until(lambda: world.done(render) > 4)
    first.die()
    world.worker(profile=MOST)
    world.run(60.0)
    before = world.done(render)
    other = world.create(100)
    world.run_until(lambda: world.row(other).state is RenderState.SUCCEEDED)
    assert world.done(render) == before
    world.worker(profile=ODD)
    world.check_survived(render)


@pytest.mark.parametrize("seed", SEEDS)
def test_workers_end_in_order(seed: int) -> None:
    """W10: SIGTERM hands the job back, which is nobody's failure."""
    world, render = running(seed, 3, 400)
    for _ in range(6):
        world.run(world.chance.uniform(0.0, 0.2))
        world.chance.choice(world.workers).leave()
        world.worker()
    world.check_survived(render)
    assert world.row(render).failed_tiles == ()


# --- lies ---


def test_a_liar_is_found_and_its_work_done_again() -> None:
    """L1: by one unit in the last place; in a render that had ended, too."""

    world = World(settings=Settings(commit_seconds=0.1, audit_share=0.5, audit_share_new=0.5))
    world.start()
    before = world.create(16)
    liar = world.worker(one_bit)
    # Alone, nobody can tell.
    world.run_until(lambda: world.row(before).state is RenderState.SUCCEEDED)
    for _ in range(2):
        world.worker()
    world.run(5.0)
    render = world.create(4000, width=160)
    world.check_survived(render)
    assert world.store.bad_workers == [liar.name]
    world.check_survived(before)


def test_a_liar_is_found_while_the_folder_refuses_to_note_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """L1, C3: what two others have proved is not forgotten, though three writes of it fail."""
    refused = 0
    works = WorkerRecords.quarantine

    def quarantine(self: WorkerRecords, *of: Any, **named: Any) -> list[str]:
        nonlocal refused
        refused += 1
        if refused <= 3:
            raise sqlite3.OperationalError("database or disk is full")
        return works(self, *of, **named)

    lied: dict[str, tuple[int, int]] = {}

    def wrong_once(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        """In its first job, whenever it is asked for that."""
        job = (result.job.tile_index, result.job.first_sample)
        if job == lied.setdefault("job", job):
            result.partial.sums = np.nextafter(np.frombuffer(result.partial.sums, "<f8"), np.inf).tobytes()
        return [result]

    monkeypatch.setattr(WorkerRecords, "quarantine", quarantine)
    world = World(settings=Settings(commit_seconds=0.1, audit_share=1.0, audit_share_new=1.0))
    world.start()
    liar = world.worker(wrong_once)
    for _ in range(2):
        world.worker()
    # Who is not known to work is not audited.
    world.run(5.0)
    world.check_survived(world.create(400))
    assert (world.store.bad_workers, refused > 3) == ([liar.name], True)


def test_honest_workers_agree() -> None:
    """L1: no other worker is found."""
    world, first = running(settings=Settings(commit_seconds=0.1, audit_share=0.5, audit_share_new=0.5))
    world.run(5.0)
    render = world.create(100)
    world.check_survived(first, render)
    assert world.row(render).totals.audited > 0
    assert world.store.bad_workers == []


def test_nothing_more_is_traced_while_an_end_waits_for_audits() -> None:
    """L1: whoever could check the last results is gone."""
    stop = StopConditions(wall_seconds=3.0)
    world = World(settings=Settings(commit_seconds=0.1, audit_share=1.0, audit_share_new=1.0))
    world.start()
    render = world.create(2**17, stop)
    world.worker()
    other = world.worker()
    world.run(2.0)
    other.die()
    world.run(4.0)
    done = world.done(render)
    assert not world.row(render).state.ended
    world.run_until(lambda: world.row(render).state.ended)
    assert world.row(render).state is RenderState.STOPPED_EARLY
    assert world.done(render) == done


def test_garbage() -> None:
    """L2: each kind of impossible result is refused, and its range done again."""
    world, render = running(settings=Settings(commit_seconds=0.1, overdue_seconds=1.0), workers=0)
    forger = Forger()
    world.worker(forger)
    world.queue.statuses["x"] = b"\xff\xff", world.clock.now + 2.0
    while not forger.sent >= set(SPOILT):
        world.check_survived(render, seconds=600.0)
        render = world.create(200)
    world.check_survived(render, seconds=600.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_results_come_again_and_in_any_order(seed: int) -> None:
    """L3, T3: ten old ones for every new one, of ended renders too; all two and ten times, shuffled."""
    world = World(seed)
    world.start()
    world.worker(Flooder(seed))
    world.worker(Shuffled(seed))
    world.worker(Shuffled(seed, copies=10))
    first = world.create(50)
    world.check_survived(first)
    world.check_survived(world.create(100))
    world.check_sums(first)


@pytest.mark.parametrize("seed", SEEDS)
def test_jobs_are_taken_off_the_stream(seed: int) -> None:
    """L4: by a worker that sends nothing; they come again when they are overdue."""
    world, render = running(seed, 1, 400, Settings(commit_seconds=0.1, overdue_seconds=1.0))
    for _ in range(3):
        world.run(world.chance.uniform(0.0, 0.3))
        for entry in list(world.queue.job_stream):
            world.queue.complete(entry, [])
    world.check_survived(render)


# --- network and Redis ---


@pytest.mark.parametrize("seed", SEEDS)
def test_redis_goes_and_comes_empty_or_full(seed: int) -> None:
    """T1, D1, D2: cut off, killed and restarted, FLUSHALL, again and again; commits go on."""
    world, render = running(seed, 2, 400)
    for _ in range(6):
        world.run(world.chance.uniform(0.0, 0.3))
        world.queue.is_down = True
        world.run(world.chance.choice([0.0, 0.1, 5.0]))
        if world.chance.random() < 0.7:
            world.queue.flush()
        world.queue.is_down = False
    begun, before = world.clock.now, world.done(render)
    if world.row(render).state is RenderState.RUNNING:
        world.run_until(lambda: world.done(render) > before or world.row(render).state.ended, 10.0)
        assert world.clock.now - begun < 10.0
    world.check_survived(render)


@pytest.mark.parametrize("seed", SEEDS)
def test_answers_are_lost(seed: int) -> None:
    """T2: calls of the coordinator that happened, one in ten."""
    world, render = running(seed, 2, 400)
    world.queue.lost_answers = lambda: world.chance.random() < 0.1
    world.run(20.0)
    world.queue.lost_answers = lambda: False
    world.check_survived(render)


def test_the_consumer_group_is_confused() -> None:
    """D3: set back to the first entry, so that jobs are given out twice; or without its pending list."""
    for confuse in ("rewound", "destroyed"):
        world, render = half_way()
        world.queue.delivered.clear()
        if confuse == "destroyed":
            world.queue.pending.clear()
        world.check_survived(render)


# --- coordinators ---


@pytest.mark.parametrize("place", POINTS)
@pytest.mark.parametrize("passage", range(1, 13))
def test_the_coordinator_is_killed_at(place: str, passage: int, crash: Callable[[str, int], None]) -> None:
    """C1, C2: at each passage of each point; the next life is cut off at the same passage of it."""
    world = World(passage)
    world.start()
    render = world.create(20_000, width=160)
    for _ in range(2):
        world.worker(delay=0.08)
    deaths = 0
    for _ in range(3):
        crash(place, passage)
        try:
            world.run_until(lambda: world.row(render).state.ended)
            break
        except Crashed:
            deaths += 1
            world.kill()
            world.start()
    crash("nowhere", 1)
    assert deaths > 0
    world.check_survived(render)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_disk_is_full_for_a_while(seed: int) -> None:
    """C3: intake pauses, nothing is lost, and it goes on when there is room."""
    world, render = running(seed, 2, 400)
    world.run(world.chance.uniform(0.0, 0.3))
    world.store.database.is_full = True
    world.run(world.chance.uniform(0.5, 30.0))
    before = world.done(render)
    core = world.coordinators[0].core
    assert core.state.scheduler.in_flight <= max(core.window.size, limits.MIN_WINDOW) + 2
    world.store.database.is_full = False
    if before < world.store.stored[render].ranges_planned:
        world.run_until(lambda: world.done(render) > before, 10.0)
    world.check_survived(render)


def test_workers_that_need_no_time_are_held_back() -> None:
    """C6: never more than a window of jobs and results."""
    world = World(settings=Settings(commit_seconds=0.5))
    world.start()
    render = world.create(3000, width=320)
    for _ in range(6):
        world.worker(delay=0.0)
    window = max(limits.MIN_WINDOW, limits.JOBS_PER_THREAD * 6)
    while not world.row(render).state.ended:
        world.round()
        assert world.coordinators[0].core.state.scheduler.in_flight <= window + 10
    assert limits.MIN_WINDOW <= world.queue.most <= window + 10
    world.check_survived(render)


def test_another_engine_is_refused_in_words() -> None:
    """C7: nothing is added to what an older engine began; another render is not held up."""
    world, render = half_way()
    world.kill()
    before = world.done(render)
    world.store.change(render, engine=job_pb2.ENGINE_CURRENT - 1)
    world.start()
    world.run_until(lambda: world.row(render).state is RenderState.FAILED)
    assert "whose bits differ" in world.store.stored[render].reason
    assert world.done(render) == before
    world.check_survived(world.create(20))


@pytest.mark.parametrize("seed", SEEDS)
def test_people_change_their_minds(seed: int) -> None:
    """C8: pause, resume, priority, extension, cancellation and deletion at random times."""
    world, render = running(seed, 3, 400)
    gone = world.create(400)
    for _ in range(4):
        world.run(world.chance.uniform(0.0, 0.1))
        if not world.row(render).state.ended:
            world.store.change(render, state=RenderState.PAUSED)
            world.run(world.chance.choice([0.0, 0.05, 1.0]))
            world.store.change(render, state=RenderState.QUEUED, priority=world.chance.randint(1, 1000))
    if world.chance.random() < 0.5:
        world.store.change(gone, state=RenderState.CANCELLED)
    else:
        world.store.delete(gone)
    longer = extended_schedule(world.row(render).schedule, 600)
    world.store.change(render, schedule=longer, state=RenderState.QUEUED, stop=StopConditions())
    world.check_survived(render)


# --- everything ---


@pytest.mark.parametrize("seed", SEEDS)
def test_everything_is_killed_at_once(seed: int) -> None:
    """S1: and comes back in any order."""
    world, render = running(seed, 2, 400)
    for _ in range(4):
        world.run(world.chance.uniform(0.05, 0.3))
        world.queue.is_down = True
        world.queue.flush()
        world.kill()
        for worker in list(world.workers):
            worker.die()
        steps: list[Callable[[], object]] = [
            lambda: setattr(world.queue, "is_down", False),
            world.start,
            world.worker,
        ]
        for step in world.chance.sample(steps, 3):
            step()
            world.run(world.chance.uniform(0.0, 1.0))
    world.check_survived(render)


def test_fleets_of_any_size_give_the_same_sums() -> None:
    """S2: 1, 2, 3, 7 workers, in order and in any order."""
    found = set()
    for workers in (1, 2, 3, 7):
        world = World(workers)
        world.start()
        render = world.create(300, StopConditions(tile_relative_error=0.09))
        for each in range(workers):
            world.worker(Shuffled(each) if each % 2 else lambda result: [result], delay=0.01 * each)
        world.run_until(lambda world=world, render=render: world.row(render).state.ended)  # type: ignore[misc]
        world.check_sums(render)
        found.add(
            tuple(
                (index, tile.samples, tile.sums)
                for index, tile in sorted(world.store.stored[render].tiles.items())
            )
        )
    assert len(found) == 1


@contextmanager
def stopped(world: World, seconds: float) -> Iterator[None]:
    """The first coordinator stands still so long, and then continues with its old state."""
    coordinator = world.coordinators.pop(0)
    yield
    world.run(seconds)
    world.coordinators.insert(0, coordinator)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_coordinator_goes_on_after_its_lease(seed: int) -> None:
    """S4: two share the folder; one stands still beyond its lease with sums that it has not committed."""
    world = World(seed, Settings(commit_seconds=1.0))
    world.start()
    world.start()
    renders = [world.create(3000), world.create(3000)]
    for _ in range(2):
        world.worker(delay=0.3)
    world.run(world.chance.uniform(3.0, 6.0))
    with stopped(world, world.chance.uniform(5.0, 15.0)):
        pass
    world.check_survived(*renders, seconds=600.0)


def test_a_night_is_replayed_from_its_event_log(tmp_path: Path) -> None:
    """S3: with faults of all kinds; a fresh core gives the same instructions, and another core is found
    out."""
    log = tmp_path / "events"
    world = World(5, Settings(commit_seconds=0.1, overdue_seconds=1.0, audit_share_new=0.5), log)
    world.start()
    world.worker(Flooder(1))
    world.worker(Forger())
    world.worker()
    renders = [world.create(200), world.create(300, StopConditions(tile_relative_error=0.09))]
    for _ in range(4):
        world.run(0.5)
        world.queue.is_down = True
        world.run(0.3)
        world.queue.flush()
        world.queue.is_down = False
        world.store.database.is_full = not world.store.database.is_full
        world.chance.choice(world.workers).stand_still(2.0)
    world.run_until(lambda: all(world.row(each).state.ended for each in renders), 600.0)
    world.close_log()
    lines = list(read_lines(log))
    events, instructions = replay(iter(lines))
    assert events > 100
    assert instructions > 100
    changed = [
        line for line in lines if not (line[0] == "event" and type(line[1]).__name__ == "RedisEmptied")
    ]
    with pytest.raises(Exception, match="event"):
        replay(iter(changed))
