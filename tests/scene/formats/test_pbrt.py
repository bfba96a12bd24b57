"""pbrt's directives as parts of a document, against its documented conventions.

One file, though long: a short test for each directive or parameter.
"""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.photometry import ies as photometric_files

HEAD = """Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" [40] "integer yresolution" [20]
Sampler "independent" "integer pixelsamples" 7
"""
LIGHT = 'LightSource "infinite" "rgb L" [1 1 1]\n'


def imported(tmp_path: Path, body: str, head: str = HEAD, **options: Any) -> tuple[dict[str, Any], Imported]:
    folder = tmp_path / "in"
    folder.mkdir(exist_ok=True)
    (folder / "a.pbrt").write_text(f"{head}WorldBegin\n{LIGHT}{body}\n")
    found = import_scene(folder / "a.pbrt", tmp_path / "out", ImportOptions(**options))
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found


def shown(sensor: dict[str, Any], point: list[float]) -> tuple[float, float]:
    """Where a point is in the image: to the right, and up; as tangents."""
    position, up = np.array(sensor["position"]), np.array(sensor["up"])
    ahead = np.subtract(sensor["look_at"], position)
    right = np.cross(ahead, up)
    off = np.subtract(point, position)
    return float(off @ right / (off @ ahead)), float(off @ up / (off @ ahead))


@pytest.mark.parametrize("head", [HEAD, "Scale -1 1 1\n" + HEAD])
def test_the_image_is_not_a_mirror_image(tmp_path: Path, head: str) -> None:
    """In pbrt's camera space +x is to the right; a scene often turns that over with a scale of -1."""
    document, _ = imported(tmp_path, 'Translate 1 2 10 Shape "sphere"', head)
    across = -1.0 if head.startswith("Scale") else 1.0
    centre = document["surfaces"][0]["shape"]["centre"]
    assert shown(document["sensor"], centre) == pytest.approx((across * 0.1, 0.2))


def test_look_at_and_the_shorter_side(tmp_path: Path) -> None:
    document, found = imported(tmp_path, 'Shape "sphere"', "LookAt 0 0 5  0 0 0  0 1 0\n" + HEAD)
    sensor = document["sensor"]
    assert sensor["vertical_field_of_view_degrees"] == pytest.approx(45)
    assert shown(sensor, document["surfaces"][0]["shape"]["centre"]) == pytest.approx((0, 0), abs=1e-12)
    assert (found.film.width, found.film.height, found.film.samples) == (40, 20, 7)
    assert document["tracing"] == {"maximum_depth": 5}


def test_a_lights_white_has_the_luminance_of_its_scale(tmp_path: Path) -> None:
    lamp = 'AreaLightSource "diffuse" "blackbody L" 3000 "float scale" 50'
    body = f'AttributeBegin {lamp} Shape "sphere" AttributeEnd'
    document, _ = imported(tmp_path, body + '\nShape "sphere"')
    bright, ball = document["surfaces"]
    assert bright["luminaire"] == {"radiance": {"blackbody": 3000, "luminance": 50}}
    assert "luminaire" not in ball
    assert document["environment"]["radiance"]["luminance"] == pytest.approx(1)


def test_a_points_power_goes_into_all_directions(tmp_path: Path) -> None:
    lamp = 'LightSource "point" "float power" 200 "float scale" 3 "blackbody I" 3000'
    document, _ = imported(tmp_path, f'{lamp} Shape "sphere"', light_radius=0.01)
    radiance = document["surfaces"][1]["luminaire"]["radiance"]["luminance"]
    assert radiance * np.pi * 0.01**2 == pytest.approx(3 * 200 / (4 * np.pi))


@pytest.mark.parametrize(("cone", "delta"), [(30, 5), (80, 80), (120, 20)])
def test_a_spots_power_is_its_flux(tmp_path: Path, cone: float, delta: float) -> None:
    """The sum of the intensities in its file, straight in between, over all directions."""
    lamp = f'LightSource "spot" "float power" 200 "float coneangle" {cone} "float conedeltaangle" {delta}'
    document, _ = imported(tmp_path, f'{lamp} Shape "sphere"')
    asset = document["surfaces"][1]["luminaire"]["profile"]["asset"]
    lamp_file = photometric_files.read((tmp_path / "out" / asset).read_bytes())
    degrees = np.linspace(0, 180, 200_001)
    candela = np.interp(degrees, lamp_file.vertical, lamp_file.candela[0])
    assert -2 * np.pi * np.trapezoid(candela, np.cos(np.radians(degrees))) == pytest.approx(200, rel=2e-4)


def test_roughness_is_the_square_of_alpha_unless_it_is_not(tmp_path: Path) -> None:
    body = 'Material "conductor" "float roughness" 0.09 Shape "sphere"\n'
    body += 'Material "conductor" "float roughness" 0.09 "bool remaproughness" false Shape "sphere"'
    document, _ = imported(tmp_path, body)
    kernels = [document["kernels"][surface["kernel"]] for surface in document["surfaces"]]
    assert [kernel["roughness"] for kernel in kernels] == pytest.approx([0.3, 0.09])
    assert kernels[0]["index"] == "Cu"


def test_a_mesh_keeps_its_corners_and_its_side(tmp_path: Path) -> None:
    """The z axis is turned over, since the camera's axes are right-handed; the normal goes along."""
    body = 'Shape "trianglemesh" "point3 P" [0 0 1 2 0 1 0 2 1] "integer indices" [0 1 2]'
    document, _ = imported(tmp_path, body)
    mesh = load_mesh(tmp_path / "out" / document["surfaces"][0]["shape"]["asset"], "ply")
    assert sorted(mesh.vertices.tolist()) == [[0, 0, -1], [0, 2, -1], [2, 0, -1]]
    a, b, c = mesh.vertices[mesh.indices[0]]
    assert np.cross(b - a, c - a) == pytest.approx([0, 0, -4])


def test_instances_and_copies(tmp_path: Path) -> None:
    body = """ObjectBegin "ball" Translate 1 0 0 Shape "sphere" ObjectEnd
    AttributeBegin Translate 0 0 3 Rotate 90 0 0 1 ObjectInstance "ball" AttributeEnd
    AttributeBegin Scale 1 1 2 ObjectInstance "ball" AttributeEnd"""
    document, found = imported(tmp_path, body, "Scale -1 1 1\n" + HEAD)
    [instance] = document["instances"]
    [member] = document["groups"][instance["group"]]
    assert member["shape"]["centre"] == [1, 0, 0]
    assert instance["translate"] == [0, 0, 3]
    assert instance["rotate"]["axis"] == pytest.approx([0, 0, 1])
    assert document["surfaces"][0]["shape"]["type"] == "mesh"
    assert any("became a copy" in note for note in found.notes)


def test_compressed_meshes_and_included_files(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    text = (
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    (tmp_path / "in" / "m.ply.gz").write_bytes(gzip.compress(text.encode()))
    (tmp_path / "in" / "b.pbrt.gz").write_bytes(
        gzip.compress(b'Shape "plymesh" "string filename" "m.ply.gz"')
    )
    document, _ = imported(tmp_path, 'Include "b.pbrt.gz"')
    assert document["surfaces"][0]["shape"]["smooth"] is False


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('Shape "nurbs"', 'no support for the shape "nurbs"'),
        ('Material "hair" Shape "sphere"', 'no support for the material "hair"'),
        ('Shape "sphere" "float colour" 1', 'no support for the parameter "colour"'),
        ('LightSource "projection"', 'no support for the light "projection"'),
        ('LightSource "distant" "float power" 9', 'no support for the parameter "power"'),
        ('MakeNamedMedium "m" "string type" "nanovdb"', 'no support for the medium "nanovdb"'),
        ('MakeNamedMedium "m" "string type" "cloud"', 'no support for the medium "cloud"'),
    ],
)
def test_what_has_no_equal_is_named_and_can_be_allowed(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(InputError, match=r"a\.pbrt:6") as raised:
        imported(tmp_path, body + '\nShape "sphere"')
    assert said in str(raised.value)
    _, found = imported(tmp_path, body + '\nShape "sphere"', allow_missing=True)
    assert any(said in str(each) for each in found.missing)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("Spin 1 2 3", 'no directive "Spin"'),
        ("Translate 1 2", "ends in the middle"),
        ("Translate 1 2 x", 'expected a number, found "x"'),
        ("Translate 1 2 inf", "expected a number"),
        ("Rotate 30 0 0 0", "the axis has no length"),
        ("AttributeEnd", "ends what did not begin"),
        ('Shape "sphere" "float radius" [1 2]', '"radius" has 2 numbers; expected 1'),
        ('Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 9]', "9"),
        ('NamedMaterial "gold"', 'no material "gold"'),
        ('Shape "sphere" "texture alpha" "t"', 'no texture "t"'),
        ("Scale 0 1 1", "a scale of 0"),
    ],
)
def test_mistakes_are_told_with_their_line(tmp_path: Path, body: str, said: str) -> None:
    with pytest.raises(InputError) as raised:
        imported(tmp_path, body)
    assert said in str(raised.value)
    assert "a.pbrt" in raised.value.problems[0].place


def test_a_board_has_its_first_colour_at_the_origin(tmp_path: Path) -> None:
    """One square for each unit of the mapping; the picture's bottom left corner is u = v = 0."""
    body = 'Texture "b" "spectrum" "checkerboard" "float uscale" 6 "float tex1" 0.5 "float tex2" 0.25\n'
    document, _ = imported(tmp_path, body + 'Material "diffuse" "texture reflectance" "b" Shape "sphere"')
    [kernel] = document["kernels"].values()
    use = kernel["reflectance"]
    assert (use["scale"], use["offset"]) == ([3, 0.5], [0, 0])
    board = oiio.ImageBuf(str(tmp_path / "out" / document["textures"][use["texture"]]["asset"]))
    last = board.spec().width - 1
    assert [board.getpixel(x, y)[0] for x, y in ((0, last), (0, 0), (last, 0))] == [0.5, 0.25, 0.5]


@pytest.mark.parametrize("name", ["glass_ball", "instances", "media"])
def test_the_repositorys_scenes_are_imported_whole(name: str, tmp_path: Path) -> None:
    scenes = Path(__file__).parents[3] / "examples" / "pbrt"
    found = import_scene(scenes / f"{name}.pbrt", tmp_path / "out", ImportOptions())
    assert found.missing == []


SKY = 'LightSource "infinite" "string filename" "sky.exr" "float scale" 40\n'


@pytest.mark.parametrize(
    ("camera", "expected"),
    [
        ("", [[1, 0, 0], [0, 1, 0], [0, 0, -1]]),
        ("Scale -1 1 1\n", [[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
    ],
)
def test_a_skys_picture_shines_from_where_it_did(
    camera: str, expected: list[list[float]], tmp_path: Path
) -> None:
    """One bright pixel in the directions x, y and z of pbrt's world. Where that is left-handed as the camera
    sees it, ours has z the other way round.
    """
    folder = tmp_path / "in"
    folder.mkdir()
    for number, (u, v) in enumerate([(63, 32), (32, 63), (32, 32)]):
        pixels = np.zeros((64, 64, 3), dtype=np.float32)
        pixels[v, u] = 100
        buffer = oiio.ImageBuf(oiio.ImageSpec(64, 64, 3, oiio.FLOAT))
        buffer.set_pixels(oiio.ROI(), pixels)
        assert buffer.write(str(folder / "sky.exr"))
        (folder / "a.pbrt").write_text(f'{camera}Camera "perspective"\nWorldBegin\n{SKY}Shape "sphere"\n')
        out = tmp_path / f"out{number}"
        found = json.loads(import_scene(folder / "a.pbrt", out, ImportOptions()).document.read_text())
        sky = found["environment"]
        assert sky["luminance"] == 40
        picture = np.asarray(oiio.ImageBuf(str(out / sky["asset"])).get_pixels(oiio.FLOAT))[..., 0]
        height, width = picture.shape
        row, column = np.unravel_index(np.argmax(picture), picture.shape)
        polar, azimuth = np.pi * (row + 0.5) / height, np.pi * (1 - 2 * (column + 0.5) / width)
        up, forward = (np.array(sky[name]) for name in ("up", "forward"))
        left = np.cross(up, forward)
        flat = np.cos(azimuth) * forward + np.sin(azimuth) * left
        assert np.cos(polar) * up + np.sin(polar) * flat == pytest.approx(np.array(expected[number]), abs=0.1)
        weight = np.sin(np.pi * (np.arange(height) + 0.5) / height)[:, None]
        # Its part of the sphere is one of 64 x 64 pixels.
        assert (picture * weight).sum() / (weight.sum() * width) == pytest.approx(100 / 4096, rel=0.02)


def test_a_skys_picture_is_a_square(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    buffer = oiio.ImageBuf(oiio.ImageSpec(64, 32, 3, oiio.FLOAT))
    assert buffer.write(str(tmp_path / "in" / "sky.exr"))
    with pytest.raises(InputError, match="64 x 32 pixels; expected a square"):
        imported(tmp_path, "", head=f"{HEAD}{SKY}")


def test_a_metal_of_three_numbers(tmp_path: Path) -> None:
    """Twice the largest times a reflectance: the numbers come out as the spectrum's colour."""
    body = 'Material "conductor" "rgb eta" [0.2 0.92 1.1] "rgb k" [3.9 2.4 2.1]\nShape "sphere"'
    document, found = imported(tmp_path, body)
    [kernel] = document["kernels"].values()
    table = dict(kernel["index"]["k"]["table"])
    assert 3.5 < table[650.0] < 4.5
    assert 1.8 < table[450.0] < 2.4
    assert any("as pbrt does" in note for note in found.notes)


def test_a_window_of_the_screen_narrows_the_field(tmp_path: Path) -> None:
    """The window's shorter half over 1 is that part of the tangent."""
    head = HEAD.replace('"float fov" 45', '"float fov" 45 "float screenwindow" [-1 1 -0.5 0.5]')
    document, _ = imported(tmp_path, 'Shape "sphere"', head)
    half = np.radians(document["sensor"]["vertical_field_of_view_degrees"] / 2)
    assert np.tan(half) == pytest.approx(np.tan(np.radians(22.5)) / 2)


def test_a_window_off_the_middle_has_no_equal(tmp_path: Path) -> None:
    head = HEAD.replace('"float fov" 45', '"float fov" 45 "float screenwindow" [0 2 -0.5 0.5]')
    with pytest.raises(InputError, match="screenwindow"):
        imported(tmp_path, 'Shape "sphere"', head)


def test_a_leaf_is_scaled_and_holds_no_more_light_than_comes(tmp_path: Path) -> None:
    def leaf(folder: str, scale: float, **options: Any) -> Any:
        (tmp_path / folder).mkdir()
        colours = '"rgb reflectance" [0.4 0.2 0.1] "rgb transmittance" [0.2 0.1 0.1]'
        material = f'Material "diffusetransmission" {colours} "float scale" {scale}'
        document, _ = imported(tmp_path / folder, material + '\nShape "sphere"', **options)
        [kernel] = document["kernels"].values()
        return kernel

    found = leaf("half", 0.5)
    assert found["reflectance"]["rgb"] == pytest.approx([0.2, 0.1, 0.05])
    assert found["transmittance"]["rgb"] == pytest.approx([0.1, 0.05, 0.05])
    with pytest.raises(InputError, match="more light than comes"):
        leaf("double", 2.0)
    held = leaf("held", 2.0, allow_missing=True)
    assert held["reflectance"]["rgb"][0] + held["transmittance"]["rgb"][0] == pytest.approx(1.0)


def test_metal_under_a_coat_has_its_colour_there(tmp_path: Path) -> None:
    """((n - 1.5)^2 + k^2) / ((n + 1.5)^2 + k^2); roughness 0.0625 is an alpha of 0.25."""
    body = (
        'Material "coatedconductor" "float conductor.eta" 0.5 "float conductor.k" 3 '
        '"float interface.roughness" 0.0625 "float conductor.roughness" 0.0081'
    )
    document, found = imported(tmp_path, body + '\nShape "sphere"')
    [kernel] = document["kernels"].values()
    assert kernel == {
        "type": "principled",
        "base": pytest.approx((1 + 9) / (4 + 9)),
        "metallic": 1.0,
        "roughness": pytest.approx(0.3),
        "coat": 1.0,
        "coat_roughness": pytest.approx(0.5),
        "coat_index": 1.5,
    }
    assert any("coatedconductor" in str(note) for note in found.notes)


def test_a_metal_by_name_is_darker_under_a_coat(tmp_path: Path) -> None:
    """Gold at 650 nm: n 0.155, k 3.52 (P. Johnson and R. Christy, Phys. Rev. B 6, 1972)."""
    body = 'Material "coatedconductor" "spectrum conductor.eta" "metal-Au-eta"'
    document, _ = imported(tmp_path, body + '\nShape "sphere"')
    [kernel] = document["kernels"].values()
    table = np.array(kernel["base"]["table"])
    expected = ((0.155 - 1.5) ** 2 + 3.52**2) / ((0.155 + 1.5) ** 2 + 3.52**2)
    assert np.interp(650, table[:, 0], table[:, 1]) == pytest.approx(expected, abs=0.02)


def test_a_coloured_metal_reflects_its_colour(tmp_path: Path) -> None:
    """Of n = 1 k^2 / (4 + k^2), as much as a diffuse surface of that colour."""
    body = 'Material "conductor" "rgb reflectance" [0.9 0.6 0.3]'
    document, _ = imported(tmp_path, body + '\nShape "sphere"')
    [kernel] = document["kernels"].values()
    k = np.array(kernel["index"]["k"]["table"])
    colour = colours.values_of({"rgb": [0.9, 0.6, 0.3]}, k[:, 0])
    assert k[:, 1] ** 2 / (4 + k[:, 1] ** 2) == pytest.approx(colour)


def test_textured_leaves_are_as_they_are(tmp_path: Path) -> None:
    texture = 'Texture "t" "spectrum" "checkerboard"\n'
    both = '"texture reflectance" "t" "texture transmittance" "t"'
    document, _ = imported(tmp_path, texture + f'Material "diffusetransmission" {both}\nShape "sphere"')
    [kernel] = document["kernels"].values()
    assert kernel["reflectance"] == kernel["transmittance"]


def test_what_is_broken_is_left_out_and_the_rest_is_there(tmp_path: Path) -> None:
    broken = 'Shape "plymesh" "string filename" "none.ply"\n'
    broken += 'Material "conductor" "rgb eta" [-1 1 1] "rgb k" [1 1 1]'
    document, found = imported(tmp_path, broken + '\nShape "sphere"', allow_missing=True)
    [surface] = document["surfaces"]
    assert document["kernels"][surface["kernel"]] == {"type": "lambertian", "reflectance": 0.5}
    assert [each.message for each in found.missing] == ['no file "none.ply"', "n and k are not negative"]


def test_glass_of_three_numbers(tmp_path: Path) -> None:
    body = 'Material "dielectric" "rgb eta" [1.5 1.5 1.5]\nShape "sphere"'
    document, _ = imported(tmp_path, body)
    [kernel] = document["kernels"].values()
    assert kernel["index"] == 1.5


def test_a_packed_file_may_have_several_parts(tmp_path: Path) -> None:
    """As `cat a.gz b.gz` makes it."""
    parts = [HEAD, f"WorldBegin\n{LIGHT}", 'Shape "sphere"\n', ""]
    (tmp_path / "a.pbrt.gz").write_bytes(b"".join(gzip.compress(part.encode()) for part in parts))
    found = import_scene(tmp_path / "a.pbrt.gz", tmp_path / "out", ImportOptions())
    assert len(json.loads(found.document.read_text())["surfaces"]) == 1


def test_one_height_everywhere_is_flat(tmp_path: Path) -> None:
    texture = 'Texture "t" "float" "constant" "float value" 0.3\n'
    document, _ = imported(
        tmp_path, texture + 'Material "diffuse" "texture displacement" "t"\nShape "sphere"'
    )
    [surface] = document["surfaces"]
    assert "bump_map" not in surface
