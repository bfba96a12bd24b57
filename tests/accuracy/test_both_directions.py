"""R_A = R: adjoint photons from the sensor and forward photons from the luminaires measure the same.

Morley et al., "Image Synthesis using Adjoint Photons", GI 2006. Independent random numbers, so that standard
errors are right; single pixels have enough hits to be near normal. A difference of the means of 2 to 7 %,
by scene, would be seen. Where a closed form exists, test_form_factors.py and test_enclosures.py compare both
directions with it.
"""

from pathlib import Path

import pytest
from nocturne_scene.validation.documents import quad, sphere

from tests.accuracy.agreement import compare
from tests.accuracy.both_directions import SCENES
from tests.accuracy.meters import image_by
from tests.system.images import Image

pytestmark = [pytest.mark.system, pytest.mark.every_sixth]


def _trace(name: str, direction: str, seed: int, folder: Path) -> Image:
    scene = SCENES[name]
    return image_by(
        direction, scene.document, scene.pixels, scene.samples[direction], seed, folder / direction
    )


@pytest.mark.parametrize("name", ["plain", "growing lamp", "mirror, film", "lamp in glass"])
def test_aimed_emission_measures_the_same(name: str, tmp_path: Path) -> None:
    """Most photons of the lamp fly towards a ball in the scene, which holds the lamp itself where that is in
    glass, and towards a screen, which is behind some lamps. False alarms: 0.023 for each scene."""
    scene = SCENES[name]
    important = [
        {"shape": sphere([0.1, 0.1, 0.2], 0.25), "weight": 3.0},
        {"shape": quad([-0.5, -0.5, 0.5], [1, 0, 0], [0, 1, 0])},
    ]
    tracing = scene.document.get("tracing", {}) | {"aimed_emission": 0.8}
    document = scene.document | {"important_directions": important, "tracing": tracing}
    adjoint = _trace(name, "adjoint", 1, tmp_path)
    samples = scene.samples["forward"]
    aimed = image_by("forward", document, scene.pixels, samples, 3, tmp_path / "aimed")
    plain = _trace(name, "forward", 3, tmp_path)
    assert (aimed.y != plain.y).any()
    # Where the ball holds the lamp, few photons are left for a pixel of the film: their sum is not normal.
    agreement = compare(adjoint, aimed)
    if name == "lamp in glass":
        agreement.check_mean_and_tiles()
    else:
        agreement.check()


@pytest.mark.parametrize("name", SCENES)
def test_both_measure_the_same(name: str, tmp_path: Path) -> None:
    """z of pixels, of tiles and of the mean; false alarms: 0.023 for each scene."""
    adjoint = _trace(name, "adjoint", 1, tmp_path)
    forward = _trace(name, "forward", 2, tmp_path)
    assert forward.y.mean() > 0.0
    compare(adjoint, forward).check()
