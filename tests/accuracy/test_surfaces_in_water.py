"""Panes, paint and metal in water look as their relative index does in air.

All of the scene, the camera and the lamp too, is in a body of index 1.33, and in a black box within that: at
the body's faces light may be totally reflected until it comes back. Fresnel's equations know the ratio of two
indices only. False alarms: 0.001 for each case.
"""

from collections.abc import Callable
from pathlib import Path

import pytest
from nocturne_scene.validation.documents import BLACK, box, diffuse, quad, surface

from tests.accuracy.eight_seeds import differ, means
from tests.accuracy.tracing import Document

pytestmark = pytest.mark.system

_WATER = 1.33


def _scene(floor: Document, *more: Document) -> Document:
    """A floor that mirrors a lamp and a wall that shines."""
    camera = {"type": "pinhole", "position": [0, 1.2, -1.8], "look_at": [0, 0.3, 0]}
    lamp = surface(quad([-0.4, 2.0, 0.2], [0.8, 0, 0], [0, 0, 0.8]), BLACK, 10.0)
    wall = surface(quad([-2, 0, 2.2], [0, 3, 0], [4, 0, 0]), diffuse(0.5), 0.2)
    ground = surface(quad([-2, 0, -2], [0, 0, 4], [4, 0, 0]), floor)
    sensor = camera | {"vertical_field_of_view_degrees": 35}
    return {"nocturne": 1, "sensor": sensor, "surfaces": [ground, lamp, wall, *more]}


def _pane(index: float) -> Document:
    pane = {"type": "thin_pane", "index": index}
    return _scene(diffuse(0.8), surface(quad([-0.6, 0.6, -0.6], [1.2, 0, 0], [0, 0, 1.2]), pane))


def _coat(index: float, roughness: float) -> Document:
    return _scene({"type": "coated_diffuse", "reflectance": 0.7, "index": index, "roughness": roughness})


def _metal(around: float, roughness: float) -> Document:
    silver = {"n": 0.5 * around, "k": 1.5 * around}
    return _scene({"type": "conductor", "index": silver, "roughness": roughness})


def _plastic(index: float) -> Document:
    return _scene({"type": "principled", "base": 0.5, "roughness": 0.5, "index": index})


_SCENES: dict[str, Callable[[float], Document]] = {
    "pane": lambda around: _pane(1.5 * around),
    "pane of water": _pane,
    "smooth coat": lambda around: _coat(1.5 * around, 0.0),
    "rough coat": lambda around: _coat(1.5 * around, 0.3),
    "coat of air": lambda around: _coat(0.9 * around, 0.0),
    "mirror": lambda around: _metal(around, 0.0),
    "rough metal": lambda around: _metal(around, 0.1),
    "plastic": lambda around: _plastic(1.5 * around),
}


@pytest.mark.parametrize("name", _SCENES)
def test_surfaces_in_water_go_by_their_relative_index(name: str, tmp_path: Path) -> None:
    """With the index of their surroundings taken for 1, a smooth coat had 0.83, a rough one 0.86, a pane of
    water 0.94 and metal 1.03 of the right light."""
    water = surface(box([-200] * 3, [200] * 3), {"type": "dielectric", "index": _WATER})
    within = _SCENES[name](_WATER)
    within["surfaces"] += [surface(box([-190] * 3, [190] * 3)), water]
    air = means(_SCENES[name](1.0), tmp_path / "air")
    assert not differ(air, means(within, tmp_path / "water"))
