"""How bright pbrt's lights are where several parameters say so, against lights.cpp of pbrt-v4."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions

FLOOR = 'Shape "disk"\n'


def imported(tmp_path: Path, light: str) -> dict[str, Any]:
    (tmp_path / "in").mkdir(parents=True, exist_ok=True)
    scene = f'Camera "perspective"\nWorldBegin\nLightSource {light}\n{FLOOR}'
    (tmp_path / "in" / "a.pbrt").write_text(scene)
    found = import_scene(tmp_path / "in" / "a.pbrt", tmp_path / "out", ImportOptions(light_radius=0.01))
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document


@pytest.mark.parametrize(
    ("given", "lux"),
    [
        # https://github.com/mmp/pbrt-v4/issues/130: both, which are multiplied. A floor of reflectance 0.5
        # below has 318.31 cd/m2.
        ('"float illuminance" 1000 "float scale" 2', 2000.0),
        ('"float illuminance" 1000', 1000.0),
        ('"float scale" 2', 2.0),
        ('"float illuminance" -1 "float scale" 2', 2.0),
        ('"float illuminance" 0', 1.0),
    ],
)
def test_a_far_lamps_illuminance_is_scaled(tmp_path: Path, given: str, lux: float) -> None:
    [lamp] = imported(tmp_path, f'"distant" "rgb L" [1 1 1] {given}')["distant"]
    assert lamp["irradiance"]["luminance"] == pytest.approx(lux)
    environment = imported(tmp_path / "sky", f'"infinite" {given}')["environment"]
    # pi times the luminance of an even sky; without an illuminance `scale` is the luminance.
    expected = lux / np.pi if "illuminance" in given and lux >= 1000 else lux
    assert environment["radiance"]["luminance"] == pytest.approx(expected)


def test_a_skys_picture_has_pbrts_illuminance(tmp_path: Path) -> None:
    """Its sum takes half of the solid angle: even, 1000 lx and scale 3 are 2 x 3 x 1000 / pi cd/m2."""
    (tmp_path / "in").mkdir()
    buffer = oiio.ImageBuf(oiio.ImageSpec(64, 64, 3, oiio.FLOAT))
    oiio.ImageBufAlgo.fill(buffer, (0.25, 0.25, 0.25))
    assert buffer.write(str(tmp_path / "in" / "sky.exr"))
    light = '"infinite" "string filename" "sky.exr" "float illuminance" 1000 "float scale" 3'
    environment = imported(tmp_path, light)["environment"]
    assert environment["luminance"] * 0.25 == pytest.approx(6000 / np.pi, rel=1e-3)


@pytest.mark.parametrize("kind", ["point", "spot"])
def test_power_is_scaled(tmp_path: Path, kind: str) -> None:
    def candela(given: str) -> float:
        [*_, lamp] = imported(tmp_path / given.replace('"', ""), f'"{kind}" {given}')["surfaces"]
        return float(lamp["luminaire"]["radiance"]["luminance"])

    assert candela('"float power" 200 "float scale" 3') == pytest.approx(3 * candela('"float power" 200'))
    assert candela('"float power" -1 "float scale" 3') == pytest.approx(3 * candela('"float scale" 1'))


# Radiance of an area light is power / (pi x area of each of its parts x sides), times scale.
@pytest.mark.parametrize(
    ("shape", "area"),
    [
        ('"sphere" "float radius" 0.5', np.pi),
        ('"disk" "float radius" 2', 4 * np.pi),
        ('"cylinder" "float radius" 0.5 "float zmin" 0 "float zmax" 3', 3 * np.pi),
        ('"bilinearmesh" "point3 P" [0 0 0  2 0 0  0 3 0  2 3 0]', 6.0),
        ('"trianglemesh" "point3 P" [0 0 0  2 0 0  0 3 0]', 3.0),
        # Each triangle has all of the power.
        ('"trianglemesh" "point3 P" [0 0 0 2 0 0 0 3 0 2 3 0] "integer indices" [0 1 2 1 3 2]', 3.0),
    ],
)
def test_an_area_lights_power(tmp_path: Path, shape: str, area: float) -> None:
    def luminance(given: str) -> float:
        name = "".join(letter for letter in given if letter.isalnum())
        light = f'"infinite" AreaLightSource "diffuse" {given} Shape {shape} ReverseOrientation'
        [lamp, *_] = imported(tmp_path / name, light)["surfaces"]
        return float(lamp["luminaire"]["radiance"]["luminance"])

    assert luminance('"float power" 100') == pytest.approx(100 / (np.pi * area), rel=1e-5)
    both = '"float power" 100 "bool twosided" true "float scale" 3'
    assert luminance(both) == pytest.approx(3 * 100 / (2 * np.pi * area), rel=1e-5)
    assert luminance('"float power" -1 "float scale" 3') == 3


def test_power_of_parts_of_several_sizes_is_told(tmp_path: Path) -> None:
    mesh = '"trianglemesh" "point3 P" [0 0 0 2 0 0 0 3 0 5 3 0] "integer indices" [0 1 2 1 3 2]'
    with pytest.raises(InputError, match='"power" on parts of several sizes'):
        imported(tmp_path, f'"infinite" AreaLightSource "diffuse" "float power" 9 Shape {mesh}')
