"""Pictures become textures and environment maps without losing light; hostile ones are refused early."""

import io
import struct
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.compile import merl
from nocturne_scene.spectra import published
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.textures import environment_maps, pictures
from nocturne_scene.textures import image_files as image_textures
from nocturne_scene.textures.pictures import UnusableImageError
from numpy.typing import NDArray

from tests.texture_files import levels_of

Pixels = NDArray[np.float32]


def save(file: Path, pixels: Pixels, kind: str = "float", tile: int = 0) -> Path:
    height, width, channels = pixels.shape
    buffer = oiio.ImageBuf(oiio.ImageSpec(width, height, channels, oiio.FLOAT))
    buffer.set_pixels(oiio.ROI(), pixels)
    if tile:
        buffer.set_write_tiles(tile, tile)
    assert buffer.write(str(file), kind)
    return file


def texels(source: Path) -> NDArray[np.float32]:
    target = io.BytesIO()
    columns, rows = environment_maps.convert(source, target)
    return np.frombuffer(target.getvalue(), "<f4").reshape(rows, columns, 4)


def luminance(found: NDArray[np.float32]) -> NDArray[np.float64]:
    """Of texels, over that of RGB (1, 1, 1)."""
    weights = rgb_spectra.rgb_weights() @ np.linalg.inv(rgb_spectra.xyz_to_rgb())[1]
    spectra = rgb_spectra.spectra_of(found[..., 1:], published.visible_wavelengths())
    return np.asarray(found[..., 0] * (spectra @ weights))


def picture_flux(pixels: Pixels) -> float:
    """Integral of grey pixels over the sphere."""
    height, width, _ = pixels.shape
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    areas = (edges[:-1] - edges[1:]) * 2 * np.pi / width
    return float((pixels[..., 0].astype(np.float64) * areas[:, None]).sum())


@pytest.mark.parametrize(("width", "height", "tile"), [(64, 32, 0), (33, 17, 0), (80, 48, 16)])
def test_a_map_keeps_its_flux(tmp_path: Path, width: int, height: int, tile: int) -> None:
    rng = np.random.default_rng(1)
    # A contrast of a million to one; brightest at the poles.
    pixels = np.repeat(10.0 ** rng.uniform(-3, 3, (height, width, 1)), 3, axis=2).astype(np.float32)
    pixels[0, 3] = pixels[-1, 5] = 1e3
    found = texels(save(tmp_path / "map.exr", pixels, tile=tile))
    flux = luminance(found).sum() * 4 * np.pi / (width * height)
    assert flux == pytest.approx(picture_flux(pixels), rel=1e-5)


def test_points_are_interpolated_and_their_ends_are_the_poles(tmp_path: Path) -> None:
    """A ramp of the polar angle: means of texels by quadrature, to what spectra of RGB have."""
    rows = 16
    pixels = np.repeat(np.linspace(1, 2, rows, dtype=np.float32)[:, None, None], 3, axis=2).repeat(32, axis=1)
    target = io.BytesIO()
    columns, count = environment_maps.convert(save(tmp_path / "map.exr", pixels), target, points=True)
    assert (columns, count) == (128, 64)
    found = luminance(np.frombuffer(target.getvalue(), "<f4").reshape(count, columns, 4))
    z = 1 - 2 * (np.arange(64 * 256) + 0.5) / (64 * 256)
    expected = (1 + np.arccos(z) / np.pi).reshape(64, 256).mean(axis=1)
    assert found == pytest.approx(np.repeat(expected[:, None], 128, axis=1), rel=3e-3)


def test_one_bright_pixel_at_the_pole_keeps_its_flux_and_place(tmp_path: Path) -> None:
    pixels = np.zeros((32, 64, 3), np.float32)
    pixels[0, 10] = 1e6
    found = luminance(texels(save(tmp_path / "map.exr", pixels)))
    # Column 10 of 64 has its middle at azimuth pi - 2 pi 10.5 / 64: column 21 from +x on.
    assert np.argwhere(found).tolist() == [[0, 21]]
    assert found.sum() * 4 * np.pi / (32 * 64) == pytest.approx(picture_flux(pixels), rel=1e-5)


def test_where_things_are(tmp_path: Path) -> None:
    pixels = np.zeros((4, 8, 3), np.float32)
    pixels[:2, 3] = 1  # just left of the middle: azimuth 0 to 45 degrees, above the horizon
    pixels[2:, 6] = 2  # right: azimuth -90 to -135 degrees, below
    found = luminance(texels(save(tmp_path / "map.hdr", pixels)))
    expected = np.zeros((4, 8))
    expected[:2, 0] = 1
    expected[2:, 5] = 2
    assert found == pytest.approx(expected, rel=5e-3, abs=1e-9)


def test_a_map_keeps_colours(tmp_path: Path) -> None:
    rgb = np.array([3.0, 1.5, 0.6], np.float32)
    found = texels(save(tmp_path / "map.exr", np.tile(rgb, (4, 8, 1))))[0, 0]
    spectrum = found[0] * rgb_spectra.spectra_of(found[1:], published.visible_wavelengths())
    assert spectrum @ rgb_spectra.rgb_weights() == pytest.approx(rgb, rel=5e-3)


@pytest.mark.parametrize(
    ("pixels", "kind", "message"),
    [
        (np.zeros((4, 8, 1), np.float32), "float", "1 channels"),
        (np.full((4, 8, 3), np.nan, np.float32), "float", "infinite, undefined"),
        (np.full((4, 8, 3), np.inf, np.float32), "float", "infinite, undefined"),
    ],
)
def test_unusable_maps(tmp_path: Path, pixels: Pixels, kind: str, message: str) -> None:
    with pytest.raises(UnusableImageError, match=message):
        texels(save(tmp_path / "map.exr", pixels, kind))


def test_unreadable_maps(tmp_path: Path) -> None:
    with pytest.raises(UnusableImageError, match="floating-point"):
        texels(save(tmp_path / "map.png", np.zeros((4, 8, 3), np.float32), "uint8"))
    (tmp_path / "noise.exr").write_bytes(b"v/1\x01" + bytes(100))
    with pytest.raises(UnusableImageError, match="no picture"):
        texels(tmp_path / "noise.exr")
    good = save(tmp_path / "cut.exr", np.random.default_rng(1).random((64, 64, 3)).astype(np.float32))
    good.write_bytes(good.read_bytes()[:2000])
    with pytest.raises(UnusableImageError):
        texels(good)


def test_a_huge_promise_is_refused_before_it_is_read(tmp_path: Path) -> None:
    # Radiance HDR: the size stands in the text of the header.
    file = tmp_path / "huge.hdr"
    file.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\n" + bytes(64))
    # OpenImageIO refuses this one itself.
    with pytest.raises(UnusableImageError, match=r"16000 x 16000|2929 MB"):
        texels(file)
    with pytest.raises(UnusableImageError, match=r"16000 x 16000|2929 MB"):
        image_textures.convert(file, 3, "linear")
    for width, height in ((16000, 16000), (20000, 1), (1, 20000)):
        with pytest.raises(UnusableImageError, match=f"{width} x {height}"):
            pictures.check_size(oiio.ImageSpec(width, height, 3, oiio.FLOAT), 2**25, 16384)


def test_decoding() -> None:
    # IEC 61966-2-1; 0.5 is 0.21404 linear, and both branches meet.
    decoded = image_textures.decoded(np.array([0.0, 0.04, 0.04045, 0.5, 1.0], np.float32))
    assert decoded == pytest.approx([0, 0.04 / 12.92, 0.0031308, 0.2140411, 1], abs=1e-6)


def test_a_texture_has_linear_values_and_levels_down_to_one_pixel(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    source = save(tmp_path / "a.png", rng.random((128, 256, 3)).astype(np.float32), "uint8")
    found = levels_of(image_textures.convert(source, 3, "srgb").content)
    stored = np.asarray(oiio.ImageBuf(str(source)).get_pixels(oiio.FLOAT))
    expected = image_textures.decoded(stored)
    assert found[0] == pytest.approx(expected, rel=1e-3, abs=1e-6)
    assert len(found) == 9
    assert found[-1].reshape(3) == pytest.approx(expected.mean(axis=(0, 1)), rel=5e-3)


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.exr", "a.hdr"])
def test_equal_pictures_give_equal_bytes(tmp_path: Path, name: str) -> None:
    pixels = np.random.default_rng(1).random((30, 50, 3)).astype(np.float32)
    (tmp_path / "other").mkdir()
    first = image_textures.convert(save(tmp_path / name, pixels), 3, "linear").content
    second = image_textures.convert(save(tmp_path / "other" / name, pixels), 3, "linear").content
    assert first == second


def test_channels(tmp_path: Path) -> None:
    colour = save(tmp_path / "a.exr", np.tile(np.array([0.5, 0.25, 1.0, 0.1], np.float32), (4, 4, 1)))
    grey = save(tmp_path / "b.exr", np.full((4, 4, 1), 0.25, np.float32))
    one = levels_of(image_textures.convert(colour, 1, "linear").content)[0]
    assert one.reshape(-1) == pytest.approx(0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722)
    three = levels_of(image_textures.convert(grey, 3, "linear").content)[0]
    assert three.shape == (4, 4, 3)
    assert np.all(three == 0.25)


def test_a_merl_table_is_read_exactly() -> None:
    cells = merl.THETA_H * merl.THETA_D * merl.PHI_D
    head = struct.pack("<3i", 90, 90, 180)
    values = np.full((3, cells), 1500.0)
    values[:, 0] = -1.0
    table = merl.read(head + values.astype("<f8").tobytes())
    assert table.shape == (3, 90, 90, 180)
    assert table[:, 0, 0, 1] == pytest.approx([1, 1.15, 1.66])
    assert np.all(table[:, 0, 0, 0] == 0)
    with pytest.raises(merl.BadMerlError, match="34992012"):
        merl.read(head + bytes(100))
    with pytest.raises(merl.BadMerlError, match="180 x 90 x 90"):
        merl.read(struct.pack("<3i", 180, 90, 90) + bytes(24 * cells))
