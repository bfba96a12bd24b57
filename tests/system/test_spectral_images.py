"""Spectral images, read back by a reader that knows nothing but the published layout.

A. Fichet, R. Pacanowski, A. Wilkie, "An OpenEXR Layout for Spectral Images" (JCGT 10(3), 2021).
"""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR
import pytest
from nocturne_client.cli.scene_options import parse_bands
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.render import LocalRender, render_scene

pytestmark = pytest.mark.system

# The paper's grammar of channels of light: Stokes component, number with a comma, multiplier, unit.
_CHANNEL = re.compile(r"S([0-3])\.(\d*,?\d*(?:[Ee][+-]?\d+)?)(n|u|m|)(m|Hz)")
_METRES = {"n": 1e-9, "u": 1e-6, "m": 1e-3, "": 1.0}


def read_spectral(path: Path) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], dict[str, Any]]:
    """Wavelengths in nm, rising; spectra of shape (height, width, wavelengths); the header."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        header = dict(file.header())
        assert header["spectralLayoutVersion"] == "1.0"
        found = {}
        for name, channel in file.channels().items():
            match = _CHANNEL.fullmatch(name)
            if match is not None and match[1] == "0":
                found[float(match[2].replace(",", ".")) * _METRES[match[3]] * 1e9] = channel.pixels
    wavelengths = sorted(found)
    return np.array(wavelengths), np.stack([found[each] for each in wavelengths], axis=-1), header


def lit(table: list[list[float]], sensor: dict[str, Any]) -> dict[str, Any]:
    """A lamp of this spectral radiance, W m-2 sr-1 nm-1, that fills what the sensor sees."""
    shape = {"type": "quad", "corner": [-9, -9, -1], "edge_u": [18, 0, 0], "edge_v": [0, 18, 0]}
    black = {"type": "lambertian", "reflectance": 0.0}
    lamp = {"shape": shape, "kernel": black, "luminaire": {"radiance": {"table": table}}}
    return {"nocturne": 1, "sensor": sensor, "surfaces": [lamp]}


CAMERA = {"type": "orthographic", "position": [0, 0, 0], "look_at": [0, 0, -1], "height": 1}
EVEN = [[360.0, 1.0], [830.0, 1.0]]


def rendered(document: dict[str, Any], bands: str, folder: Path) -> Path:
    scene, image = folder / "scene.json", folder / "image.exr"
    scene.write_text(json.dumps(document))
    render_scene(LocalRender(scene, [image], 4, 4, 4096, 2, changes=parse_bands(bands)))
    return image


def test_spectra_come_back(tmp_path: Path) -> None:
    """A slope: the mean of a band is its value in the middle."""
    image = rendered(lit([[360, 0.0], [830, 4.7]], CAMERA), "380:780:10", tmp_path)
    wavelengths, spectra, header = read_spectral(image)
    np.testing.assert_allclose(wavelengths, [385.0 + 10 * i for i in range(40)])
    assert header["emissiveUnits"] == "W.m^-2.sr^-1"
    mean = spectra.mean(axis=(0, 1))
    np.testing.assert_allclose(mean, (wavelengths - 360) / 100, rtol=0.02)


def test_bands_know_their_errors(tmp_path: Path) -> None:
    image = rendered(lit(EVEN, CAMERA), "400:700:100", tmp_path)
    with OpenEXR.File(str(image), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    for middle in (450, 550, 650):
        value, error = (channels[f"S0.{middle},000000nm{end}"] for end in ("", ".stderr"))
        assert np.all(error > 0.0)
        assert np.all(np.abs(value - 1.0) < 6.0 * error)


def test_the_outermost_bands_have_all_their_light(tmp_path: Path) -> None:
    _, spectra, _ = read_spectral(rendered(lit(EVEN, CAMERA), "360:830:10", tmp_path))
    np.testing.assert_allclose(spectra[..., [0, -1]].mean(axis=(0, 1)), 1.0, rtol=0.02)


def test_an_irradiance_has_its_own_unit(tmp_path: Path) -> None:
    meter = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, -1], "height": 1}
    _, _, header = read_spectral(rendered(lit(EVEN, meter), "400:700:50", tmp_path))
    assert header["emissiveUnits"] == "W.m^-2"


@pytest.mark.parametrize("bands", ["380:780:7", "780:380:10", "100:500:10", "360:830:1"])
def test_bands_that_can_not_be_are_told_with_their_place(bands: str, tmp_path: Path) -> None:
    with pytest.raises(NocturneClientError) as refused:
        rendered(lit(EVEN, CAMERA), bands, tmp_path)
    assert all("sensor.bands" in each.place for each in refused.value.problems)


def test_images_without_bands_are_not_called_spectral(tmp_path: Path) -> None:
    with OpenEXR.File(str(rendered(lit(EVEN, CAMERA), "", tmp_path))) as file:
        assert "spectralLayoutVersion" not in file.header()
