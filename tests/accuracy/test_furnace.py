"""The furnace: in a closed box whose walls scatter a of the light and all emit L, radiance is L / (1 - a).

Everywhere, from a scene document through the compiler to the image, in absolute units.
"""

from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.validation.documents import furnace

from tests.accuracy.agreement import ROUNDING, sidak_bound
from tests.accuracy.spectral_meters import Y_PER_RADIANCE
from tests.accuracy.tracing import trace

pytestmark = pytest.mark.system

# A fault shows in every pixel alike: more samples of fewer pixels find a smaller one at the same cost.
_EDGE = 8
_SAMPLES = 1024

_RADIANCE = 2.0
"""W m-2 sr-1 nm-1, at all wavelengths."""


@pytest.mark.parametrize("albedo", [0.0, 0.5, 0.9])
def test_every_pixel_is_right(albedo: float, tmp_path: Path) -> None:
    """Largest |z| of all pixels within the Sidak bound, and the mean within 3 standard errors.

    False alarms: 0.01 + 0.003 with independent points; less with Sobol's, whose standard errors are large.
    """
    image = trace(furnace(albedo, _RADIANCE), tmp_path, _EDGE, _SAMPLES)
    truth = _RADIANCE / (1.0 - albedo) * Y_PER_RADIANCE
    allowed = sidak_bound(image.y.size) * image.y_error + ROUNDING * truth
    np.testing.assert_array_less(np.abs(image.y - truth), allowed)
    mean_error = np.sqrt(np.mean(image.y_error.astype(np.float64) ** 2) / image.y.size)
    assert abs(image.y.mean() - truth) < 3.0 * mean_error + ROUNDING * truth


def test_units_are_absolute(tmp_path: Path) -> None:
    """Walls that only emit: the wavelength is the only chance left, and its points are spread evenly.

    So the mean is right to 1e-4, ten times better than the standard error of independent points.
    """
    image = trace(furnace(0.0, _RADIANCE), tmp_path, _EDGE, _SAMPLES)
    assert image.y.mean() == pytest.approx(_RADIANCE * Y_PER_RADIANCE, rel=1e-4)
