"""Photons that are guided make the same image, whatever guides them.

Half of those that are sent towards lights then go where learned light comes from (docs/decisions/0104). Here
it was not learned but made up: from the lamp, from its mirror image, and from anywhere, at places all over
the scene. So any error in a density moves the image.
"""

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import diffuse, quad, sphere, surface

from tests.accuracy.agreement import compare
from tests.accuracy.meters import Measurement, independent_image
from tests.accuracy.tracing import Document

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]

_LAMP = np.array([0.2, 1.4, 0.1])


def _scene(*surfaces: Document) -> Document:
    camera = {"type": "pinhole", "position": [0.2, 1.2, 1.8], "look_at": [0, 0.1, 0]}
    return {
        "nocturne": 1,
        "sensor": camera | {"vertical_field_of_view_degrees": 40},
        "surfaces": [
            surface(quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), diffuse(0.6)),
            surface(sphere(_LAMP.tolist(), 0.3), diffuse(0.2), 1.0),
            *surfaces,
        ],
    }


_WATER = surface(
    {"type": "box", "minimum": [-0.8, -0.1, -0.8], "maximum": [0.8, 0.3, 0.8]},
    {"type": "dielectric", "index": 1.33},
)
_MURKY_WATER = _WATER | {"interior": {"media": ["murk"]}}
_FOG = {
    "shape": {"type": "box", "minimum": [-3, -1, -3], "maximum": [3, 4, 3]},
    "interior": {"media": ["murk"]},
}
_MIRROR = surface(quad([-1, 0, -1], [2, 0, 0], [0, 1, 0]), {"type": "conductor", "index": "Ag"})
_ROUGH = surface(
    quad([-1, 0, -1], [2, 0, 0], [0, 1, 0]), {"type": "conductor", "index": "Ag", "roughness": 0.2}
)
_PANE = surface(quad([-0.8, 0.5, -0.8], [0, 0, 1.6], [1.6, 0, 0]), {"type": "thin_pane", "index": 1.8})

_MEDIA: Document = {"media": {"murk": {"scattering": 0.4, "absorption": 0.1}}}

SCENES = {
    "water": _scene(_WATER),
    "murky water": _scene(_MURKY_WATER) | _MEDIA,
    "mirror in fog": _scene(_MIRROR, _FOG) | _MEDIA,
    "mirror and pane": _scene(_MIRROR, _PANE),
    "rough mirror": _scene(_ROUGH, surface(sphere([0.3, 0.3, 0], 0.2), {"type": "dielectric", "index": 1.5})),
}


def _arrivals(count: int = 4000) -> bytes:
    """As CompiledScene.learned_light has them."""
    random = np.random.default_rng(1)
    floor = np.stack([random.uniform(-1, 1, count), np.zeros(count), random.uniform(-1, 1, count)], axis=1)
    anywhere = random.uniform([-1, 0, -1], [1, 1.2, 1], (count, 3))
    places = np.where(random.random((count, 1)) < 0.8, floor, anywhere)
    goals = _LAMP + random.normal(0, 0.15, (count, 3))
    goals[::3] *= [1, 1, -1]  # and behind the mirror, which stands at z = -1
    goals[::3, 2] -= 2
    directions = goals - places
    directions[::7] = random.normal(size=directions[::7].shape)
    l1 = np.abs(directions).sum(axis=1, keepdims=True)
    x, y, z = (directions / l1).T
    u = np.where(z < 0, (1 - np.abs(y)) * np.copysign(1, x), x)
    v = np.where(z < 0, (1 - np.abs(x)) * np.copysign(1, y), y)
    steps = np.rint(np.stack([u, v], axis=1) * 32767).astype(int)
    return b"".join(struct.pack("<3f2h", *p, *s) for p, s in zip(places, steps, strict=True))


@pytest.mark.parametrize(
    "tracing",
    [
        {"direction": "adjoint", "sharing": 1},
        {"direction": "adjoint", "sharing": 16},
        {"direction": "both", "sharing": 1},
        {"direction": "adjoint", "estimator": "mixture", "mixture": {"kernel": 0.6, "luminaires": 0.4}},
    ],
    ids=["alone", "shared", "both", "mixture"],
)
@pytest.mark.parametrize("name", SCENES)
def test_what_guides_photons_changes_no_image(name: str, tracing: dict[str, Any], tmp_path: Path) -> None:
    """z of tiles and of the mean; false alarms: 0.013 for each scene and method."""
    plain: dict[str, Any] = {"direction": "adjoint", "sharing": 1}
    reference = independent_image(SCENES[name], 1, tmp_path / "plain", **plain)
    guided = independent_image(
        SCENES[name], 2, tmp_path / "guided", lambda one: one.guide(_arrivals()), **tracing
    )
    compare(reference, guided).check_mean_and_tiles()


def test_guided_photons_caught_in_a_murky_ball_end(tmp_path: Path) -> None:
    """Sent towards light from a collision in glass and totally reflected they went on until their weight
    underflowed: 30 rays for each sample instead of 4."""
    murky = surface(sphere([0, 0.4, 0], 0.3), {"type": "dielectric", "index": 1.5})
    document = _scene(murky | {"interior": {"media": ["murk"]}})
    document["media"] = {"murk": {"scattering": 3.0, "absorption": 0.3}}
    rays = []
    for guided in (False, True):
        (tmp_path / str(guided)).mkdir()
        measurement = Measurement(document, tmp_path / str(guided), 16, 16)
        if guided:
            measurement.guide(_arrivals())
        measurement.image(64, 1)
        rays.append(measurement.statistics["rays"])
    assert rays[0] < rays[1] < 2.5 * rays[0]
