"""Mitsuba's plugins as parts of a document, against its documented conventions."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT, white
from nocturne_scene.formats.reading.coats import base_under, rough_coat, smooth_coat
from nocturne_scene.formats.reading.fresnel import reflectance_of
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from nocturne_scene.meshes.files import load_mesh

from tests.pictures import write_exr

SENSOR = """
<sensor type="perspective">
  <float name="fov" value="45"/>
  <transform name="to_world"><lookat origin="0 0 -5" target="0 0 0" up="0 1 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="20"/></film>
  <sampler type="independent"><integer name="sample_count" value="7"/></sampler>
</sensor>
"""
SPHERE = '<shape type="sphere"/>'


def imported(tmp_path: Path, body: str, **options: Any) -> tuple[dict[str, Any], Imported]:
    folder = tmp_path / "in"
    folder.mkdir(exist_ok=True)
    lit = any(f'type="{kind}"' in body for kind in ("constant", "envmap"))
    light = "" if lit else '<emitter type="constant"/>'
    (folder / "a.xml").write_text(f'<scene version="3.0.0">{SENSOR}{body}{light}</scene>')
    found = import_scene(folder / "a.xml", tmp_path / "out", ImportOptions(**options))
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found


def kernel(tmp_path: Path, bsdf: str, **options: Any) -> Any:
    document, _ = imported(tmp_path, f'<shape type="sphere">{bsdf}</shape>', **options)
    return document["surfaces"][0]["kernel"]


def test_the_camera_and_the_film(tmp_path: Path) -> None:
    document, found = imported(tmp_path, SPHERE)
    sensor = document["sensor"]
    assert (found.film.width, found.film.height, found.film.samples) == (40, 20, 7)
    assert sensor["position"] == [0, 0, -5]
    assert sensor["look_at"] == pytest.approx([0, 0, -4])
    # 45 degrees along x, of a film twice as wide as high.
    half = np.tan(np.radians(sensor["vertical_field_of_view_degrees"] / 2))
    assert half == pytest.approx(np.tan(np.radians(22.5)) / 2)


def test_a_pinhole_sees_the_same_wherever_it_is_focused(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    sensor = SENSOR.replace("<film", '<float name="focus_distance" value="6"/><film')
    scene = f'<scene version="3.0.0">{sensor}{SPHERE}<emitter type="constant"/></scene>'
    (tmp_path / "in" / "b.xml").write_text(scene)
    found = import_scene(tmp_path / "in" / "b.xml", tmp_path / "focused", ImportOptions())
    plain, _ = imported(tmp_path, SPHERE)
    assert json.loads(found.document.read_text())["sensor"] == plain["sensor"]


def test_a_metal_of_three_numbers(tmp_path: Path) -> None:
    parts = '<rgb name="eta" value="0.2 0.92 1.1"/><rgb name="k" value="3.9 2.4 2.1"/>'
    found = kernel(tmp_path, f'<bsdf type="conductor">{parts}</bsdf>')["front"]
    assert dict(found["index"]["n"]["table"])[650.0] < 0.5
    assert dict(found["index"]["k"]["table"])[650.0] > 3.5


@pytest.mark.parametrize(
    ("integrator", "depth"),
    [
        ('<integrator type="path"><integer name="max_depth" value="2"/></integrator>', 1),
        ('<integrator type="moment"><integrator type="direct"/></integrator>', 1),
        ('<integrator type="volpath"><integer name="max_depth" value="16"/></integrator>', 15),
        ('<integrator type="path"/>', None),
    ],
)
def test_depth_counts_interactions_instead_of_edges(
    tmp_path: Path, integrator: str, depth: int | None
) -> None:
    document, _ = imported(tmp_path, integrator + SPHERE)
    assert document.get("tracing", {}).get("maximum_depth") == depth


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
        ({}, '"metallic" other than 1, or 0 with a "spec_trans" of 1'),
        ({"metallic": 0.5, "spec_trans": 1}, '"metallic" other than 1'),
        ({"metallic": 1, "clearcoat": 0.5}, '"clearcoat" other than 0'),
        ({"metallic": 1, "anisotropic": 0.5}, '"anisotropic" other than 0'),
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


def test_light_is_absolute(tmp_path: Path) -> None:
    """A flat radiance of 1 has Y = 1 in Mitsuba, up to the film's constant; grey rgb is D65."""
    document, _ = imported(
        tmp_path, '<emitter type="constant"><rgb name="radiance" value="2"/></emitter>' + SPHERE
    )
    radiance = document["environment"]["radiance"]
    assert radiance["rgb"] == [1, 1, 1]
    assert radiance["luminance"] == pytest.approx(2 * white())
    # Measured with Mitsuba 3.9.1: Y of (1, 1, 1) is 0.9999.
    assert white() / CANDELAS_PER_UNIT == pytest.approx(0.9999, abs=5e-5)


def test_a_point_becomes_a_sphere_of_the_same_intensity(tmp_path: Path) -> None:
    body = (
        '<emitter type="point"><spectrum name="intensity" value="3"/><point name="position" x="2"/></emitter>'
    )
    document, found = imported(tmp_path, SPHERE + body, light_radius=0.25)
    lamp = document["surfaces"][1]
    assert lamp["shape"] == {"type": "sphere", "centre": [2, 0, 0], "radius": 0.25}
    assert lamp["kernel"] == {"type": "passage"}
    assert lamp["luminaire"]["radiance"] == pytest.approx(3 / (np.pi * 0.25**2))
    assert any("became a sphere of radius 0.25" in note for note in found.notes)


def test_light_from_one_direction_becomes_a_disc(tmp_path: Path) -> None:
    body = (
        '<emitter type="directional"><vector name="direction" value="0 0 2"/>'
        '<spectrum name="irradiance" value="5"/></emitter>'
    )
    document, _ = imported(tmp_path, SPHERE + body, light_degrees=0.5)
    assert document["distant"] == [
        {"direction": [0, 0, -2], "angular_diameter_degrees": 0.5, "irradiance": 5}
    ]


def test_a_sky_is_seen_where_mitsuba_sees_it(tmp_path: Path) -> None:
    """Its u = 1/2 is +z and u = 1/4 is +x, with y up: one bright column."""
    (tmp_path / "in").mkdir()
    pixels = np.zeros((8, 16, 3), dtype=np.float32)
    pixels[:, 4] = 1.0
    write_exr(tmp_path / "in" / "sky.exr", pixels, "RGB")
    body = '<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>'
    document, _ = imported(tmp_path, SPHERE + body)
    sky = document["environment"]
    assert (sky["up"], sky["forward"]) == ([0, 1, 0], [0, 0, 1])
    found = oiio.ImageBuf(str(tmp_path / "out" / sky["asset"]))
    width = found.spec().width
    row = [found.getpixel(x, found.spec().height // 2)[0] for x in range(width)]
    # Column 4's centre is at (4 + 1/2) / 16 of the width; bilinear over one column on either side.
    centre = np.average((np.arange(width) + 0.5) / width, weights=row)
    assert centre == pytest.approx(4.5 / 16)
    # An eighth of a column from the middle, brightness and colour each interpolated.
    assert max(row) == pytest.approx((7 / 8) ** 2)


def test_meshes_stand_where_they_are_put_and_face_their_normals(tmp_path: Path) -> None:
    """A rectangle turned to face -x, stretched; a texture makes it a mesh, v going down the picture."""
    body = (
        '<shape type="rectangle"><transform name="to_world"><scale x="2"/><rotate y="1" angle="-90"/>'
        '<translate x="1"/></transform><bsdf type="diffuse"><texture name="reflectance" type="checkerboard">'
        '<transform name="to_uv"><scale x="3" y="5"/></transform></texture></bsdf></shape>'
    )
    document, _ = imported(tmp_path, body)
    [surface] = document["surfaces"]
    mesh = load_mesh(tmp_path / "out" / surface["shape"]["asset"], "ply", normals=True)
    assert mesh.coordinates is not None
    a, b, c = mesh.vertices[mesh.indices[0]]
    normal = np.cross(b - a, c - a)
    assert normal / np.linalg.norm(normal) == pytest.approx([-1, 0, 0], abs=1e-6)
    # u grows with x of the rectangle, which became z; Mitsuba's v, which is 1 - ours, with y.
    for vertex, (u, v) in zip(mesh.vertices, mesh.coordinates, strict=True):
        assert vertex == pytest.approx([1, 1 - 2 * v, 2 * (2 * u - 1)], abs=1e-6)
    use = surface["kernel"]["front"]["reflectance"]
    # v' = 1 - v: 5 v becomes 1 - 5 (1 - v').
    assert (use["scale"], use["offset"]) == ([3, 5], [0, -4])


def test_a_board_has_its_first_colour_at_the_first_corner(tmp_path: Path) -> None:
    found = kernel(tmp_path, '<bsdf type="diffuse"><texture name="reflectance" type="checkerboard"/></bsdf>')
    document = json.loads((tmp_path / "out" / "scene.json").read_text())
    texture = document["textures"][found["front"]["reflectance"]["texture"]]
    board = oiio.ImageBuf(str(tmp_path / "out" / texture["asset"]))
    last = board.spec().width - 1
    assert texture["sharp"]
    assert [board.getpixel(x, y)[0] for x, y in ((0, 0), (last, 0), (last, last))] == pytest.approx(
        [0.4, 0.2, 0.4]
    )


def test_instances_of_a_group(tmp_path: Path) -> None:
    body = (
        f'<shape type="shapegroup" id="g">{SPHERE}</shape>'
        '<shape type="instance"><ref id="g"/><transform name="to_world"><scale value="2"/>'
        '<rotate y="1" angle="90"/><translate x="3"/></transform></shape>'
        '<shape type="instance"><ref id="g"/><transform name="to_world"><scale x="2"/></transform></shape>'
    )
    document, found = imported(tmp_path, body)
    [instance] = document["instances"]
    assert instance["scale"] == pytest.approx(2)
    assert instance["rotate"]["degrees"] == pytest.approx(90)
    assert instance["rotate"]["axis"] == pytest.approx([0, 1, 0])
    # The stretched one is a copy, and no sphere any more.
    assert document["surfaces"][0]["shape"]["type"] == "mesh"
    assert any("became a copy" in note for note in found.notes)


def test_defaults_includes_and_references(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "b.xml").write_text(
        '<scene version="3.0.0"><default name="grey" value="0.9"/><bsdf type="diffuse" id="paint">'
        '<rgb name="reflectance" value="$grey"/></bsdf></scene>'
    )
    body = '<include filename="b.xml"/><shape type="sphere"><ref id="paint"/></shape>'
    document, _ = imported(tmp_path, body, parameters={"grey": "0.125"})
    assert document["surfaces"][0]["kernel"] == "paint"
    assert document["kernels"]["paint"]["front"]["reflectance"] == 0.125


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('<shape type="sdfgrid"/>', 'a.xml:8: no equal of the shape "sdfgrid"'),
        ('<shape type="sphere"><bsdf type="hair"/></shape>', 'no equal of the bsdf "hair"'),
        (
            '<shape type="sphere"><float name="colour" value="1"/></shape>',
            'no equal of the parameter "colour"',
        ),
        ('<emitter type="projector"/>' + SPHERE, 'no equal of the emitter "projector"'),
        (
            '<shape type="sphere"><bsdf type="principledthin"/></shape>',
            'no equal of the bsdf "principledthin"',
        ),
        (SPHERE + '<volume type="gridvolume"/>', "no equal of <volume>"),
    ],
)
def test_what_has_no_equal_is_named_and_can_be_allowed(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(InputError) as raised:
        imported(tmp_path, SPHERE + body)
    assert said in str(raised.value)
    _, found = imported(tmp_path, SPHERE + body, allow_missing=True)
    assert any(said in str(each) for each in found.missing)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('<shape type="sphere"><ref id="nobody"/></shape>', 'nothing has the id "nobody"'),
        ('<shape type="sphere"><float name="radius" value="two"/></shape>', "expected numbers"),
        ('<shape type="sphere"><float name="radius" value="nan"/></shape>', "expected finite numbers"),
        ('<shape type="sphere"><string name="radius" value="2"/></shape>', "expected <float> or <integer>"),
        ('<shape type="sphere"><float name="radius" value="$size"/></shape>', "-D size=VALUE"),
        ('<shape type="obj"><string name="filename" value="no.obj"/></shape>', 'no file "no.obj"'),
        ('<bsdf type="diffuse" id="a"/><bsdf type="diffuse" id="a"/>', 'the id "a" is used twice'),
    ],
)
def test_mistakes_are_told_with_their_line(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(InputError) as raised:
        imported(tmp_path, body)
    assert said in str(raised.value)
    assert "a.xml:8" in raised.value.problems[0].place


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


def test_a_textured_base_saturates_no_more_than_an_even_one(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "t.exr", np.array([[[0.2, 0.5, 0.9], [1.0, 0.0, 0.5]]]))
    texture = (
        '<texture name="diffuse_reflectance" type="bitmap"><string name="filename" value="t.exr"/></texture>'
    )
    found = kernel(tmp_path, f'<bsdf type="plastic">{texture}</bsdf>')["front"]
    document = json.loads((tmp_path / "out" / "scene.json").read_text())
    asset = document["textures"][found["reflectance"]["texture"]]["asset"]
    under = np.asarray(oiio.ImageBuf(str(tmp_path / "out" / asset)).get_pixels(oiio.FLOAT))
    # What one of the same reflectance everywhere becomes.
    coat = smooth_coat(found["index"])
    expected = [base_under(coat, each, linear=True) for each in (0.2, 0.5, 0.9, 1.0, 0.0, 0.5)]
    assert under.ravel() == pytest.approx(expected, abs=1e-6)


def test_an_emitter_of_the_scene_is_that_of_shapes_that_refer_to_it(tmp_path: Path) -> None:
    emitter = '<emitter type="area" id="e"><spectrum name="radiance" value="2"/></emitter>'
    document, _ = imported(tmp_path, emitter + '<shape type="sphere"><ref id="e"/></shape>')
    assert document["surfaces"][0]["luminaire"] == {"radiance": 2}


def test_an_area_emitter_without_a_shape_is_told_what_it_lacks(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="belongs into a shape"):
        imported(tmp_path, SPHERE + '<emitter type="area"/>')


def test_folders_of_included_files_may_be_those_of_the_scene(tmp_path: Path) -> None:
    """<path> is looked for beside its own file first, and then beside those that include it."""
    (tmp_path / "in" / "parts").mkdir(parents=True)
    (tmp_path / "in" / "meshes").mkdir()
    (tmp_path / "in" / "meshes" / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    part = '<path value="meshes"/><shape type="obj"><string name="filename" value="t.obj"/></shape>'
    (tmp_path / "in" / "parts" / "p.xml").write_text(f'<scene version="3.0.0">{part}</scene>')
    document, _ = imported(tmp_path, '<include filename="parts/p.xml"/>')
    assert len(document["surfaces"]) == 1


def test_what_is_broken_is_left_out_and_the_rest_is_there(tmp_path: Path) -> None:
    broken = '<shape type="obj"><string name="filename" value="none.obj"/></shape>'
    document, found = imported(tmp_path, broken + SPHERE, allow_missing=True)
    assert len(document["surfaces"]) == 1
    assert 'no file "none.obj"' in str(found.missing[0])
