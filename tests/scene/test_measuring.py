"""Regions, lines, histograms and isolines of images, against numbers on paper and by drawing many images."""

import itertools
import math

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.isolines import BlockMeans, isolines
from nocturne_scene.photometry.measuring import Histogram, Measured, Measuring, as_csv, profile_as_csv
from nocturne_scene.photometry.outlines import Outline
from nocturne_scene.uncertainty import ImageMoments, moments_of

from tests import sums

Values = npt.NDArray[np.float64]

EDGE = 8
SAMPLES = 64


def image_of(samples: Values) -> ImageMoments:
    """`samples`: of Y, shape (samples, EDGE, EDGE); X is twice, Z three times that."""
    found = sums.sums_of(samples[..., None] * [2.0, 1.0, 3.0])
    counts = np.full((EDGE, EDGE), len(samples), dtype=np.uint32)
    return moments_of(found.pixels, counts, found.block_products, found.tile_products[None], EDGE)


def constant(y: Values) -> ImageMoments:
    return image_of(np.stack([y, y]))


def measured(image: ImageMoments, outline: Outline, index: int = 1) -> Measured:
    measuring = Measuring(outline, 3, index)
    measuring.add(image, 0, 0)
    found = measuring.measured()
    assert found is not None
    return found


def ramp() -> Values:
    """10 at the upper left, 1 more for each column, 8 more for each row."""
    return 10.0 + np.arange(EDGE * EDGE, dtype=np.float64).reshape(EDGE, EDGE)


WHOLE = Outline("rectangle", ((0, 0), (EDGE, EDGE)))


def test_a_rectangle_has_extremes_mean_and_uniformity() -> None:
    found = measured(constant(ramp()), Outline("rectangle", ((2, 1), (5, 3))))
    assert found.pixels == 6
    assert found.mean == pytest.approx((20 + 21 + 22 + 28 + 29 + 30) / 6)
    assert (found.minimum.x, found.minimum.y, found.minimum.value) == (2, 1, 20.0)
    assert (found.maximum.x, found.maximum.y, found.maximum.value) == (4, 2, 30.0)
    assert [found.u0, found.ud] == pytest.approx([20 / 25, 20 / 30])
    assert (found.mean_error, found.u0_error, found.ud_error) == (0.0, 0.0, 0.0)
    of_x = measured(constant(ramp()), Outline("rectangle", ((2, 1), (5, 3))), 0)
    assert [of_x.mean, of_x.u0] == pytest.approx([50.0, 0.8])


def test_parts_of_a_film_add_up_to_it() -> None:
    outline = Outline("polygon", ((1, 1), (7, 2), (4, 7)))
    halves = Measuring(outline, 3, 1)
    y = ramp()
    for top in (4, 0):
        found = sums.sums_of(np.stack([y, y])[:, top : top + 4, :, None] * [2.0, 1.0, 3.0])
        counts = np.full((4, EDGE), 2, dtype=np.uint32)
        halves.add(
            moments_of(found.pixels, counts, found.block_products, found.tile_products[None], 8), 0, top
        )
    assert halves.measured() == measured(constant(y), outline)


@pytest.mark.parametrize(
    ("points", "pixels"),
    [
        # Half of a square: its centres on the diagonal are on the edge and belong to one side.
        (((0, 0), (8, 0), (0, 8)), {28, 36}),
        (((2, 2), (6, 2), (6, 6), (2, 6)), {16}),
        # A square with a square hole, by one line that crosses itself.
        (((0, 0), (8, 0), (8, 8), (0, 8), (0, 0), (2, 2), (2, 6), (6, 6), (6, 2), (2, 2)), {48}),
    ],
)
def test_a_polygon_has_the_pixels_whose_centres_it_holds(
    points: tuple[tuple[float, float], ...], pixels: set[int]
) -> None:
    assert measured(constant(ramp()), Outline("polygon", points)).pixels in pixels


def test_a_line_has_its_pixels_in_order() -> None:
    found = measured(constant(ramp()), Outline("line", ((7, 7), (0, 0))))
    assert [(pixel.x, pixel.y) for pixel in found.profile] == [(k, k) for k in range(7, -1, -1)]
    assert [pixel.value for pixel in found.profile] == [10.0 + 9 * k for k in range(7, -1, -1)]
    assert found.pixels == 8
    text = profile_as_csv(found, "luminance", "cd/m2").splitlines()
    assert text[0] == "distance_pixels,x,y,luminance cd/m2,standard_error"
    assert text[2] == "1.4142136,6,6,64,0"


def test_errors_hold_for_images_that_are_drawn_again() -> None:
    """Uniformity of pixels that are far apart in brightness, so that the darkest is always the same."""
    rng = np.random.default_rng(5)
    y = ramp()
    y[3, 4] = 4.0
    found = [measured(image_of(y * rng.gamma(4.0, 0.25, (SAMPLES, EDGE, EDGE))), WHOLE) for _ in range(300)]
    for value, error in (("u0", "u0_error"), ("mean", "mean_error")):
        spread = np.std([getattr(each, value) for each in found])
        told = np.sqrt(np.mean([getattr(each, error) ** 2 for each in found]))
        # 300 draws know a spread to 4 %.
        assert told == pytest.approx(spread, rel=0.15)
    assert {(each.minimum.x, each.minimum.y) for each in found} == {(4, 3)}
    assert found[0].minimum.standard_error > 0.0


def test_one_pixel_is_even_without_doubt() -> None:
    rng = np.random.default_rng(6)
    found = measured(
        image_of(rng.gamma(4.0, 0.25, (SAMPLES, EDGE, EDGE))), Outline("rectangle", ((1, 1), (2, 2)))
    )
    assert (found.u0, found.ud) == (1.0, 1.0)
    assert [found.u0_error, found.ud_error] == pytest.approx([0.0, 0.0], abs=1e-7)


def test_what_is_not_known_is_said_so() -> None:
    once = measured(image_of(ramp()[None]), WHOLE)
    assert math.isnan(once.mean_error)
    assert math.isnan(once.u0_error)
    dark = measured(constant(np.zeros((EDGE, EDGE))), WHOLE)
    assert math.isnan(dark.u0)
    assert dark.zero_pixels == EDGE * EDGE
    table = as_csv([("=cmd", WHOLE, dark)], "luminance", "cd/m2").splitlines()
    assert table[0].startswith("name,kind,points,quantity,unit,pixels,mean,mean_error,")
    assert table[1] == '\'=cmd,rectangle,"0,0 8,8",luminance,cd/m2,64,0,0,0,0,0,0,0,0,0,0,,,,,64'


@pytest.mark.parametrize(
    ("outline", "message"),
    [
        (Outline("rectangle", ((0, 0), (9, 4))), "outside of the film"),
        (Outline("rectangle", ((0, 0), (math.nan, 4))), "outside of the film"),
        (Outline("rectangle", ((3, 3), (3, 5))), "no pixel has its centre"),
        (Outline("polygon", ((0, 0), (1, 1))), "2 points; a polygon has 3 to 256"),
        (Outline("line", ((0, 0), (8, 0))), "outside of the film"),
        (Outline("circle", ((0, 0), (8, 0))), "expected rectangle, polygon, line"),  # type: ignore[arg-type]
    ],
)
def test_what_is_no_part_of_the_film_is_refused(outline: Outline, message: str) -> None:
    with pytest.raises(InputError, match=message):
        outline.check(EDGE, EDGE)


def test_a_histogram_counts_every_pixel_once() -> None:
    linear = Histogram(10.0, 74.0, 4, logarithmic=False)
    linear.add(ramp().ravel())
    assert linear.counts.tolist() == [16, 16, 16, 16]
    logarithmic = Histogram(1.0, 100.0, 2, logarithmic=True)
    logarithmic.add(np.array([0.0, 0.5, 1.0, 9.9, 10.1, 100.0, 101.0]))
    assert (logarithmic.counts.tolist(), logarithmic.outside) == ([2, 2], 3)


# --- isolines ---


def test_the_isolines_of_a_cone_are_circles() -> None:
    y, x = np.mgrid[0:64, 0:64] + 0.5
    (line,) = isolines(np.hypot(x - 32, y - 32), 20.0)
    radius = [math.hypot(px - 32, py - 32) for px, py in line]
    # Linear interpolation between neighbours of a cone errs by less than 1 / (8 r).
    assert radius == pytest.approx([20.0] * len(radius), abs=1 / (8 * 20.0))
    assert line[0] == line[-1]
    length = sum(math.dist(a, b) for a, b in itertools.pairwise(line))
    assert length == pytest.approx(2 * math.pi * 20.0, rel=0.01)


def test_an_isoline_of_a_slope_goes_from_border_to_border() -> None:
    values = np.broadcast_to(np.arange(6.0), (4, 6))
    (line,) = isolines(values, 2.25)
    assert sorted(line) == [(2.75, 0.5), (2.75, 1.5), (2.75, 2.5), (2.75, 3.5)]
    assert line in (sorted(line), sorted(line, reverse=True))


def test_a_saddle_is_parted_by_its_middle() -> None:
    bright = isolines(np.array([[4.0, 0.0], [0.0, 4.0]]), 1.0)
    dark = isolines(np.array([[4.0, 0.0], [0.0, 4.0]]), 3.0)
    assert len(bright) == len(dark) == 2
    # Where the middle is above the level, lines go around the dark corners; where it is below, around the
    # bright.
    assert {min(math.dist(point, (1.5, 0.5)) for point in line) for line in bright} == {0.25, 1.25}
    assert {min(math.dist(point, (0.5, 0.5)) for point in line) for line in dark} == {0.25, 1.25}


def test_what_has_no_samples_has_no_isolines() -> None:
    values = np.broadcast_to(np.arange(6.0), (4, 6)).copy()
    values[1:] = math.nan
    assert isolines(values, 2.25) == []


def test_blocks_are_means_in_pixels_of_the_film() -> None:
    blocks = BlockMeans(40, 20, max_edge=10)
    y = np.broadcast_to(np.arange(40.0), (20, 40))
    for top in range(0, 20, 5):
        blocks.add(y[top : top + 5, :22], np.zeros((5, 22)), np.ones((5, 22), dtype=np.bool_), 0, top)
        blocks.add(y[top : top + 5, 22:], np.zeros((5, 18)), np.ones((5, 18), dtype=np.bool_), 22, top)
    assert (blocks.edge, blocks.means().shape) == (4, (5, 10))
    (line,) = blocks.isolines(17.0)
    # The pixel in column i has the value i at its middle, i + 0.5.
    assert [x for x, _ in line] == pytest.approx([17.5] * 5)
    assert sorted(y for _, y in line) == [2.0, 6.0, 10.0, 14.0, 18.0]


def test_blocks_grow_until_they_are_calm() -> None:
    """A relative error of 10 % of pixels is 2.5 % of 4 x 4 of them."""
    blocks = BlockMeans(250, 130)
    y = np.full((130, 250), 7.0)
    blocks.add(y, (0.1 * y) ** 2, np.ones(y.shape, dtype=np.bool_), 0, 0)
    blocks.calm()
    assert (blocks.edge, blocks.means().shape) == (4, (33, 63))
    assert blocks.means() == pytest.approx(np.full((33, 63), 7.0))


def test_noise_has_too_many_isolines() -> None:
    noise = np.random.default_rng(1).random((300, 300))
    with pytest.raises(InputError, match="too noisy"):
        isolines(noise, 0.5)
