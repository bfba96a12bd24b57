"""Stokes parameters do not depend on how directions are drawn: towards lights, by mixtures, split, one photon
at a time, or guided by which sky is visible.

Photons from luminaires, and pixels that share, are refused in such scenes: tests/scene/test_polarisation.py.
"""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from nocturne_scene.compare.images import read_picture
from nocturne_scene.validation.documents import box, quad, surface

from tests.accuracy.agreement import compare
from tests.accuracy.meters import independent_image
from tests.accuracy.test_visible_sky import _sightings
from tests.accuracy.window_rooms import SCENES

pytestmark = pytest.mark.system

_METAL = {"type": "conductor", "index": {"n": 0.9, "k": 3.2}, "roughness": 0.3}
_AIR = {"air": {"scattering": 0.15, "absorption": 0.02, "phase": {"type": "rayleigh"}}}


def _room() -> dict[str, Any]:
    """With a floor of rough metal, a block of glass on it, and air that polarises."""
    room = SCENES["sky and Sun"]
    sensor = {**room["sensor"], "stokes": True}
    floor = surface(quad([0, 0, 0.01], [4, 0, 0], [0, 4, 0]), _METAL)
    block = surface(box([2, 2, 0.1], [2.6, 2.6, 0.7]), {"type": "dielectric", "index": 1.5})
    haze = {"shape": box([-0.5, -1, -0.5], [4.5, 4.5, 3.5]), "interior": {"media": ["air"]}}
    return {
        **room,
        "sensor": sensor,
        "surfaces": [*room["surfaces"], floor, block, haze],
        "media": _AIR,
    }


def _of(folder: Path, name: str) -> Any:
    """An image's channel in the place of Y, with the error by its samples alone."""
    picture = read_picture(folder / "image.exr")
    assert picture.moments is not None
    place = picture.names.index(name)
    error = np.sqrt(picture.moments.variance[..., place])
    return SimpleNamespace(y=picture.moments.mean[..., place], y_error=error)


@pytest.mark.parametrize(
    "tracing",
    [
        {"photons_together": 1},
        {"estimator": "mixture", "mixture": {"kernel": 0.6, "environment": 0.4}},
        {"estimator": "split", "split_vertices": 2},
        {"guide": "auto"},
    ],
    ids=["one by one", "mixture", "split", "guided"],
)
def test_the_method_changes_no_stokes_parameter(tracing: dict[str, Any], tmp_path: Path) -> None:
    """z of tiles and of the mean of S1 and S2; false alarms: 0.03 for each method."""
    see = (lambda one: one.see(_sightings())) if "guide" in tracing else None
    plain = independent_image(_room(), 1, tmp_path / "plain", guide="none")
    independent_image(_room(), 2, tmp_path / "other", see, **{"guide": "none", **tracing})
    for name in ("S1.Y", "S2.Y"):
        one, other = (_of(tmp_path / folder, name) for folder in ("plain", "other"))
        # Otherwise nothing is tested.
        assert np.abs(one.y).mean() > 0.01 * plain.y.mean()
        compare(one, other).check_mean_and_tiles()
