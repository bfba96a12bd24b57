"""A camera's image with photons from the luminaires is that of photons from the camera alone.

Each path of light is found by one of the two (docs/decisions/0032): what is counted twice or not at all moves
the mean by a part of what the luminaires' photons bring. Independent random numbers. Single pixels are not
compared: photons from the camera find gathered light too seldom.
"""

from pathlib import Path

import pytest

from tests.accuracy.agreement import compare
from tests.accuracy.cameras_both_ways import SCENES
from tests.accuracy.meters import image_by
from tests.accuracy.scenes import quad, sphere
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
    """They come in ranges of their own beside the one tile. False alarms: 0.013 for each."""
    name = next(iter(SCENES))
    adjoint = _trace(name, "adjoint", 3, tmp_path)
    compare(adjoint, _trace(name, "both", 4, tmp_path, ratio)).check_mean_and_tiles()


def test_distant_light_can_be_aimed(tmp_path: Path) -> None:
    """The Sun and the sky at a part of the ball, and at what is none. False alarms: 0.013."""
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
