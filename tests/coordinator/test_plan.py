"""The plan covers every sample of every pixel once."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne_coordinator import limits
from nocturne_coordinator.errors import InputError
from nocturne_coordinator.plan import LONGEST_RANGE, RangeList, TileGrid, make_plan


def test_ranges_double_then_stay() -> None:
    assert list(make_plan(8, 8, 64).range_ends) == [4, 8, 16, 32, 64]
    assert list(make_plan(8, 8, 3).range_ends) == [3]
    assert list(make_plan(8, 8, 20_000).range_ends)[-6:] == [2048, 4096, 8192, 12288, 16384, 20_000]


@given(samples=st.integers(1, 100_000))
def test_ranges_cover_all_samples_once(samples: int) -> None:
    ranges = RangeList(make_plan(1, 1, samples))
    following = 0
    for index in range(len(ranges)):
        planned = ranges[index]
        assert planned.first == following < planned.end <= planned.first + LONGEST_RANGE
        assert ranges.find(planned.first, planned.end) == planned
        assert ranges.merged_at(planned.end) == index + 1
        following = planned.end
    assert following == samples
    assert ranges.merged_at(0) == 0
    assert ranges.find(0, samples + 1) is None


@given(width=st.integers(1, 100), height=st.integers(1, 100))
def test_tiles_cover_all_pixels_once(width: int, height: int) -> None:
    grid = TileGrid.of(make_plan(width, height, 1))
    pixels = [
        (x, y)
        for tile in map(grid.tile, range(grid.count))
        for y in range(tile.y, tile.y + tile.height)
        for x in range(tile.x, tile.x + tile.width)
    ]
    assert len(pixels) == width * height
    assert set(pixels) == {(x, y) for x in range(width) for y in range(height)}


@pytest.mark.parametrize(
    ("film", "places"),
    [
        ((0, 5, 5), ["$.width"]),
        ((-1, limits.MAXIMUM_FILM_EDGE + 1, 0), ["$.width", "$.height", "$.samples"]),
        ((limits.MAXIMUM_FILM_EDGE, limits.MAXIMUM_FILM_EDGE, 1), ["$.width"]),
        ((8, 8, limits.MAXIMUM_SAMPLES + 1), ["$.samples"]),
        ((8192, 8192, limits.MAXIMUM_SAMPLES), ["$.samples"]),
    ],
)
def test_a_film_out_of_bounds_is_refused_by_name(film: tuple[int, int, int], places: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        make_plan(*film)
    assert [problem.place for problem in caught.value.problems] == places
