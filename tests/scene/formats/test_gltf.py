"""glTF's nodes, materials and extensions as parts of a document, against the specifications' formulas."""

import base64
import json
import struct
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import Imported, ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.textures.image_files import decoded

from tests.pictures import write_exr

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4")
COORDINATES = np.array([[0, 0], [1, 0], [0, 0.25]], dtype="<f4")
BINARY = CORNERS.tobytes() + COORDINATES.tobytes() + np.array([0, 1, 2, 0], dtype="<u2").tobytes()
TREE: dict[str, Any] = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
    "meshes": [
        {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}
    ],
    "materials": [{"name": "paint", "emissiveFactor": [1, 1, 1]}],
    "buffers": [{"byteLength": len(BINARY)}],
    "bufferViews": [
        {"buffer": 0, "byteOffset": 0, "byteLength": 36},
        {"buffer": 0, "byteOffset": 36, "byteLength": 24},
        {"buffer": 0, "byteOffset": 60, "byteLength": 8},
    ],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"},
    ],
}


def tree() -> dict[str, Any]:
    found = deepcopy(TREE)
    found["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(BINARY).decode()
    return found


def imported(tmp_path: Path, scene: dict[str, Any], **options: Any) -> tuple[dict[str, Any], Imported]:
    (tmp_path / "in").mkdir(exist_ok=True)
    (tmp_path / "in" / "a.gltf").write_text(json.dumps(scene))
    found = import_scene(tmp_path / "in" / "a.gltf", tmp_path / "out", ImportOptions(**options))
    document: dict[str, Any] = json.loads(found.document.read_text())
    return document, found


def kernel(tmp_path: Path, material: dict[str, Any], **options: Any) -> Any:
    scene = tree()
    scene["materials"] = [{"emissiveFactor": [1, 1, 1], **material}]
    document, _ = imported(tmp_path, scene, **options)
    return document["kernels"][document["surfaces"][0]["kernel"]]


def test_nodes_place_meshes_and_v_goes_up(tmp_path: Path) -> None:
    scene = tree()
    scene["nodes"] += [{"children": [0], "scale": [2, 2, 2], "rotation": [0, 0, 2**-0.5, 2**-0.5]}]
    scene["scenes"][0]["nodes"] = [2, 1]
    document, _ = imported(tmp_path, scene)
    mesh = load_mesh(tmp_path / "out" / document["surfaces"][0]["shape"]["asset"], "ply")
    assert mesh.vertices == pytest.approx(np.array([[0, 0, 0], [0, 2, 0], [-2, 0, 0]]), abs=1e-6)
    assert mesh.coordinates == pytest.approx(np.array([[0, 1], [1, 1], [0, 0.75]]))
    assert document["sensor"]["look_at"] == pytest.approx([0, 0, 3])
    assert document["sensor"]["vertical_field_of_view_degrees"] == pytest.approx(np.degrees(0.8))


def test_glb_holds_the_same(tmp_path: Path) -> None:
    text = json.dumps(TREE).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(BINARY), b"BIN\0") + BINARY
    )
    (tmp_path / "a.glb").write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    found = import_scene(tmp_path / "a.glb", tmp_path / "out", ImportOptions())
    assert json.loads(found.document.read_text())["surfaces"][0]["luminaire"]["radiance"]["luminance"] == 1


def test_brushed_surfaces_are_rougher_along_the_brush(tmp_path: Path) -> None:
    """Along it alpha is 0.25 + 0.75 x 0.5^2; a quarter of a turn is a quarter."""
    pbr = {"baseColorFactor": [0.6, 0.6, 0.6, 1], "metallicFactor": 1, "roughnessFactor": 0.5}
    brush = {"anisotropyStrength": 0.5, "anisotropyRotation": np.pi / 2}
    found = kernel(tmp_path, {"pbrMetallicRoughness": pbr, "extensions": {"KHR_materials_anisotropy": brush}})
    assert found["roughness"] ** 2 == pytest.approx(0.4375)
    assert (found["roughness_across"], found["rotation"]) == (0.5, pytest.approx(0.25))


def test_a_brush_by_a_texture_has_its_direction_and_strength(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "t.exr", np.array([[[1.0, 0.5, 1.0], [0.5, 1.0, 0.0]]]), "RGB")
    brush = {"anisotropyStrength": 1.0, "anisotropyTexture": {"index": 0}}
    scene = tree() | {"images": [{"uri": "t.exr"}], "textures": [{"source": 0}]}
    scene["materials"] = [
        {
            "pbrMetallicRoughness": {"roughnessFactor": 0.5},
            "emissiveFactor": [1, 1, 1],
            "extensions": {"KHR_materials_anisotropy": brush},
        }
    ]
    document, found = imported(tmp_path, scene)
    [entry] = document["kernels"].values()

    def stored(name: str) -> list[float]:
        asset = found.document.parent / entry[name]["texture"]["asset"]
        return list(np.asarray(oiio.ImageBuf(str(asset)).get_pixels(oiio.FLOAT))[0, :, 0])

    assert stored("rotation") == pytest.approx([0.0, 0.25], abs=3e-3)
    assert stored("roughness") == pytest.approx([1.0, 0.5], abs=3e-3)


def test_sheen_is_the_kernels(tmp_path: Path) -> None:
    sheen = {"sheenColorFactor": [0.5, 0.5, 0.5], "sheenRoughnessFactor": 0.3}
    found = kernel(tmp_path, {"extensions": {"KHR_materials_sheen": sheen}})
    assert (found["sheen"], found["sheen_roughness"]) == (0.5, 0.3)


def test_a_dielectric_reflects_in_colour(tmp_path: Path) -> None:
    """0.04 of the colour at normal incidence, and half of all that."""
    specular = {"specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 0.25]}
    found = kernel(tmp_path, {"extensions": {"KHR_materials_specular": specular}})
    assert found["specular"] == 0.5
    assert found["specular_colour"]["rgb"] == pytest.approx([0.04, 0.02, 0.01])


def test_metal_and_plastic_are_one_kernel(tmp_path: Path) -> None:
    """Base colour, metal and roughness go over as they are."""
    pbr = {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0.25, "roughnessFactor": 0.3}
    found = kernel(tmp_path, {"pbrMetallicRoughness": pbr})
    assert found == {
        "type": "principled",
        "base": 0.5,
        "metallic": 0.25,
        "roughness": 0.3,
        "index": pytest.approx(1.5),
    }


def test_a_clear_coat_is_the_kernels(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "t.exr", np.array([[[0.2, 0.5, 0.9], [1.0, 0.0, 0.5]]]), "RGB")
    scene = tree()
    coat = {
        "clearcoatFactor": 0.8,
        "clearcoatRoughnessFactor": 0.5,
        "clearcoatRoughnessTexture": {"index": 0},
    }
    scene |= {"images": [{"uri": "t.exr"}], "textures": [{"source": 0}]}
    pbr = {"baseColorFactor": [0.5, 0.5, 0.5, 1]}
    scene["materials"] = [
        {
            "pbrMetallicRoughness": pbr,
            "emissiveFactor": [1, 1, 1],
            "extensions": {"KHR_materials_clearcoat": coat},
        }
    ]
    document, found = imported(tmp_path, scene)
    [entry] = document["kernels"].values()
    assert entry["coat"] == 0.8
    asset = found.document.parent / entry["coat_roughness"]["texture"]["asset"]
    stored = np.asarray(oiio.ImageBuf(str(asset)).get_pixels(oiio.FLOAT))
    assert stored[0, :, 0] == pytest.approx(0.5 * np.array([0.5, 0.0]), abs=3e-3)


def test_a_textured_base_is_multiplied_texel_by_texel(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    write_exr(tmp_path / "in" / "t.exr", np.array([[[0.2, 0.5, 0.9], [1.0, 0.0, 0.5]]]), "RGB")
    scene = tree()
    pbr = {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 0.5, 1], "metallicFactor": 0}
    scene |= {"images": [{"uri": "t.exr"}], "textures": [{"source": 0}]}
    scene["materials"] = [{"pbrMetallicRoughness": pbr, "emissiveFactor": [1, 1, 1]}]
    document, found = imported(tmp_path, scene)
    [entry] = document["kernels"].values()
    assert entry["base"]["texture"]["encoding"] == "linear"
    asset = found.document.parent / entry["base"]["texture"]["asset"]
    base = np.asarray(oiio.ImageBuf(str(asset)).get_pixels(oiio.FLOAT))
    stored = np.array([[[0.2, 0.5, 0.9], [1.0, 0.0, 0.5]]])
    expected = decoded(stored) * [1, 1, 0.5]
    assert base == pytest.approx(expected, rel=3e-3)


def test_glass_with_a_volume_absorbs_and_disperses(tmp_path: Path) -> None:
    """Beer's law: the colour is left at the attenuation distance. Abbe's number is 20 / dispersion."""
    extensions = {
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_ior": {"ior": 1.6},
        "KHR_materials_volume": {
            "thicknessFactor": 1,
            "attenuationDistance": 0.5,
            "attenuationColor": [0.25] * 3,
        },
        "KHR_materials_dispersion": {"dispersion": 0.5},
    }
    pbr = {"roughnessFactor": 0, "metallicFactor": 0}
    found = kernel(tmp_path, {"pbrMetallicRoughness": pbr, "extensions": extensions})
    assert found["type"] == "dielectric"
    a, b = found["index"]["cauchy"]
    n = {line: a + b / line**2 for line in (0.4861, 0.5876, 0.6563)}
    assert n[0.5876] == pytest.approx(1.6)
    assert (n[0.5876] - 1) / (n[0.4861] - n[0.6563]) == pytest.approx(20 / 0.5)
    assert np.exp(-0.5 * found["absorption"]["table"][0][1]) == pytest.approx(0.25, rel=1e-3)


def test_without_a_volume_it_is_a_sheet(tmp_path: Path) -> None:
    extensions = {"KHR_materials_transmission": {"transmissionFactor": 0.5}}
    pbr = {"roughnessFactor": 0, "metallicFactor": 0}
    found = kernel(tmp_path, {"pbrMetallicRoughness": pbr, "extensions": extensions})
    assert (found["type"], found["weight"]) == ("blend", 0.5)
    assert found["second"] == {"type": "thin_pane", "index": 1.5}


def test_emission_has_its_strength_in_candelas_per_square_metre(tmp_path: Path) -> None:
    scene = tree()
    scene["materials"][0]["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": 300}}
    document, _ = imported(tmp_path, scene)
    assert document["surfaces"][0]["luminaire"]["radiance"]["luminance"] == pytest.approx(300)


def test_punctual_lamps(tmp_path: Path) -> None:
    scene = tree()
    lights = [
        {"type": "point", "intensity": 50},
        {"type": "directional", "intensity": 800},
        {"type": "spot", "intensity": 20, "spot": {"outerConeAngle": 0.5}},
    ]
    scene["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
    for index in range(3):
        scene["nodes"].append(
            {"translation": [0, 2, 0], "extensions": {"KHR_lights_punctual": {"light": index}}}
        )
        scene["scenes"][0]["nodes"].append(2 + index)
    document, found = imported(tmp_path, scene, light_radius=0.1)
    point, spot = document["surfaces"][1:]
    # Intensity over the area of the sphere's outline.
    assert point["luminaire"]["radiance"]["luminance"] * np.pi * 0.01 == pytest.approx(50)
    [distant] = document["distant"]
    assert distant["irradiance"]["luminance"] == pytest.approx(800)
    assert distant["direction"] == pytest.approx([0, 0, 1])
    assert spot["luminaire"]["profile"]["axis"] == pytest.approx([0, 0, -1])
    assert sum("became a" in note for note in found.notes) == 3


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"extensionsRequired": ["KHR_no_such_thing"]}, "KHR_no_such_thing"),
        (
            {"materials": [{"emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_iridescence": {}}}]},
            "iridescence",
        ),
    ],
)
def test_what_has_no_equal_is_named(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        imported(tmp_path, tree() | change)
    _, found = imported(tmp_path, tree() | change, allow_missing=True)
    assert any(said in str(each) for each in found.missing)


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("accessors", 0, "count"), 2**40, "too many"),
        (("accessors", 0, "count"), 4, "beyond its buffer view"),
        (("accessors", 0, "count"), -1, "not negative"),
        (("accessors", 0, "bufferView"), 9, "there is no bufferViews"),
        (("bufferViews", 0, "byteLength"), 10**9, "beyond its buffer"),
        (("accessors", 1, "count"), 2, "different counts"),
        (("nodes", 0, "children"), [0], "nested too deep, or in themselves"),
        (("nodes", 0, "matrix"), [1, 2], "16 numbers"),
        (("meshes", 0, "primitives", 0, "material"), 7, "there is no materials"),
        (("buffers", 0, "uri"), "../secret.bin", "leads out of"),
        (("buffers", 0, "uri"), "/etc/passwd", "absolute path"),
        (("buffers", 0, "uri"), "data:;base64,@@", "no base64"),
        (("asset", "version"), "1.0", "no glTF 2.0"),
        (("meshes", 0, "primitives", 0, "material"), [0], "expected an integer"),
        (("accessors", 0, "componentType"), {}, "expected an integer"),
        (("accessors", 0, "count"), True, "expected an integer"),
        (("nodes", 0, "extensions"), 2.5, "expected an object"),
        (("scenes", 0, "nodes"), None, r"scenes\[0\].nodes: expected an array"),
    ],
)
def test_damaged_files_are_told(tmp_path: Path, path: tuple[Any, ...], value: Any, said: str) -> None:
    scene = tree()
    (tmp_path / "secret.bin").write_bytes(BINARY)
    inner: Any = scene
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    with pytest.raises(InputError, match=said):
        imported(tmp_path, scene)
    assert not (tmp_path / "out").exists()
