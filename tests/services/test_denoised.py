"""Denoised pictures: made of committed samples, labelled, and taken for an image by nobody."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import OpenEXR
import pytest
from nocturne_api.children import denoising as pictures
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.image_error import image_error
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, write_image
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.compare.images import read_picture
from nocturne_scene.errors import InputError
from nocturne_scene.tile_sums import PRODUCTS, sums_per_pixel

from tests.services import coordinator_acts

STAND_IN = '''
def denoise(color, albedo=None, normal=None, *, hdr):
    """The mean of all pixels, where an albedo guides; else the image itself."""
    import numpy as np
    assert hdr and color.dtype == np.float32 and color.min() >= 0
    return color if albedo is None else np.broadcast_to(color.mean(axis=(0, 1)), color.shape).copy()
'''


@pytest.fixture
def denoiser(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A package that stands for pyoidn, for child processes too."""
    packages = tmp_path / "packages"
    packages.mkdir()
    (packages / "pyoidn.py").write_text(STAND_IN)
    monkeypatch.syspath_prepend(str(packages))
    monkeypatch.delitem(sys.modules, "pyoidn", raising=False)
    monkeypatch.setenv("PYTHONPATH", str(packages), prepend=":")
    yield
    sys.modules.pop("pyoidn", None)


def image(path: Path) -> Path:
    """8 x 8 pixels of 4 samples each, brighter to the right."""
    sums = np.zeros((8, 8, sums_per_pixel(0)))
    sums[..., :3] = 4.0 * np.arange(1, 9)[None, :, None]
    sums[..., 3:6] = sums[..., :3] ** 2 / 4.0 + 3.0
    squares = Squares(np.zeros((1, 1, PRODUCTS)), np.zeros((1, 1, PRODUCTS)), 8)
    write_image(path, sums, np.full((8, 8), 4, np.uint32), squares, Provenance("00", "{}", 1))
    return path


def values(*numbers: float) -> pictures.Values:
    return np.array(numbers, dtype=np.float32)


@pytest.mark.usefixtures("denoiser")
def test_are_no_image_for_any_reader_of_ours(tmp_path: Path) -> None:
    pictures.write_denoised(image(tmp_path / "image.exr"), tmp_path)
    made = tmp_path / pictures.EXR
    with OpenEXR.File(str(made), separate_channels=True) as file:
        assert {*file.channels()} == {"denoised.R", "denoised.G", "denoised.B", "difference.errorBars"}
        assert file.header()["nocturne:denoised"].startswith("To look at, not to measure")
    with pytest.raises(InputError, match="expected channels X, Y, Z or R, G, B or Y"):
        read_picture(made)
    with pytest.raises(NocturneClientError):
        image_error(made)


@pytest.mark.usefixtures("denoiser")
def test_tell_where_they_leave_the_error_bars(tmp_path: Path) -> None:
    bars = pictures.error_bars(values(1.0, 1.4, 2.2, 2.0), values(1, 1, 1, 2), values(0.5, 0.5, 0.5, 0))
    assert bars == pytest.approx([0.0, 0.8, 2.4, 0.0])
    assert np.isinf(pictures.error_bars(values(1), values(2), values(0)))
    colours = pictures.coloured(values(0.5, 1.5, 2.5, 9.0)[None])
    assert len({tuple(pixel) for pixel in colours[0]}) == 4
    pictures.write_denoised(image(tmp_path / "image.exr"), tmp_path)
    with OpenEXR.File(str(tmp_path / pictures.EXR), separate_channels=True) as file:
        # The stand-in changes nothing without an albedo; the matrices of sRGB are rounded to four digits.
        assert np.all(file.channels()["difference.errorBars"].pixels < 0.01)


@pytest.mark.usefixtures("denoiser")
def test_albedo_and_normals_guide() -> None:
    ramp = np.arange(4, dtype=np.float32).reshape(2, 2)
    channels = dict.fromkeys(("R", "G", "B"), ramp)
    assert np.array_equal(pictures.denoised(channels)[..., 0], ramp)
    channels |= dict.fromkeys(("albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z"), ramp)
    assert np.all(pictures.denoised(channels) == 1.5)


@pytest.mark.usefixtures("denoiser")
async def test_come_from_the_service(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    made = (await rest.post("/v1/renders", json=body)).json()["id"]
    assert (await rest.get(f"/v1/renders/{made}/denoised.png")).status_code == 404
    coordinator_acts.finish(folder, made)
    place = folder.image_path(made)
    place.parent.mkdir(parents=True, exist_ok=True)
    image(place)
    for name, start in (
        ("denoised.png", b"\x89PNG"),
        ("difference.png", b"\x89PNG"),
        ("denoised.exr", b"v/1\x01"),
    ):
        answer = await rest.get(f"/v1/renders/{made}/{name}")
        assert answer.status_code == 200, answer.text
        assert answer.content.startswith(start)
        etag = answer.headers["ETag"]
        again = await rest.get(f"/v1/renders/{made}/{name}", headers={"If-None-Match": etag})
        assert again.status_code == 304


async def test_films_that_are_too_large_are_refused(rest: httpx.AsyncClient, body: dict[str, Any]) -> None:
    made = (await rest.post("/v1/renders", json={**body, "width": 8192, "height": 4096})).json()["id"]
    answer = await rest.get(f"/v1/renders/{made}/denoised.png")
    assert answer.status_code == 404
    assert "pixels are not denoised" in answer.json()["detail"]


async def test_a_service_without_a_denoiser_says_so(
    rest: httpx.AsyncClient,
    folder: DataFolder,
    body: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    (tmp_path / "pyoidn.py").write_text("raise ImportError")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=":")
    made = (await rest.post("/v1/renders", json=body)).json()["id"]
    coordinator_acts.finish(folder, made)
    folder.image_path(made).parent.mkdir(parents=True, exist_ok=True)
    image(folder.image_path(made))
    answer = await rest.get(f"/v1/renders/{made}/denoised.png")
    assert answer.status_code == 404
    assert "has no denoiser" in answer.json()["detail"]


def test_open_image_denoise_itself() -> None:
    """The real one, where it is installed."""
    pytest.importorskip("pyoidn")
    noise = np.random.default_rng(1).exponential(1.0, (64, 64)).astype(np.float32)
    found = pictures.denoised(dict.fromkeys(("R", "G", "B"), noise))
    assert found.std() < 0.3 * noise.std()
    assert found.mean() == pytest.approx(noise.mean(), rel=0.1)
