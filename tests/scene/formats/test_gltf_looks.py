"""glTF's textures and material extensions, against the specifications' formulas."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read.workflows import _solved
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.textures.environment_maps import read_whole

from tests.pictures import write_exr
from tests.scene.formats.test_gltf import COORDINATES, tree
from tests.scene.formats.test_gltf_shapes import Model


def textured(tmp_path: Path, reference: dict[str, Any], sampler: dict[str, Any]) -> tuple[Any, Any, Path]:
    """The use of a base colour's texture, the mesh's coordinates, and the texture's file."""
    picture = np.arange(24, dtype=float).reshape(2, 4, 3) / 24
    write_exr(tmp_path / "t.exr", picture, "RGB")
    scene = tree() | {"images": [{"uri": "t.exr"}], "samplers": [sampler]}
    scene["textures"] = [{"source": 0, "sampler": 0}]
    scene["materials"] = [{"normalTexture": {"index": 0, **reference}}]
    (tmp_path / "a.gltf").write_text(json.dumps(scene))
    found = import_scene(tmp_path / "a.gltf", tmp_path / "out", ImportOptions(light="sky"))
    document = json.loads(found.document.read_text())
    [surface] = document["surfaces"]
    use = surface["normal_map"]
    mesh = load_mesh(tmp_path / "out" / surface["shape"]["asset"], "ply")
    return use, mesh.coordinates, tmp_path / "out" / use["texture"]["asset"]


def looked_up(use: Any, coordinates: Any) -> Any:
    """Where in the picture, v down, the document's rules look: at coordinates times scale plus offset."""
    found = coordinates * use.get("scale", [1, 1]) + use.get("offset", [0, 0])
    return np.stack([found[:, 0], 1 - found[:, 1]], 1)


@pytest.mark.parametrize("angle", [0.0, 0.3, -2.0])
def test_a_turned_texture_is_where_the_extension_puts_it(tmp_path: Path, angle: float) -> None:
    """Offset, then turned counter-clockwise as seen with v down, then scaled."""
    transform = {"offset": [0.1, 0.2], "rotation": angle, "scale": [2.0, 3.0]}
    use, coordinates, _ = textured(tmp_path, {"extensions": {"KHR_texture_transform": transform}}, {})
    u, v = COORDINATES.T * np.array([[2.0], [3.0]])
    expected = [0.1 + np.cos(angle) * u + np.sin(angle) * v, 0.2 - np.sin(angle) * u + np.cos(angle) * v]
    assert looked_up(use, coordinates) == pytest.approx(np.transpose(expected), abs=1e-6)


def test_a_mirrored_texture_is_followed_by_its_mirror_image(tmp_path: Path) -> None:
    """The picture doubled, looked up at half the coordinates."""
    use, coordinates, file = textured(tmp_path, {}, {"wrapS": 33648, "wrapT": 33648})
    assert use["texture"].get("wrap", "repeat") == "repeat"
    assert looked_up(use, coordinates) == pytest.approx(COORDINATES / 2, abs=1e-6)
    pixels = read_whole(file)
    assert pixels.shape == (4, 8, 3)
    assert pixels[:, 4:] == pytest.approx(pixels[:, 3::-1])
    assert pixels[2:] == pytest.approx(pixels[1::-1])


def test_held_in_one_direction_only_has_no_equal(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="held at its edges in one direction"):
        textured(tmp_path, {}, {"wrapS": 33071})


def test_a_second_set_of_coordinates_is_the_meshs(tmp_path: Path) -> None:
    model = Model()
    second = np.array([[0, 0], [0.5, 0], [0, 0.5], [0.5, 0.5]])
    uv = {"TEXCOORD_0": model.array(np.zeros((4, 2))), "TEXCOORD_1": model.array(second)}
    model.mesh([0, 1, 2, 1, 3, 2], attributes=uv)
    write_exr(tmp_path / "t.exr", np.ones((2, 2, 3)) * 0.5, "RGB")
    model.tree |= {"images": [{"uri": "t.exr"}], "textures": [{"source": 0}]}
    model.tree["materials"] = [{"normalTexture": {"index": 0, "texCoord": 1}}]
    found = model.triangles(tmp_path).coordinates
    assert found is not None
    assert np.stack([found[:, 0], 1 - found[:, 1]], 1) == pytest.approx(second, abs=1e-6)


def test_sets_of_coordinates_on_one_material_have_no_equal(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2])
    write_exr(tmp_path / "t.exr", np.ones((2, 2, 3)) * 0.5, "RGB")
    model.tree |= {"images": [{"uri": "t.exr"}], "textures": [{"source": 0}]}
    pbr = {"baseColorTexture": {"index": 0}}
    model.tree["materials"] = [{"normalTexture": {"index": 0, "texCoord": 1}, "pbrMetallicRoughness": pbr}]
    with pytest.raises(InputError, match="several sets"):
        model.imported(tmp_path)


def test_specular_and_glossiness_keep_both_colours() -> None:
    """(1 - m) c is the diffuse colour below the reflection, and 0.04 (1 - m) + m c the reflectance."""
    generator = np.random.default_rng(3)
    # Of metal or of none, where both are kept; in between brightness is.
    for metal in (0.0, 1.0):
        base = generator.uniform(0.05, 0.95, size=(20, 3))
        specular = 0.04 * (1 - metal) + metal * base
        diffuse = (1 - metal) * base * 0.96 / (1 - specular.max(axis=1, keepdims=True))
        metallic, found = _solved(diffuse, specular)
        assert metallic == pytest.approx(np.full((20, 1), metal), abs=1e-6)
        assert found == pytest.approx(base, abs=1e-6)
    metallic, found = _solved(np.array([0.3, 0.3, 0.3]), np.array([0.2, 0.2, 0.2]))
    assert 0.04 * (1 - metallic) + metallic * found == pytest.approx([0.2] * 3, abs=0.02)


def test_unlit_shows_its_colour_as_light(tmp_path: Path) -> None:
    scene = tree()
    pbr = {"baseColorFactor": [0.5, 0.5, 0.5, 1]}
    scene["materials"] = [{"pbrMetallicRoughness": pbr, "extensions": {"KHR_materials_unlit": {}}}]
    (tmp_path / "a.gltf").write_text(json.dumps(scene))
    found = import_scene(tmp_path / "a.gltf", tmp_path / "out", ImportOptions())
    [surface] = json.loads(found.document.read_text())["surfaces"]
    assert surface["luminaire"]["radiance"]["luminance"] == pytest.approx(0.5)
    assert surface["luminaire"]["two_sided"] is True


def test_what_needs_no_change_stays_the_file_that_it_was(tmp_path: Path) -> None:
    """A base colour without a factor; numbers in channels of one picture become pictures of eight bits."""
    pixels = np.random.default_rng(5).integers(0, 256, (4, 4, 3)).astype(np.uint8)
    buffer = oiio.ImageBuf(oiio.ImageSpec(4, 4, 3, oiio.UINT8))
    buffer.set_pixels(oiio.ROI(), pixels.astype(np.float32) / 255)
    buffer.write(str(tmp_path / "t.png"))
    scene = tree() | {"images": [{"uri": "t.png"}], "textures": [{"source": 0}]}
    pbr = {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}}
    scene["materials"] = [{"pbrMetallicRoughness": pbr}]
    (tmp_path / "a.gltf").write_text(json.dumps(scene))
    found = import_scene(tmp_path / "a.gltf", tmp_path / "out", ImportOptions(light="sky"))
    [kernel] = json.loads(found.document.read_text())["kernels"].values()
    files = {name: tmp_path / "out" / kernel[name]["texture"]["asset"] for name in ("base", "roughness")}
    assert kernel["base"]["texture"]["encoding"] == "sRGB"
    assert files["base"].read_bytes() == (tmp_path / "t.png").read_bytes()
    stored = np.asarray(oiio.ImageBuf(str(files["roughness"])).get_pixels(oiio.UINT8))
    assert files["roughness"].suffix == ".png"
    assert stored[..., 0].tolist() == pixels[..., 1].tolist()
