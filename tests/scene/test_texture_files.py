"""Texture files hold what pictures show, in numbers of the least size that loses nothing."""

from pathlib import Path
from typing import Any, Literal

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.textures import texture_files
from nocturne_scene.textures.image_files import convert, decoded
from numpy.typing import NDArray

from tests.pictures import read_pixels, write_picture
from tests.texture_files import Level, levels_of

SIZES = [(1, 1), (1, 7), (7, 1), (5, 3), (64, 64), (65, 2), (70, 131), (100, 33), (200, 150)]


def by_openimageio(values: Level, folder: Path) -> list[Level]:
    """Levels that OpenImageIO makes with its box."""
    buffer = oiio.ImageBuf(oiio.ImageSpec(values.shape[1], values.shape[0], values.shape[2], oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), values)
    config = oiio.ImageSpec(oiio.FLOAT)
    config.attribute("maketx:fileformatname", "openexr")
    config.attribute("maketx:filtername", "box")
    file = str(folder / "levels.exr")
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, buffer, file, config)
    picture = oiio.ImageInput.open(file)
    assert picture is not None
    found: list[Level] = []
    while picture.seek_subimage(0, len(found)):
        shape = (picture.spec().height, picture.spec().width, -1)
        found.append(
            np.asarray(picture.read_image(0, len(found), 0, values.shape[2], oiio.FLOAT)).reshape(shape)
        )
    picture.close()
    return found


@pytest.mark.parametrize(("width", "height"), SIZES)
@pytest.mark.parametrize("channels", [1, 3])
def test_levels_are_those_of_openimageio_to_the_bit(
    tmp_path: Path, width: int, height: int, channels: int
) -> None:
    values = np.random.default_rng(1).random((height, width, channels), dtype=np.float32)
    expected = by_openimageio(values, tmp_path)
    found = levels_of(texture_files.packed(values, narrow=False))
    assert [each.shape for each in found] == [each.shape for each in expected]
    assert all(np.array_equal(*pair) for pair in zip(found, expected, strict=True))
    narrow = levels_of(texture_files.packed(values, narrow=True))
    assert all(np.array_equal(a, b.astype(np.float16)) for a, b in zip(narrow, expected, strict=True))


@pytest.mark.parametrize("encoding", ["srgb", "linear"])
def test_numbers_of_eight_bits_are_what_they_were_to_the_bit(
    tmp_path: Path, encoding: Literal["srgb", "linear"]
) -> None:
    stored = np.arange(256, dtype=np.uint8).reshape(16, 16, 1)
    file = write_picture(tmp_path / "a.png", stored)
    made = convert(file, 1, encoding)
    values = read_pixels(file)
    linear = decoded(values) if encoding == "srgb" else values
    found = levels_of(made.content)
    assert np.array_equal(found[0], linear.astype(np.float16))
    for level, expected in zip(found[1:], by_openimageio(linear, tmp_path)[1:], strict=True):
        assert np.array_equal(level, expected.astype(np.float16))
    assert (made.least, made.most) == (found[0].min(), found[0].max())


def sizes_of(content: bytes) -> tuple[int, int]:
    """Bytes of a number of the finest level, and of all others."""
    return content[24], content[28]


def eight(*shape: int) -> NDArray[np.uint8]:
    return np.random.default_rng(1).integers(0, 256, shape, np.uint8)


@pytest.mark.parametrize(
    ("name", "values", "channels", "encoding", "sizes"),
    [
        ("a.png", eight(9, 70, 3), 3, "srgb", (1, 2)),
        ("a.png", eight(9, 70, 1), 3, "srgb", (1, 2)),
        ("a.png", eight(9, 70, 4), 3, "linear", (1, 2)),
        # Luminances are no numbers of eight bits.
        ("a.png", eight(9, 70, 3), 1, "srgb", (2, 2)),
        ("a.png", np.full((4, 4, 1), 257, np.uint16), 1, "linear", (4, 4)),
        # What half holds exactly; means of it are not.
        ("a.exr", np.full((4, 4, 3), 1.5, np.float32), 3, "linear", (2, 4)),
        ("a.exr", np.full((4, 4, 3), 1e5, np.float32), 3, "linear", (4, 4)),
        ("a.exr", np.full((4, 4, 3), 0.1, np.float32), 3, "linear", (4, 4)),
    ],
)
def test_numbers_are_as_small_as_the_picture_lets_them_be(
    tmp_path: Path, name: str, values: NDArray[Any], channels: Any, encoding: Any, sizes: tuple[int, int]
) -> None:
    file = write_picture(tmp_path / name, values)
    content = convert(file, channels, encoding).content
    assert sizes_of(content) == sizes
    finest = levels_of(content)[0]
    assert np.array_equal(finest, texture_files.finest(content))
    if values.dtype == np.uint8 and channels == 3:
        pixels = (values[..., :3] / 255).astype(np.float32)
        assert finest == pytest.approx(
            (decoded(pixels) if encoding == "srgb" else pixels) + 0 * finest, rel=1e-3
        )


def test_another_version_is_not_read() -> None:
    content = texture_files.packed(np.zeros((1, 1, 1), np.float32), narrow=False)
    for other in (b"\x76\x2f\x31\x01" + content[4:], content[:8] + b"\x02" + content[9:]):
        with pytest.raises(ValueError, match="version"):
            texture_files.finest(other)
