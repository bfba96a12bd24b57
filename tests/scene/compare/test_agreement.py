"""Differences of images whose noise is made here, so that the right result is known. Fixed seeds."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.compare.agreement import Estimate, compare, compare_by_tiles, sidak
from nocturne_scene.compare.images import read_picture, write_difference
from nocturne_scene.errors import InputError

from tests.pictures import write_exr

SHAPE = (48, 48, 3)
SIGMA = 0.1


def noisy(seed: int, batches: int, factor: float = 1.0) -> Estimate:
    """The mean of some batches around 1, its variance from their scatter."""
    values = factor + SIGMA * np.random.default_rng(seed).standard_normal((batches, *SHAPE))
    return Estimate(values.mean(axis=0), values.var(axis=0, ddof=1) / batches, batches - 1)


def exact(value: float = 1.0) -> Estimate:
    return Estimate(np.full(SHAPE, value))


def test_sidak_is_the_chance_of_all_together() -> None:
    assert (1 - sidak(2304)) ** 2304 == pytest.approx(0.99, rel=1e-12)


@pytest.mark.parametrize("batches", [3, 16, 64])
def test_images_of_the_same_agree_however_few_batches_tell_the_noise(batches: int) -> None:
    """False alarms: 0.01 by the tiles and 0.008 by the means, for each case; those of pixels are rarer."""
    verdict = compare(noisy(1, batches), exact()).verdict
    assert verdict is not None
    assert verdict.pixels_agree
    assert verdict.sums_agree


def test_a_normal_distribution_would_not_do_for_few_batches() -> None:
    few = noisy(1, 3)
    verdict = compare(Estimate(few.mean, few.variance), exact()).verdict
    assert verdict is not None
    assert not verdict.pixels_agree


def test_one_percent_everywhere_is_seen_by_the_mean_and_not_by_the_pixels() -> None:
    """0.01 is 0.1 standard deviations of a batch: z of a pixel 0.4, of the mean 19."""
    verdict = compare(noisy(2, 16, 1.01), exact()).verdict
    assert verdict is not None
    assert verdict.pixels_agree
    assert np.all(verdict.mean_z > 10)
    assert not verdict.sums_agree


def test_a_wrong_patch_is_seen_by_the_tiles_and_the_pixels() -> None:
    estimate = noisy(3, 16)
    estimate.mean[8:24, 8:24] += 0.5
    verdict = compare(estimate, exact()).verdict
    assert verdict is not None
    assert verdict.share_explained == pytest.approx(1 - 256 / 2304, abs=0.001)
    assert verdict.largest_tile > 1


def test_without_noise_only_rounding_may_differ() -> None:
    still = Estimate(np.ones(SHAPE), np.zeros(SHAPE))
    same, other = compare(still, exact()), compare(still, exact(1.001))
    assert same.verdict is not None
    assert same.verdict.sums_agree
    assert other.verdict is not None
    assert not other.verdict.pixels_agree


def test_relmse_is_that_of_its_formula_and_trimming_takes_the_outlier() -> None:
    image = exact(1.1)
    image.mean[0, 0, 0] = 100.0
    found = compare(image, exact())
    per_value = 1.01  # 1 + a hundredth of the squared mean
    expected = (0.01 * (image.mean.size - 1) + 99.0**2) / per_value / image.mean.size
    assert found.relmse == pytest.approx(expected)
    assert found.trimmed_relmse == pytest.approx(0.01 / per_value)
    assert found.verdict is None
    assert found.ratio[1] == pytest.approx(1.1)


def test_shapes_must_be_the_same() -> None:
    with pytest.raises(ValueError, match="different shapes"):
        compare(exact(), Estimate(np.ones((4, 4, 3))))


def write(path: Path, names: str, values: list[float]) -> Path:
    return write_exr(path, np.tile(np.array(values), (2, 4, 1)), names)


def test_rgb_becomes_xyz(tmp_path: Path) -> None:
    """IEC 61966-2-1: white (1, 1, 1) is (0.9505, 1, 1.089)."""
    found = read_picture(write(tmp_path / "a.exr", "RGB", [1.0, 1.0, 1.0]))
    assert found.xyz[1, 3] == pytest.approx([0.9505, 1.0, 1.0890], abs=2e-4)
    assert read_picture(write(tmp_path / "b.exr", "XYZ", [0.1, 0.2, 0.3])).xyz[0, 0, 1] == pytest.approx(0.2)


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(b"hello")
    with pytest.raises(InputError, match="no image"):
        read_picture(tmp_path / "a.exr")
    with pytest.raises(InputError, match="expected channels"):
        read_picture(write(tmp_path / "b.exr", "AB", [0.0, 0.0]))
    with pytest.raises(InputError, match="not finite"):
        read_picture(write(tmp_path / "c.exr", "XYZ", [0.0, float("nan"), 0.0]))


def test_the_difference_is_red_where_it_is_brighter(tmp_path: Path) -> None:
    image = np.ones((2, 3))
    image[0, 0], image[0, 1] = 2.0, 0.0
    write_difference(tmp_path / "d.png", image, np.ones((2, 3)))
    pixels = oiio.ImageBuf(str(tmp_path / "d.png"))
    assert pixels.getpixel(0, 0) == pytest.approx([1, 0, 0])
    assert pixels.getpixel(1, 0) == pytest.approx([0, 0, 1])
    assert pixels.getpixel(2, 1) == pytest.approx([1, 1, 1])


def _silent(random: np.random.Generator, factor: float) -> Estimate:
    """128 x 128 pixels around `factor`; the noise of 3 x 3 goes together, as filters make it."""
    noise = random.standard_normal((130, 130, 3))
    smooth = sum(noise[row : row + 128, column : column + 128] for row in range(3) for column in range(3)) / 3
    return Estimate(factor + SIGMA * np.asarray(smooth))


def test_intervals_by_tiles_hold_where_one_image_does_not_state_its_noise() -> None:
    """Of 400 pairs 95 % within 1.96; noise that reaches into the neighbouring tile takes some of them. By the
    stated noise alone it would be a tenth."""
    random = np.random.default_rng(5)
    plain = Estimate(np.ones((128, 128, 3)), np.full((128, 128, 3), SIGMA**2 / 16))
    found = [compare_by_tiles(plain, _silent(random, 1.0)).by_tiles for _ in range(400)]
    z = np.array([each.mean_z[1] for each in found if each is not None])
    assert len(z) == 400
    assert 0.9 < np.mean(np.abs(z) < 1.96) < 0.98


def test_one_percent_is_seen_although_one_image_does_not_state_its_noise() -> None:
    """The noise of the mean is 0.1 x 3 / 128 = 0.23 %: 1.5 % are six of it."""
    random = np.random.default_rng(7)
    ours = 1 + SIGMA / 4 * random.standard_normal((128, 128, 3))
    variance = np.full(ours.shape, SIGMA**2 / 16)
    same = compare_by_tiles(Estimate(ours, variance), _silent(random, 1.0))
    other = compare_by_tiles(Estimate(ours + 0.015, variance), _silent(random, 1.0))
    assert same.verdict is None
    assert same.by_tiles is not None
    assert same.by_tiles.means_agree
    assert 0.03 < same.by_tiles.explained < 0.1  # 1/16 of sigma squared, of 17/16
    assert other.by_tiles is not None
    assert not other.by_tiles.means_agree


def test_few_tiles_say_nothing_of_an_unstated_noise() -> None:
    small = Estimate(np.ones((24, 24, 3)), np.full((24, 24, 3), 0.01))
    assert compare_by_tiles(small, Estimate(np.ones((24, 24, 3)))).by_tiles is None
