"""Photons that know which sky is visible make the same image, whatever they know.

Half of those that are sent to the sky then go where it was met (docs/decisions/0116). Here that was not
learned but made up: through the window, and anywhere, at places all over the room and beyond it. So any error
in a density moves the image.
"""

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to

from tests.accuracy.agreement import compare
from tests.accuracy.meters import independent_image
from tests.accuracy.tracing import write
from tests.accuracy.window_rooms import SCENES

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]


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
    plain: dict[str, Any] = {"direction": "adjoint", "sharing": 1}
    reference = independent_image(SCENES[name], 1, tmp_path / "plain", guide="none", **plain)
    knowing = independent_image(
        SCENES[name], 2, tmp_path / "knowing", lambda one: one.see(_sightings()), guide="none", **tracing
    )
    compare(reference, knowing).check_mean_and_tiles()


@pytest.mark.parametrize(("name", "pays"), [("sky", True), ("film", True), ("sky and Sun", False)])
def test_a_pilot_keeps_what_pays(name: str, pays: bool, tmp_path: Path) -> None:
    """`python -m bench visible_sky`: 2.0 and 2.5 times the efficiency, and 0.94 where it was kept always."""
    document = write({**SCENES[name], "tracing": {"guide": "auto"}}, tmp_path)
    compiled = compile_to(document, tmp_path, 96, 64, 64)
    scene = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes())
    assert bool(scene.visible_sky) == pays
