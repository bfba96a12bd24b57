"""The schedule covers every sample of every pixel once."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne.v1 import scene_pb2
from nocturne_coordinator.output.pictures import schedule_json
from nocturne_scene import limits
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError
from nocturne_scene.ranges import (
    MAX_PHOTON_RANGE,
    MAX_RANGE,
    PHOTON_BUNDLE,
    TILE_SIZE,
    ForwardPhotons,
    RangeList,
    TileGrid,
    extended_schedule,
    make_schedule,
    samples_of,
)
from nocturne_scene.scene_ranges import schedule_for_scene


def test_ranges_double_then_stay() -> None:
    assert list(make_schedule(8, 8, 64).range_ends) == [4, 8, 16, 32, 64]
    assert list(make_schedule(8, 8, 3).range_ends) == [3]
    assert list(make_schedule(8, 8, 20_000).range_ends)[-6:] == [2048, 4096, 8192, 12288, 16384, 20_000]


@given(samples=st.integers(1, 100_000))
def test_ranges_cover_all_samples_once(samples: int) -> None:
    ranges = RangeList(make_schedule(1, 1, samples).range_ends)
    following = 0
    for index in range(len(ranges)):
        planned = ranges[index]
        assert planned.first == following < planned.end <= planned.first + MAX_RANGE
        assert ranges.find(planned.first, planned.end) == planned
        assert ranges.merged_at(planned.end) == index + 1
        following = planned.end
    assert following == samples
    assert ranges.merged_at(0) == 0
    assert ranges.find(0, samples + 1) is None


@given(width=st.integers(1, 100), height=st.integers(1, 100))
def test_tiles_cover_all_pixels_once(width: int, height: int) -> None:
    grid = TileGrid.of(make_schedule(width, height, 1))
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
        ((-1, limits.MAX_FILM_EDGE + 1, 0), ["$.width", "$.height", "$.samples"]),
        ((limits.MAX_FILM_EDGE, limits.MAX_FILM_EDGE, 1), ["$.width"]),
        ((8, 8, limits.MAX_SAMPLES + 1), ["$.samples"]),
        ((8192, 8192, limits.MAX_SAMPLES), ["$.samples"]),
    ],
)
def test_a_film_out_of_bounds_is_refused_by_name(film: tuple[int, int, int], places: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        make_schedule(*film)
    assert [problem.place for problem in caught.value.problems] == places


def test_further_responses_make_smaller_tiles() -> None:
    sizes = {}
    for count in range(limits.MAX_FURTHER_RESPONSES + 1):
        schedule = make_schedule(70, 33, 20, [f"r{index}" for index in range(count)])
        assert len(schedule.further_responses) == count
        edge = schedule.tile_size
        assert 8 * (edge**2 * (9 + 2 * count) + (edge // 4) ** 2 + 1) <= 144 * 1024
        sizes[count] = schedule.tile_size
    assert (sizes[0], sizes[4], sizes[5], sizes[31], sizes[32], sizes[60]) == (32, 32, 16, 16, 8, 8)


def test_further_responses_leave_fewer_pixels() -> None:
    make_schedule(8192, 8192, 1)
    names = [f"r{index}" for index in range(9)]  # 27 sums instead of 9
    make_schedule(8192, 2730, 1, names)
    with pytest.raises(InputError) as caught:
        make_schedule(8192, 2731, 1, names)
    assert [problem.place for problem in caught.value.problems] == ["$.width"]


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["Y"], "'Y'"),
        (["n"], "'n'"),
        ([""], "''"),
        (["Y.stderr"], "'Y.stderr'"),
        (['"'], "letter"),
        (["a" * 32], "letter"),
        (["rod", "rod"], "two responses"),
        ([f"r{index}" for index in range(61)], "61 further responses"),
    ],
)
def test_names_that_no_channel_can_have_are_refused(names: list[str], said: str) -> None:
    with pytest.raises(InputError) as caught:
        make_schedule(8, 8, 1, names)
    assert [problem.place for problem in caught.value.problems] == ["$.scene"]
    assert said in caught.value.problems[0].message


def test_a_scene_says_how_its_film_is_cut(tmp_path: Path) -> None:
    scene = scene_pb2.CompiledScene()
    for name in ("rod", "far-red"):
        scene.sensor.further_responses.add(name=name, values=[0.0, 1.0])
    scene.tracing.group = 4
    blobs = BlobStore(tmp_path)
    schedule = schedule_for_scene(blobs, blobs.put(scene.SerializeToString()), 70, 33, 20)
    expected = make_schedule(70, 33, 20, ["rod", "far-red"], photons_per_sample=4)
    expected.quantity = "luminance"
    assert schedule == expected
    scene.tracing.direction = scene_pb2.DIRECTION_FORWARD
    schedule = schedule_for_scene(blobs, blobs.put(scene.SerializeToString()), 70, 33, 20)
    assert (len(schedule.range_ends), len(schedule.photon_range_ends)) == (0, 3)
    assert (schedule.tile_size, schedule.photons_per_sample) == (32, 4)


def test_the_plan_is_spelled_as_ever() -> None:
    assert schedule_json(make_schedule(8, 9, 6)) == '{"width":8,"height":9,"tileSize":32,"rangeEnds":[4,6]}'
    assert schedule_json(make_schedule(8, 9, 3, ["rod", "far-red"])) == (
        '{"width":8,"height":9,"tileSize":32,"rangeEnds":[3],"furtherResponses":["rod","far-red"]}'
    )


@given(width=st.integers(1, 4096), height=st.integers(1, 4096), samples=st.integers(1, 20_000))
def test_forward_photons_alone_have_ranges_that_are_all(width: int, height: int, samples: int) -> None:
    schedule = make_schedule(width, height, samples, forward_photons=ForwardPhotons.ALONE)
    assert schedule.tile_size == TILE_SIZE
    assert not schedule.range_ends
    lengths = np.diff([0, *schedule.photon_range_ends])
    assert 0 < lengths.min() <= lengths.max() <= MAX_PHOTON_RANGE
    photons = PHOTON_BUNDLE * schedule.photon_range_ends[-1]
    assert 0 <= photons - width * height * samples < PHOTON_BUNDLE
    assert samples_of(schedule) == photons // (width * height) >= samples
    more = extended_schedule(schedule, 2 * samples)
    assert list(more.photon_range_ends)[: len(lengths)] == list(schedule.photon_range_ends)
    assert samples_of(more) >= 2 * samples


def test_ranges_of_photons_are_shorter_on_small_films() -> None:
    """As long as those of tiles, up to films of 512 x 512; eight times as long from two million pixels on."""
    edges = {32: 2**8, 512: 2**8, 1024: 2**10, 1448: 2**11, 4096: 2**11}
    for edge, longest in edges.items():
        schedule = make_schedule(edge, edge, 2**36 // edge**2, forward_photons=ForwardPhotons.ALONE)
        assert np.diff(schedule.photon_range_ends).max() == longest
    assert 2**8 * PHOTON_BUNDLE == MAX_RANGE * TILE_SIZE**2


@given(width=st.integers(1, 4096), height=st.integers(1, 4096), samples=st.integers(1, 500))
def test_a_film_of_both_directions_has_tiles_and_ranges_of_photons(
    width: int, height: int, samples: int
) -> None:
    schedule = make_schedule(width, height, samples, forward_photons=ForwardPhotons.BESIDE)
    assert schedule.tile_size == TILE_SIZE
    assert schedule.range_ends == make_schedule(width, height, samples).range_ends
    lengths = np.diff([0, *schedule.photon_range_ends])
    assert 0 < lengths.min() <= lengths.max() <= MAX_PHOTON_RANGE
    photons = PHOTON_BUNDLE * schedule.photon_range_ends[-1]
    assert 0 <= photons - width * height * samples < PHOTON_BUNDLE
    text = json.loads(schedule_json(schedule))
    assert text["photonRangeEnds"] == list(schedule.photon_range_ends)


@given(
    width=st.integers(1, 512),
    height=st.integers(1, 512),
    samples=st.integers(1, 500),
    ratio=st.sampled_from([1 / 16, 0.25, 3.0, 8.0, 64.0]),
)
def test_forward_photons_that_are_not_as_many_as_adjoint_ones_have_ranges_on_any_film(
    width: int, height: int, samples: int, ratio: float
) -> None:
    schedule = make_schedule(
        width, height, samples, forward_photons=ForwardPhotons.BESIDE, forward_ratio=ratio
    )
    assert (schedule.tile_size, schedule.forward_ratio) == (TILE_SIZE, ratio)
    assert schedule.range_ends == make_schedule(width, height, samples).range_ends
    photons = PHOTON_BUNDLE * schedule.photon_range_ends[-1]
    assert 0 <= photons - ratio * width * height * samples < PHOTON_BUNDLE
    # More samples keep the ratio.
    more = extended_schedule(schedule, 2 * samples)
    photons = PHOTON_BUNDLE * more.photon_range_ends[-1]
    assert 0 <= photons - 2 * ratio * width * height * samples < PHOTON_BUNDLE


@pytest.mark.parametrize("film", [(16384, 1025), (4097, 4096)])
@pytest.mark.parametrize("photons", [ForwardPhotons.BESIDE, ForwardPhotons.ALONE])
def test_forward_photons_have_films_of_which_a_thread_can_hold_the_sums(
    film: tuple[int, int], photons: ForwardPhotons
) -> None:
    with pytest.raises(InputError, match=f"at most {4096**2}"):
        make_schedule(*film, 4, forward_photons=photons)


def test_more_samples_continue_the_ranges_of_photons() -> None:
    few = make_schedule(1920, 1080, 8, forward_photons=ForwardPhotons.BESIDE)
    more = extended_schedule(few, 64)
    before = list(few.photon_range_ends)
    assert list(more.photon_range_ends)[: len(before)] == before
    fresh = make_schedule(1920, 1080, 64, forward_photons=ForwardPhotons.BESIDE)
    assert more.photon_range_ends[-1] == fresh.photon_range_ends[-1]


def test_more_samples_than_ranges_of_photons_have_are_refused() -> None:
    with pytest.raises(InputError) as caught:
        make_schedule(512, 512, limits.MAX_SAMPLES, forward_photons=ForwardPhotons.ALONE)
    assert [problem.place for problem in caught.value.problems] == ["$.samples"]
