"""Scenes of Mitsuba 0.x: the same documents as of scenes that say the same in the words of Mitsuba 3.

One file, though long: a short test for each plugin or word.
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.mitsuba.read.units import white
from nocturne_scene.formats.reading.coats import smooth_coat
from nocturne_scene.formats.reading.options import Imported, ImportOptions

from tests.pictures import write_exr
from tests.scene.formats.mitsuba_import import SENSOR, SPHERE

OLD_SENSOR = """
<sensor type="perspective">
  <float name="fov" value="45"/>
  <transform name="toWorld"><lookAt origin="0,0,-5" target="0,0,0" up="0,1,0"/></transform>
  <film type="ldrfilm"><integer name="width" value="40"/><integer name="height" value="20"/>
    <boolean name="banner" value="false"/><string name="pixelFormat" value="rgb"/>
    <float name="gamma" value="2.2"/>
    <rfilter type="box"/></film>
  <sampler type="ldsampler"><integer name="sampleCount" value="7"/>
    <integer name="dimension" value="4"/></sampler>
</sensor>
"""
_NEW_SENSOR = SENSOR.replace("</film>", '<rfilter type="box"/></film>')
_BITMAP = '<string name="filename" value="a.exr"/>'


def read(tmp_path: Path, text: str, **options: Any) -> tuple[dict[str, Any], Imported]:
    folder = tmp_path / "in"
    folder.mkdir(exist_ok=True)
    if not (folder / "a.exr").exists():
        write_exr(folder / "a.exr", np.array([[[0.2, 0.3, 0.4], [0.5, 0.6, 0.7]]], np.float32), "RGB")
    (folder / "a.xml").write_text(text)
    out = tmp_path / f"out{len(list(tmp_path.iterdir()))}"
    found = import_scene(folder / "a.xml", out, ImportOptions(**options))
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found


def old(tmp_path: Path, body: str, version: str = "0.6.0", **options: Any) -> tuple[dict[str, Any], Imported]:
    light = "" if "<emitter" in body or "<luminaire" in body else '<emitter type="constant"/>'
    return read(tmp_path, f'<scene version="{version}">{OLD_SENSOR}{body}{light}</scene>', **options)


def old_kernel(tmp_path: Path, bsdf: str, **options: Any) -> Any:
    document, _ = old(tmp_path, f'<shape type="sphere">{bsdf}</shape>', **options)
    return document["surfaces"][0]["kernel"]


def _of_sphere(old_bsdf: str, new_bsdf: str) -> tuple[str, str]:
    return f'<shape type="sphere">{old_bsdf}</shape>', f'<shape type="sphere">{new_bsdf}</shape>'


def _conductor(inside: str) -> str:
    return f'<bsdf type="conductor">{inside}</bsdf>'


_PAIRS = {
    "names": (
        '<shape type="sphere"><boolean name="flipNormals" value="true"/>'
        '<transform name="toWorld"><translate x="1"/></transform></shape>',
        '<shape type="sphere"><boolean name="flip_normals" value="true"/>'
        '<transform name="to_world"><translate x="1"/></transform></shape>',
    ),
    "types in any letters": ('<shape type="Sphere"/>', SPHERE),
    "depth": (
        f'<integrator type="bdpt"><integer name="maxDepth" value="4"/>'
        f'<boolean name="lightImage" value="true"/></integrator>{SPHERE}',
        f'<integrator type="volpath"><integer name="max_depth" value="4"/></integrator>{SPHERE}',
    ),
    "direct light": (
        f'<integrator type="direct"><integer name="emitterSamples" value="4"/></integrator>{SPHERE}',
        f'<integrator type="direct"/>{SPHERE}',
    ),
    "an integrator of a fork": (
        f'<integrator type="guided_path"><integer name="maxDepth" value="3"/>'
        f'<string name="nee" value="always"/></integrator>{SPHERE}',
        f'<integrator type="path"><integer name="max_depth" value="3"/></integrator>{SPHERE}',
    ),
    "diffuse": _of_sphere(
        '<bsdf type="diffuse"><srgb name="diffuseReflectance" value="#ff0000"/></bsdf>',
        '<bsdf type="diffuse"><rgb name="reflectance" value="1 0 0"/></bsdf>',
    ),
    "hexadecimal numbers are linear": _of_sphere(
        '<bsdf type="diffuse"><rgb name="reflectance" value="#330000"/></bsdf>',
        '<bsdf type="diffuse"><rgb name="reflectance" value="0.2 0 0"/></bsdf>',
    ),
    "three numbers are a colour": _of_sphere(
        '<bsdf type="diffuse"><spectrum name="reflectance" value="0.5, 0.2, 0.1"/></bsdf>',
        '<bsdf type="diffuse"><rgb name="reflectance" value="0.5 0.2 0.1"/></bsdf>',
    ),
    "nothing is smooth": (
        '<shape type="cube"><float name="maxSmoothAngle" value="0"/></shape>',
        '<shape type="cube"><boolean name="face_normals" value="true"/></shape>',
    ),
    "copper unless said": _of_sphere(_conductor(""), _conductor('<string name="material" value="Cu"/>')),
    "an index beside another one": _of_sphere(
        _conductor(
            '<float name="extEta" value="2"/><spectrum name="eta" value="3"/><spectrum name="k" value="4"/>'
        ),
        _conductor('<spectrum name="eta" value="1.5"/><spectrum name="k" value="2"/>'),
    ),
    "facets": _of_sphere(
        '<bsdf type="roughdielectric"><string name="distribution" value="as"/>'
        '<float name="alphaU" value="0.1"/><float name="alphaV" value="0.2"/>'
        '<float name="intIOR" value="1.4"/></bsdf>',
        '<bsdf type="roughdielectric"><string name="distribution" value="beckmann"/>'
        '<float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.2"/>'
        '<float name="int_ior" value="1.4"/></bsdf>',
    ),
    "a mixture that lacks something": _of_sphere(
        '<bsdf type="mixturebsdf"><string name="weights" value="0.5, 0.3"/><bsdf type="diffuse"/>'
        '<bsdf type="conductor"/></bsdf>',
        '<bsdf type="blendbsdf"><bsdf type="blendbsdf">'
        '<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf><bsdf type="diffuse"/>'
        f'<float name="weight" value="{0.5 / 0.7!r}"/></bsdf>'
        f'{_conductor("""<string name="material" value="Cu"/>""")}<float name="weight" value="0.3"/></bsdf>',
    ),
    "heights": _of_sphere(
        f'<bsdf type="bumpmap"><texture type="scale"><float name="scale" value="1"/>'
        f'<texture type="bitmap">{_BITMAP}<float name="gamma" value="1.0"/></texture></texture>'
        '<bsdf type="diffuse"/></bsdf>',
        f'<bsdf type="bumpmap"><texture name="map" type="bitmap">{_BITMAP}<boolean name="raw" value="true"/>'
        '</texture><bsdf type="diffuse"/></bsdf>',
    ),
    "pictures": _of_sphere(
        f'<bsdf type="diffuse"><texture name="reflectance" type="bitmap">{_BITMAP}'
        '<string name="filterType" value="ewa"/><string name="wrapModeU" value="clamp"/>'
        '<string name="wrapModeV" value="clamp"/><float name="uscale" value="2"/>'
        '<float name="uoffset" value="0.25"/></texture></bsdf>',
        f'<bsdf type="diffuse"><texture name="reflectance" type="bitmap">{_BITMAP}'
        '<string name="wrap_mode" value="clamp"/><transform name="to_uv"><scale x="2" y="1"/>'
        '<translate x="0.25"/></transform></texture></bsdf>',
    ),
    "light of one number is white": (
        f'{SPHERE}<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>',
        f'{SPHERE}<emitter type="constant"><spectrum name="radiance" type="d65">'
        '<float name="scale" value="2"/></spectrum></emitter>',
    ),
    "and grey if that is meant": (
        f'{SPHERE}<emitter type="constant">'
        f'<spectrum name="radiance" value="2" intent="reflectance"/></emitter>',
        f'{SPHERE}<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>',
    ),
    "a black body": (
        f'{SPHERE}<emitter type="constant"><blackbody name="radiance" temperature="4000K"/></emitter>',
        f'{SPHERE}<emitter type="constant"><spectrum name="radiance" type="blackbody">'
        '<float name="temperature" value="4000"/></spectrum></emitter>',
    ),
    "a medium": (
        '<shape type="sphere"><medium name="interior" type="homogeneous"><rgb name="sigmaS" value="1 2 3"/>'
        '<spectrum name="sigmaA" value="1"/><float name="scale" value="2"/>'
        '<string name="strategy" value="single"/></medium></shape>',
        '<shape type="sphere"><bsdf type="null"/><medium name="interior" type="homogeneous">'
        f'<rgb name="sigma_t" value="2 3 4"/><rgb name="albedo" value="0.5 {2 / 3!r} 0.75"/>'
        '<float name="scale" value="2"/></medium></shape>',
    ),
    "a parameter given twice": (
        '<shape type="sphere"><float name="radius" value="2"/><float name="radius" value="3"/></shape>',
        '<shape type="sphere"><float name="radius" value="3"/></shape>',
    ),
    "colours above one": _of_sphere(
        '<bsdf type="diffuse"><rgb name="reflectance" value="2 1 0"/></bsdf>',
        '<bsdf type="diffuse"><rgb name="reflectance" value="0.99 0.495 0"/></bsdf>',
    ),
    "groups": (
        '<shape type="shapeGroup" id="g"><shape type="cube"/></shape>'
        '<shape type="instance"><ref id="g"/><transform name="toWorld"><translate x="1"/>'
        "</transform></shape>",
        '<shape type="shapegroup" id="g"><shape type="cube"/></shape>'
        '<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="1"/>'
        "</transform></shape>",
    ),
}


@pytest.mark.parametrize("name", _PAIRS)
def test_an_old_scene_is_the_new_one(tmp_path: Path, name: str) -> None:
    before, after = _PAIRS[name]
    document, found = old(tmp_path, before)
    light = "" if "<emitter" in after else '<emitter type="constant"/>'
    expected, same = read(tmp_path, f'<scene version="3.0.0">{_NEW_SENSOR}{after}{light}</scene>')
    document.pop("note"), expected.pop("note")
    assert document == expected
    assert found.film == same.film


def test_words_of_before_version_0_4(tmp_path: Path) -> None:
    """data/schema/upgrade_0.3.0.xsl and upgrade_0.4.0.xsl of Mitsuba 0.6: two mirrors undo each other."""
    camera = (
        '<camera type="perspective"><float name="fov" value="30"/>'
        '<transform name="toWorld"><lookAt ox="0" oy="0" oz="-5" tx="0" ty="0" tz="0" ux="0" uy="1" uz="0"/>'
        '</transform><film type="exrfilm"><integer name="width" value="40"/>'
        '<integer name="height" value="20"/>'
        "</film></camera>"
    )
    body = (
        '<shape type="sphere"><bsdf type="lambertian"><spectrum name="reflectance" value="0.25"/>'
        "</bsdf></shape>"
        '<luminaire type="constant"><spectrum name="intensity" value="3"/></luminaire>'
    )
    document, _ = read(tmp_path, f'<scene version="0.2.0">{camera}{body}</scene>')
    assert document["sensor"]["look_at"] == pytest.approx([0, 0, -4])
    assert document["sensor"]["up"] == pytest.approx([0, 1, 0])
    # Of the smaller side, which is the height here.
    assert document["sensor"]["vertical_field_of_view_degrees"] == pytest.approx(30)
    assert document["surfaces"][0]["kernel"]["front"]["reflectance"] == 0.25
    assert document["environment"]["radiance"] == {"illuminant": "D65", "luminance": 3 * white()}


def test_a_scaled_black_body_is_planck_s_law_times_that(tmp_path: Path) -> None:
    document, _ = old(
        tmp_path,
        f'{SPHERE}<emitter type="constant">'
        f'<blackbody name="radiance" temperature="2856" scale="3"/></emitter>',
    )
    table = dict(document["environment"]["radiance"]["table"])
    # c1 / (pi l^5) / (exp(c2 / l T) - 1), with c1 = 3.741771852e-16 W m2 and c2 = 0.01438776877 m K (CODATA).
    at = 560e-9
    planck = 3.741771852e-16 / math.pi / at**5 / (math.exp(0.01438776877 / at / 2856) - 1) * 1e-9
    assert table[560] == pytest.approx(3 * planck, rel=1e-6)


@pytest.mark.parametrize(("diffuse", "glossy"), [((0.5, 0.2, 0.1), 0.2), ((0.0, 0.0, 0.0), 0.5)])
def test_phong_reflects_both_parts(
    tmp_path: Path, diffuse: tuple[float, float, float], glossy: float
) -> None:
    colour = " ".join(map(str, diffuse))
    kernel = old_kernel(
        tmp_path,
        f'<bsdf type="phong"><rgb name="diffuseReflectance" value="{colour}"/>'
        f'<spectrum name="specularReflectance" value="{glossy}"/><float name="exponent" value="50"/></bsdf>',
    )["front"]
    if not any(diffuse):
        assert kernel == {"type": "phong", "reflectance": glossy, "exponent": 50}
        return
    weight = kernel["weight"]
    assert kernel["second"]["exponent"] == 50
    assert weight * kernel["second"]["reflectance"] == pytest.approx(glossy)
    assert (1 - weight) * np.array(kernel["first"]["reflectance"]["rgb"]) == pytest.approx(diffuse)


def test_phong_makes_no_light(tmp_path: Path) -> None:
    kernel = old_kernel(
        tmp_path,
        '<bsdf type="phong"><spectrum name="diffuseReflectance" value="0.9"/>'
        '<spectrum name="specularReflectance" value="0.9"/></bsdf>',
    )["front"]
    parts = kernel["first"]["reflectance"] * (1 - kernel["weight"]), kernel["second"]["reflectance"] * 0.5
    # librender/bsdf.cpp: each times 0.99 / 1.8.
    assert parts == pytest.approx((0.9 * 0.55, 0.9 * 0.55))


def test_a_picture_under_a_phong_lobe_keeps_its_sum(tmp_path: Path) -> None:
    document, found = old(
        tmp_path,
        f'<shape type="sphere"><bsdf type="phong"><texture name="diffuseReflectance" type="bitmap">{_BITMAP}'
        '</texture><spectrum name="specularReflectance" value="0.3"/></bsdf></shape>',
    )
    kernel = document["surfaces"][0]["kernel"]["front"]
    texture = document["textures"][kernel["first"]["reflectance"]["texture"]]
    pixels = np.asarray(oiio.ImageBuf(str(found.document.parent / texture["asset"])).get_pixels())
    assert (1 - kernel["weight"]) * pixels[0, 1] == pytest.approx([0.5, 0.6, 0.7], rel=2e-3)


def test_ward_at_normal_incidence(tmp_path: Path) -> None:
    """ks / (4 pi a^2): with weight w a metal of reflectance F has w F D(0) / 4, D(0) = 1 / (pi a^2)."""
    kernel = old_kernel(
        tmp_path,
        '<bsdf type="ward"><spectrum name="diffuseReflectance" value="0.3"/>'
        '<spectrum name="specularReflectance" value="0.4"/><float name="alpha" value="0.15"/></bsdf>',
    )["front"]
    metal = kernel["second"]
    assert (metal["distribution"], metal["roughness"]) == ("beckmann", 0.15)
    n, k = metal["index"]["n"], metal["index"]["k"]
    reflected = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    assert kernel["weight"] * reflected == pytest.approx(0.4)
    assert (1 - kernel["weight"]) * kernel["first"]["reflectance"] == pytest.approx(0.3)


def test_leaves_let_all_through_that_they_scatter(tmp_path: Path) -> None:
    kernel = old_kernel(tmp_path, '<bsdf type="difftrans"><rgb name="transmittance" value="0.4"/></bsdf>')
    assert kernel == {"type": "diffuse_transmitter", "reflectance": 0.0, "transmittance": 0.4}


def test_a_coating_loses_what_it_sends_back(tmp_path: Path) -> None:
    """Theirs is T T R / (pi n^2), ours T T R' / (pi n^2 (1 - R' E)): bsdfs/coating.cpp of Mitsuba 0.6."""
    kernel = old_kernel(
        tmp_path,
        '<bsdf type="coating"><float name="intIOR" value="1.7"/><float name="extIOR" value="1"/>'
        '<bsdf type="diffuse"><spectrum name="reflectance" value="0.6"/></bsdf></bsdf>',
    )["front"]
    assert (kernel["type"], kernel["index"]) == ("coated_diffuse", 1.7)
    base = kernel["reflectance"]
    assert base / (1 - base * smooth_coat(1.7).inside) == pytest.approx(0.6)


def test_glass_that_lets_nothing_through(tmp_path: Path) -> None:
    """It reflects by Fresnel's equations, over black."""
    kernel = old_kernel(
        tmp_path,
        '<bsdf type="dielectric"><float name="intIOR" value="1.5"/><float name="extIOR" value="1"/>'
        '<rgb name="specularTransmittance" value="0, 0, 0"/></bsdf>',
    )
    assert kernel == {"type": "coated_diffuse", "index": 1.5, "reflectance": 0.0}


def test_a_coloured_metal_has_its_colour_at_normal_incidence(tmp_path: Path) -> None:
    kernel = old_kernel(
        tmp_path,
        '<bsdf type="conductor"><string name="material" value="none"/>'
        '<rgb name="specularReflectance" value="0.8 0.4 0.2"/></bsdf>',
    )["front"]
    assert kernel["index"]["n"] == 1.0
    k = dict(kernel["index"]["k"]["table"])
    assert k[450] ** 2 / (4 + k[450] ** 2) < 0.25 < 0.6 < k[640] ** 2 / (4 + k[640] ** 2) < 0.85


def test_the_sun_stands_where_the_hour_says(tmp_path: Path) -> None:
    """In Tokyo, the default, on July 10: at noon 90 - 35.69 + 22.2 degrees high, to the south (+z)."""
    document, _ = old(
        tmp_path,
        f'{SPHERE}<emitter type="sun"><float name="hour" value="11.77"/>'
        '<float name="sunRadiusScale" value="4"/></emitter>',
        light="studio",
    )
    [disc] = document["distant"]
    x, y, z = disc["direction"]
    assert np.degrees(np.arcsin(y)) == pytest.approx(76.5, abs=0.2)
    assert (abs(x) < 0.02, z > 0.2) == (True, True)
    assert disc["angular_diameter_degrees"] == pytest.approx(4 * 0.5358)


def test_a_sky_lights_the_ground_as_in_0_6(tmp_path: Path) -> None:
    """16,778 lx with the Sun 45 degrees high and a turbidity of 3: by the program of 0.6, 2026-11-29."""
    document, found = old(
        tmp_path,
        f'{SPHERE}<emitter type="sky"><vector name="sunDirection" x="1" y="1" z="0"/>'
        '<float name="scale" value="2"/></emitter>',
    )
    sky = document["environment"]
    assert (sky["up"], sky["forward"]) == ([0, 1, 0], [0, 0, 1])
    pixels = np.asarray(oiio.ImageBuf(str(found.document.parent / sky["asset"])).get_pixels())
    rows = len(pixels)
    zenith = (np.arange(rows) + 0.5) * np.pi / rows
    luminance = sky["luminance"] * pixels @ np.array([0.2126, 0.7152, 0.0722])
    weights = np.maximum(np.cos(zenith), 0) * np.sin(zenith) * (np.pi / rows) ** 2
    assert float(luminance.sum(axis=1) @ weights) == pytest.approx(2 * 16_778, rel=0.015)
    # Brightest around the Sun, in the east: a quarter of the picture to the right of north.
    row, column = np.unravel_index(np.argmax(luminance), luminance.shape)
    assert [row / rows, column / rows] == pytest.approx([0.25, 0.5], abs=0.02)
    assert not luminance[rows // 2 :].any()


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (
            '<shape type="sphere"><animation name="toWorld"><transform time="0"/></animation></shape>',
            "no support for an <animation>",
        ),
        ('<shape type="sphere"><bsdf type="irawan"/></shape>', 'no support for the bsdf "irawan"'),
        (f'{SPHERE}<emitter type="collimated"/>', 'no support for the emitter "collimated"'),
        (
            '<shape type="sphere"><medium name="interior" type="homogeneous">'
            '<string name="material" value="milk"/></medium></shape>',
            'no table of the medium "milk"; give sigmaS and sigmaA',
        ),
        (
            '<shape type="sphere"><bsdf type="coating"><bsdf type="conductor"/></bsdf></shape>',
            'no support for a coating over "conductor"',
        ),
    ],
)
def test_what_has_no_equal_is_told(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(Incomplete) as caught:
        old(tmp_path, body + '<emitter type="constant"/>')
    [problem] = [each for each in caught.value.problems if said in each.message]
    assert problem.place.startswith("a.xml:")


def test_files_of_several_versions(tmp_path: Path) -> None:
    """Each is read by its own version."""
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "b.xml").write_text('<scene version="3.0.0"><bsdf type="conductor" id="m"/></scene>')
    document, _ = old(tmp_path, '<include filename="b.xml"/><shape type="sphere"><ref id="m"/></shape>')
    # A mirror in the words of Mitsuba 3, copper in those of 0.x.
    assert document["kernels"]["m"]["front"]["index"] == {"n": 0.001, "k": 1.0}


def test_versions_that_are_none_are_refused_first(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        old(tmp_path, '<shape type="obj"><string name="filename" value="none.obj"/></shape>', "old")
    [problem] = caught.value.problems
    assert problem.message == 'expected a version such as "0.6.0" or "3.0.0", found "old"'
