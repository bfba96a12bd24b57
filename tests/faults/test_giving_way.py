"""Jobs that take long give way to another owner's, whoever came first."""

import random

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings

from tests.coordinator.world import World

_LONG_S = 40.0


def _world(threads: int, seed: int = 1) -> World:
    """Workers of a thread each; a job of a render of the long owner takes forty seconds."""
    # An audit waits for another machine, and the render's end for the audit.
    world = World(seed, Settings(commit_seconds=0.1, audit_share=0.0, audit_share_new=0.0))
    world.start()
    long: set[str] = set()
    world.long = long  # type: ignore[attr-defined]
    for _ in range(threads):
        worker = world.worker()
        worker.seconds = lambda data: _LONG_S if job_pb2.Job.FromString(data).render_id in long else 0.02
    return world


def _create(world: World, owner: str, samples: int = 1, width: int = 34) -> str:
    render = world.create(samples, width=width)
    world.store.change(render, owner=owner)
    if owner == "long":
        world.long.add(render)  # type: ignore[attr-defined]
    return render


def _seconds(world: World, owner: str) -> float:
    begun, render = world.clock.now, _create(world, owner)
    world.run_until(lambda: world.row(render).state is RenderState.SUCCEEDED, 200.0)
    return world.clock.now - begun


@pytest.mark.parametrize("threads", [2, 4])
def test_a_small_render_waits_for_nobodys_long_jobs(threads: int) -> None:
    """P17: whenever it comes."""
    world, chance = _world(threads), random.Random(threads)
    _create(world, "long", 10**6, 34 * threads)
    world.run(5.0)
    for number in range(3):
        world.run(chance.uniform(0.0, 40.0))
        assert _seconds(world, f"owner {number % 3}") < 3.0


def test_who_has_long_jobs_keeps_a_thread() -> None:
    """P17: of two, however often others come; what is stopped is traced again, with the same bits."""
    world = _world(2)
    long = _create(world, "long", 16)
    while not world.row(long).state.ended:
        assert _seconds(world, "short") < 3.0
        assert world.clock.now < 1000.0 + 1800.0
    assert world.row(long).state is RenderState.SUCCEEDED
    world.check_sums(long)


def test_a_single_thread_is_taken_from_nobody() -> None:
    """P17: who comes waits for one job, and not for all those behind it."""
    world = _world(1)
    long = _create(world, "long", 16)
    world.run(5.0)
    while not world.row(long).state.ended:
        assert _seconds(world, "short") < _LONG_S + 3.0
        # Six jobs of it.
        assert world.clock.now < 1000.0 + 2 * 6 * _LONG_S
    world.check_sums(long)
