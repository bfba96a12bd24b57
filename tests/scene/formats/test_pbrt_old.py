"""Scenes of pbrt-v3: the same documents as of scenes that say the same in the words of pbrt-v4."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.pbrt.read.old_materials import alpha_of
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from nocturne_scene.textures.environment_maps import read_whole

from tests.pictures import write_exr

_OLD_HEAD = """Film "image" "integer xresolution" [40] "integer yresolution" [20] "string filename" "a.png"
Sampler "lowdiscrepancy" "integer pixelsamples" 7
Integrator "path" "integer maxdepth" 8 "float rrthreshold" 1
PixelFilter "box" "float xwidth" [0.5] "float ywidth" [0.5]
Camera "perspective" "float fov" 45
"""
_NEW_HEAD = """Film "rgb" "integer xresolution" [40] "integer yresolution" [20]
Sampler "paddedsobol" "integer pixelsamples" 7
Integrator "path" "integer maxdepth" 8
PixelFilter "box" "float xradius" [0.5] "float yradius" [0.5]
Camera "perspective" "float fov" 45
"""
_LIGHT = 'LightSource "infinite" "rgb L" [1 1 1]\n'
_SPHERE = 'Shape "sphere"'
_TRIANGLE = '"point P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2]'


def read(tmp_path: Path, text: str, **options: Any) -> tuple[dict[str, Any], Imported]:
    folder = tmp_path / "in"
    folder.mkdir(exist_ok=True)
    (folder / "a.pbrt").write_text(text)
    found = import_scene(
        folder / "a.pbrt", tmp_path / f"out{len(list(tmp_path.iterdir()))}", ImportOptions(**options)
    )
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found


def old(tmp_path: Path, body: str, **options: Any) -> tuple[dict[str, Any], Imported]:
    light = "" if "LightSource" in body else _LIGHT
    return read(tmp_path, f"{_OLD_HEAD}WorldBegin\n{light}{body}\nWorldEnd\n", **options)


def old_kernel(tmp_path: Path, material: str, **options: Any) -> Any:
    document, _ = old(tmp_path, f"{material} {_SPHERE}", **options)
    kernel = document["surfaces"][0]["kernel"]
    return document["kernels"][kernel] if isinstance(kernel, str) else kernel


def _materials(before: str, after: str) -> tuple[str, str]:
    return f"Material {before} {_SPHERE}", f"Material {after} {_SPHERE}"


_PAIRS = {
    "the head": (_SPHERE, _SPHERE),
    "matte": _materials('"matte" "color Kd" [0.1 0.2 0.3]', '"diffuse" "rgb reflectance" [0.1 0.2 0.3]'),
    "polished glass": _materials('"glass" "float index" 1.4', '"dielectric" "float eta" 1.4'),
    "rough glass": _materials(
        '"glass" "float uroughness" 0.05 "float vroughness" 0.1',
        f'"dielectric" "bool remaproughness" false "float uroughness" {alpha_of(0.05, remap=True)!r} '
        f'"float vroughness" {alpha_of(0.1, remap=True)!r}',
    ),
    "metal": _materials(
        '"metal" "spectrum eta" "spds/Au.eta.spd" "spectrum k" "spds/Au.k.spd"',
        '"conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "bool remaproughness" false '
        f'"float roughness" {alpha_of(0.01, remap=True)!r}',
    ),
    "metal by alpha": _materials(
        '"metal" "float roughness" 0.2 "bool remaproughness" "false"',
        '"conductor" "float roughness" 0.2 "bool remaproughness" false',
    ),
    "nothing": _materials('""', '"interface"'),
    "mixtures the other way round": (
        'MakeNamedMaterial "a" "string type" "matte" MakeNamedMaterial "b" "string type" "mirror" '
        f'Material "mix" "string namedmaterial1" "a" "string namedmaterial2" "b" "rgb amount" [0.2 '
        f"0.2 0.2] {_SPHERE}",
        'MakeNamedMaterial "a" "string type" "diffuse" MakeNamedMaterial "b" "string type" "mirror" '
        f'Material "mix" "string materials" ["b" "a"] "float amount" 0.2 {_SPHERE}',
    ),
    "textures": (
        'Texture "c" "color" "constant" "color value" [0.1 0.2 0.3] '
        'Texture "d" "color" "scale" "texture tex1" "c" "float tex2" 0.5 '
        f'Material "matte" "texture Kd" "d" {_SPHERE}',
        'Texture "c" "spectrum" "constant" "rgb value" [0.1 0.2 0.3] '
        'Texture "d" "spectrum" "scale" "texture tex" "c" "float scale" 0.5 '
        f'Material "diffuse" "texture reflectance" "d" {_SPHERE}',
    ),
    "triangles": (
        f'Shape "trianglemesh" {_TRIANGLE} "float uv" [0 0 1 0 0 1] "bool discarddegenerateUVs" "true"',
        f'Shape "trianglemesh" {_TRIANGLE} "point2 uv" [0 0 1 0 0 1]',
    ),
    "subdivision": (
        f'Shape "loopsubdiv" "integer nlevels" 1 {_TRIANGLE}',
        f'Shape "loopsubdiv" "integer levels" 1 {_TRIANGLE}',
    ),
    "area lights": (
        f'AreaLightSource "area" "color L" [1 2 3] "color scale" [2 2 2] "integer nsamples" 4 {_SPHERE}',
        f'AreaLightSource "diffuse" "rgb L" [1 2 3] "float scale" 2 {_SPHERE}',
    ),
    "coloured scales": (
        f'LightSource "distant" "rgb L" [1 2 3] "rgb scale" [3 2 1] "integer samples" 2 {_SPHERE}',
        f'LightSource "distant" "rgb L" [3 4 3] {_SPHERE}',
    ),
    "grids": (
        'MakeNamedMedium "m" "string type" "heterogeneous" "float density" [1 2] "integer nx" 2 '
        '"point p0" [0 0 0] "point p1" [1 1 1] "rgb sigma_s" [1 1 1] '
        f'MediumInterface "m" "" Material "" {_SPHERE}',
        'MakeNamedMedium "m" "string type" "uniformgrid" "float density" [1 2] "integer nx" 2 '
        '"point3 p0" [0 0 0] "point3 p1" [1 1 1] "rgb sigma_s" [1 1 1] "rgb sigma_a" [0.0011 0.0024 0.014] '
        f'MediumInterface "m" "" Material "interface" {_SPHERE}',
    ),
    "words of pbrt-v2": (f"{_SPHERE} WorldEnd", _SPHERE),
}


@pytest.mark.parametrize("name", _PAIRS)
def test_an_old_scene_is_the_new_one(tmp_path: Path, name: str) -> None:
    before, after = _PAIRS[name]
    document, found = old(tmp_path, before) if name != "words of pbrt-v2" else _of_v2(tmp_path, before)
    light = "" if "LightSource" in after else _LIGHT
    expected, same = read(tmp_path, f"{_NEW_HEAD}WorldBegin\n{light}{after}\n")
    document.pop("note"), expected.pop("note")
    assert document == expected
    assert found.film == same.film


def _of_v2(tmp_path: Path, body: str) -> tuple[dict[str, Any], Imported]:
    head = _OLD_HEAD.replace("Integrator", "SurfaceIntegrator") + 'Renderer "sampler"\n'
    return read(tmp_path, f"{head}WorldBegin\n{_LIGHT}{body}")


def test_roughness_by_the_polynomial_of_v3() -> None:
    """With x = ln r: r = 1 leaves 1.62142, held at 1; r = e^-3 = 0.0498 by hand."""
    assert alpha_of(1.0, remap=True) == 1.0
    by_hand = 1.62142 - 3 * 0.819955 + 9 * 0.1734 - 27 * 0.0171201 + 81 * 0.000640711
    assert alpha_of(math.exp(-3), remap=True) == pytest.approx(by_hand)
    assert (alpha_of(0.0, remap=True), alpha_of(0.3, remap=False)) == (0.0, 0.3)


def test_colours_by_xyz(tmp_path: Path) -> None:
    """The red primary of sRGB, IEC 61966-2-1."""
    kernel = old_kernel(tmp_path, 'Material "matte" "xyz Kd" [0.4124 0.2126 0.0193]')
    assert kernel["reflectance"]["rgb"] == pytest.approx([1, 0, 0], abs=1e-4)


def test_a_black_body_is_as_bright_as_in_v3(tmp_path: Path) -> None:
    """Planck's law over its largest value, times the scale: at 2700 K and 555 nm a small part."""
    document, _ = old(tmp_path, f'LightSource "infinite" "blackbody L" [2700 10] {_SPHERE}')
    radiance = document["environment"]["radiance"]
    assert radiance["blackbody"] == 2700

    def planck(nm: float) -> float:
        return nm**-5 / math.expm1(0.01438776877e9 / (nm * 2700))

    at_most = planck(2.8977721e6 / 2700)
    # The observer's curve is nearly a Gaussian.
    nm = np.arange(400.0, 750.0, 1.0)
    seen = np.exp(-0.5 * ((nm - 562) / 44) ** 2)
    mean = sum(planck(each) * weight for each, weight in zip(nm, seen, strict=True)) / seen.sum() / at_most
    assert radiance["luminance"] == pytest.approx(10 * mean, rel=0.04)


def test_a_light_s_spectrum_is_absolute(tmp_path: Path) -> None:
    """An even spectrum of 3 has Y = 3."""
    document, _ = old(tmp_path, f'LightSource "infinite" "spectrum L" [300 3 900 3] {_SPHERE}')
    assert document["environment"]["radiance"]["luminance"] == pytest.approx(3)


def test_skies_are_pictures_of_latitudes(tmp_path: Path) -> None:
    """The first row is +z; azimuth 0, +x, is at the left edge and grows to the right."""
    (tmp_path / "in").mkdir()
    pixels = np.zeros((4, 8, 3), np.float32)
    pixels[0] = 1.0
    pixels[2, 1] = (0.0, 5.0, 0.0)  # of azimuths from 45 to 90 degrees
    write_exr(tmp_path / "in" / "sky.exr", pixels, "RGB")
    document, found = old(
        tmp_path,
        f'LightSource "infinite" "string mapname" "sky.exr" "rgb L" [2 2 2] "color scale" [3 3 3] {_SPHERE}',
    )
    sky = document["environment"]
    assert sky["luminance"] == 6
    # The world is mirrored along z here, as this camera's axes are right-handed.
    assert (sky["up"], sky["forward"]) == ([0, 0, -1], [1, 0, 0])
    seen = read_whole(found.document.parent / sky["asset"])
    assert np.all(seen[0] == 1)
    # Our middle column is +x; the world's mirror image turns rows over.
    [[row, column]] = np.argwhere(seen[..., 1] == 5)
    assert (row, column) == (2, 5)


def test_plastic_reflects_ks_times_fresnel(tmp_path: Path) -> None:
    kernel = old_kernel(tmp_path, 'Material "plastic" "rgb Kd" [0.5 0.2 0.1] "rgb Ks" [0.3 0.3 0.3]')
    assert kernel == {
        "type": "principled",
        "base": {"rgb": [0.5, 0.2, 0.1]},
        "index": 1.5,
        "roughness": pytest.approx(math.sqrt(alpha_of(0.1, remap=True))),
        "specular": 0.3,
    }


def test_a_coloured_glossy_part_has_its_colour_at_normal_incidence(tmp_path: Path) -> None:
    kernel = old_kernel(
        tmp_path, 'Material "uber" "rgb Ks" [0.4 0.2 0.1] "float index" 2 "rgb opacity" [0.7 0.7 0.7]'
    )
    assert (kernel["type"], kernel["opacity"]) == ("mask", 0.7)
    inside = kernel["kernel"]
    # Ks times ((2 - 1) / (2 + 1))^2.
    colour = np.array(inside["specular_colour"]["rgb"]) * inside["specular"]
    assert colour == pytest.approx(np.array([0.4, 0.2, 0.1]) / 9)


def test_substrate_reflects_ks_at_normal_incidence(tmp_path: Path) -> None:
    kernel = old_kernel(tmp_path, 'Material "substrate" "rgb Ks" [0.04 0.05 0.06] "float uroughness" 0.2')
    assert kernel["specular_colour"] == {"rgb": [0.04, 0.05, 0.06]}
    assert kernel["roughness"] == pytest.approx(math.sqrt(alpha_of(0.2, remap=True)))
    assert kernel["roughness_across"] == pytest.approx(math.sqrt(alpha_of(0.1, remap=True)))


def test_mirrors_reflect_kr(tmp_path: Path) -> None:
    index = old_kernel(tmp_path, 'Material "mirror"')["index"]
    n, k = index["n"], index["k"]
    assert ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2) == pytest.approx(0.9)


def test_translucent_is_a_product(tmp_path: Path) -> None:
    kernel = old_kernel(
        tmp_path,
        'Material "translucent" "rgb Kd" [0.8 0.4 0.2] "rgb Ks" [0 0 0] "rgb reflect" [0.25 0.25 0.25] '
        '"rgb transmit" [0.5 0.25 1]',
    )
    assert kernel["reflectance"]["rgb"] == pytest.approx([0.2, 0.1, 0.05])
    assert kernel["transmittance"]["rgb"] == pytest.approx([0.4, 0.1, 0.2])


def test_disney_is_principled(tmp_path: Path) -> None:
    kernel = old_kernel(
        tmp_path,
        'Material "disney" "color color" [0.3 0.2 0.1] "float metallic" 1 "float roughness" 0.4 '
        '"float clearcoat" 1',
    )
    assert kernel["base"] == {"rgb": [0.3, 0.2, 0.1]}
    assert (kernel["metallic"], kernel["roughness"], kernel["coat"]) == (1, 0.4, 0.25)


def test_a_material_outlasts_a_transformation(tmp_path: Path) -> None:
    """In pbrt-v3 TransformEnd ends the transformation alone."""
    body = f'TransformBegin Translate 3 0 0 Material "matte" "rgb Kd" [0.1 0.1 0.1] TransformEnd {_SPHERE}'
    document, _ = old(tmp_path, body)
    [surface] = document["surfaces"]
    assert surface["shape"]["centre"] == [0, 0, 0]
    assert document["kernels"][surface["kernel"]]["reflectance"] == 0.1


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (f'Material "fourier" "string bsdffile" "a.bsdf" {_SPHERE}', 'no support for the material "fourier"'),
        (f'Material "glass" "rgb Kt" [1 0.5 0.5] {_SPHERE}', 'no support for a "Kt" other than 1 of glass'),
        (f'Material "translucent" {_SPHERE}', 'no support for the "Ks" of a translucent surface'),
        (f"{_SPHERE} WorldEnd {_SPHERE}", "no support for what follows the end of the world"),
        (f'NamedMaterial "none" {_SPHERE}', 'no material "none"; known: none'),
        ('Shape "heightfield"', 'no support for the shape "heightfield"'),
    ],
)
def test_what_has_no_equal_is_told(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(Incomplete if "height" not in body else InputError) as caught:
        old(tmp_path, body)
    assert any(said in each.message for each in caught.value.problems)
    assert all(each.place.startswith("a.pbrt:") for each in caught.value.problems if said in each.message)


def test_files_of_v2_with_volumes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        old(tmp_path, 'Volume "homogeneous"')
    assert "the file is of pbrt-v2 or before" in caught.value.problems[0].message
