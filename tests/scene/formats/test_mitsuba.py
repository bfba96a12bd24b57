"""Mitsuba's plugins, its BSDFs apart, as parts of a document, against its documented conventions."""

import json
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene import limits
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import Incomplete, import_scene
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT, white
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.textures.environment_maps import interpolated, read_whole

from tests.pictures import write_exr
from tests.scene.formats.mitsuba_import import SENSOR, SPHERE, imported, kernel


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
    assert lamp["kernel"] == {"type": "null"}
    assert lamp["luminaire"]["radiance"] == pytest.approx(3 / (np.pi * 0.25**2))
    assert any("became a sphere of radius 0.25" in note for note in found.notes)


def test_light_from_one_direction_becomes_a_disc(tmp_path: Path) -> None:
    body = (
        '<emitter type="directional"><vector name="direction" value="0 0 2"/>'
        '<spectrum name="irradiance" value="5"/></emitter>'
    )
    document, _ = imported(tmp_path, SPHERE + body, light_degrees=0.5)
    assert document["distant"] == [
        {
            "direction": [0, 0, -2],
            "angular_diameter_degrees": 0.5,
            "irradiance": 5,
            "hidden_from": "camera_and_mirrors",
        }
    ]


def test_hidden_emitters_are_hidden_from_the_camera(tmp_path: Path) -> None:
    """As Mitsuba's are; points are hidden from mirrors, too."""
    glowing = '<shape type="sphere"><emitter type="area"/></shape>'
    hiding = '<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>'
    document, found = imported(
        tmp_path, glowing + hiding + '<emitter type="point"/><emitter type="constant"/>'
    )
    hidden = [surface["luminaire"]["hidden_from"] for surface in document["surfaces"]]
    assert hidden == ["camera", "camera_and_mirrors"]
    assert document["environment"]["hidden_from"] == "camera"
    assert not found.missing


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
    assert sky["pixels"] == "points"
    # As small as it came.
    file = tmp_path / "out" / sky["asset"]
    assert file.read_bytes() == (tmp_path / "in" / "sky.exr").read_bytes()
    rows, count, width = interpolated(read_whole(file))
    row = np.stack(list(rows))[count // 2, :, 0]
    # Column 4's centre is at (4 + 1/2) / 16 of the width; bilinear over one column on either side.
    centre = np.average((np.arange(width) + 0.5) / width, weights=row)
    assert centre == pytest.approx(4.5 / 16)
    # An eighth of a column from the middle, brightness and colour each interpolated.
    assert max(row) == pytest.approx((7 / 8) ** 2)


def test_a_sky_of_eight_bits_is_decoded(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    picture = oiio.ImageBuf(oiio.ImageSpec(16, 8, 3, oiio.UINT8))
    oiio.ImageBufAlgo.fill(picture, (0.5, 0.5, 0.5))
    picture.write(str(tmp_path / "in" / "sky.png"))
    body = '<emitter type="envmap"><string name="filename" value="sky.png"/></emitter>'
    document, _ = imported(tmp_path, SPHERE + body)
    pixels = read_whole(tmp_path / "out" / document["environment"]["asset"])
    # 128 of 255 by IEC 61966-2-1.
    assert pixels == pytest.approx(0.2158605, rel=1e-3)


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
        ('<shape type="sdfgrid"/>', 'a.xml:8: no support for the shape "sdfgrid"'),
        ('<shape type="sphere"><bsdf type="hair"/></shape>', 'no support for the bsdf "hair"'),
        (
            '<shape type="sphere"><float name="colour" value="1"/></shape>',
            'no support for the parameter "colour"',
        ),
        ('<emitter type="sunsky"/>' + SPHERE, 'no support for the emitter "sunsky"'),
        (
            '<shape type="sphere"><bsdf type="principledthin"/></shape>',
            'no support for the bsdf "principledthin"',
        ),
        (SPHERE + '<volume type="gridvolume"/>', "no support for <volume>"),
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


def test_a_film_without_pixels_is_refused(tmp_path: Path) -> None:
    film = '<film type="hdrfilm"><integer name="height" value="0"/></film>'
    (tmp_path / "a.xml").write_text(f'<scene version="3.0.0"><sensor type="thinlens">{film}</sensor></scene>')
    with pytest.raises(InputError, match="a film has at least one pixel"):
        import_scene(tmp_path / "a.xml", tmp_path / "out", ImportOptions())


def test_an_emitter_of_the_scene_is_that_of_shapes_that_refer_to_it(tmp_path: Path) -> None:
    emitter = '<emitter type="area" id="e"><spectrum name="radiance" value="2"/></emitter>'
    document, _ = imported(tmp_path, emitter + '<shape type="sphere"><ref id="e"/></shape>')
    assert document["surfaces"][0]["luminaire"] == {"radiance": 2}


def test_a_lamp_of_which_no_material_is_said_reflects_nothing(tmp_path: Path) -> None:
    emitter = '<emitter type="area"><spectrum name="radiance" value="1"/></emitter>'
    document, _ = imported(tmp_path, f'<shape type="sphere">{emitter}</shape>{SPHERE}')
    lamp, plain = (each["kernel"] for each in document["surfaces"])
    assert lamp == {"type": "lambertian", "reflectance": 0.0}
    assert plain["front"]["reflectance"] == 0.5


def test_an_area_emitter_without_a_shape_is_told_what_it_lacks(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="belongs into a shape"):
        imported(tmp_path, SPHERE + '<emitter type="area"/>')


def test_folders_of_included_files_may_be_those_of_the_scene(tmp_path: Path) -> None:
    """<path> is looked for in its own file's folder first, and then in those of files that include it."""
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


def test_a_mirrored_picture_repeats_with_its_mirror_images(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "a.exr", np.arange(18, dtype=np.float32).reshape(2, 3, 3), "RGB")
    body = (
        '<shape type="rectangle"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">'
        '<string name="filename" value="a.exr"/><string name="wrap_mode" value="mirror"/>'
        '<transform name="to_uv"><scale x="2" y="4"/><translate x="1" y="0.5"/></transform>'
        "</texture></bsdf></shape>"
    )
    document, found = imported(tmp_path, body)
    assert not found.missing
    [texture] = document["textures"].values()
    pixels = read_whole(tmp_path / "out" / texture["asset"])
    upper, lower = [0, 3, 6, 6, 3, 0], [9, 12, 15, 15, 12, 9]
    assert pixels[..., 0].tolist() == [upper, lower, lower, upper]
    use = document["surfaces"][0]["kernel"]["front"]["reflectance"]
    assert use["scale"] == [1.0, 2.0]
    # v down: 1 - 2 - 0.25.
    assert use["offset"] == [0.5, -1.25]


def test_a_number_of_samples_may_be_left_open(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    sensor = SENSOR.replace('value="7"', 'value="$spp"')
    (tmp_path / "in" / "a.xml").write_text(
        f'<scene version="3.0.0">{sensor}{SPHERE}<emitter type="constant"/></scene>'
    )
    found = import_scene(tmp_path / "in" / "a.xml", tmp_path / "open", ImportOptions())
    assert found.film.samples == 16
    with pytest.raises(InputError, match="has no value"):
        imported(tmp_path, '<shape type="sphere"><float name="radius" value="$spp"/></shape>')


def test_a_document_that_is_too_long_to_be_rendered_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is written without line breaks and spaces before it comes to that."""
    document, _ = imported(tmp_path, 40 * SPHERE)
    shortest = len(json.dumps(document, separators=(",", ":"))) + 1
    (tmp_path / "short").mkdir()
    monkeypatch.setattr(limits, "MAX_SCENE_BYTES", shortest)
    imported(tmp_path / "short", 40 * SPHERE)
    (tmp_path / "long").mkdir()
    monkeypatch.setattr(limits, "MAX_SCENE_BYTES", shortest - 1)
    with pytest.raises(Incomplete, match="too long"):
        imported(tmp_path / "long", 40 * SPHERE)
