"""A lamp's photometric file through the tracer and back: luminaire, intensity meter, `nocturne ies`.

The lamp's intensity is c (1 + 0.5 cos(v) + 0.4 sin(v) cos(h - 40 degrees)), vertical angle v and horizontal
angle h: no direction can be taken for another. Its mean over a pixel is a closed form.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_client.local.photometry import write_photometry
from nocturne_scene.photometry import ies as photometric_files
from nocturne_scene.photometry.intensities import Photometry, flux

from tests.accuracy.agreement import sidak_bound
from tests.accuracy.tracing import Document, trace
from tests.system.images import Image

pytestmark = pytest.mark.system

Angles = npt.NDArray[np.float64]

_CANDELA = 250.0
_ROWS, _COLUMNS = 12, 24
_SAMPLES = 4096


def test_round_trip(tmp_path: Path) -> None:
    """The measured distribution equals the lamp's file, and so does that of a file made from the measurement.

    Straight lines over s radians are off by s^2 / 8 of a second derivative, and means over s by s^2 / 24. The
    derivatives are at most 0.64 c down and 0.4 c around, so in a file of degrees it is 4e-5 c, and in one of
    the pixels' angles, 15 degrees, with the pixels' own means, 1.2e-2 c. z within the Sidak bound of all
    pixels, standard errors as of independent points; false alarms: below 0.02.
    """
    vertical, horizontal = np.linspace(0.0, 180.0, 181), np.linspace(0.0, 360.0, 361)
    exact = Photometry(vertical, horizontal, _intensity(vertical, horizontal[:, None]))
    (tmp_path / "lamp.ies").write_bytes(photometric_files.write(exact))
    first = _measured(tmp_path)
    _check(first, _pixel_means(), 4e-5 * _CANDELA)

    write_photometry(tmp_path / "image.exr", tmp_path / "lamp.ies")
    written = photometric_files.read((tmp_path / "lamp.ies").read_bytes())
    assert written.lamp_lumens is None
    assert written.candela[1:-1, 1:-1] == pytest.approx(first.y.T)
    # cos and sin cos integrate to nothing.
    assert flux(written) == pytest.approx(4 * np.pi * _CANDELA, rel=8e-3)
    _check(_measured(tmp_path), _pixel_means(), 1.2e-2 * _CANDELA)


def _intensity(vertical: Angles, horizontal: Angles) -> Angles:
    v, h = np.radians(vertical), np.radians(horizontal - 40.0)
    return np.asarray(_CANDELA * (1.0 + 0.5 * np.cos(v) + 0.4 * np.sin(v) * np.cos(h)))


def _pixel_means() -> Angles:
    """Over solid angle: integrals of cos(v) sin(v), sin(v)^2 and cos(h) over those of sin(v) and 1."""
    v = np.radians(np.linspace(0.0, 180.0, _ROWS + 1))
    h = np.radians(np.linspace(0.0, 360.0, _COLUMNS + 1) - 40.0)
    whole = -np.diff(np.cos(v))
    cosines = np.diff(np.sin(v) ** 2) / 2.0 / whole
    sines = np.diff(v / 2.0 - np.sin(2.0 * v) / 4.0) / whole
    around = np.diff(np.sin(h)) / np.diff(h)
    return np.asarray(_CANDELA * (1.0 + 0.5 * cosines[:, None] + 0.4 * sines[:, None] * around))


def _measured(folder: Path) -> Image:
    lamp: Document = {
        "shape": {"type": "sphere", "centre": [1, 2, 3], "radius": 0.2},
        "kernel": {"type": "lambertian", "reflectance": 0},
        "luminaire": {"radiance": {"illuminant": "D65"}, "profile": {"asset": "lamp.ies"}},
    }
    sensor = {"type": "intensity_meter", "position": [1, 2, 3], "lamp_radius": 0.2}
    return trace({"nocturne": 1, "sensor": sensor, "surfaces": [lamp]}, folder, (_COLUMNS, _ROWS), _SAMPLES)


def _check(image: Image, truth: Angles, uncertainty: float) -> None:
    allowed = sidak_bound(truth.size) * image.y_error + uncertainty
    np.testing.assert_array_less(np.abs(image.y - truth), allowed)
    mean_error = np.sqrt(np.mean(image.y_error.astype(np.float64) ** 2) / truth.size)
    assert abs(np.mean(image.y - truth)) < 3.0 * mean_error + uncertainty
