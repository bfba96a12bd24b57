"""Images: right numbers, canonical files."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_coordinator.dispatch.error_estimate import Squares, estimate_error
from nocturne_coordinator.dispatch.merge import Counts, Sums
from nocturne_coordinator.output.images import (
    FINAL_COMPRESSION,
    LIVE_COMPRESSION,
    Provenance,
    tone_map,
    write_image,
    write_preview,
    write_thumbnail,
)
from nocturne_scene.pixel_errors import pixel_variance, variance_of_mean
from nocturne_scene.render_warnings import RenderWarning, UnmetPart, WarningKind
from nocturne_scene.spectra.wavelength_range import WavelengthRange
from nocturne_scene.tile_sums import Values, block_sums

from tests.coordinator.service import read_exr, read_further_responses, read_rgb
from tests.sums import sums_of

PROVENANCE = Provenance("5c" * 32, '{"width":9}', 1, quantity="luminance")


def film(samples: int = 10, further: int = 0) -> tuple[Sums, Counts]:
    draws = np.random.default_rng(1).random((samples, 7, 9, 3 + further)) * 50
    return sums_of(draws).pixels, np.full((7, 9), samples, dtype=np.uint32)


SQUARES = Squares(np.zeros((2, 3, 6)), np.zeros((1, 1, 6)), 32)
"""Of a film whose blocks nobody looks at."""


def variance_of_y(sums: Sums, counts: Counts) -> Values:
    return pixel_variance(sums[..., 1], sums[..., 3], counts)


def with_one_more(draws: Values) -> Values:
    """Variances of the means of pixels, from numbers of shape (samples, height, width). One more lit sample
    of the block is added, computed from the samples themselves; it adds less the more lit samples a pixel
    has."""
    own = draws.var(axis=0, ddof=1) / len(draws)
    variance: Values = own.copy()
    own_finds = draws.sum(axis=0) ** 2 / (draws**2).sum(axis=0)
    for y in range(0, variance.shape[0], 4):
        for x in range(0, variance.shape[1], 4):
            of_block = draws[:, y : y + 4, x : x + 4]
            finds = of_block.sum() ** 2 / (of_block**2).sum()
            one_more = own[y : y + 4, x : x + 4].sum() / finds
            variance[y : y + 4, x : x + 4] += one_more / own_finds[y : y + 4, x : x + 4]
    return variance


def test_variance_is_that_of_the_mean() -> None:
    draws = np.random.default_rng(1).random((10, 7, 9, 3)) * 50
    sums, counts = film()
    expected = draws[..., 1].var(axis=0, ddof=1) / 10
    assert variance_of_mean(sums[..., 1], sums[..., 3], counts) == pytest.approx(expected)
    assert variance_of_y(sums, counts) == pytest.approx(with_one_more(draws[..., 1]))
    y = draws[..., 1].mean(axis=0)
    relative_variance = expected / (y**2 + 0.01 * y.mean() ** 2)
    assert estimate_error(*film()).relative_error == pytest.approx(np.sqrt(relative_variance.mean()))


def test_one_sample_has_no_error_yet() -> None:
    sums, counts = film(1)
    assert not variance_of_y(sums, counts).any()
    assert estimate_error(sums, counts).relative_error == 0.0


@pytest.mark.parametrize("count", [0, 1, 2**24 + 1, 3 * 2**20 + 1, 2**31, 2**32 - 1])
def test_exr_keeps_every_bit(tmp_path: Path, count: int) -> None:
    sums, counts = film()
    counts[2, 3] = count
    path = tmp_path / "image.exr"
    write_image(path, sums, counts, SQUARES, PROVENANCE)
    xyz, stderr, read_counts = read_exr(path)
    assert np.array_equal(read_counts, counts)
    assert np.array_equal(xyz, (sums[..., :3] / np.maximum(counts, 1)[..., None]).astype(np.float32))
    assert np.array_equal(stderr, np.sqrt(variance_of_y(sums, counts)).astype(np.float32))
    assert [path.name for path in path.parent.iterdir()] == ["image.exr"]


def test_exr_says_its_wavelengths(tmp_path: Path) -> None:
    """Those of the scene, and the unit of what takes the place of Y."""
    in_infrared = replace(
        PROVENANCE, wavelengths=WavelengthRange(900.0, 1700.0), quantity="photon flux density"
    )
    for name, provenance in (("usual.exr", PROVENANCE), ("infrared.exr", in_infrared)):
        write_image(tmp_path / name, *film(), SQUARES, provenance)
    with OpenEXR.File(str(tmp_path / "usual.exr"), header_only=True) as file:
        assert file.header()["nocturne:wavelengths"] == "360 to 830 nm"
    with OpenEXR.File(str(tmp_path / "infrared.exr"), header_only=True) as file:
        assert file.header()["nocturne:wavelengths"] == "900 to 1700 nm"
        assert file.header()["nocturne:unit"] == "umol m-2 s-1"
        assert "whiteLuminance" not in file.header()


def test_exr_says_what_it_may_not_show_in_lines(tmp_path: Path) -> None:
    parts = (UnmetPart(0, 4, 8, 3, 0.25), UnmetPart(8, 0, 1, 7, 31.6228))
    warnings = (
        RenderWarning(WarningKind.MISSING_LIGHT, "up to 2% of the mean may be missing"),
        RenderWarning(WarningKind.MISSING_IN_PARTS, "light may be missing at pixels", parts),
    )
    write_image(tmp_path / "image.exr", *film(), SQUARES, replace(PROVENANCE, warnings=warnings))
    write_image(tmp_path / "plain.exr", *film(), SQUARES, PROVENANCE)
    with (
        OpenEXR.File(str(tmp_path / "image.exr")) as image,
        OpenEXR.File(str(tmp_path / "plain.exr")) as plain,
    ):
        told = image.header()
        assert told["nocturne:warnings"].splitlines() == [each.sentence for each in warnings]
        assert told["nocturne:unmetParts"].splitlines() == ["0 4 8 3 0.25", "8 0 1 7 31.6"]
        assert not {"nocturne:warnings", "nocturne:unmetParts"} & plain.header().keys()


def test_exr_has_channels_for_each_further_response(tmp_path: Path) -> None:
    sums, counts = film(further=2)
    write_image(tmp_path / "image.exr", sums, counts, SQUARES, PROVENANCE, ("rod", "A-far_red"))
    read = read_further_responses(tmp_path / "image.exr")
    assert sorted(read) == ["A-far_red", "rod"]
    n = counts.astype(np.float64)
    assert np.array_equal(read["rod"], (sums[..., 9] / n).astype(np.float32))
    assert np.array_equal(read["A-far_red"], (sums[..., 10] / n).astype(np.float32))
    xyz, stderr, read_counts = read_exr(tmp_path / "image.exr")
    assert np.array_equal(xyz, (sums[..., :3] / n[..., None]).astype(np.float32))
    assert np.array_equal(stderr, np.sqrt(variance_of_y(sums, counts)).astype(np.float32))
    assert np.array_equal(read_counts, counts)


def test_exr_has_the_errors_of_all_quantities(tmp_path: Path) -> None:
    """What numpy says of the samples that were drawn."""
    draws = np.random.default_rng(1).random((10, 7, 9, 4))
    draws[..., 2] += draws[..., 0]
    sums = sums_of(draws)
    squares = Squares(sums.block_products, sums.tile_products[None], 32)
    path = tmp_path / "image.exr"
    write_image(path, sums.pixels, np.full((7, 9), 10, np.uint32), squares, PROVENANCE, ("rod",))
    with OpenEXR.File(str(path), separate_channels=True) as file:
        read = {name: channel.pixels for name, channel in file.channels().items()}
    for index, name in enumerate(("X", "Y", "Z", "rod")):
        error = np.sqrt(with_one_more(draws[..., index]))
        assert read[f"{name}.stderr"] == pytest.approx(error, rel=1e-6)
    for name, one, other in (("XY", 0, 1), ("XZ", 0, 2), ("YZ", 1, 2)):
        expected = [
            [np.corrcoef(draws[:, y, x, one], draws[:, y, x, other])[0, 1] for x in range(9)]
            for y in range(7)
        ]
        assert read[f"{name}.correlation"] == pytest.approx(np.array(expected), abs=1e-5)
    together = np.array([block_sums(each) for each in draws[..., :3]])
    for index, name in enumerate("XYZ"):
        blocks = together[..., index]
        of_pixels = block_sums(draws[..., index].var(axis=0, ddof=1))
        found = read[f"{name}.blockRatio"]
        assert found[::4, ::4] == pytest.approx(blocks.var(axis=0, ddof=1) / of_pixels, rel=1e-5)
        assert (found[:4, 4:8] == found[0, 4]).all()
        of_all = with_one_more(draws[..., index])
        own = draws[..., index].var(axis=0, ddof=1) / 10
        assert read[f"{name}.ownRatio"] == pytest.approx(own / of_all, rel=1e-5)
        tile = blocks.sum(axis=(1, 2)).var(ddof=1) / blocks.var(axis=0, ddof=1).sum()
        assert read[f"{name}.tileRatio"] == pytest.approx(tile, rel=1e-5)
    for name, one, other in (("XY", 0, 1), ("XZ", 0, 2), ("YZ", 1, 2)):
        expected = [
            [np.corrcoef(together[:, y, x, one], together[:, y, x, other])[0, 1] for x in range(3)]
            for y in range(2)
        ]
        assert read[f"{name}.blockCorrelation"][::4, ::4] == pytest.approx(np.array(expected), abs=1e-5)


def test_exr_has_linear_srgb_for_viewers(tmp_path: Path) -> None:
    sums, counts = film(1)
    # White of IEC 61966-2-1 at 100 cd/m2, and its red primary at 1 cd/m2.
    sums[0, 0, :3] = np.array([0.9505, 1.0, 1.0890]) * 100
    sums[0, 1, :3] = [0.4124 / 0.2126, 1.0, 0.0193 / 0.2126]
    write_image(tmp_path / "image.exr", sums, counts, SQUARES, PROVENANCE)
    rgb = read_rgb(tmp_path / "image.exr")
    # The standard gives its matrices to four digits.
    assert rgb[0, 0] == pytest.approx([100] * 3, abs=0.02)
    assert rgb[0, 1] == pytest.approx([1 / 0.2126, 0, 0], abs=0.002)


def test_a_response_named_as_a_colour_is_itself(tmp_path: Path) -> None:
    sums, counts = film(1, further=1)
    sums[..., 9] = 5.0
    write_image(tmp_path / "image.exr", sums, counts, SQUARES, PROVENANCE, ("R",))
    with OpenEXR.File(str(tmp_path / "image.exr"), separate_channels=True) as file:
        assert sorted(name for name in file.channels() if "." not in name) == ["R", "X", "Y", "Z", "n"]
        assert (file.channels()["R"].pixels == 5.0).all()


def test_an_image_that_can_not_be_written_is_an_os_error(tmp_path: Path) -> None:
    (tmp_path / "image.exr").mkdir()
    with pytest.raises(OSError, match=r"image\.exr"):
        write_image(tmp_path / "image.exr", *film(), SQUARES, PROVENANCE)


def test_exr_says_what_it_is(tmp_path: Path) -> None:
    write_image(tmp_path / "image.exr", *film(), SQUARES, PROVENANCE)
    image: Any = oiio.ImageInput.open(str(tmp_path / "image.exr"))
    said = {attribute.name: attribute.value for attribute in image.spec().extra_attribs}
    image.close()
    assert said["whiteLuminance"] == 1.0
    assert said["chromaticities"] == pytest.approx((0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290))
    assert (said["nocturne:scene"], said["nocturne:schedule"]) == ("5c" * 32, '{"width":9}')
    assert said["nocturne:engine"] == 1
    assert "DateTime" not in said


def test_equal_images_are_equal_files(tmp_path: Path) -> None:
    write_image(tmp_path / "a.exr", *film(), SQUARES, PROVENANCE)
    write_preview(tmp_path / "a.png", *film(), FINAL_COMPRESSION)
    time.sleep(1.1)
    write_image(tmp_path / "b.exr", *film(), SQUARES, PROVENANCE)
    write_preview(tmp_path / "b.png", *film(), FINAL_COMPRESSION)
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_picture_beside_another_is_exposed_as_that_one() -> None:
    sums, counts = film()
    true = tone_map(sums, counts)
    assert np.abs(tone_map(2.0 * sums, counts).astype(int) - true).max() <= 1
    beside = (sums[..., 1] / counts).astype(np.float32)
    assert np.array_equal(tone_map(sums, counts, beside), true)
    assert tone_map(2.0 * sums, counts, beside).mean() > true.mean() + 10


def test_live_and_final_previews_show_the_same(tmp_path: Path) -> None:
    for compression in (LIVE_COMPRESSION, FINAL_COMPRESSION):
        write_preview(tmp_path / "preview.png", *film(), compression)
        image: Any = oiio.ImageInput.open(str(tmp_path / "preview.png"))
        assert np.array_equal(image.read_image("uint8"), tone_map(*film()))
        image.close()


def test_tone_mapping_keeps_neutral_and_order() -> None:
    sums = np.zeros((2, 100, 4))
    # D65, from dark to bright; the second row has other counts and the same means.
    sums[..., :3] = (
        np.array([0.9505, 1.0, 1.0888]) * np.concatenate([[0], np.geomspace(0.1, 1e4, 99)])[:, None]
    )
    counts = np.array([[1] * 100, [3] * 100], dtype=np.uint32)
    sums[1] *= 3
    shown = tone_map(sums, counts).astype(int)
    assert np.array_equal(shown[0], shown[1])
    assert np.all(np.ptp(shown, axis=-1) <= 1)
    assert np.all(np.diff(shown[0, :, 1]) >= 0)
    assert shown[0, 0, 1] == 0
    assert shown[0, -1, 1] > 240


def test_a_black_or_empty_film_is_black() -> None:
    assert not tone_map(np.zeros((4, 4, 4)), np.zeros((4, 4), dtype=np.uint32)).any()
    assert not tone_map(np.zeros((4, 4, 4)), np.ones((4, 4), dtype=np.uint32)).any()


def test_spread_of_even_noise_and_of_one_firefly() -> None:
    """Where all pixels have one variance, all carry the error; one that has nearly all of it carries it
    alone."""
    counts = np.full((40, 50), 4, dtype=np.uint32)
    sums = np.zeros((40, 50, 4))
    sums[..., :3] = 4.0
    sums[..., 3] = 4.0 + 12.0 * 0.01
    even = estimate_error(sums, counts)
    assert even.relative_error == pytest.approx(np.sqrt(0.01 / 1.01), rel=1e-9)
    assert even.effective_pixels == pytest.approx(2000.0)
    assert even.top_percent_share == pytest.approx(0.01)
    sums[7, 9, 3] += 1e6
    spoiled = estimate_error(sums, counts)
    assert spoiled.effective_pixels == pytest.approx(1.0, abs=0.01)
    assert spoiled.top_percent_share == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("kind", ["heavy", "mostly none", "where they are looked for", "equal"])
def test_the_worst_pixels_of_a_large_film(kind: str) -> None:
    """Those that sorting all of them finds, wherever they lie."""
    numbers = np.random.default_rng(7).exponential(size=400 * 500) ** 3
    if kind == "mostly none":
        numbers[3000:] = 0.0
    if kind == "where they are looked for":
        numbers[:: numbers.size // 2**14] += 1000.0
    if kind == "equal":
        numbers[:] = 0.25
    counts = np.full((400, 500), 4, dtype=np.uint32)
    sums = np.zeros((400, 500, 4))
    sums[..., :3] = 4.0
    sums[..., 3] = 4.0 + 12.0 * numbers.reshape(counts.shape)
    worst = np.sort(numbers)[-numbers.size // 100 :].sum() / numbers.sum()
    assert estimate_error(sums, counts).top_percent_share == pytest.approx(worst, rel=1e-9)


def test_the_error_is_unknown_below_two_samples_and_in_the_dark() -> None:
    counts = np.ones((4, 4), dtype=np.uint32)
    once = estimate_error(np.ones((4, 4, 4)), counts)
    assert (once.relative_error, once.effective_pixels, once.mean, once.zero_pixels) == (
        0.0,
        0.0,
        1.0,
        0,
    )
    dark = estimate_error(np.zeros((4, 4, 4)), counts + 7)
    assert (dark.relative_error, dark.mean, dark.mean_error, dark.zero_pixels) == (0.0, 0.0, 0.0, 16)


def test_the_means_error_is_that_of_independent_pixels() -> None:
    sums, counts = film()
    estimate = estimate_error(sums, counts)
    assert estimate.mean == pytest.approx(sums[..., 1].sum() / counts.sum())
    assert estimate.mean_error == pytest.approx(
        np.sqrt(variance_of_mean(sums[..., 1], sums[..., 3], counts).sum()) / 63
    )


def test_a_thumbnail_has_the_films_shape_and_its_mean_light(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    sums = rng.gamma(2.0, 1.0, (500, 330, 5))
    counts = np.full((500, 330), 3, dtype=np.uint32)
    write_thumbnail(tmp_path / "t.png", sums, counts)
    spec = oiio.ImageBuf(str(tmp_path / "t.png")).spec()
    assert (spec.width, spec.height) == (82, 125)
    write_thumbnail(tmp_path / "t.png", sums[:1, :7], counts[:1, :7])
    spec = oiio.ImageBuf(str(tmp_path / "t.png")).spec()
    assert (spec.width, spec.height) == (7, 1)
