"""glTF's moving and coloured shapes, against the specification's formulas, evaluated here by other methods.

One file, though long: all its tests build their models with the same few functions.
"""

import base64
import json
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import DracoPy
import meshopt
import numpy as np
import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.formats.import_scene import import_scene
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.triangles import Triangles
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

Tree = dict[str, Any]
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], dtype="<f4")
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_TYPES = {"f": 5126, "H": 5123, "B": 5121}


class Model:
    """A file under construction: arrays become accessors of one buffer."""

    def __init__(self) -> None:
        self.content = b""
        self.tree: Tree = {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "materials": [{"doubleSided": True}],
            "bufferViews": [],
            "accessors": [],
        }

    def array(self, values: Any, kind: str = "<f4", **fields: Any) -> int:
        """The number of an accessor for values."""
        found = np.atleast_1d(np.asarray(values)).astype(kind)
        found = found.reshape(len(found), -1)
        self.tree["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.content), "byteLength": found.nbytes}
        )
        self.content += found.tobytes() + b"\0" * (-found.nbytes % 4)
        self.tree["accessors"].append(
            {
                "bufferView": len(self.tree["bufferViews"]) - 1,
                "componentType": _TYPES[found.dtype.char],
                "count": len(found),
                "type": _KINDS[found.shape[1]],
                **fields,
            }
        )
        return len(self.tree["accessors"]) - 1

    def mesh(self, indices: list[int] | None = None, **fields: Any) -> Tree:
        """The file's mesh: the square, or what `attributes` says."""
        attributes = {"POSITION": self.array(SQUARE), **fields.pop("attributes", {})}
        primitive = {"attributes": attributes, "material": 0, **fields}
        if indices is not None:
            primitive["indices"] = self.array(indices, "<u2")
        self.tree["meshes"] = [{"primitives": [primitive]}]
        return primitive

    def imported(self, tmp_path: Path, **options: Any) -> tuple[Tree, list[str]]:
        """The document, and the notes."""
        data = base64.b64encode(self.content).decode()
        self.tree["buffers"] = [
            {"byteLength": len(self.content), "uri": f"data:application/octet-stream;base64,{data}"}
        ]
        (tmp_path / "a.gltf").write_text(json.dumps(self.tree))
        found = import_scene(tmp_path / "a.gltf", tmp_path / "out", ImportOptions(**options))
        return json.loads(found.document.read_text()), found.notes

    def triangles(self, tmp_path: Path, **options: Any) -> Triangles:
        """The only mesh."""
        document, _ = self.imported(tmp_path, **options)
        [surface] = document["surfaces"]
        return load_mesh(tmp_path / "out" / surface["shape"]["asset"], "ply")


def normals(mesh: Triangles) -> NDArray[np.float64]:
    a, b, c = (mesh.vertices[mesh.indices[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


@pytest.mark.parametrize(("mode", "indices"), [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])], ids=["strip", "fan"])
def test_strips_and_fans_face_one_way(tmp_path: Path, mode: int, indices: list[int]) -> None:
    model = Model()
    model.mesh(indices, mode=mode)
    found = normals(model.triangles(tmp_path))
    assert found == pytest.approx(np.array([[0, 0, 1], [0, 0, 1]]))


def test_strips_are_joined_by_triangles_that_are_none(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2, 2, 1, 1, 3, 2], mode=5)
    assert len(normals(model.triangles(tmp_path))) == 2


def test_points_are_named_as_what_they_are(tmp_path: Path) -> None:
    model = Model()
    model.mesh(mode=0)
    with pytest.raises(InputError, match="points and lines have no surface"):
        model.imported(tmp_path)


@pytest.mark.parametrize(
    ("extension", "said"), [("EXT_mesh_polygon", "consists of polygons"), ("EXT_any", "EXT_any")]
)
def test_vertices_of_other_kinds_are_named_as_such(tmp_path: Path, extension: str, said: str) -> None:
    model = Model()
    primitive = model.mesh([0, 1, 2], extensions={extension: {}})
    if "mesh" in extension:
        del model.tree["accessors"][primitive["attributes"]["POSITION"]]["bufferView"]
    with pytest.raises(InputError, match=said):
        model.imported(tmp_path)


def draco_model(spoil: Callable[[bytes], bytes] = bytes) -> tuple[Model, Triangles]:
    """A bent sheet with coordinates whose vertices are compressed, and the sheet."""
    x, y = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 2, 9))
    points = np.stack([x, y, np.sin(x * y)], -1).reshape(-1, 3)
    corner = (np.arange(8)[:, None] * 9 + np.arange(8)).ravel()
    faces = np.concatenate(
        [
            np.stack([corner, corner + 1, corner + 9], 1),
            np.stack([corner + 1, corner + 10, corner + 9], 1),
        ]
    )
    uv = points[:, :2] / 2
    packed = DracoPy.encode(points, faces, tex_coord=uv, quantization_bits=16, preserve_order=True)
    stored = DracoPy.decode(packed)
    ids = {each["attribute_type"]: each["unique_id"] for each in stored.attributes}
    packed = spoil(packed)
    model = Model()
    model.tree["bufferViews"].append({"buffer": 0, "byteOffset": 0, "byteLength": len(packed)})
    model.content = packed + b"\0" * (-len(packed) % 4)
    attributes = {"POSITION": int(DracoPy.AttributeType.POSITION), "TEXCOORD_0": 3}
    numbers = {}
    for name, width in (("POSITION", 3), ("TEXCOORD_0", 2), ("", 1)):
        model.tree["accessors"].append(
            {
                "componentType": 5126 if name else 5125,
                "count": len(points) if name else faces.size,
                "type": _KINDS[width],
            }
        )
        numbers[name] = len(model.tree["accessors"]) - 1
    extension = {"bufferView": 0, "attributes": {name: ids[kind] for name, kind in attributes.items()}}
    model.tree["meshes"] = [
        {
            "primitives": [
                {
                    "attributes": {name: numbers[name] for name in attributes},
                    "indices": numbers[""],
                    "material": 0,
                    "extensions": {"KHR_draco_mesh_compression": extension},
                }
            ]
        }
    ]
    model.tree["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    return model, Triangles(points, faces, None, uv)


def test_vertices_compressed_by_draco_are_read(tmp_path: Path) -> None:
    model, sheet = draco_model()
    found = model.triangles(tmp_path)
    assert len(found.indices) == len(sheet.indices)
    # Triangles and vertices may come in another order.
    centres = [mesh.vertices[mesh.indices].mean(axis=1) for mesh in (found, sheet)]
    nearest = np.linalg.norm(centres[0][:, None] - centres[1][None], axis=2).argmin(axis=1)
    assert len(set(nearest.tolist())) == len(sheet.indices)
    assert centres[0] == pytest.approx(centres[1][nearest], abs=1e-4)
    assert found.coordinates is not None
    assert found.coordinates == pytest.approx(
        np.stack([found.vertices[:, 0] / 2, 1 - found.vertices[:, 1] / 2], 1), abs=1e-4
    )


@pytest.mark.parametrize("at", [0, 5, 9, 12, 20, 40])
def test_broken_draco_data_is_an_error(tmp_path: Path, at: int) -> None:
    """Or reads as something else; never more than an error."""
    model, _ = draco_model(lambda packed: packed[:at] + bytes([packed[at] ^ 0xFF]) + packed[at + 1 :])
    with suppress(InputError):
        model.imported(tmp_path)
    (tmp_path / "cut").mkdir()
    model, _ = draco_model(lambda packed: packed[:at])
    with pytest.raises(InputError, match="Draco"):
        model.imported(tmp_path / "cut")


def test_morph_targets_are_added_by_weight(tmp_path: Path) -> None:
    """p + sum w_i d_i, by the mesh's weights and by those of a node."""
    moves = np.random.default_rng(1).normal(size=(2, 4, 3))
    for name, expected in (("mesh", (0.25, 2.0)), ("node", (0.5, -1.0))):
        model = Model()
        model.mesh([0, 1, 2, 1, 3, 2], targets=[{"POSITION": model.array(each)} for each in moves])
        model.tree["meshes"][0]["weights"] = [0.25, 2.0]
        if name == "node":
            model.tree["nodes"][0]["weights"] = [0.5, -1.0]
        (tmp_path / name).mkdir()
        found = model.triangles(tmp_path / name)
        assert found.vertices == pytest.approx(SQUARE + np.tensordot(expected, moves, 1), abs=1e-6)


def test_a_sparse_accessor_replaces_what_it_names(tmp_path: Path) -> None:
    model = Model()
    primitive = model.mesh([0, 1, 2])
    where, what = model.array([2, 3], "<u2"), model.array([[0, 5, 0], [1, 5, 0]])
    views = [model.tree["accessors"][each]["bufferView"] for each in (where, what)]
    model.tree["accessors"][primitive["attributes"]["POSITION"]]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": views[0], "componentType": 5123},
        "values": {"bufferView": views[1]},
    }
    expected = SQUARE.copy()
    expected[2:, 1] = 5
    assert model.triangles(tmp_path).vertices[:3] == pytest.approx(expected[:3])


def animated(path: str, times: list[float], values: Any, interpolation: str = "LINEAR") -> Model:
    model = Model()
    model.mesh([0, 1, 2])
    sampler = {"input": model.array(times), "output": model.array(values), "interpolation": interpolation}
    channel = {"sampler": 0, "target": {"node": 0, "path": path}}
    model.tree["animations"] = [{"samplers": [sampler], "channels": [channel]}]
    return model


@pytest.mark.parametrize("time", [-1.0, 0.5, 1.7, 9.0])
def test_turns_go_the_shorter_way_at_even_speed(tmp_path: Path, time: float) -> None:
    """Against scipy's spherical interpolation."""
    keys = Rotation.from_euler("xyz", [[0, 0, 0], [40, 70, 10], [100, 0, 50]], degrees=True)
    quaternions = keys.as_quat() * np.array([[1], [-1], [1]])
    model = animated("rotation", [0.0, 1.0, 2.0], quaternions)
    found = model.triangles(tmp_path, time=time)
    expected = Slerp([0.0, 1.0, 2.0], keys)(np.clip(time, 0.0, 2.0)).apply(SQUARE[:3])
    assert found.vertices[:3] == pytest.approx(expected, abs=2e-6)


def test_splines_pass_their_keys_with_their_tangents(tmp_path: Path) -> None:
    """A cubic of which value and slope are known at both ends is that cubic everywhere."""

    def cubic(t: float) -> float:
        return 1 + 2 * t - 3 * t**2 + 0.5 * t**3

    def slope(t: float) -> float:
        return 2 - 6 * t + 1.5 * t**2

    keys = [[[slope(t)] * 3, [cubic(t)] * 3, [slope(t)] * 3] for t in (0.0, 2.0)]
    model = animated("translation", [0.0, 2.0], np.array(keys).reshape(-1, 3), "CUBICSPLINE")
    assert model.triangles(tmp_path, time=0.7).vertices[0] == pytest.approx([cubic(0.7)] * 3, abs=1e-6)


def test_steps_hold_the_key_before(tmp_path: Path) -> None:
    model = animated("translation", [0.0, 1.0, 2.0], [[0, 0, 0], [5, 0, 0], [9, 0, 0]], "STEP")
    assert model.triangles(tmp_path, time=1.99).vertices[0] == pytest.approx([5, 0, 0])


def test_at_rest_an_animation_is_a_note(tmp_path: Path) -> None:
    model = animated("translation", [0.0, 1.0], [[7, 0, 0], [8, 0, 0]])
    document, notes = model.imported(tmp_path)
    assert any("--time" in note for note in notes)
    mesh = load_mesh(tmp_path / "out" / document["surfaces"][0]["shape"]["asset"], "ply")
    assert mesh.vertices[0] == pytest.approx([0, 0, 0])


def test_a_skin_follows_its_joints(tmp_path: Path) -> None:
    """sum w_j G_j B_j p, whatever the node of the mesh says; an elbow bent by 90 degrees."""
    model = Model()
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, :3, 3] = [-1, 0, 0]  # the elbow is at x = 1
    weights = np.array([[1, 0, 0, 0], [0.25, 0.75, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0]])
    attributes = {
        "JOINTS_0": model.array([[0, 1, 0, 0]] * 4, "<u1"),
        "WEIGHTS_0": model.array(weights),
    }
    model.mesh([0, 1, 2, 1, 3, 2], attributes=attributes)
    model.tree["nodes"] = [
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
        {"children": [2], "translation": [0, 2, 0]},
        {"translation": [1, 0, 0], "rotation": [0, 0, 2**-0.5, 2**-0.5]},
    ]
    model.tree["scenes"] = [{"nodes": [0, 1]}]
    matrices = model.array(bind.transpose(0, 2, 1).reshape(2, 16))
    model.tree["skins"] = [{"joints": [1, 2], "inverseBindMatrices": matrices}]

    def upper(p: Any) -> NDArray[np.float64]:
        raised: NDArray[np.float64] = np.asarray(p, dtype=np.float64) + np.array([0.0, 2.0, 0.0])
        return raised

    def fore(p: Any) -> NDArray[np.float64]:
        x, y, z = np.asarray(p) - [1, 0, 0]
        return np.array([1 - y, 2 + x, z])

    expected = [
        weight[0] * upper(point) + weight[1] * fore(point)
        for weight, point in zip(weights, SQUARE, strict=True)
    ]
    assert model.triangles(tmp_path).vertices == pytest.approx(np.array(expected), abs=1e-6)


def test_copies_stand_where_the_extension_says(tmp_path: Path) -> None:
    model = Model()
    model.mesh([0, 1, 2])
    shifts = model.array([[1, 0, 0], [0, 5, 0]])
    model.tree["nodes"][0] |= {
        "scale": [2, 2, 2],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": shifts}}},
    }
    document, _ = model.imported(tmp_path)
    found = [(each["translate"], each["scale"]) for each in document["instances"]]
    assert found == [([2, 0, 0], pytest.approx(2)), ([0, 10, 0], pytest.approx(2))]


def test_colours_at_vertices_are_linear_over_a_triangle(tmp_path: Path) -> None:
    """The texture at a vertex's coordinates is its colour."""
    import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

    model = Model()
    colours = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]) * 0.5
    model.mesh([0, 1, 2], attributes={"COLOR_0": model.array(colours)})
    model.tree["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 0}}]
    document, _ = model.imported(tmp_path)
    [surface] = document["surfaces"]
    mesh = load_mesh(tmp_path / "out" / surface["shape"]["asset"], "ply")
    use = document["kernels"][surface["kernel"]]["base"]
    picture = np.asarray(
        oiio.ImageBuf(str(tmp_path / "out" / use["texture"]["asset"])).get_pixels(oiio.FLOAT)
    )
    assert mesh.coordinates is not None
    rows, columns = picture.shape[:2]
    for corner in range(3):
        u, v = mesh.coordinates[mesh.indices[0, corner]]
        texel = picture[int((1 - v) * rows), int(u * columns)]
        assert texel == pytest.approx(colours[corner], abs=3e-3)


def test_one_colour_at_all_vertices_is_a_factor(tmp_path: Path) -> None:
    model = Model()
    model.mesh(
        [0, 1, 2], attributes={"COLOR_0": model.array([[51, 51, 51, 255]] * 4, "<u1", normalized=True)}
    )
    model.tree["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0}}]
    document, _ = model.imported(tmp_path)
    [kernel] = document["kernels"].values()
    assert kernel["base"] == pytest.approx(0.2)


def by_meshopt(name: str, *, spoil: bool = False, rows: int | None = None) -> Model:
    """SQUARE as two triangles, compressed; the buffer that would hold them plain is not there."""
    faces = np.array([0, 1, 2, 2, 1, 3], np.uint32)
    parts = [(SQUARE, 12, "ATTRIBUTES", 5126), (faces.reshape(-1, 1), 4, "TRIANGLES", 5125)]
    model = Model()
    for plain, stride, mode, component in parts:
        packed = meshopt.encode_gltf_buffer(plain, mode)
        packed = packed[:-3] if spoil else packed
        start = len(model.content)
        model.content += packed + b"\0" * (-len(packed) % 4)
        count = len(plain) if rows is None else rows
        extension = {"buffer": 0, "byteOffset": start, "byteLength": len(packed), "byteStride": stride}
        extensions = {name: extension | {"mode": mode, "count": count}}
        view = {"buffer": 1, "byteLength": stride * len(plain), "extensions": extensions}
        model.tree["bufferViews"].append(view)
        number = len(model.tree["bufferViews"]) - 1
        kind = _KINDS[plain.shape[1]]
        model.tree["accessors"].append(
            {"bufferView": number, "componentType": component, "count": len(plain), "type": kind}
        )
    model.tree["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]
    model.tree["extensionsRequired"] = [name]
    return model


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_buffers_that_meshopt_compressed_are_read(tmp_path: Path, name: str) -> None:
    mesh = by_meshopt(name).triangles(tmp_path)
    corners = sorted(map(tuple, mesh.vertices[mesh.indices].reshape(-1, 3).tolist()))
    assert corners == sorted(map(tuple, SQUARE[[0, 1, 2, 2, 1, 3]].tolist()))


@pytest.mark.parametrize(
    ("model", "said"),
    [
        (by_meshopt("EXT_meshopt_compression", spoil=True), "can't be read"),
        (by_meshopt("EXT_meshopt_compression", rows=2**40), "too many"),
        (by_meshopt("EXT_meshopt_compression", rows=0), "too many"),
    ],
)
def test_damaged_buffers_of_meshopt_are_told(tmp_path: Path, model: Model, said: str) -> None:
    with pytest.raises(InputError, match=said):
        model.imported(tmp_path)
