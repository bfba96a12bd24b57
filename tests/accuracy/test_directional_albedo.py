"""White furnaces: light of radiance 1 from everywhere; a plate then shows its directional albedo."""

from math import acos, cos, sin
from pathlib import Path

import pytest
from nocturne_scene.validation.documents import measured_scene, quad, surface

from tests.accuracy.meters import Measurement, Reading
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

# Reflects all but 4 n / ((n + 1)^2 + k^2) = 4e-7 along the normal, and less than 1e-6 at other angles.
_MIRROR = {"n": 0.001, "k": 100.0}

_GGX = {
    # alpha: by the cosine of the angle of view, 1, 0.7, 0.5, 0.2
    0.1: (0.98830419, 0.98141853, 0.96920501, 0.90455907),
    0.25: (0.91581396, 0.88533576, 0.85726346, 0.84815992),
    0.5: (0.68784825, 0.68295422, 0.69825069, 0.78992919),
    1.0: (0.30685191, 0.37888775, 0.45069387, 0.64164812),
}
_COSINES = (1.0, 0.7, 0.5, 0.2)


def _albedo(kernel: Document, cosine: float, estimator: str, folder: Path, samples: int) -> Reading:
    angle = acos(cosine)
    sensor = {
        "type": "radiance_meter",
        "position": [0.1 * sin(angle), 0.0, 0.1 * cos(angle)],
        "look_at": [0, 0, 0],
        "diameter": 1e-4,
        "cone_degrees": 1e-3,
    }
    plate = surface(quad([-1, -1, 0], [2, 0, 0], [0, 2, 0]), kernel)
    document = measured_scene(sensor, [plate], estimator=estimator)
    document["environment"] = {"radiance": 1.0}
    return Measurement(document, folder, 16, 16).by_pixels(samples)


@pytest.mark.parametrize("estimator", ["two_photons", "mixture", "split"])
@pytest.mark.parametrize("alpha", _GGX)
def test_rough_mirror(alpha: float, estimator: str, tmp_path: Path) -> None:
    """GGX with Smith's height-correlated masking, single scattering (Heitz, JCGT 3(2), 2014), by quadrature
    to 6e-6; 1 - ln 2 for alpha 1 seen along the normal. False alarms: 0.01."""
    kernel = {"type": "conductor", "roughness": alpha, "index": _MIRROR}
    for cosine, truth in zip(_COSINES, _GGX[alpha], strict=True):
        folder = tmp_path / str(cosine)
        folder.mkdir()
        reading = _albedo(kernel, cosine, estimator, folder, 256)
        reading.check(truth, 2.5e-5 + 6e-6 / truth, values=4)


@pytest.mark.parametrize("estimator", ["two_photons", "mixture", "split"])
@pytest.mark.parametrize("exponent", [10.0, 1000.0, 100_000.0])
def test_phong_seen_along_the_normal(exponent: float, estimator: str, tmp_path: Path) -> None:
    """(n + 2) / 2 pi times the integral of cos^(n + 1) over the half-sphere is 1. False alarms: 0.01."""
    kernel = {"type": "phong", "reflectance": 1.0, "exponent": exponent}
    _albedo(kernel, 1.0, estimator, tmp_path, 256).check(1.0, 2e-5)
