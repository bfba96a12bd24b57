"""Mesh files of other systems: byte order marks, Latin-1, CR line ends, tabs, capitals; sparse parts."""

import base64
import codecs
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne_scene.document.fields import MeshFormat
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.headers import UnusableMeshError

CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
OBJ = "# Büro\no Körper\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
HEADER = """ply
format {}
comment Büro
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
"""
PLY = HEADER.format("ascii 1.0") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
STL = """solid Büro
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid Büro
"""
TEXTS: dict[MeshFormat, str] = {"obj": OBJ, "ply": PLY, "stl": STL}


def corners(tmp_path: Path, content: bytes, file_format: MeshFormat) -> list[list[float]]:
    (tmp_path / "a").write_bytes(content)
    mesh = load_mesh(tmp_path / "a", file_format)
    found: list[list[float]] = mesh.vertices[mesh.indices.ravel()].tolist()
    return found


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("file_format", ["obj", "ply", "stl"])
def test_text_of_other_systems(tmp_path: Path, file_format: MeshFormat, end: str, encoding: str) -> None:
    content = TEXTS[file_format].replace("\n", end).encode(encoding)
    assert corners(tmp_path, content, file_format) == CORNERS


@pytest.mark.parametrize(
    "text",
    [
        OBJ.replace(" ", "\t"),
        OBJ.replace("\n", "\n  "),
        OBJ[OBJ.index("v 0") :],
        "\ufeff" + OBJ[OBJ.index("v 0") :],
    ],
)
def test_obj_with_other_blanks(tmp_path: Path, text: str) -> None:
    """With tabs or blanks before words no triangle was there, and nothing was said."""
    assert corners(tmp_path, text.encode(), "obj") == CORNERS


def test_obj_in_utf_16(tmp_path: Path) -> None:
    assert corners(tmp_path, OBJ.encode("utf-16"), "obj") == CORNERS


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [b"", codecs.BOM_UTF8])
@pytest.mark.parametrize(("order", "name"), [("<", "little"), (">", "big")])
def test_headers_of_binary_ply(tmp_path: Path, order: str, name: str, mark: bytes, end: str) -> None:
    header = HEADER.format(f"binary_{name}_endian 1.0").replace("\n", end).encode("latin-1")
    rows = b"".join(struct.pack(f"{order}3f", *corner) for corner in CORNERS)
    content = mark + header + rows + struct.pack(f"{order}B3i", 3, 0, 1, 2)
    assert corners(tmp_path, content, "ply") == CORNERS


def test_stl_in_capitals(tmp_path: Path) -> None:
    assert corners(tmp_path, STL.replace("Büro", "desk").upper().encode(), "stl") == CORNERS


def test_binary_stl_whose_header_says_solid(tmp_path: Path) -> None:
    header = b"SOLID by another program".ljust(80, b"\0")
    facet = struct.pack("<12f", 0, 0, 1, *np.ravel(CORNERS)) + b"\0\0"
    assert corners(tmp_path, header + struct.pack("<I", 1) + facet, "stl") == CORNERS


def test_sparse_accessors_of_a_meshs_file_are_told(tmp_path: Path) -> None:
    """https://github.com/godotengine/godot/issues/76875: the loader would show the replaced triangles."""
    positions = np.array(CORNERS, dtype="<f4").tobytes()
    content = positions + struct.pack("<2H", 1, 2)
    uri = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
    sparse: dict[str, Any] = {"count": 2, "indices": {"bufferView": 1, "componentType": 5123}}
    sparse["values"] = {"bufferView": 0, "byteOffset": 12}
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": len(content), "uri": uri}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 4},
        ],
        "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse}],
    }
    with pytest.raises(UnusableMeshError, match="accessor 0 is sparse"):
        corners(tmp_path, json.dumps(tree).encode(), "gltf")
