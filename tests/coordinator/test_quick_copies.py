"""Quick copies (decision 0185): another owner's small render does not wait behind long jobs."""

import itertools

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.quick_entries import QUICK, is_quick
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings

from tests.coordinator.memory_queue import Worker
from tests.coordinator.simulated_worker import unaltered
from tests.coordinator.world import World

LONG = 60.0
"""Seconds of mallory's jobs."""


class Mixed(Worker):
    """Does mallory's jobs in a minute, bob's at once."""

    def __init__(self, world: World, name: str, small: dict[str, float], quick: bool = True) -> None:
        super().__init__(name, world.queue, world.clock, unaltered, quick=quick)
        self._small = small
        """Seconds of a job, by render; of others it is a minute."""

    def seconds_of(self, job: job_pb2.Job) -> float:
        return self._small.get(job.render_id, LONG)


def held_by_mallory(
    workers: int = 2, settings: Settings | None = None, quick: bool = True
) -> tuple[World, dict[str, float]]:
    """All threads have a job of a minute."""
    world = World(1, settings or Settings(commit_seconds=0.1, audit_share=0.0, audit_share_new=0.0))
    world.start()
    small: dict[str, float] = {}
    made = [Mixed(world, f"w{number}", small, quick) for number in range(workers)]
    world.create(4000, width=160, height=160, owner="mallory")
    world.run_until(lambda: all(worker.has_job for worker in made))
    world.run(5.0)
    return world, small


def seconds_of_bobs(world: World, small: dict[str, float], takes: float = 0.02, owner: str = "bob") -> float:
    render = world.create(1, width=8, height=8, owner=owner)
    small[render] = takes
    begun = world.clock.now
    world.run_until(lambda: world.row(render).state.ended, 3 * LONG)
    assert world.row(render).state is RenderState.SUCCEEDED
    world.check_sums(render)
    return world.clock.now - begun


def test_anothers_small_render_ends_while_one_owner_holds_all_threads() -> None:
    """P16: within a second, wherever the jobs of a minute stand; without the further threads it takes that
    minute."""
    world, small = held_by_mallory()
    assert max(seconds_of_bobs(world, small) for _ in range(8)) < 1.5
    assert not any(map(is_quick, world.queue.job_stream))
    without, small = held_by_mallory(quick=False)
    small[without.create(1, width=8, height=8, owner="bob")] = 0.02
    without.run(10.0)
    assert not without.row("r1").state.ended


def test_its_audits_do_not_wait_either() -> None:
    world, small = held_by_mallory(
        settings=Settings(commit_seconds=0.1, audit_share=1.0, audit_share_new=1.0)
    )
    assert seconds_of_bobs(world, small) < 3.0
    assert world.coordinators[0].core.state.auditor.agreed


def test_who_holds_the_threads_gets_none() -> None:
    world, small = held_by_mallory()
    render = world.create(1, width=8, height=8, owner="mallory")
    small[render] = 0.02
    world.run(10.0)
    assert not any(map(is_quick, world.queue.job_stream))
    assert not world.row(render).state.ended


def test_where_a_thread_is_free_none_are_made() -> None:
    world, small = held_by_mallory()
    Mixed(world, "idle", small)
    world.run(5.0)
    made = world.coordinators[0].core.window.quick_copies.made
    world.run_until(lambda: all(worker.has_job for worker in world.workers))
    assert made == 0


def test_one_that_takes_long_is_stopped_and_its_owner_gets_none_for_a_minute() -> None:
    """Its job is done as before, and nothing fails."""
    world, small = held_by_mallory()
    fool = world.create(1, width=8, height=8, owner="fool")
    small[fool] = 5.0
    quick = world.coordinators[0].core.window.quick_copies
    world.run_until(lambda: bool(world.coordinators[0].core.state.no_quick_copies))
    made = quick.made
    again = world.create(1, width=8, height=8, owner="fool")
    small[again] = 0.02
    world.run(limits.QUICK_REFUSED_SECONDS / 4)
    assert quick.made == made
    assert not world.row(again).state.ended
    # Others' do not suffer.
    assert seconds_of_bobs(world, small) < 2.5
    world.store.change("r0", state=RenderState.CANCELLED)
    world.run_until(lambda: world.row(fool).state.ended and world.row(again).state.ended, 5 * LONG)
    assert world.row(fool).state is RenderState.SUCCEEDED
    assert not world.coordinators[0].core.state.fleet.quarantined


def test_owners_take_turns_though_one_has_many() -> None:
    """A quarter of the further threads for one owner, at most, and who waited longest first."""
    world, small = held_by_mallory(workers=8)
    for _ in range(8):
        small[world.create(64, width=32, height=32, owner="carol")] = 0.9
    out = []
    for _ in range(40):
        world.run(0.1)
        out.append(sum(map(is_quick, world.queue.job_stream)))
    assert max(out) == 4
    assert seconds_of_bobs(world, small) < 1.5


def test_of_one_worker_no_owner_has_all_places() -> None:
    """Each copy of a fool takes as long as it may, and one comes after the other."""
    world, small = held_by_mallory(workers=1)
    for _ in range(40):
        small[world.create(1, width=8, height=8, owner="fool")] = 0.99
    world.run(1.0)
    assert max(seconds_of_bobs(world, small) for _ in range(8)) < 0.8


def test_a_large_render_gets_none() -> None:
    world, small = held_by_mallory()
    render = world.create(2000, width=64, height=64, owner="bob")
    small[render] = 0.02
    world.run(5.0)
    assert not any(map(is_quick, world.queue.job_stream))


@pytest.mark.parametrize("fault", ["redis emptied", "coordinator killed", "workers killed", "cancelled"])
def test_faults_with_quick_copies_out(fault: str) -> None:
    """Bits and streams as ever."""
    world, small = held_by_mallory()
    render = world.create(40, width=40, height=33, owner="bob")
    small[render] = 0.4
    world.run_until(lambda: any(map(is_quick, world.queue.job_stream)))
    if fault == "redis emptied":
        world.queue.flush()
    elif fault == "coordinator killed":
        world.kill()
        world.start()
    elif fault == "workers killed":
        for worker in list(world.workers):
            worker.die()
        for number in range(2):
            Mixed(world, f"new{number}", small)
    else:
        world.store.change(render, state=RenderState.CANCELLED)
        world.run_until(lambda: not any(map(is_quick, world.queue.job_stream)), 2.0)
        assert any(map(is_quick, world.queue.stopped))
        return
    world.run_until(lambda: world.row(render).state.ended, 3 * LONG)
    assert world.row(render).state is RenderState.SUCCEEDED
    world.check_sums(render)


def test_entries_are_told_apart() -> None:
    names = [QUICK + b"1-0", b"1-0"]
    assert [is_quick(each) for each in names] == [True, False]
    assert len(set(itertools.chain(names))) == 2
