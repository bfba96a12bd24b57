"""Lights that are hidden from the camera light everything else, and only the camera sees past them.

The camera looks along -z at a wall that emits 3 W m-2 sr-1 nm-1 and scatters nothing, past a lamp that emits
50. Where lights make no difference to the camera, images agree in every bit. Elsewhere only wavelengths are
drawn: a pixel's Y of 64 groups is off by less than 1 %.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.validation.documents import BLACK, diffuse, quad, sphere, surface

from tests.accuracy.tracing import Document, trace

EDGE, SAMPLES = 8, 64
MIRROR = {"type": "conductor", "index": {"n": 1.0, "k": 1000.0}}
NULL = {"type": "null"}
WALL = surface(quad([-20, -20, -9], [40, 0, 0], [0, 40, 0]), BLACK, 3.0)
CAMERA = {
    "type": "pinhole",
    "position": [0, 0, 0],
    "look_at": [0, 0, -1],
    "vertical_field_of_view_degrees": 10,
}


def lamp(kernel: Document, **luminaire: Any) -> Document:
    """It fills the camera's view."""
    return surface(sphere([0, 0, -4], 1.0), kernel, 50.0, **luminaire)


def image(surfaces: list[Document], folder: Path, **more: Any) -> np.ndarray:
    document = {"nocturne": 1, "sensor": CAMERA, "surfaces": surfaces, **more}
    return np.array(trace(document, folder, EDGE, SAMPLES).y)


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> np.ndarray:
    """The image without lamps."""
    return image([WALL], tmp_path_factory.mktemp("wall"))


@pytest.fixture(scope="module")
def unit(wall: np.ndarray) -> float:
    """Y of a radiance of 1."""
    return float(wall.mean()) / 3.0


@pytest.mark.parametrize("kernel", [NULL, diffuse(0.5), MIRROR])
@pytest.mark.parametrize("hidden", ["camera", "camera_and_mirrors"])
def test_the_camera_sees_what_is_behind(
    tmp_path: Path, wall: np.ndarray, kernel: Document, hidden: str
) -> None:
    assert np.array_equal(image([WALL, lamp(kernel, hidden_from=hidden)], tmp_path), wall)


def test_the_camera_sees_other_lamps(tmp_path: Path, unit: float) -> None:
    assert image([WALL, lamp(NULL)], tmp_path) == pytest.approx(53.0 * unit, rel=2e-2)


@pytest.mark.parametrize(("hidden", "seen"), [("camera", 50.0), ("camera_and_mirrors", 3.0)])
@pytest.mark.parametrize("through", ["mirror", "glass"])
def test_what_mirrors_and_glass_show(
    tmp_path: Path, unit: float, hidden: str, seen: float, through: str
) -> None:
    """A mirror in front of the camera shows a lamp behind it, with the wall's radiance all around."""
    sky = {"environment": {"radiance": 3.0}}
    if through == "mirror":
        pane = surface(quad([-5, -5, -2], [10, 0, 0], [0, 10, 0]), MIRROR)
        far = surface(sphere([0, 0, 6], 2.0), BLACK, 50.0, hidden_from=hidden)
        y = image([pane, far], tmp_path, **sky)
        assert y == pytest.approx(seen * unit, rel=2e-2)
        return
    # A clear ball of glass reflects the sky and transmits the lamp's light.
    ball = surface(sphere([0, 0, -4], 1.0), {"type": "dielectric", "index": 1.5})
    far = surface(sphere([0, 0, -60], 40.0), BLACK, 50.0, hidden_from=hidden)
    y = image([ball, far], tmp_path, **sky)
    if hidden == "camera":
        assert y.min() > 30 * unit
    else:
        assert y == pytest.approx(3.0 * unit, rel=2e-2)


@pytest.mark.parametrize("hidden", ["camera", "camera_and_mirrors"])
@pytest.mark.parametrize("direction", ["adjoint", "both"])
def test_the_surface_of_a_hidden_lamp_is_hidden_too(
    tmp_path: Path, wall: np.ndarray, hidden: str, direction: str
) -> None:
    """It emits inwards, too: photons that start there meet its other side, which the camera does not see."""
    dark = lamp(diffuse(0.5), hidden_from=hidden, two_sided=True)
    shown = image([WALL, dark], tmp_path, tracing={"direction": direction})
    assert shown.mean() == pytest.approx(wall.mean(), rel=1e-2)


@pytest.mark.parametrize("hidden", ["camera", "camera_and_mirrors"])
@pytest.mark.parametrize("direction", ["adjoint", "both"])
def test_everything_else_is_lit_the_same(tmp_path: Path, hidden: str, direction: str) -> None:
    """A floor next to the lamp; with media, so that the tracer takes no short cut, and without."""
    floor = surface(quad([-1, -1, -9], [2, 0, 0], [0, 2, 0]), diffuse(0.7))
    above = surface(sphere([0, 3, -7], 0.5), NULL, 50.0)
    dark = {**above, "luminaire": {"radiance": 50.0, "hidden_from": hidden}}
    pane = surface(quad([-0.2, -0.2, -8], [0.4, 0, 0], [0, 0.4, 0]), {"type": "thin_pane", "index": 1.5})
    tracing = {"tracing": {"direction": direction}}
    for beside in ([], [pane]):
        shown = image([floor, above, *beside], tmp_path, **tracing)
        assert shown.mean() > 0
        assert np.array_equal(image([floor, dark, *beside], tmp_path, **tracing), shown)


@pytest.mark.parametrize("environment", [{"radiance": 50.0}, {"cie": 5, "illuminance": 1e4}])
def test_skies_and_suns_can_be_hidden(tmp_path: Path, environment: Document) -> None:
    floor = surface(quad([-0.3, -0.3, -4], [0.3, 0, 0], [0, 0.6, 0]), diffuse(0.7))
    sun = {"direction": [0, 0.01, -1], "angular_diameter_degrees": 20, "radiance": 20.0}
    shown, hidden = (
        image(
            [floor],
            tmp_path,
            environment=environment | more,
            distant=[sun | more],
        )
        for more in ({}, {"hidden_from": "camera"})
    )
    assert np.all(hidden[:, EDGE // 2 :] == 0)
    assert np.all(shown[:, EDGE // 2 :] > 0)
    assert np.array_equal(shown[2:-2, 2:3], hidden[2:-2, 2:3])
    assert np.all(hidden[2:-2, 2:3] > 0)


def test_meters_see_every_light(tmp_path: Path) -> None:
    meter = {"type": "irradiance_meter", "position": [0, 0, 0], "normal": [0, 0, -1], "height": 0.01}
    shown, hidden = (
        image([lamp(NULL, **more)], tmp_path, sensor=meter)
        for more in ({}, {"hidden_from": "camera_and_mirrors"})
    )
    assert shown.mean() > 0
    assert np.array_equal(shown, hidden)
