"""Pictures look the same however they are stored: orders, windows, exposures, channels, primaries."""

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.textures.environment_maps import polar_change, read_whole
from nocturne_scene.textures.image_files import convert
from nocturne_scene.textures.pictures import UnusableImageError, opened
from numpy.typing import NDArray

from tests.pictures import write_exr
from tests.texture_files import levels_of

# 2 rows of 3, all different; of red, green and blue these times 1, 2 and 4.
SEEN = np.array([[1.0, 2.0, 4.0], [0.5, 0.25, 8.0]])[..., None] * np.array([1.0, 2.0, 4.0])


def radiance(path: Path, stored: NDArray[np.float64], order: str, *lines: str, kind: str = "rgbe") -> Path:
    """A Radiance picture, uncompressed, of shape (lines, length, 3); powers of two have exact numbers."""
    exponents = np.frexp(stored.max(axis=2))[1]
    mantissas = (stored / 2.0 ** exponents[..., None] * 256).astype(np.uint8)
    body = np.concatenate([mantissas, (exponents + 128).astype(np.uint8)[..., None]], axis=2)
    head = "\n".join(["#?RADIANCE", *lines, f"FORMAT=32-bit_rle_{kind}", "", order, ""])
    path.write_bytes(head.encode() + body.tobytes())
    return path


def seen(path: Path) -> NDArray[np.float32]:
    with opened(path) as picture:
        return np.asarray(picture.read_image(oiio.FLOAT))


# https://github.com/Roughsketch/imagesize/issues/26: the eight orders of Radiance pictures. The first axis
# goes from line to line; Y is up and X to the right, so +Y begins at the bottom and -X at the right.
@pytest.mark.parametrize(
    ("order", "stored"),
    [
        ("-Y 2 +X 3", SEEN),
        ("+Y 2 +X 3", SEEN[::-1]),
        ("-Y 2 -X 3", SEEN[:, ::-1]),
        ("+Y 2 -X 3", SEEN[::-1, ::-1]),
        ("+X 3 -Y 2", SEEN.swapaxes(0, 1)),
        ("-X 3 -Y 2", SEEN[:, ::-1].swapaxes(0, 1)),
        ("+X 3 +Y 2", SEEN[::-1].swapaxes(0, 1)),
        ("-X 3 +Y 2", SEEN[::-1, ::-1].swapaxes(0, 1)),
    ],
)
def test_orders_of_radiance_pictures(tmp_path: Path, order: str, stored: NDArray[np.float64]) -> None:
    file = radiance(tmp_path / "a.hdr", stored, order)
    assert seen(file) == pytest.approx(SEEN)
    assert read_whole(file) == pytest.approx(SEEN)


def test_orders_of_compressed_radiance_pictures(tmp_path: Path) -> None:
    """OpenImageIO writes runs; the last line of the header is all that is changed."""
    rows = np.repeat(np.arange(1, 5, dtype=np.float32)[:, None, None], 3, axis=2).repeat(16, axis=1)
    buffer = oiio.ImageBuf(oiio.ImageSpec(16, 4, 3, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), rows)
    assert buffer.write(str(tmp_path / "a.hdr"))
    plain = (tmp_path / "a.hdr").read_bytes()
    assert b"-Y 4 +X 16" in plain
    (tmp_path / "b.hdr").write_bytes(plain.replace(b"-Y 4 +X 16", b"+Y 4 +X 16"))
    assert seen(tmp_path / "a.hdr")[:, 0, 0].tolist() == [1, 2, 3, 4]
    assert seen(tmp_path / "b.hdr")[:, 0, 0].tolist() == [4, 3, 2, 1]


# https://github.com/13thsymphony/HDRImageViewer/issues/51: numbers are divided by EXPOSURE to have radiance.
@pytest.mark.parametrize(
    ("lines", "factors"),
    [
        (["EXPOSURE=0.5"], [2, 2, 2]),
        (["EXPOSURE= 0.5", "SOFTWARE=x", "EXPOSURE=8"], [0.25, 0.25, 0.25]),
        (["COLORCORR=1 2 4"], [1, 0.5, 0.25]),
        (["EXPOSURE=2", "COLORCORR= 1 2 4"], [0.5, 0.25, 0.125]),
        (["EXPOSURE=1.0"], [1, 1, 1]),
        (["EXPOSURE=bright", "PRIMARIES=0 0 0 0 0 0 0 0", "GAMMA=1"], [1, 1, 1]),
    ],
)
def test_exposure_of_radiance_pictures(tmp_path: Path, lines: list[str], factors: list[float]) -> None:
    file = radiance(tmp_path / "a.hdr", SEEN, "-Y 2 +X 3", *lines)
    assert seen(file) == pytest.approx(SEEN * factors)


def test_radiance_pictures_of_xyz(tmp_path: Path) -> None:
    """X, Y, Z of D65 white are white."""
    white = np.tile([0.9505, 1.0, 1.089], (2, 3, 1))
    file = radiance(tmp_path / "a.hdr", white, "-Y 2 +X 3", kind="xyze")
    assert seen(file) == pytest.approx(np.ones((2, 3, 3)), abs=0.02)


def exr(path: Path, pixels: NDArray[Any], names: str, **fields: Any) -> Path:
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.FLOAT)
    spec.channelnames = tuple(names.split())
    chromaticities = fields.pop("chromaticities", None)
    for name, value in fields.items():
        setattr(spec, name, value)
    if chromaticities is not None:
        spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), chromaticities)
    output = oiio.ImageOutput.create(str(path))
    assert output is not None
    assert output.open(str(path), spec)
    assert output.write_image(np.ascontiguousarray(pixels, dtype=np.float32))
    output.close()
    return path


# https://github.com/disneyresearch/jeri/issues/9, https://github.com/microsoft/DirectXTex/issues/724.
@pytest.mark.parametrize(("x", "y"), [(0, 0), (1, 2), (2, 1), (-1, -1), (3, 0), (50, 0), (0, -50)])
@pytest.mark.parametrize(("left", "top"), [(0, 0), (-7, 5)])
def test_a_data_window_is_a_part_of_the_display_window(
    tmp_path: Path, x: int, y: int, left: int, top: int
) -> None:
    """Pixels outside of the display window are invisible; pixels that are not stored are black."""
    display = {"full_x": left, "full_y": top, "full_width": 6, "full_height": 4}
    file = exr(tmp_path / "a.exr", SEEN, "R G B", x=left + x, y=top + y, **display)
    expected = np.zeros((4, 6, 3))
    for row in range(2):
        for column in range(3):
            if 0 <= y + row < 4 and 0 <= x + column < 6:
                expected[y + row, x + column] = SEEN[row, column]
    assert np.array_equal(seen(file), expected)
    assert np.array_equal(read_whole(file), expected)


def test_half_a_sky_is_half_a_sky(tmp_path: Path) -> None:
    display = {"full_width": 32, "full_height": 16, "full_x": 0, "full_y": 0}
    file = exr(tmp_path / "a.exr", np.ones((8, 32, 3)), "R G B", **display)
    assert read_whole(file).shape == (16, 32, 3)
    assert read_whole(file).sum(axis=(1, 2)).tolist() == [96] * 8 + [0] * 8
    assert polar_change(file) < 0.1


def test_a_display_window_has_bounds(tmp_path: Path) -> None:
    file = exr(tmp_path / "a.exr", SEEN, "R G B", full_width=10**6, full_height=10**6)
    with pytest.raises(UnusableImageError, match="a display window of 1000000 x 1000000"):
        read_whole(file)


@pytest.mark.parametrize(
    ("names", "order"),
    [
        ("R G B", [0, 1, 2]),
        ("B G R", [2, 1, 0]),
        ("r g b", [0, 1, 2]),
        ("Red Green Blue", [0, 1, 2]),
        ("B G R Z", [2, 1, 0]),
        ("A B G R", [3, 2, 1]),
        ("Depth.Z Image.B Image.G Image.R", [3, 2, 1]),
        ("N.X N.Y N.Z View.Combined.R View.Combined.G View.Combined.B", [3, 4, 5]),
        ("diffuse.R diffuse.G diffuse.B R G B", [3, 4, 5]),
    ],
)
def test_channels_by_their_names(tmp_path: Path, names: str, order: list[int]) -> None:
    pixels = np.tile(np.arange(1.0, 1 + len(names.split())), (2, 3, 1))
    file = exr(tmp_path / "a.exr", pixels, names)
    assert read_whole(file)[0, 0].tolist() == [1.0 + each for each in order]


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ("a.R a.G a.B b.R b.G b.B", "several layers, a, b"),
        ("N.x N.y N.z", "channels N.x, N.y, N.z; expected R, G, B"),
        ("Y RY BY", "expected R, G, B"),
    ],
)
def test_channels_that_may_be_anything(tmp_path: Path, names: str, said: str) -> None:
    file = exr(tmp_path / "a.exr", np.ones((2, 3, len(names.split()))), names)
    with pytest.raises(UnusableImageError, match=said):
        read_whole(file)


def test_grey_and_its_alpha_or_depth(tmp_path: Path) -> None:
    for names in ("Y", "Y A", "A Y Z"):
        pixels = np.full((2, 3, len(names.split())), 0.75)
        pixels[..., names.split().index("Y")] = 0.25
        file = exr(tmp_path / "a.exr", pixels, names)
        assert levels_of(convert(file, 1, "linear").content)[0][0, 0, 0] == 0.25


def test_xyz_are_colours(tmp_path: Path) -> None:
    """As in the images of renders here; XYZ of D65 white, and of red by IEC 61966-2-1."""
    pixels = np.array([[[0.9505, 1.0, 1.089], [0.4124, 0.2126, 0.0193]]])
    file = write_exr(tmp_path / "a.exr", pixels.repeat(2, axis=0))
    assert read_whole(file)[0] == pytest.approx(np.array([[1, 1, 1], [1, 0, 0]]), abs=2e-3)


# Primaries and white of BT.2020, whose matrix to BT.709 is that of ITU-R BT.2407-0, and of ACES AP0.
BT_2020 = (0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329)
AP0 = (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767)


def test_other_primaries(tmp_path: Path) -> None:
    pixels = np.array([[[1, 1, 1], [0.25, 0.5, 0.5]]]).repeat(2, axis=0)
    found = seen(exr(tmp_path / "a.exr", pixels, "R G B", chromaticities=BT_2020))
    matrix = np.array([[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]])
    assert found[0] == pytest.approx(pixels[0] @ matrix.T, abs=1e-3)
    lines = f"PRIMARIES={' '.join(map(str, BT_2020))}"
    again = seen(radiance(tmp_path / "a.hdr", pixels, "-Y 2 +X 2", lines))
    assert again == pytest.approx(found, abs=5e-3)


def test_white_stays_white(tmp_path: Path) -> None:
    file = exr(tmp_path / "a.exr", np.ones((2, 2, 3)), "R G B", chromaticities=AP0)
    assert seen(file) == pytest.approx(np.ones((2, 2, 3)), abs=1e-3)


def test_what_is_plain_is_not_copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from nocturne_scene.textures import pictures

    monkeypatch.setattr(pictures, "_written", None)
    seen(radiance(tmp_path / "a.hdr", SEEN, "-Y 2 +X 3", "EXPOSURE=1"))
    srgb = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
    seen(exr(tmp_path / "a.exr", SEEN, "R G B", chromaticities=srgb))


def test_a_header_whose_names_are_no_text_is_told(tmp_path: Path) -> None:
    picture = tmp_path / "damaged.exr"
    write_exr(picture, np.ones((4, 4, 3), np.float32))
    picture.write_bytes(picture.read_bytes().replace(b"chlist\0", b"\xffhlist\0", 1))
    with pytest.raises(UnusableImageError, match="names that are no text"), opened(picture):
        pass
