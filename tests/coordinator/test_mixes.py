"""Mixes of light groups are the images that their samples would have made, with the errors of these."""

import json
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from nocturne_client.cli.app import app
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_coordinator.output.mixes import MIX, write_mix
from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.responses import group_channels
from nocturne_scene.tile_sums import TileSums, factors_of_tile
from numpy.typing import NDArray
from typer.testing import CliRunner

from tests.coordinator.service import read_channel

_GROUPS = ("desk", "windows", "rest")
_NAMES = [name for group in _GROUPS for name in group_channels(group)]
_SIZE, _SAMPLES = 4, 20_000


def _samples() -> NDArray[np.float64]:
    """Of each pixel X, Y, Z of three groups, shape (samples, 8, 8, groups, 3): two that are lit by turns, as
    a photon is sent to one of them, and one that goes with the first."""
    chance = np.random.default_rng(3)
    turns = chance.random((_SAMPLES, _SIZE, _SIZE)) < 0.4
    strength = chance.random((_SAMPLES, _SIZE, _SIZE))
    desk, windows = np.where(turns, 5.0 * strength, 0.0), np.where(turns, 0.0, 3.0)
    y = np.stack([desk, windows, 0.5 * desk + 0.1], axis=-1)
    # Warm and cold by wavelength, as a photon has one.
    colour = np.where(
        (chance.random((_SAMPLES, _SIZE, _SIZE)) < 0.5)[..., None], [1.5, 1.2, 0.1], [0.3, 0.8, 1.3]
    )
    return np.asarray(y[..., None] * colour[..., None, :], dtype=np.float64)


def _write(path: Path, samples: NDArray[np.float64]) -> None:
    whole, further = samples.sum(axis=3), samples.reshape(*samples.shape[:3], 9)
    sums = TileSums.zeros(_SIZE, _SIZE, len(_NAMES))
    x, y_, z = np.moveaxis(whole, -1, 0)
    of_sample = np.stack([x, y_, z, y_ * y_, x * x, z * z, x * y_, x * z, y_ * z], axis=-1)
    sums.pixels[...] = np.concatenate([of_sample, further, np.square(further)], axis=-1).sum(axis=0)
    of_tile = np.concatenate([whole, further], axis=-1).sum(axis=(1, 2))
    one, other = factors_of_tile(len(_NAMES))
    sums.tile_products[0] = (of_tile[:, one] * of_tile[:, other]).sum(axis=0)
    counts = np.full((_SIZE, _SIZE), _SAMPLES, dtype=np.uint32)
    squares = Squares(sums.block_products, sums.tile_products[None], _SIZE)
    schedule = json.dumps({"tileSize": _SIZE, "furtherResponses": _NAMES})
    write_image(
        path, sums.pixels, counts, squares, Provenance("0" * 64, schedule, 2, quantity="illuminance"), _NAMES
    )


@pytest.mark.parametrize(
    "factors", [{}, {"desk": 0.3}, {"windows": 2.0, "rest": 0.0}, {"desk": 0.5, "windows": 0.5, "rest": 0.5}]
)
def test_a_mix_is_what_its_samples_make(tmp_path: Path, factors: dict[str, float]) -> None:
    samples = _samples()
    _write(tmp_path / "image.exr", samples)
    write_mix(tmp_path / "image.exr", tmp_path / "mix.exr", factors)
    weights = np.array([factors.get(group, 1.0) for group in _GROUPS])
    mixed = np.einsum("nhwgc,g->nhwc", samples, weights)
    error = mixed.std(axis=0, ddof=1) / np.sqrt(_SAMPLES)
    for index, axis in enumerate("XYZ"):
        assert read_channel(tmp_path / "mix.exr", axis) == pytest.approx(
            mixed.mean(axis=0)[..., index], rel=1e-5
        )
        told = read_channel(tmp_path / "mix.exr", f"{axis}.stderr")
        # Covariances are those of the tile's totals, whose own scatter is 1 / sqrt(20000); one more lit
        # sample adds less than a thousandth.
        assert told == pytest.approx(error[..., index], rel=0.03)
        assert np.square(told).sum() == pytest.approx(np.square(error[..., index]).sum(), rel=0.03)
    for pair, (one, other) in {"XY": (0, 1), "XZ": (0, 2), "YZ": (1, 2)}.items():
        deviations = mixed - mixed.mean(axis=0)
        covariance = (deviations[..., one] * deviations[..., other]).mean(axis=0) / _SAMPLES
        correlation = covariance / (error[..., one] * error[..., other])
        for channel in ("correlation", "blockCorrelation"):
            told = read_channel(tmp_path / "mix.exr", f"{pair}.{channel}")
            assert told.mean() == pytest.approx(correlation.mean(), abs=0.05)


def test_what_groups_have_in_common_counts(tmp_path: Path) -> None:
    """Without covariances errors are wrong to both sides: of lights by turns, of lights that go together."""
    samples = _samples()
    _write(tmp_path / "image.exr", samples)
    apart = {group: read_channel(tmp_path / "image.exr", f"{group}.Y.stderr") for group in _GROUPS}
    for kept, together in ((("desk", "windows"), False), (("desk", "rest"), True)):
        others = dict.fromkeys(set(_GROUPS) - set(kept), 0.0)
        write_mix(tmp_path / "image.exr", tmp_path / "mix.exr", others)
        told = read_channel(tmp_path / "mix.exr", "Y.stderr").mean()
        alone = np.hypot(apart[kept[0]], apart[kept[1]]).mean()
        assert told > 1.2 * alone if together else told < 0.9 * alone


def test_a_mix_is_an_image_like_any(tmp_path: Path) -> None:
    _write(tmp_path / "image.exr", _samples())
    write_mix(tmp_path / "image.exr", tmp_path / "mix.exr", {"desk": 0.25})
    picture = read_picture(tmp_path / "mix.exr")
    assert picture.moments is not None
    assert picture.names == ("X", "Y", "Z")
    with OpenEXR.File(str(tmp_path / "mix.exr")) as file:
        header = dict(file.header())
    assert header[MIX] == '{"desk": 0.25, "rest": 1.0, "windows": 1.0}'
    assert header["nocturne:quantity"] == "illuminance"


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ({"doors": 1.0}, "there is no light group 'doors'; expected desk, rest, windows"),
        ({"rest": -1.0}, "rest = -1; expected a factor from 0 to 1e+06"),
        ({"rest": float("nan")}, "rest = nan; expected a factor from 0 to 1e+06"),
    ],
)
def test_factors_that_make_no_mix_are_refused(
    tmp_path: Path, factors: dict[str, float], message: str
) -> None:
    _write(tmp_path / "image.exr", _samples())
    with pytest.raises(InputError) as refused:
        write_mix(tmp_path / "image.exr", tmp_path / "mix.exr", factors)
    assert refused.value.problems[0].message == message
    assert not (tmp_path / "mix.exr").exists()


def test_the_command_writes_the_mix_or_says_why_not(tmp_path: Path) -> None:
    _write(tmp_path / "image.exr", _samples())
    words = ["mix", str(tmp_path / "image.exr"), "-o", str(tmp_path / "mix.exr"), "--group"]
    done = CliRunner().invoke(app, [*words, "desk=0.5"])
    assert done.exit_code == 0, done.output
    write_mix(tmp_path / "image.exr", tmp_path / "same.exr", {"desk": 0.5})
    assert (tmp_path / "mix.exr").read_bytes() == (tmp_path / "same.exr").read_bytes()
    before = (tmp_path / "mix.exr").read_bytes()
    done = CliRunner().invoke(app, [*words, "doors=0.5"])
    assert done.exit_code != 0
    assert "there is no light group 'doors'" in str(done.exception)
    assert (tmp_path / "mix.exr").read_bytes() == before
