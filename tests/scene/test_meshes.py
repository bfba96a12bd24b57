"""Mesh files of every format are read, packed as the tracer expects, and refused where they are wrong."""

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.document.fields import MeshFormat
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.similarity import IDENTITY, Similarity
from nocturne_scene.meshes.triangles import BadVertexError, Triangles, pack_mesh

AS_IT_IS = [IDENTITY]

OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\nf 1 2 3\n"
PLY_HEADER = (
    b"ply\nformat %s 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
)
PLY = PLY_HEADER % (b"ascii", 3, 1) + b"0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4")
BINARY_PLY = (
    PLY_HEADER % (b"binary_little_endian", 3, 1) + CORNERS.tobytes() + b"\x03" + struct.pack("<3i", 0, 1, 2)
)
STL = bytes(80) + struct.pack("<I", 1) + bytes(12) + CORNERS.tobytes() + bytes(2)
TEXT_STL = (
    b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    b"endsolid a\n"
)


def gltf(**changes: Any) -> dict[str, Any]:
    data = CORNERS.tobytes() + np.array([0, 1, 2], dtype="<u4").tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data), "uri": uri}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 12},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"},
        ],
    } | changes


def glb() -> bytes:
    tree = gltf(buffers=[{"byteLength": 48}])
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    data = CORNERS.tobytes() + np.array([0, 1, 2], dtype="<u4").tobytes()
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def load(tmp_path: Path, data: bytes, file_format: MeshFormat) -> Triangles:
    (tmp_path / "mesh").write_bytes(data)
    return load_mesh(tmp_path / "mesh", file_format)


def inline_mesh(
    vertices: list[tuple[float, float, float]], triangles: list[tuple[int, int, int]]
) -> Triangles:
    return Triangles(np.array(vertices, dtype=np.float64), np.array(triangles))


def corners(mesh: Triangles) -> Any:
    return mesh.vertices[mesh.indices]


@pytest.mark.parametrize(
    ("data", "file_format"),
    [
        (OBJ, "obj"),
        (PLY, "ply"),
        (BINARY_PLY, "ply"),
        (STL, "stl"),
        (TEXT_STL, "stl"),
        (json.dumps(gltf()).encode(), "gltf"),
        (glb(), "glb"),
    ],
)
def test_every_format_gives_the_same_triangle(tmp_path: Path, data: bytes, file_format: MeshFormat) -> None:
    packed = pack_mesh(load(tmp_path, data, file_format), AS_IT_IS)
    assert (packed.vertex_count, packed.triangle_count) == (3, 1)
    assert packed.blob == CORNERS.tobytes() + struct.pack("<3I", 0, 1, 2)


def test_polygons_are_split(tmp_path: Path) -> None:
    mesh = load(tmp_path, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "obj")
    area = np.linalg.norm(np.cross(*np.diff(corners(mesh), axis=1).swapaxes(0, 1)), axis=1).sum() / 2
    assert area == pytest.approx(1)


def test_parts_of_gltf_are_merged_where_their_nodes_put_them(tmp_path: Path) -> None:
    nodes = [{"children": [1, 2]}, {"mesh": 0, "translation": [0, 0, 7]}, {"mesh": 0, "scale": [1, 1, -1]}]
    mesh = load(tmp_path, json.dumps(gltf(nodes=nodes)).encode(), "gltf")
    assert sorted({vertex[2] for vertex in mesh.vertices}) == [0, 7]
    upwards = np.cross(*np.diff(corners(mesh), axis=1).swapaxes(0, 1))[:, 2]
    assert sorted(upwards) == [-1, 1]  # the mirrored one faces down


@pytest.mark.parametrize(
    ("data", "file_format", "words"),
    [
        (b"", "obj", "empty"),
        (b"hello", "obj", "no triangles"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "obj", "no triangles"),
        (
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
            "obj",
            "a number in it points beyond",
        ),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "obj", "counts from 1"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n", "obj", "absolute indices"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n", "obj", "not a usable obj file"),
        (b"v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "obj", "three coordinates"),
        (b"hello", "ply", "no header"),
        (PLY.replace(b"3 0 1 2", b"3 0 1 3"), "ply", "triangle 0 refers to vertex 3; there are 3 vertices"),
        (PLY.replace(b"3 0 1 2", b"3 0 1 -1"), "ply", "refers to vertex -1"),
        (PLY.replace(b"face 1", b"face 2"), "ply", "promises 14 lines"),
        (PLY.replace(b"vertex 3", b"vertex 999999999"), "ply", "at most 200000000"),
        (PLY.replace(b"vertex 3", b"vertex 1000000"), "ply", "promises at least"),
        (PLY.replace(b"vertex 3", b"vertex -3"), "ply", "element vertex -3"),
        (BINARY_PLY[:-1], "ply", "not a usable ply file"),
        (BINARY_PLY.replace(b"face 1", b"face 1000"), "ply", "promises at least"),
        (STL[:-1], "stl", "promises 1 triangles"),
        (bytes(80) + b"\xff\xff\xff\xff", "stl", "promises 4294967295 triangles"),
        (b"abc", "stl", "not an STL file"),
        (b"[" * 100_000, "gltf", "not a glTF file"),
        (b"glTF", "glb", "no GLB file"),
        (glb()[:12] + b"\xff\xff\xff\x7f" + glb()[16:], "glb", "JSON has 2147483647 bytes"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path: Path, data: bytes, file_format: MeshFormat, words: str) -> None:
    with pytest.raises(UnusableMeshError, match=words):
        pack_mesh(load(tmp_path, data, file_format), AS_IT_IS)


_HUGE = {"componentType": 5126, "count": 10**12, "type": "VEC3"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"buffers": [{"byteLength": 48, "uri": "mesh.bin"}]}, "in another file"),
        ({"buffers": [{"byteLength": 48, "uri": "file:///etc/passwd"}]}, "in another file"),
        ({"accessors": [_HUGE, _HUGE]}, "promises 1000000000000 items"),
        ({"nodes": [{"children": [0]}]}, "has one"),
        ({"nodes": [{"children": [1]}, {"children": [1]}]}, "more than one parent"),
        ({"nodes": [{"mesh": 7}]}, "does not exist"),
        ({"meshes": 3}, "no list of objects"),
    ],
)
def test_a_wrong_gltf_is_refused(tmp_path: Path, changes: dict[str, Any], words: str) -> None:
    with pytest.raises(UnusableMeshError, match=words):
        load(tmp_path, json.dumps(gltf(**changes)).encode(), "gltf")


def test_an_obj_file_reads_no_other_file(tmp_path: Path) -> None:
    (tmp_path / "other.mtl").write_text("newmtl a\nmap_Kd other.png\n")
    other = str(tmp_path / "other.mtl").encode()
    accessed = (tmp_path / "other.mtl").stat().st_atime_ns
    mesh = load(tmp_path, b"mtllib " + other + b"\nusemtl a\n" + OBJ, "obj")
    assert len(mesh.indices) == 1
    assert (tmp_path / "other.mtl").stat().st_atime_ns == accessed


@pytest.mark.parametrize("bad", [b"nan", b"1e400"])
def test_a_bad_vertex_is_named(tmp_path: Path, bad: bytes) -> None:
    mesh = load(tmp_path, PLY.replace(b"1 0 0", bad + b" 0 0"), "ply")
    with pytest.raises(BadVertexError, match=r"vertex 1 .* is not finite"):
        pack_mesh(mesh, AS_IT_IS)


def test_a_vertex_that_is_placed_too_far_is_named() -> None:
    mesh = inline_mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    with pytest.raises(BadVertexError, match=r"vertex 1 .* farther than"):
        pack_mesh(mesh, [Similarity(1e12, np.diag([2.0, 1.0, 1.0]), np.zeros(3))])


def test_triangles_without_area_and_their_vertices_are_dropped() -> None:
    vertices = [(9.0, 9.0, 9.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (2.0, 0.0, 0.0)]
    packed = pack_mesh(inline_mesh(vertices, [(1, 2, 4), (1, 2, 3), (3, 3, 0)]), AS_IT_IS)
    assert (packed.vertex_count, packed.triangle_count, packed.dropped_triangles) == (3, 1, 2)
    assert packed.blob == CORNERS.tobytes() + struct.pack("<3I", 0, 1, 2)


def test_a_mesh_without_any_area_is_refused() -> None:
    with pytest.raises(UnusableMeshError, match="no triangle with an area"):
        pack_mesh(inline_mesh([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), AS_IT_IS)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian"])
def test_a_ply_file_keeps_its_normals_beside_texture_coordinates(tmp_path: Path, kind: str) -> None:
    rows = np.array(
        [[0, 0, 0, 1, 0, 0, 0, 0], [1, 0, 0, 0, 1, 0, 0, 0.5], [0, 1, 0, 0, 0, 1, 1, 1]], dtype="<f4"
    )
    names = b"".join(b"property float %s\n" % name for name in b"x y z nx ny nz s t".split())
    header = b"ply\nformat %s 1.0\nelement vertex 3\n" % kind.encode() + names
    header += b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    text = b"\n".join(b" ".join(b"%g" % value for value in row) for row in rows) + b"\n3 0 1 2\n"
    body = text if kind == "ascii" else rows.tobytes() + b"\x03" + struct.pack("<3i", 0, 1, 2)
    (tmp_path / "mesh").write_bytes(header + body)
    mesh = load_mesh(tmp_path / "mesh", "ply", normals=True)
    assert mesh.normals is not None
    assert mesh.coordinates is not None
    assert np.array_equal(mesh.normals[mesh.indices][0], rows[:, 3:6])
    assert np.array_equal(mesh.coordinates[mesh.indices][0], rows[:, 6:])
