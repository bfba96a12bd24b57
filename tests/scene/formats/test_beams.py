"""Lamps that throw pictures: their intensities by angle are the picture's, and so is their colour."""

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT
from nocturne_scene.photometry import ies
from nocturne_scene.photometry.intensities import Photometry

from tests.scene.formats.mitsuba_import import SPHERE, imported

AXIS = '<transform name="to_world"><lookat origin="1 2 3" target="1 2 9" up="0 1 0"/></transform>'
# Red top left, green top right, blue below it, white in the fourth corner.
PIXELS = [[[255, 0, 0], [0, 255, 0]], [[255, 255, 255], [0, 0, 255]]]


def lamps(tmp_path: Path, body: str) -> list[tuple[dict[str, Any], Photometry]]:
    (tmp_path / "in").mkdir()
    picture = oiio.ImageBuf(oiio.ImageSpec(2, 2, 3, oiio.UINT8))
    picture.set_pixels(oiio.ROI(), np.array(PIXELS, dtype=np.uint8))
    picture.write(str(tmp_path / "in" / "slide.png"))
    document, found = imported(tmp_path, SPHERE + body)
    assert not found.missing
    made = [surface["luminaire"] for surface in document["surfaces"] if "luminaire" in surface]
    assert all(each["hidden_from"] == "camera_and_mirrors" for each in made)
    return [(each, ies.read((tmp_path / "out" / each["profile"]["asset"]).read_bytes())) for each in made]


def candela(lamp: tuple[dict[str, Any], Photometry], x: float, y: float, z: float) -> float:
    """Towards a point seen from the lamp, in the scene's axes."""
    luminaire, photometry = lamp
    axis, zero = (np.array(luminaire["profile"][key]) for key in ("axis", "zero"))
    towards = np.array([x, y, z]) / np.linalg.norm([x, y, z])
    vertical = np.degrees(np.arccos(towards @ axis))
    horizontal = np.degrees(np.arctan2(towards @ np.cross(zero, axis), towards @ zero)) % 360
    along = [np.interp(vertical, photometry.vertical, row) for row in photometry.candela]
    return float(np.interp(horizontal, photometry.horizontal, along))


def texture(name: str) -> str:
    return f'<texture name="{name}" type="bitmap"><string name="filename" value="slide.png"/></texture>'


def test_a_projector_shows_its_picture_upright(tmp_path: Path) -> None:
    """For someone who looks along its axis, +z: the left is +x."""
    found = lamps(tmp_path, f'<emitter type="projector">{AXIS}{texture("irradiance")}</emitter>')
    assert len(found) == 3
    lit = [
        [candela(lamp, x, y, 4.0) > 1e-3 * lamp[1].candela.max() for lamp in found]
        for y in (1.2, -1.2)
        for x in (1.2, -1.2)
    ]
    assert lit == [[True, False, False], [False, True, False], [True, True, True], [False, False, True]]
    # Beyond the picture there is nothing: by default it is 45 degrees wide.
    assert all(candela(lamp, 1.8, 0.1, 4.0) == 0 for lamp in found)


def test_a_projectors_intensity_is_that_on_its_plane(tmp_path: Path) -> None:
    """pi times the irradiance over the cosine's cube, as measured with Mitsuba 3.9.1."""
    plane = '<rgb name="irradiance" value="2"/><float name="scale" value="3"/>'
    body = f'<emitter type="projector">{AXIS}{plane}</emitter>'
    [lamp] = lamps(tmp_path, body)
    for x in (0.0, 0.3):
        expected = 6 * np.pi * (1 + x**2) ** 1.5 * CANDELAS_PER_UNIT
        assert candela(lamp, 4 * x, 0.0, 4.0) == pytest.approx(expected, rel=2e-3)


def test_a_spots_texture_is_turned_the_other_way(tmp_path: Path) -> None:
    """Its left column is at -x and its top row at -y, as measured with Mitsuba 3.9.1."""
    body = f'<emitter type="spot">{AXIS}{texture("texture")}<float name="cutoff_angle" value="45"/></emitter>'
    found = lamps(tmp_path, body)
    lit = [
        [candela(lamp, x, y, 4.0) > 1e-3 * lamp[1].candela.max() for lamp in found]
        for y in (-2.6, 2.6)
        for x in (-2.6, 2.6)
    ]
    assert lit == [[True, False, False], [False, True, False], [True, True, True], [False, False, True]]
