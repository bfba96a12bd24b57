"""Photons that know which sky is visible make the same image, whatever they know.

Most of those that are sent to the sky then go where it was met (docs/decisions/0116). Here that was not
learned but made up: through the window, and anywhere, at places all over the room and beyond it. So any error
in a density moves the image.
"""

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import diffuse, quad, surface

from tests.accuracy.agreement import compare
from tests.accuracy.meters import Measurement
from tests.accuracy.tracing import Document, part_of
from tests.system.images import Image

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_CAMERA = {
    "type": "pinhole",
    "position": [0.6, 0.6, 1.5],
    "look_at": [3, 3, 0.5],
    "up": [0, 0, 1],
    "vertical_field_of_view_degrees": 70,
}
_METER = {"type": "irradiance_meter", "position": [2, 2, 0.8], "normal": [0, 0, 1], "height": 1}
_SKY = {"cie": 12, "sun": [1, -1, 1], "up": [0, 0, 1], "illuminance": 10000}
_SUN = {"direction": [0.3, -1, 0.8], "angular_diameter_degrees": 5, "irradiance": 3.0}
_PANE = surface(quad([1.2, 0, 1], [0, 0, 1.4], [1.6, 0, 0]), {"type": "thin_pane", "index": 1.5})
_HAZE = {
    "shape": {"type": "box", "minimum": [-0.5, -1, -0.5], "maximum": [4.5, 4.5, 3.5]},
    "interior": {"media": ["haze"]},
}
_CURTAIN = surface(
    quad([1.2, 0.1, 1], [0, 0, 1.4], [1.6, 0, 0]),
    {"type": "diffuse_transmitter", "reflectance": 0.3, "transmittance": 0.5},
)


def _room(*surfaces: Document, **given: Any) -> Document:
    """Of 4 m x 4 m x 3 m with a window."""
    walls = [
        quad([0, 0, 0], [4, 0, 0], [0, 4, 0]),
        quad([0, 0, 3], [0, 4, 0], [4, 0, 0]),
        quad([0, 4, 0], [4, 0, 0], [0, 0, 3]),
        quad([0, 0, 0], [0, 4, 0], [0, 0, 3]),
        quad([4, 0, 0], [0, 0, 3], [0, 4, 0]),
        quad([0, 0, 0], [0, 0, 1], [4, 0, 0]),
        quad([0, 0, 2.4], [0, 0, 0.6], [4, 0, 0]),
        quad([0, 0, 1], [0, 0, 1.4], [1.2, 0, 0]),
        quad([2.8, 0, 1], [0, 0, 1.4], [1.2, 0, 0]),
    ]
    return {
        "nocturne": 1,
        "sensor": _CAMERA,
        "environment": _SKY,
        "surfaces": [*(surface(each, diffuse(0.5)) for each in walls), *surfaces],
        **given,
    }


SCENES = {
    "sky": _room(),
    "even sky": _room(environment={"radiance": 1.0}),
    "sky and Sun": _room(distant=[_SUN]),
    "pane": _room(_PANE),
    "haze": _room(_HAZE, media={"haze": {"scattering": 0.05, "absorption": 0.02}}),
    "curtain": _room(_CURTAIN),
    "film": _room(sensor=_METER),
    "lamp": _room(surface({"type": "sphere", "centre": [2, 3, 2.5], "radius": 0.2}, diffuse(0.2), 1e3)),
}


def _sightings(count: int = 4000) -> bytes:
    """As CompiledScene.visible_sky has them."""
    random = np.random.default_rng(1)
    places = random.uniform([-1, -1, 0], [5, 5, 3], (count, 3))
    places[::2, 2] = 0
    window = np.stack(
        [random.uniform(1.2, 2.8, count), np.zeros(count), random.uniform(1, 2.4, count)], axis=1
    )
    directions = window - places
    directions[::5] = random.normal(size=directions[::5].shape)
    x, y, z = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).T
    t = y / (np.abs(x) + np.abs(y))
    turn = np.where(x >= 0, np.where(t >= 0, t, 4 + t), 2 - t)
    bins = np.minimum(15, (8 * (z + 1)).astype(int)) * 32 + np.minimum(31, (8 * turn).astype(int))
    sides = random.integers(0, 6, count)
    sides[::2] = 4
    worth = np.exp(random.normal(size=count)).astype(np.float32).view(np.uint32) >> 16
    return b"".join(
        struct.pack("<3f2H", *place, 512 * side + bin_, each)
        for place, side, bin_, each in zip(places, sides, bins, worth, strict=True)
    )


def _image(document: Document, seed: int, folder: Path, *, knows: bool, **tracing: Any) -> Image:
    folder.mkdir()
    traced = {**document, "tracing": {"sequence": "independent", "guide": "none", **tracing}}
    measurement = Measurement(traced, folder, 16, 16)
    if knows:
        measurement.see(_sightings())
    image = measurement.image(part_of(1024), seed)
    assert measurement.statistics["invalid_samples"] == 0
    return image


@pytest.mark.parametrize(
    "tracing",
    [
        {"direction": "adjoint", "sharing": 1},
        {"direction": "adjoint", "sharing": 16},
        {"direction": "adjoint", "photons_together": 1},
        {"direction": "adjoint", "estimator": "mixture", "mixture": {"kernel": 0.6, "environment": 0.4}},
        {"direction": "adjoint", "estimator": "split", "split_vertices": 2},
    ],
    ids=["alone", "shared", "one by one", "mixture", "split"],
)
@pytest.mark.parametrize("name", SCENES)
def test_what_is_known_of_the_sky_changes_no_image(
    name: str, tracing: dict[str, Any], tmp_path: Path
) -> None:
    """z of tiles and of the mean; false alarms: 0.013 for each scene and method."""
    plain = {"direction": "adjoint", "sharing": 1}
    reference = _image(SCENES[name], 1, tmp_path / "plain", knows=False, **plain)
    knowing = _image(SCENES[name], 2, tmp_path / "knowing", knows=True, **tracing)
    compare(reference, knowing).check_mean_and_tiles()
