"""Scenes of Radiance become documents."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
import trimesh
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.radiance.read import skies, surfaces
from nocturne_scene.formats.radiance.read.primitives import Primitive
from nocturne_scene.formats.reading.options import ImportOptions

_ROOM = """
# a comment
void plastic grey 0 0 5 .5 .5 .5 0 0
void light lamp 0 0 3 10 10 10
grey polygon floor
0
0
12 0 0 0  4 0 0  4 3 0  0 3 0
lamp polygon panel 0 0 12  1 1 2.9  1 2 2.9  2 2 2.9  2 1 2.9
"""


def _imported(text: str, folder: Path, *, allow_missing: bool = False) -> tuple[dict[str, Any], Any]:
    file = folder / "scene.rad"
    file.write_text(text)
    found = import_scene(file, folder / "made", ImportOptions(allow_missing=allow_missing))
    return json.loads(found.document.read_text()), found


def _primitive(kind: str, numbers: list[float], texts: tuple[str, ...] = ()) -> Primitive:
    return Primitive("void", kind, "it", texts, tuple(numbers), "here")


def _area(mesh: Any) -> float:
    return float(trimesh.Trimesh(mesh.vertices, mesh.indices, process=False).area)


def _mean_normal(mesh: Any) -> Any:
    made = trimesh.Trimesh(mesh.vertices, mesh.indices, process=False)
    return (made.face_normals * made.area_faces[:, None]).sum(axis=0)


def test_a_room_with_a_lamp(tmp_path: Path) -> None:
    """z becomes y; a radiance of 10 W/(sr m2) is 1790 cd/m2; light leaves where the normal points: down."""
    document, found = _imported(_ROOM, tmp_path)
    floor, panel = document["surfaces"]
    assert document["kernels"]["grey"] == {"type": "lambertian", "reflectance": 0.5}
    assert panel["luminaire"]["radiance"]["luminance"] == pytest.approx(1790.0)
    mesh: Any = trimesh.load(found.document.parent / panel["shape"]["asset"])
    assert mesh.area == pytest.approx(1.0)
    assert mesh.face_normals == pytest.approx(np.tile([0.0, -1.0, 0.0], (2, 1)))
    assert mesh.bounds == pytest.approx(np.array([[1, 2.9, -2], [2, 2.9, -1]]))
    mesh = trimesh.load(found.document.parent / floor["shape"]["asset"])
    assert mesh.bounds == pytest.approx(np.array([[0, 0, -3], [4, 0, 0]]))
    assert any("became y" in note for note in found.notes)


@pytest.mark.parametrize(
    ("corners", "area", "normal"),
    [
        ([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]], 3.0, [0, 1, 0]),
        ([[0, 2, 0], [1, 2, 0], [1, 1, 0], [2, 1, 0], [2, 0, 0], [0, 0, 0]], 3.0, [0, -1, 0]),
        ([[0, 0, 0], [0, 0, 2], [0, 2, 2], [0, 2, 0]], 4.0, [-1, 0, 0]),
        # A square of 3 with a hole of 1, joined by a seam.
        (
            [
                [0, 0, 0],
                [3, 0, 0],
                [3, 3, 0],
                [0, 3, 0],
                [0, 0, 0],
                [1, 1, 0],
                [1, 2, 0],
                [2, 2, 0],
                [2, 1, 0],
                [1, 1, 0],
            ],
            8.0,
            [0, 1, 0],
        ),
    ],
)
def test_polygons(corners: list[list[float]], area: float, normal: list[float]) -> None:
    """By the right-hand rule; also with corners that turn in, and with a hole."""
    mesh = surfaces.polygon(_primitive("polygon", [each for corner in corners for each in corner]))
    assert _area(mesh) == pytest.approx(area)
    assert _mean_normal(mesh) / area == pytest.approx(np.array(normal))


def test_round_surfaces() -> None:
    """Areas of many-sided ones, and where they face."""
    sides = 128
    disc = surfaces.ring(_primitive("ring", [0, 0, 1, 0, 0, 1, 0, 2]))
    polygon = 0.5 * sides * math.sin(2 * math.pi / sides)
    assert _area(disc) == pytest.approx(4 * polygon)
    assert _mean_normal(disc) == pytest.approx(np.array([0, 4 * polygon, 0]))
    ring = surfaces.ring(_primitive("ring", [0, 0, 1, 0, 0, -1, 2, 1]))
    assert _mean_normal(ring) == pytest.approx(np.array([0, -3 * polygon, 0]))
    around = 2 * sides * math.sin(math.pi / sides)
    for kind, sign in (("cylinder", 1.0), ("tube", -1.0)):
        tube = surfaces.MESHES[kind](_primitive(kind, [0, 0, 0, 0, 0, 3, 0.5]))
        assert _area(tube) == pytest.approx(3 * 0.5 * around)
        made = trimesh.Trimesh(tube.vertices, tube.indices, process=False)
        outwards = made.triangles_center * [1, 0, 1]
        assert (sign * (made.face_normals * outwards).sum(axis=1) > 0).all()
    cone = surfaces.MESHES["cone"](_primitive("cone", [0, 0, 0, 0, 0, 1, 1, 0]))
    # Slant faces of a pyramid with 128 sides.
    apothem = math.cos(math.pi / sides)
    assert _area(cone) == pytest.approx(0.5 * around * math.hypot(1.0, apothem))


# What `rtrace -ab 0` of Radiance 6.0a (pyradiance 1.3.1) shows of `gensky 3 21 12 +s / -c / +i -a 48 -o -9
# -m -15` with glows of 1 1 1, towards these directions (z up).
_TOWARDS: list[list[float]] = [
    [0, 0, 1],
    [0, 1, 0.2],
    [1, 0, 0.02],
    [0.3, -1, 0.5],
    [0, 1, -0.02],
    [0, 1, -1],
]
_SUN = [0.136587, -0.740876, 0.657607]
_SHOWN = {
    "clear": ([1, 8.585, 19.61, 0.5146, *_SUN], [8.580121, 14.66113, 18.38196, 48.58933, 19.58916, 19.61]),
    "overcast": ([2, 28.47, 4.428], [28.46998, 13.01007, 7.930258, 17.67933, 6.534818, 4.428]),
    "intermediate": (
        [4, 18.53, 7.046, 0.9825, *_SUN],
        [18.52538, 8.038588, 13.53587, 53.41442, 7.073956, 7.046],
    ),
}


@pytest.mark.parametrize("name", _SHOWN)
def test_skies_are_those_that_radiance_shows(name: str) -> None:
    _check_shown(skies.FUNCTION, _TOWARDS, *_SHOWN[name])


def _check_shown(
    function: tuple[str, str], towards: list[list[float]], numbers: list[float], shown: list[float]
) -> None:
    unit = np.array(towards) / np.linalg.norm(towards, axis=1, keepdims=True)
    found = skies.brightness(_primitive("brightfunc", numbers, function), unit)
    assert found == pytest.approx(np.array(shown), rel=1e-4)


# The same of `gendaylit 3 21 9 -a 48.8 -o -9.2 -m -15 -W 600 120`, `gendaylit -ang 5 20 -W 0 80` and
# `gendaylit -ang 60 -30 -W 850 90`, without their Suns.
_TOWARDS_OF_ALL_WEATHER: list[list[float]] = [
    [0, 0, 1],
    [1, 0, 1],
    [0, -1, 0.3],
    [-1, 1, 0.2],
    [0.3, 1, 0.005],
    [0.5, 0.5, -0.3],
]
_ALL_WEATHER: dict[str, tuple[list[float], list[float]]] = {
    "morning": (
        [31.55, 11.63, -0.862532, -0.315134, 13.198034, -3.359868, 0.34315, 0.794931, -0.4611, 0.394299],
        [15.39138, 44.8414, 35.62667, 34.0731, 23.91418, 11.63156],
    ),
    "overcast": (
        [15.93, 1.594, -0.430652, -0.129459, 12.262382, -4.010997, 0.377551, -0.340719, -0.936117, 0.087156],
        [10.24744, 10.45287, 43.70613, 13.36218, 13.21248, 1.595303],
    ),
    "clear": (
        [31.09, 30.77, -0.989814, -0.207278, 22.213997, -6.015554, 1.321415, 0.25, -0.433013, 0.866025],
        [17.88787, 18.21254, 27.75414, 28.29743, 33.65816, 30.77062],
    ),
}


@pytest.mark.parametrize("name", _ALL_WEATHER)
def test_skies_of_gendaylit_are_those_that_radiance_shows(name: str) -> None:
    _check_shown(skies.ALL_WEATHER, _TOWARDS_OF_ALL_WEATHER, *_ALL_WEATHER[name])


def test_a_sky_of_gendaylit_without_a_sun(tmp_path: Path) -> None:
    numbers = " ".join(map(str, _ALL_WEATHER["overcast"][0]))
    text = f"""
void light solar 0 0 3 0.0 0.0 0.0
solar source sun 0 0 4 -0.340719 -0.936117 0.087156 0.533
void brightfunc skyfunc 2 skybright perezlum.cal 0 10 {numbers}
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
"""
    document, found = _imported(text + _ROOM, tmp_path)
    assert "distant" not in document
    picture = oiio.ImageBuf(str(found.document.parent / document["environment"]["asset"]))
    pixels = np.asarray(picture.get_pixels(oiio.FLOAT))
    assert pixels[0, 0, 1] == pytest.approx(179 * _ALL_WEATHER["overcast"][1][0], rel=2e-3)


def test_a_sky_and_its_sun(tmp_path: Path) -> None:
    """As gensky writes it, with the two glows of its manual."""
    gensky = """
void light solar 0 0 3 6.66e6 6.66e6 6.66e6
solar source sun 0 0 4 0.136587 -0.740876 0.657607 0.5
void brightfunc skyfunc 2 skybr skybright.cal 0 3 2 28.47 4.428
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
skyfunc glow ground_glow 0 0 4 2 2 2 0
ground_glow source ground 0 0 4 0 0 -1 180
"""
    document, found = _imported(gensky + _ROOM, tmp_path)
    (sun,) = document["distant"]
    assert sun["direction"] == pytest.approx([0.136587, 0.657607, 0.740876])
    assert sun["radiance"]["luminance"] == pytest.approx(179 * 6.66e6)
    picture = oiio.ImageBuf(str(found.document.parent / document["environment"]["asset"]))
    pixels = np.asarray(picture.get_pixels(oiio.FLOAT))
    rows = len(pixels)
    assert pixels[0, 0, 1] == pytest.approx(179 * 28.47, rel=1e-3)
    assert pixels[-1, 0, 1] == pytest.approx(179 * 2 * 4.428, rel=1e-3)
    # 30 degrees above the horizon, where the blend is of the sky alone.
    at = int(rows * 60 / 180)
    assert pixels[at, 0, 1] == pytest.approx(179 * 28.47 * (1 + 2 * 0.5) / 3, rel=0.01)


def test_materials(tmp_path: Path) -> None:
    text = """
void plastic shiny 0 0 5 .4 .3 .2 .05 .1
void metal steel 0 0 5 .6 .6 .6 .8 .05
void glass pane 0 0 3 .96 .96 .96
void trans blind 0 0 7 .6 .6 .6 0 0 .5 .2
void dielectric water 0 0 5 .9 .9 .9 1.33 0
void alias metal2 steel
shiny sphere a 0 0 4 0 0 0 1
steel sphere b 0 0 4 3 0 0 1
pane polygon c 0 0 9 0 0 5 1 0 5 0 1 5
blind polygon d 0 0 9 0 0 6 1 0 6 0 1 6
water sphere e 0 0 4 6 0 0 1
metal2 sphere f 0 0 4 9 0 0 1
"""
    document, _ = _imported(text, tmp_path)
    kernels = document["kernels"]
    assert kernels["shiny"]["type"] == "principled"
    assert kernels["shiny"]["specular_colour"] == 0.05
    assert kernels["steel"]["weight"] == 0.8
    assert kernels["steel"]["second"]["metallic"] == 1.0
    assert kernels["pane"] == {"type": "thin_pane", "index": 1.52, "transmittance": 0.96}
    blind = kernels["blind"]
    # Straight on 0.6 x 0.5 x 0.2 = 0.06; diffusely 0.6 x 0.5 x 0.8 = 0.24 through and 0.3 back.
    assert 1 - blind["opacity"] == pytest.approx(0.06)
    assert blind["kernel"]["transmittance"] * blind["opacity"] == pytest.approx(0.24)
    assert blind["kernel"]["reflectance"] * blind["opacity"] == pytest.approx(0.3)
    assert kernels["water"]["absorption"] == pytest.approx(-math.log(0.9))
    assert [each["kernel"] for each in document["surfaces"] if each["name"] == "f"] == ["metal2"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("!genbox grey b 1 1 1\n", "is not run; write what it prints"),
        ("void colorpict p 7 red green blue a.hdr picture.cal u v 0 0\n", "colorpict p is not read"),
        ("void BSDF b 6 0 a.xml 0 0 1 . 0 0\n", "BSDF b is not read; read are light, glow"),
        ("nothing polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n", "no material nothing that is read"),
        ("grey polygon p 0 0 6 0 0 0 1 0 0\n", "expected three numbers a corner, found 6"),
        ("grey polygon p 0 0 9 0 0 0 1 0 0 2 0 0\n", "it has no area"),
        ("grey sphere s 0 0 4 0 0 0 -1\n", "expected a radius above 0, found -1"),
        ("grey bubble s 0 0 4 0 0 0 1\n", "bubble s is not read"),
        ("void plastic p 0 0 5 2 .5 .5 0 0\np polygon q 0 0 9 0 0 0 1 0 0 0 1 0\n", "parts from 0 to 1"),
        (
            "void brightfunc f 2 skybr other.cal 0 3 2 1 1\nf glow g 0 0 4 1 1 1 0\n"
            "g source s 0 0 4 0 0 1 180\n",
            "the function skybr other.cal is not read; read are those of gensky and gendaylit",
        ),
    ],
)
def test_what_is_not_read_is_said(text: str, said: str, tmp_path: Path) -> None:
    """The rest is written all the same."""
    with pytest.raises(Incomplete, match=said):
        _imported(_ROOM + text, tmp_path)
    document, found = _imported(_ROOM + text, tmp_path, allow_missing=True)
    assert len(document["surfaces"]) == 2
    assert found.missing


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("void plastic", "the file ends where a type and a name is expected"),
        ("void plastic p many 0 5", "expected a number of arguments, found 'many'"),
        ("void plastic p 0 0 2 1 x", "expected a number, found 'x'"),
        ("void plastic p 0 0 5 1", "the file ends where a number is expected"),
    ],
)
def test_what_is_no_radiance_is_refused_with_its_line(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        _imported(text, tmp_path)
