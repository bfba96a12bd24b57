"""OpenEXR files of ours and of others, as images in XYZ."""

from pathlib import Path

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError


def write(path: Path, compression: object = None, **channels: np.ndarray) -> Path:
    header = {"type": OpenEXR.scanlineimage, "compression": compression or OpenEXR.ZIP_COMPRESSION}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))
    return path


def noise(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((37, 50)).astype(np.float32)


@pytest.mark.parametrize(
    "compression", [OpenEXR.NO_COMPRESSION, OpenEXR.PIZ_COMPRESSION, OpenEXR.ZIPS_COMPRESSION]
)
def test_any_compression(tmp_path: Path, compression: object) -> None:
    planes = {name: noise(index) for index, name in enumerate("XYZ")}
    found = read_picture(write(tmp_path / "a.exr", compression, **planes))
    assert np.array_equal(found.xyz, np.stack([planes[name] for name in "XYZ"], axis=-1))
    assert found.y_error is None
    assert found.samples is None


def test_counts_are_counts(tmp_path: Path) -> None:
    counts = np.array([[0, 1, 10, 2**24 + 1, 2**32 - 1]], dtype=np.uint32)
    y = np.ones(counts.shape, dtype=np.float32)
    found = read_picture(write(tmp_path / "a.exr", Y=y, n=counts))
    assert found.samples is not None
    assert np.array_equal(found.samples, counts)
    assert np.array_equal(found.xyz, np.stack([y, y, y], axis=-1))


def test_xyz_goes_before_what_is_for_viewers(tmp_path: Path) -> None:
    planes = {name: noise(index) for index, name in enumerate("XYZRGB")}
    found = read_picture(write(tmp_path / "a.exr", **planes))
    assert np.array_equal(found.xyz[..., 0], planes["X"])


def test_a_picture_that_is_too_large_is_refused(tmp_path: Path) -> None:
    file = write(tmp_path / "a.exr", Y=noise(1))
    assert read_picture(file, 37 * 50).xyz.shape == (37, 50, 3)
    with pytest.raises(InputError, match="too many"):
        read_picture(file, 37 * 50 - 1)


# OpenEXR's technical introduction, "Windows": pixels are stored of the data window, which may be a part of
# the display window or reach beyond it.
def test_a_picture_is_what_the_display_window_shows(tmp_path: Path) -> None:
    rows, columns = 4, 5
    stored = np.arange(1.0, rows * columns + 1.0, dtype=np.float32).reshape(rows, columns)
    spec = oiio.ImageSpec(columns, rows, 1, oiio.FLOAT)
    spec.channelnames = ("Y",)
    spec.x, spec.y = -2, 1
    spec.full_x, spec.full_y, spec.full_width, spec.full_height = 0, 0, 4, 6
    output = oiio.ImageOutput.create(str(tmp_path / "a.exr"))
    assert output is not None
    assert output.open(str(tmp_path / "a.exr"), spec)
    output.write_image(stored[..., None])
    output.close()
    shown = np.zeros((6, 4))
    shown[1:5, :3] = stored[:, 2:]
    assert np.array_equal(read_picture(tmp_path / "a.exr").xyz[..., 1], shown)


def test_a_display_window_is_checked_before_memory_is_taken(tmp_path: Path) -> None:
    spec = oiio.ImageSpec(2, 2, 1, oiio.FLOAT)
    spec.channelnames = ("Y",)
    spec.full_width, spec.full_height = 2**20, 2**20
    output = oiio.ImageOutput.create(str(tmp_path / "a.exr"))
    assert output is not None
    assert output.open(str(tmp_path / "a.exr"), spec)
    output.write_image(np.ones((2, 2, 1), dtype=np.float32))
    output.close()
    with pytest.raises(InputError, match="1048576 x 1048576 pixels are too many"):
        read_picture(tmp_path / "a.exr")
