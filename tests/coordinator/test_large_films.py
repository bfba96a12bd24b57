"""Films of many tiles are taken up in parts, and hold nobody up."""

import pytest
from nocturne_coordinator.dispatch import admission, film, loading
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.state import Settings
from nocturne_scene.ranges import extended_schedule

from tests.coordinator.world import CheckedCoordinator, World

_TILES = 60
_TILE_SIZE = 32


@pytest.fixture(autouse=True)
def _small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading, "TILES_AT_ONCE", 12)
    monkeypatch.setattr(admission, "_REPLAN_PAUSE", 0.05)


def _half_done() -> tuple[World, str]:
    """A large film that the coordinator of a world without one has begun."""
    world = World(settings=Settings(commit_seconds=0.1))
    world.start()
    for _ in range(4):
        world.worker(delay=0.001)
    large = world.create(12, width=_TILES * _TILE_SIZE)
    world.run_until(lambda: len(world.store.stored[large].tiles) > _TILES - 8, 200.0)
    world.kill()
    # Nobody waits for it any more.
    world.run(15.0)
    return world, large


def _next(world: World, large: str) -> CheckedCoordinator:
    """The next coordinator, which has just taken the large film."""
    coordinator, fence = world.start(), world.row(large).fence
    world.run_until(lambda: world.row(large).fence > fence)
    return coordinator


def test_a_small_film_is_done_while_a_large_one_is_read() -> None:
    world, large = _half_done()
    small = world.create(1)
    world.store.change(small, owner="another")
    coordinator = _next(world, large)
    world.run_until(lambda: world.row(small).state is RenderState.SUCCEEDED)
    assert large not in coordinator.core.state.renders
    world.check_survived(small, large, seconds=300.0)


def test_a_large_film_that_is_let_go_while_it_is_read_comes_back() -> None:
    """It is paused and resumed, and extended, before all of it is here."""
    world, large = _half_done()
    coordinator = _next(world, large)
    assert large not in coordinator.core.state.renders
    world.store.change(large, state=RenderState.PAUSED)
    world.run(1.0)
    assert large not in coordinator.core.state.renders
    schedule = extended_schedule(world.row(large).schedule, 14)
    world.store.change(large, state=RenderState.QUEUED, schedule=schedule)
    world.run(0.1)
    # Once more, in the middle.
    schedule = extended_schedule(schedule, 15)
    world.store.change(large, schedule=schedule)
    world.check_survived(large, seconds=300.0)


def test_a_disk_that_fails_in_the_middle_is_tried_again() -> None:
    world, large = _half_done()
    coordinator = _next(world, large)
    world.store.database.is_full = True
    world.run(2.0)
    world.store.database.is_full = False
    assert not world.row(large).state.ended
    world.check_survived(large, seconds=300.0)
    assert not coordinator.core.state.owed


def test_a_large_film_that_is_extended_again_and_again_is_not_cut_anew_each_time() -> None:
    """Each other schedule is looked at for all tiles, while all others wait; the last one is never lost."""
    world, large = _half_done()
    coordinator = world.start()
    world.run_until(lambda: large in coordinator.core.state.renders)
    seen = set()
    for samples in range(13, 17):
        schedule = extended_schedule(world.row(large).schedule, samples)
        world.store.change(large, schedule=schedule)
        world.run(0.05)
        seen.add(coordinator.core.state.renders[large].row.schedule.range_ends[-1])
    # In three seconds there is one.
    assert seen == {13}
    world.check_survived(large, seconds=600.0)


def test_a_small_film_is_done_while_a_large_one_is_taken_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing of it is committed yet: its tiles alone are many."""
    monkeypatch.setattr(film, "QUEUES_AT_ONCE", 1)
    world = World()
    world.worker()
    coordinator = world.start()
    large = world.create(4, width=_TILES * _TILE_SIZE)
    coordinator.round()
    small = world.create(4, owner="other")
    world.run_until(lambda: world.row(small).state.ended)
    assert large not in coordinator.core.state.renders
    world.check_survived(small, large, seconds=300.0)


def test_a_small_film_is_done_while_a_large_one_gets_another_schedule(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """In the middle it is extended once more, and jobs and results of it are on the streams."""
    monkeypatch.setattr(film, "QUEUES_AT_ONCE", 1)
    world = World(settings=Settings(commit_seconds=0.1, audit_share=0.0, audit_share_new=0.0))
    coordinator = world.start()
    for _ in range(4):
        world.worker(delay=0.05)
    large = world.create(12, width=_TILES * _TILE_SIZE)
    world.run_until(lambda: len(world.store.stored[large].tiles) > _TILES // 2, 200.0)
    for samples in (14, 15):
        schedule = extended_schedule(world.row(large).schedule, samples)
        world.store.change(large, schedule=schedule)
        world.run_until(lambda: large not in coordinator.core.state.renders, 60.0)
    small = world.create(1)
    world.store.change(small, owner="another")
    world.run_until(lambda: world.row(small).state is RenderState.SUCCEEDED)
    assert large not in coordinator.core.state.renders
    world.check_survived(small, large, seconds=300.0)
    assert world.row(large).schedule.range_ends[-1] == 15


def test_a_large_film_that_ends_while_it_gets_another_schedule_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(film, "QUEUES_AT_ONCE", 1)
    world = World()
    coordinator = world.start()
    world.worker(delay=0.01)
    large = world.create(4, width=_TILES * _TILE_SIZE)
    world.run_until(lambda: len(world.store.stored[large].tiles) > 3, 200.0)
    fence = world.row(large).fence
    world.store.change(large, schedule=extended_schedule(world.row(large).schedule, 5))
    world.run_until(lambda: large not in coordinator.core.state.renders)
    world.store.change(large, state=RenderState.PAUSED)
    world.run(1.0)
    # Its lease is given back, and it may be taken up again.
    assert large not in coordinator.core.state.renders
    world.store.change(large, state=RenderState.QUEUED)
    world.check_survived(large, seconds=300.0)
    assert world.row(large).fence > fence


def test_renders_are_taken_up_for_a_while_then_others_get_their_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a flood of one owner some are started in each look, and who came in between is next."""
    monkeypatch.setattr(admission, "_ADMIT_SECONDS", -1.0)
    world = World()
    flood = [world.create(1) for _ in range(20)]
    coordinator = world.start()
    world.run_until(lambda: len(coordinator.core.state.renders) == 1)
    late = world.create(1)
    world.store.change(late, owner="another")
    world.run_until(lambda: late in coordinator.core.state.renders)
    assert len(coordinator.core.state.renders) <= 3
    world.worker()
    world.check_survived(*flood, late)
