"""A camera's image with photons from the luminaires is that of photons from the camera alone.

Each path of light is found by one of the two (docs/decisions/0032): paths that are counted twice or not at
all change the mean by a part of the luminaires' photons. Random numbers are independent. Single pixels are
not compared: photons from the camera find focused light too seldom.
"""

from pathlib import Path

import pytest
from nocturne_scene.validation.documents import diffuse, measured_scene, quad, sphere, surface

from tests.accuracy.agreement import compare
from tests.accuracy.cameras_both_ways import SCENES
from tests.accuracy.meters import Measurement, check_equal, image_by
from tests.accuracy.tracing import Document, part_of
from tests.system.images import Image

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]


def _trace(
    name: str, direction: str, seed: int, folder: Path, ratio: float = 1.0, more: Document | None = None
) -> Image:
    scene = SCENES[name]
    samples = part_of(2 * scene.samples)
    document = {**scene.document, "tracing": {"forward_ratio": ratio}, **(more or {})}
    return image_by(direction, document, scene.pixels, samples, seed, folder / direction)


@pytest.mark.parametrize("ratio", [1 / 16, 8])
def test_a_ratio_of_photons_changes_no_image(ratio: float, tmp_path: Path) -> None:
    """Forward photons come in separate ranges in addition to the one tile. False alarms: 0.013 for each."""
    name = next(iter(SCENES))
    adjoint = _trace(name, "adjoint", 3, tmp_path)
    compare(adjoint, _trace(name, "both", 4, tmp_path, ratio)).check_mean_and_tiles()


def test_distant_light_can_be_aimed(tmp_path: Path) -> None:
    """The Sun and the sky are aimed at a part of the ball, and at empty space. False alarms: 0.013."""
    important = [
        {"shape": sphere([0.1, 0.5, 0], 0.25), "weight": 3.0},
        {"shape": quad([-1, 0.1, -1], [0.5, 0, 0], [0, 0.5, 0])},
    ]
    more = {"important_directions": important, "tracing": {"aimed_emission": 0.8}}
    name = "Sun and sky"
    aimed = _trace(name, "both", 2, tmp_path, more=more)
    (tmp_path / "plain").mkdir()
    assert (aimed.y != _trace(name, "both", 2, tmp_path / "plain").y).any()
    compare(_trace(name, "adjoint", 1, tmp_path), aimed).check_mean_and_tiles()


@pytest.mark.parametrize("name", SCENES)
def test_both_directions_make_the_same_image(name: str, tmp_path: Path) -> None:
    """z of tiles and of the mean; false alarms: 0.013 for each scene."""
    adjoint = _trace(name, "adjoint", 1, tmp_path)
    compare(adjoint, _trace(name, "both", 2, tmp_path)).check_mean_and_tiles()


@pytest.mark.parametrize("index", [{"n": 0.001, "k": 100.0}, "Ag"], ids=["ideal", "silver"])
def test_what_a_mirror_throws_from_floor_to_floor_is_met(index: object, tmp_path: Path) -> None:
    """No surface in the scene transmits light, so that the tracer only traces shadow rays to the sky. Between
    a white floor and an ideal mirror even light stays even; photons from the camera alone show the part that
    silver absorbs, too. False alarms: 0.01 for each.
    """
    sensor = {
        "type": "pinhole",
        "position": [0, 1.2, 1.8],
        "look_at": [0, 0.1, 0],
        "vertical_field_of_view_degrees": 30,
    }
    ball = surface(sphere([0, 0.35, 0], 0.3), {"type": "conductor", "index": index})
    floor = surface(quad([-1, 0, -1], [0, 0, 2], [2, 0, 0]), diffuse(1.0))
    document = measured_scene(sensor, [floor, ball]) | {"environment": {"radiance": 1.0}}
    readings = {}
    for direction in ("adjoint", "both"):
        (tmp_path / direction).mkdir()
        traced = document | {"tracing": {"direction": direction, "sharing": 1}}
        readings[direction] = Measurement(traced, tmp_path / direction, 16, 16).by_seeds(1024)
    if index != "Ag":
        readings["both"].check(1.0)
    else:
        check_equal(readings["both"], readings["adjoint"])
