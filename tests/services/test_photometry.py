"""`nocturne ies` refuses images that can't become a photometric file."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.photometry import write_photometry
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_scene.photometry import ies as photometric_files
from nocturne_scene.tile_sums import TileSums


def _image(folder: Path, width: int, height: int, quantity: str = "luminous intensity") -> Path:
    path = folder / "image.exr"
    sums = TileSums.zeros(width, height)
    sums.pixels[..., :] = 1.0
    provenance = Provenance("0" * 64, "{}", 2, quantity=quantity)
    squares = Squares(sums.block_products, sums.tile_products[None], max(width, height))
    write_image(path, sums.pixels, np.ones((height, width), dtype=np.uint32), squares, provenance)
    return path


@pytest.mark.parametrize("quantity", ["luminance", "illuminance", ""])
def test_the_image_of_another_sensor_is_refused(tmp_path: Path, quantity: str) -> None:
    with pytest.raises(NocturneClientError, match=r"image\.exr is of .*made of an intensity_meter's image"):
        write_photometry(_image(tmp_path, 1, 3, quantity), tmp_path / "lamp.ies")


def test_one_column_is_a_lamp_that_is_the_same_all_around(tmp_path: Path) -> None:
    write_photometry(_image(tmp_path, 1, 3), tmp_path / "lamp.ies")
    found = photometric_files.read((tmp_path / "lamp.ies").read_bytes())
    # Mean angle over a cap of 60 degrees: (sin a - a cos a) / (1 - cos a).
    cap = np.degrees((np.sin(np.pi / 3) - np.pi / 3 * 0.5) / 0.5)
    assert found.vertical.tolist() == pytest.approx([0, cap, 90, 180 - cap, 180])
    assert found.horizontal.tolist() == [0]
    assert found.candela.tolist() == [[1, 1, 1, 1, 1]]
    assert found.keywords["TEST"].endswith("0" * 64)


def test_another_picture_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.exr").write_text("hello")
    buffer = oiio.ImageBuf(oiio.ImageSpec(2, 2, 3, oiio.FLOAT))
    buffer.write(str(tmp_path / "other.exr"))
    for name in ("text.exr", "other.exr", "none.exr"):
        with pytest.raises(NocturneClientError, match=f"{name} is no EXR of ours"):
            write_photometry(tmp_path / name, tmp_path / "lamp.ies")


def test_too_many_pixels_are_refused(tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError, match=r"1 x 4000 pixels are too many.*at most 3601 angles"):
        write_photometry(_image(tmp_path, 1, 4000), tmp_path / "lamp.ies")


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError, match="No such file"):
        write_photometry(_image(tmp_path, 2, 2), tmp_path / "none" / "lamp.ies")
