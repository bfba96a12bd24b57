"""How long jobs may be: rules alone, and with a coordinator in memory, by a virtual clock."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.job_cost import JOB_SECONDS, longest_range, max_cpu_seconds
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings
from nocturne_coordinator.store.commits import Commits
from nocturne_scene.ranges import MAX_CUT_RANGES, extended_schedule, make_schedule, recut_schedule

from tests.coordinator.world import World

_JOB = 1.0


def test_a_first_job_has_less_time_than_those_after_it() -> None:
    assert max_cpu_seconds(4, known=False, job_seconds=JOB_SECONDS) == 120.0
    assert max_cpu_seconds(16, known=False, job_seconds=JOB_SECONDS) == 480.0
    assert max_cpu_seconds(4096, known=False, job_seconds=JOB_SECONDS) == 600.0
    assert max_cpu_seconds(4, known=True, job_seconds=JOB_SECONDS) == 600.0


@pytest.mark.parametrize(
    ("seconds", "samples", "longest"),
    [
        (60.0, 4096, None),
        (61.0, 4096, 1024),
        (120.0, 4096, 1024),
        (121.0, 4096, 512),
        (1e6, 4096, 4),
        (1e6, 4, None),
    ],
)
def test_ranges_are_cut_to_half_of_what_a_job_should_take(
    seconds: float, samples: int, longest: int | None
) -> None:
    assert longest_range(seconds, samples, JOB_SECONDS) == longest


def test_a_schedule_is_cut_after_what_some_tile_has() -> None:
    schedule = make_schedule(64, 64, 300)
    assert list(schedule.range_ends) == [4, 8, 16, 32, 64, 128, 256, 300]
    cut = recut_schedule(schedule, 64, 32)
    assert cut is not None
    assert list(cut.range_ends) == [4, 8, 16, 32, 64, 96, 128, 160, 192, 224, 256, 288, 300]
    assert recut_schedule(schedule, 64, 128) is None
    assert recut_schedule(schedule, 300, 4) is None


def test_a_schedule_is_not_cut_without_end() -> None:
    schedule = make_schedule(64, 64, 4 * MAX_CUT_RANGES)
    assert recut_schedule(schedule, 4, 4) is not None
    assert recut_schedule(make_schedule(64, 64, 4 * MAX_CUT_RANGES + 4), 4, 4) is None


def _costs(
    seconds_per_sample: Callable[[int], float],
) -> Callable[[job_pb2.JobResult], list[job_pb2.JobResult | bytes]]:
    def alter(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        job = result.job
        result.partial.cpu_seconds = seconds_per_sample(job.tile_index) * (job.end_sample - job.first_sample)
        return [result]

    return alter


@pytest.mark.parametrize("seed", range(5))
def test_dear_ranges_are_cut_and_merged_like_any(seed: int) -> None:
    """P2: one tile a hundred times dearer than the other; the coordinator is killed now and then."""
    world = World(seed, Settings(commit_seconds=0.1, job_seconds=_JOB))
    world.start()
    for _ in range(3):
        world.worker(_costs(lambda tile: (0.0002, 0.02)[tile]))
    render = world.create(samples=1000)
    before = world.row(render).schedule
    while not world.row(render).state.ended:
        world.run(world.chance.uniform(0.2, 2.0))
        if world.chance.random() < 0.3 and not world.row(render).state.ended:
            world.kill()
            world.start()
    world.check_survived(render)
    ends = world.row(render).schedule.range_ends
    assert len(ends) > len(before.range_ends)
    lengths = [end - first for first, end in pairwise([0, *ends])]
    # 0.02 s each: what takes a second has 50 samples. Four ranges may be out before the first is back.
    assert max(lengths) <= 64


def test_an_extension_between_a_look_and_a_cut_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """B4: the cut wrote its schedule over the extension's, and the render ended with half of the samples."""
    world = World(1, Settings(commit_seconds=0.1, job_seconds=_JOB))
    world.start()
    world.worker(_costs(lambda _: 0.02))
    render = world.create(samples=300)
    recut = Commits.recut
    extended: list[job_pb2.RangeSchedule] = []

    def late(commits: Commits, *cut: Any) -> Any:
        if not extended:
            extended.append(extended_schedule(world.row(render).schedule, 600))
            world.store.change(render, schedule=extended[0])
        return recut(commits, *cut)

    monkeypatch.setattr(Commits, "recut", late)
    world.check_survived(render)
    ends = list(world.row(render).schedule.range_ends)
    assert extended
    assert ends[-1] == 600
    assert len(ends) > len(extended[0].range_ends), "what was extended is cut, too"


def test_cheap_ranges_stay_as_they_are() -> None:
    """P2: the schedule, and so the bits, are those of a render that nobody measured."""
    world = World(1, Settings(commit_seconds=0.1, job_seconds=_JOB))
    world.start()
    world.worker(_costs(lambda _: 0.0002))
    render = world.create(samples=1000)
    before = world.row(render).schedule
    world.check_survived(render)
    assert world.row(render).schedule == before


def _too_long(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
    """What a worker sends of a job of more than 32 samples."""
    if result.job.end_sample - result.job.first_sample <= 32:
        return [result]
    stopped = job_pb2.JobResult(
        job=result.job, worker_id=result.worker_id, failure="it was stopped", stopped_too_long=True
    )
    return [stopped]


def test_a_job_that_was_stopped_is_cut() -> None:
    """P2: it is nobody's fault, and no tile fails."""
    world = World(1, Settings(commit_seconds=0.1, job_seconds=_JOB))
    world.start()
    for _ in range(3):
        world.worker(_too_long)
    render = world.create(samples=400)
    world.check_survived(render)
    assert world.row(render).failed_tiles == ()


def test_a_job_that_can_not_be_cut_fails() -> None:
    """P2: three machines stopped it."""
    world = World(1, Settings(commit_seconds=0.1, job_seconds=_JOB))
    world.start()

    def stopped(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        failure = job_pb2.JobResult(job=result.job, worker_id=result.worker_id, failure="it was stopped")
        failure.stopped_too_long = True
        return [failure]

    for _ in range(3):
        world.worker(stopped)
    render = world.create(samples=400)
    world.run_until(lambda: world.row(render).state.ended)
    assert world.row(render).state is RenderState.FAILED


@pytest.mark.parametrize("state", [RenderState.CANCELLED, RenderState.PAUSED])
def test_who_has_a_job_that_nobody_needs_is_told(state: RenderState) -> None:
    """P2: all jobs of a render that was cancelled or paused."""
    world = World(1)
    world.start()
    for _ in range(3):
        world.worker(delay=1000.0)
    render = world.create()
    world.run(1.0)
    held = set(world.queue.pending)
    assert len(held) == 3
    world.store.change(render, state=state)
    world.run(1.0)
    assert held <= world.queue.stopped
