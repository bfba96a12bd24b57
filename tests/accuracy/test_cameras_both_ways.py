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
from tests.accuracy.tracing import part_of
from tests.system.images import Image

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]


def _trace(name: str, direction: str, seed: int, folder: Path, ratio: float = 1.0) -> Image:
    scene = SCENES[name]
    samples = part_of(2 * scene.samples)
    document = {**scene.document, "tracing": {"forward_ratio": ratio}}
    return image_by(direction, document, scene.pixels, samples, seed, folder / direction)


@pytest.mark.parametrize("ratio", [1 / 16, 8])
def test_a_ratio_of_photons_changes_no_image(ratio: float, tmp_path: Path) -> None:
    """They come in ranges of their own beside the one tile. False alarms: 0.013 for each."""
    name = next(iter(SCENES))
    adjoint = _trace(name, "adjoint", 3, tmp_path)
    compare(adjoint, _trace(name, "both", 4, tmp_path, ratio)).check_mean_and_tiles()


@pytest.mark.parametrize("name", SCENES)
def test_both_directions_make_the_same_image(name: str, tmp_path: Path) -> None:
    """z of tiles and of the mean; false alarms: 0.013 for each scene."""
    adjoint = _trace(name, "adjoint", 1, tmp_path)
    compare(adjoint, _trace(name, "both", 2, tmp_path)).check_mean_and_tiles()
