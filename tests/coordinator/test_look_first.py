"""A part of the film that goes first: its tiles, and the jobs that are published then."""

import pytest
from nocturne_coordinator.dispatch.range_queue import RangeQueue
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.scheduler import Scheduler
from nocturne_scene.errors import InputError
from nocturne_scene.ranges import TileGrid

GRID = TileGrid(100, 70, 32)
"""Four columns, three rows."""


@pytest.mark.parametrize(
    ("region", "tiles"),
    [
        (Region(0, 0, 1, 1), {0}),
        (Region(31, 31, 2, 2), {0, 1, 4, 5}),
        (Region(64, 32, 32, 32), {6}),
        (Region(99, 69, 1, 1), {11}),
        (Region(0, 0, 100, 70), set(range(12))),
    ],
)
def test_tiles_of_a_region(region: Region, tiles: set[int]) -> None:
    assert region.tiles(GRID) == tiles
    assert Region.from_json(region.to_json()) == region


@pytest.mark.parametrize(
    "region", [Region(0, 0, 0, 1), Region(-1, 0, 2, 2), Region(0, 0, 101, 1), Region(99, 69, 1, 2)]
)
def test_a_region_outside_the_film(region: Region) -> None:
    with pytest.raises(InputError):
        region.check(100, 70)


def _taken(scheduler: Scheduler, count: int) -> list[tuple[int, int]]:
    """Range and tile of the jobs, which are published."""
    found = []
    for key in scheduler.take(count):
        scheduler.published(key, b"%d-%d" % (key.range_index, key.tile_index), 0.0)
        found.append((key.range_index, key.tile_index))
    return found


def test_the_whole_frame_once_and_then_what_was_asked_for() -> None:
    scheduler = Scheduler()
    scheduler.add("a", [RangeQueue(bytearray(3)) for _ in range(4)])
    scheduler.set_first("a", frozenset({2}))
    assert _taken(scheduler, 8) == [(0, 0), (0, 1), (0, 2), (0, 3), (1, 2), (2, 2), (1, 0), (2, 0)]


def test_asking_in_the_middle_and_taking_it_back() -> None:
    """Nothing is lost and nothing comes twice, whenever the wish changes."""
    scheduler = Scheduler()
    scheduler.add("a", [RangeQueue(bytearray(3)) for _ in range(4)])
    taken = _taken(scheduler, 5)
    scheduler.set_first("a", frozenset({3}))
    taken += _taken(scheduler, 2)
    assert taken[-2:] == [(1, 3), (2, 3)]
    scheduler.set_first("a", frozenset())
    taken += _taken(scheduler, 20)
    assert sorted(taken) == [(index, tile) for index in range(3) for tile in range(4)]
    assert taken[7] == (2, 0)
