"""Light that photons meet too rarely for a pilot to learn where it comes from."""

from pathlib import Path

import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_scene.compile.ways import unmet_light
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

GLASS_BALL = Path(__file__).parents[2] / "examples" / "pbrt" / "glass_ball.pbrt"


@pytest.mark.parametrize("samples", [2, 16, 128])
def test_a_ball_of_glass_on_a_wide_floor_is_found_by_what_may_gather_light(
    samples: int, tmp_path: Path
) -> None:
    """Under an even sky and a Sun, one photon of 800 that leave for a floor of 40 m meets the ball of 1 m. By
    photons from the sensor alone this film's mean is 363.7 cd/m2 and 128 samples say +- 0.1; 365.4 is true.
    """
    document = import_scene(GLASS_BALL, tmp_path / "scene", ImportOptions()).document
    compiled = compile_to(document, tmp_path, 320, 320, samples)
    assert compiled.way.startswith("photons from both directions"), compiled.way


def test_light_that_a_pilot_hardly_met_is_told() -> None:
    assert (unmet_light(0.0), unmet_light(0.0049)) == ("", "")
    assert "up to 2.4% of the mean may be missing" in unmet_light(0.024)
    assert '`"direction": "forward"` would find it' in unmet_light(0.024, "forward")
