"""Mitsuba's BSDFs and textures as kernels, against its documented conventions."""

import json
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading.coats import base_under, rough_coat, smooth_coat
from nocturne_scene.formats.reading.fresnel import reflectance_of

from tests.pictures import write_exr
from tests.scene.formats.mitsuba_import import imported, kernel


def test_a_metal_of_three_numbers(tmp_path: Path) -> None:
    parts = '<rgb name="eta" value="0.2 0.92 1.1"/><rgb name="k" value="3.9 2.4 2.1"/>'
    found = kernel(tmp_path, f'<bsdf type="conductor">{parts}</bsdf>')["front"]
    assert dict(found["index"]["n"]["table"])[650.0] < 0.5
    assert dict(found["index"]["k"]["table"])[650.0] > 3.5


def test_a_material_is_black_from_behind_unless_it_is_two_sided(tmp_path: Path) -> None:
    diffuse = '<bsdf type="diffuse"><rgb name="reflectance" value="0.25"/></bsdf>'
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
    one = kernel(tmp_path / "one", diffuse)
    two = kernel(tmp_path / "two", f'<bsdf type="twosided">{diffuse}</bsdf>')
    assert one == {
        "type": "two_sided",
        "front": {"type": "lambertian", "reflectance": 0.25},
        "back": {"type": "lambertian", "reflectance": 0.0},
    }
    assert two == {"type": "lambertian", "reflectance": 0.25}


def test_glass_has_the_ratio_of_the_indices(tmp_path: Path) -> None:
    found = kernel(
        tmp_path,
        '<bsdf type="roughdielectric"><string name="int_ior" value="diamond"/>'
        '<float name="alpha" value="0.3"/>'
        '<string name="distribution" value="beckmann"/></bsdf>',
    )
    assert found["index"] == pytest.approx(2.419 / 1.000277)
    assert (found["roughness"], found["distribution"]) == (0.3, "beckmann")


def test_linear_plastic_sends_on_what_mitsuba_says(tmp_path: Path) -> None:
    """R / (1 - E) of light that entered the base, E being what the coat reflects back inside."""
    found = kernel(tmp_path, '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.4"/></bsdf>')
    index, base = found["front"]["index"], found["front"]["reflectance"]
    inside = smooth_coat(index).inside
    assert base / (1 - base * inside) == pytest.approx(0.4 / (1 - inside))


def test_saturating_plastic_keeps_its_base(tmp_path: Path) -> None:
    bsdf = (
        '<bsdf type="plastic"><boolean name="nonlinear" value="true"/>'
        '<rgb name="diffuse_reflectance" value="0.4"/></bsdf>'
    )
    assert kernel(tmp_path, bsdf)["front"]["reflectance"] == pytest.approx(0.4)


def test_what_the_coat_reflects_back_is_as_published() -> None:
    """D. Judd, J. Res. NBS 29 (1942), diffuse reflectance of dielectrics: 0.596 inside for n = 1.5."""
    assert smooth_coat(1.5).inside == pytest.approx(0.596, abs=1e-3)


def test_rough_plastic_becomes_a_coat_over_what_its_loss_leaves(tmp_path: Path) -> None:
    bsdf = (
        '<bsdf type="roughplastic"><float name="alpha" value="0.4"/><string name="distribution" value="ggx"/>'
        '<rgb name="diffuse_reflectance" value="0.2"/></bsdf>'
    )
    found = kernel(tmp_path, bsdf)["front"]
    assert found["roughness"] == 0.4
    coat = rough_coat(found["index"], 0.4, "ggx")
    gain = coat.passing * 0.2 / (1 - coat.theirs)
    assert found["reflectance"] / (1 - found["reflectance"] * coat.inside) == pytest.approx(gain)


def principled(**parameters: float) -> str:
    given = "".join(f'<float name="{name}" value="{value}"/>' for name, value in parameters.items())
    return f'<bsdf type="principled">{given}</bsdf>'


def test_principled_glass_is_a_rough_dielectric(tmp_path: Path) -> None:
    """Alpha is the square of its roughness, and 0.08 specular the reflectance at normal incidence."""
    found = kernel(tmp_path, principled(base_color=1, spec_trans=1, roughness=0.5, specular=0.6, sheen=1))
    assert (found["type"], found["roughness"]) == ("dielectric", 0.25)
    assert ((found["index"] - 1) / (found["index"] + 1)) ** 2 == pytest.approx(0.08 * 0.6)


def test_principled_metal_reflects_its_colour_at_normal_incidence(tmp_path: Path) -> None:
    found = kernel(tmp_path, principled(base_color=0.7, metallic=1, roughness=0.3, spec_tint=1))
    front = found["front"]
    assert (front["type"], front["roughness"]) == ("conductor", pytest.approx(0.09))
    n, k = front["index"]["n"], front["index"]["k"]
    assert ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2) == pytest.approx(0.7)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"metallic": 0.5, "spec_trans": 1}, "glass that is partly metal"),
        ({"spec_trans": 1, "base_color": 1, "spec_tint": 0.5}, '"spec_tint" other than 0'),
        ({"spec_trans": 1, "base_color": 0.5}, '"base_color" of glass other than 1'),
        ({"spec_trans": 1, "base_color": 1, "eta": 1.5, "specular": 0.5}, "found both"),
    ],
)
def test_what_else_is_principled_is_refused_by_name(
    tmp_path: Path, parameters: dict[str, float], said: str
) -> None:
    with pytest.raises(InputError) as raised:
        kernel(tmp_path, principled(**parameters))
    assert said in str(raised.value)


def test_what_else_is_principled_is_ours(tmp_path: Path) -> None:
    found = kernel(
        tmp_path,
        principled(base_color=0.7, metallic=0.4, roughness=0.3, eta=1.6, clearcoat=1, clearcoat_gloss=1),
    )
    assert found == {
        "type": "two_sided",
        "front": {
            "type": "principled",
            "base": pytest.approx(0.7),
            "metallic": pytest.approx(0.4),
            "roughness": pytest.approx(0.3),
            "index": pytest.approx(1.6),
            "coat": 0.25,
            "coat_roughness": pytest.approx(0.001**0.5),
            "coat_index": 1.5,
        },
        "back": {"type": "lambertian", "reflectance": 0.0},
    }


BOARD = """<texture name="{name}" type="checkerboard"><float name="color0" value="0.9"/>
<float name="color1" value="0.1"/></texture>"""


def test_a_principled_number_that_varies_is_its_mean_and_told(tmp_path: Path) -> None:
    board = BOARD.format(name="clearcoat")
    body = f'<shape type="sphere"><bsdf type="principled">{board}</bsdf></shape>'
    document, found = imported(tmp_path, body, allow_missing=True)
    assert document["surfaces"][0]["kernel"]["front"]["coat"] == pytest.approx(0.25 * 0.5)
    assert [each.message for each in found.missing] == [
        'no support for a principled "clearcoat" that varies; taken as its mean, 0.5'
    ]


def test_principled_glass_in_part_is_the_boundary_of_a_body(tmp_path: Path) -> None:
    """Of a body nothing is hidden behind a front."""
    found = kernel(tmp_path, principled(base_color=1, spec_trans=0.5))
    assert (found["type"], found["second"]["type"]) == ("blend", "dielectric")


def test_a_principled_brush_is_along_u(tmp_path: Path) -> None:
    """Alpha is 0.25 over and times the root of 1 - 0.9 x 0.5."""
    front = kernel(tmp_path, principled(metallic=1, roughness=0.5, anisotropic=0.5))["front"]
    assert front["roughness"] ** 2 == pytest.approx(0.25 / 0.55**0.5)
    assert front["roughness_across"] ** 2 == pytest.approx(0.25 * 0.55**0.5)


def test_a_principled_base_sends_back_as_much_even_light(tmp_path: Path) -> None:
    """Of smooth facets of index 1.5 even light is reflected by 0.0918 (D. Judd, J. Res. NBS 29, 1942)."""
    front = kernel(tmp_path, principled(base_color=0.5, roughness=0, eta=1.5))["front"]
    # Without retro-reflection (1 - F/2)^2 is left, the mean of F being 1/21.
    assert front["base"] * (1 - 0.0918) == pytest.approx(0.5 * (1 - 1 / 42) ** 2, rel=2e-3)


def test_sheen_and_specular_take_the_hue_of_the_base(tmp_path: Path) -> None:
    colour = '<rgb name="base_color" value="0.6,0.3,0.1"/>'
    numbers = "".join(
        f'<float name="{name}" value="{value}"/>'
        for name, value in {"sheen": 1, "sheen_tint": 1, "spec_tint": 1, "eta": 1.5}.items()
    )
    front = kernel(tmp_path, f'<bsdf type="principled">{colour}{numbers}</bsdf>')["front"]
    luminance = 0.2126 * 0.6 + 0.7152 * 0.3 + 0.0722 * 0.1
    hue = np.array([0.6, 0.3, 0.1]) / luminance
    assert front["specular_colour"]["rgb"] == pytest.approx(0.04 * hue)
    assert np.array(front["sheen"]["rgb"]) / front["sheen"]["rgb"][0] == pytest.approx(hue / hue[0])


def test_a_base_gets_more_of_the_colours_that_a_tint_does_not_reflect(tmp_path: Path) -> None:
    """Each colour of it is that under facets in grey that reflect as much as those do of the colour."""
    colour = '<rgb name="base_color" value="0.4,0.2,0.1"/><float name="roughness" value="0"/>'
    tinted = f'{colour}<float name="eta" value="1.5"/><float name="spec_tint" value="1"/>'
    front = kernel(tmp_path, f'<bsdf type="principled">{tinted}</bsdf>')["front"]
    made = zip(front["specular_colour"]["rgb"], (0.4, 0.2, 0.1), front["base"]["rgb"], strict=True)
    for number, (reflected, part, found) in enumerate(made):
        (tmp_path / str(number)).mkdir()
        grey = principled(base_color=part, roughness=0, specular=reflected / 0.08)
        assert found == pytest.approx(kernel(tmp_path / str(number), grey)["front"]["base"], rel=1e-3)


def test_a_raw_constant_is_a_number(tmp_path: Path) -> None:
    bsdf = (
        '<bsdf type="roughconductor"><string name="material" value="Al"/>'
        '<texture name="alpha" type="rawconstant"><float name="value" value="0.3"/></texture></bsdf>'
    )
    assert kernel(tmp_path, bsdf)["front"]["roughness"] == 0.3


def test_a_raw_constant_can_be_a_normal(tmp_path: Path) -> None:
    bsdf = (
        '<bsdf type="normalmap"><texture name="normalmap" type="rawconstant">'
        '<vector name="value" value="0.5, 0.5, 1"/></texture><bsdf type="diffuse"/></bsdf>'
    )
    document, found = imported(tmp_path, f'<shape type="rectangle">{bsdf}</shape>')
    [use] = [surface["normal_map"] for surface in document["surfaces"]]
    texture = document["textures"][use["texture"]]
    assert texture["encoding"] == "linear"
    pixels = np.asarray(oiio.ImageBuf(str(found.document.parent / texture["asset"])).get_pixels(oiio.FLOAT))
    assert pixels.reshape(-1, 3).tolist() == [[0.5, 0.5, 1.0]]


@pytest.mark.parametrize("kind", ["normalmap", "bumpmap"])
def test_rules_of_shading_normals_are_told_and_left_out(kind: str, tmp_path: Path) -> None:
    """They stand before the texture, which is found all the same."""
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "map.exr", np.full((4, 4, 3), 0.5), "RGB")
    rules = ("use_shadowing_function", "flip_invalid_normals")
    flags = "".join(f'<boolean name="{name}" value="false"/>' for name in rules)
    texture = (
        '<texture name="normalmap" type="bitmap"><string name="filename" value="map.exr"/>'
        '<boolean name="raw" value="true"/></texture>'
    )
    bsdf = f'<bsdf type="{kind}">{flags}{texture}<bsdf type="diffuse"/></bsdf>'
    document, found = imported(tmp_path, f'<shape type="rectangle">{bsdf}</shape>')
    assert kind.replace("map", "_map") in document["surfaces"][0]
    assert all(any(name in str(each) for each in found.notes) for name in rules)


def test_plastic_that_polarises_loses_what_the_coat_sends_back(tmp_path: Path) -> None:
    """T(wi) T(wo) R / pi, as measured of Mitsuba 3.9.1's (no specular part): degrees of wi and wo, value."""
    reflectance = '<spectrum name="diffuse_reflectance" value="0.5"/>'
    found = kernel(tmp_path, f'<bsdf type="pplastic">{reflectance}</bsdf>')["front"]
    index, inside = found["index"], smooth_coat(found["index"]).inside
    base = found["reflectance"] / (1 - found["reflectance"] * inside) / index**2
    for first, second, expected in (
        (0, 0, 0.147083),
        (0, 60, 0.139620),
        (45, 60, 0.138151),
        (30, 80, 0.093808),
    ):
        through = [1 - reflectance_of(np.cos(np.radians(each)), index) for each in (first, second)]
        assert np.prod(through) * base / np.pi == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("bsdf", "nonlinear"), [("plastic", False), ("roughplastic", False), ("roughplastic", True)]
)
def test_a_textured_base_is_under_a_coat_what_an_even_one_is(
    tmp_path: Path, bsdf: str, nonlinear: bool
) -> None:
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "t.exr", np.array([[[0.2, 0.5, 0.9], [1.0, 0.0, 0.5]]]), "RGB")
    words = (
        '<texture name="diffuse_reflectance" type="bitmap"><string name="filename" value="t.exr"/></texture>'
        f'<boolean name="nonlinear" value="{str(nonlinear).lower()}"/>'
    )
    words += '<float name="alpha" value="0.2"/>' if bsdf == "roughplastic" else ""
    found = kernel(tmp_path, f'<bsdf type="{bsdf}">{words}</bsdf>')["front"]
    document = json.loads((tmp_path / "out" / "scene.json").read_text())
    asset = document["textures"][found["reflectance"]["texture"]]["asset"]
    under = np.asarray(oiio.ImageBuf(str(tmp_path / "out" / asset)).get_pixels(oiio.FLOAT))
    index = found["index"]
    coat = smooth_coat(index) if bsdf == "plastic" else rough_coat(index, 0.2, "beckmann")
    expected = [base_under(coat, each, linear=not nonlinear) for each in (0.2, 0.5, 0.9, 1.0, 0.0, 0.5)]
    assert under.ravel() == pytest.approx(expected, abs=1e-6)


def test_a_metal_with_another_table_than_mitsubas_is_told(tmp_path: Path) -> None:
    for name, told in {"Cr": "55.5% of light of 550 nm, Mitsuba's 65.9%", "Al": ""}.items():
        metal = f'<bsdf type="conductor"><string name="material" value="{name}"/></bsdf>'
        _, made = imported(tmp_path / name, f'<shape type="sphere">{metal}</shape>')
        notes = [each for each in made.notes if "another table than in Mitsuba" in each]
        assert len(notes) == bool(told)
        assert all(told in each for each in notes)


def test_a_polarizer_lets_half_of_the_light_through(tmp_path: Path) -> None:
    made = kernel(tmp_path, '<bsdf type="polarizer"><float name="transmittance" value="0.8"/></bsdf>')
    assert (made["type"], made["opacity"]) == ("mask", pytest.approx(0.6))
