"""What a mesh file says about its own size, read before a loader takes memory for it."""

import json
import mmap
import os
import re
import struct
from collections.abc import Callable
from typing import Any, BinaryIO

from nocturne_scene import limits
from nocturne_scene.document.fields import MeshFormat
from nocturne_scene.meshes import glb

_HEADER_BYTES = 64 * 1024  # more than any PLY header with a comment or two
PLY_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
"""In numpy's names: a kind and a number of bytes."""
_PLY_FORMAT = re.compile(rb"^format (ascii|binary_little_endian|binary_big_endian) 1\.0\s*$", re.MULTILINE)
_STL_HEADER_BYTES = 84
_STL_TRIANGLE_BYTES = 50
_GLTF_JSON_BYTES = 64 * 2**20
_CHUNK_BYTES = 2**20
_OBJ_LINE_BYTES = 8  # "v 0 0 0\n", the shortest line that makes a vertex
_OBJ_INDEX_ZERO = re.compile(rb"^f[^\n]*[ \t]0+(?=[ \t/\r\n]|\Z)", re.MULTILINE)
_OBJ_RELATIVE = re.compile(rb"^f[^\n]*[ \t]-[0-9]", re.MULTILINE)
_OBJ_VERTEX = re.compile(rb"^v[ \t]", re.MULTILINE)


class UnusableMeshError(Exception):
    """A mesh can't be used; the message says why, without saying where."""


def check_header(file: BinaryIO, file_format: MeshFormat) -> None:
    """Raise UnusableMeshError if the file declares more than is allowed or than it holds.

    Leaves the file at its start.
    """
    size = file.seek(0, os.SEEK_END)
    file.seek(0)
    if size > limits.MAX_ASSET_BYTES:
        raise UnusableMeshError(f"the file has {size} bytes; at most {limits.MAX_ASSET_BYTES} are accepted")
    _CHECKS[file_format](file, size)
    file.seek(0)


def check_counts(vertices: int, triangles: int) -> None:
    """Raise UnusableMeshError where a mesh is larger than allowed."""
    if vertices > limits.MAX_VERTICES:
        raise UnusableMeshError(f"{vertices} vertices; at most {limits.MAX_VERTICES} are accepted")
    if triangles > limits.MAX_TRIANGLES:
        raise UnusableMeshError(f"{triangles} triangles; at most {limits.MAX_TRIANGLES} are accepted")


def _check_ply(file: BinaryIO, size: int) -> None:
    head = file.read(_HEADER_BYTES)
    header, end, _ = head.partition(b"end_header")
    if not head.startswith(b"ply") or not end:
        raise UnusableMeshError("not a PLY file: no header")
    if not _PLY_FORMAT.search(header):
        raise UnusableMeshError('not a PLY file: its header has no line "format ascii 1.0", or binary')
    binary = b"format binary" in header
    counts: dict[str, int] = {}
    properties: dict[str, list[str]] = {}
    name, needed = "", 0
    for line in header.decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["element"]:
            name, count = _ply_element(words)
            counts[name] = count
            properties[name] = []
        elif words[:1] == ["property"]:
            if not name:
                raise UnusableMeshError("not a PLY file: a property stands before the first element")
            properties[name].append(_ply_property(words))
            # An ASCII number and its separator take at least two bytes; a binary list at least its count.
            needed += counts[name] * (_ply_property_bytes(words) if binary else 2)
    check_counts(counts.get("vertex", 0), counts.get("face", 0))
    if missing := {"x", "y", "z"} - set(properties.get("vertex", "")):
        raise UnusableMeshError(f"the vertices have no property {' and no '.join(sorted(missing))}")
    if counts.get("face") and not {"vertex_indices", "vertex_index"} & set(properties["face"]):
        raise UnusableMeshError('the faces have no property "list ... vertex_indices"')
    if needed > size:
        raise UnusableMeshError(f"the header promises at least {needed} bytes, the file has {size}")
    if not binary:
        _check_lines(file, size, header.count(b"\n") + 1 + sum(counts.values()))


def _check_lines(file: BinaryIO, size: int, needed: int) -> None:
    """Refuse an ASCII PLY file that was cut off; the loader would take it for a smaller mesh.

    Each element has a line.
    """
    file.seek(0)
    lines = sum(chunk.count(b"\n") for chunk in iter(lambda: file.read(_CHUNK_BYTES), b""))
    file.seek(size - 1)
    lines += file.read() != b"\n"
    if lines < needed:
        raise UnusableMeshError(f"the header promises {needed} lines, the file has {lines}")


def _ply_element(words: list[str]) -> tuple[str, int]:
    if len(words) != 3 or not re.fullmatch(r"[0-9]{1,18}", words[2]):
        raise UnusableMeshError(f'not a PLY file: "{" ".join(words)[:80]}"')
    return words[1], int(words[2])


def _ply_property(words: list[str]) -> str:
    """Its name."""
    match words:
        case ["property", "list", count, kind, name]:
            kinds = {count, kind}
        case ["property", kind, name]:
            kinds = {kind}
        case _:
            kinds, name = {""}, ""
    if not kinds <= PLY_TYPES.keys():
        expected = ", ".join(PLY_TYPES)
        raise UnusableMeshError(f'"{" ".join(words)[:80]}" is no property; its type is one of {expected}')
    return name


def _ply_property_bytes(words: list[str]) -> int:
    kind = words[2] if words[1:2] == ["list"] and len(words) > 2 else words[1] if len(words) > 1 else ""
    return int(PLY_TYPES[kind][1]) if kind in PLY_TYPES else 1


def _check_stl(file: BinaryIO, size: int) -> None:
    head = file.read(_STL_HEADER_BYTES)
    if len(head) == _STL_HEADER_BYTES:
        (count,) = struct.unpack("<I", head[-4:])
        if _STL_HEADER_BYTES + count * _STL_TRIANGLE_BYTES == size:
            check_counts(3 * count, count)
            return
        if not head.lstrip().startswith(b"solid"):
            raise UnusableMeshError(f"the STL header promises {count} triangles, the file has {size} bytes")
    elif not head.lstrip().startswith(b"solid"):
        raise UnusableMeshError("not an STL file")


def _check_obj(file: BinaryIO, size: int) -> None:
    """OBJ declares nothing. Refuse what the loader gets wrong in silence.

    Index 0, and relative indices between vertices.
    """
    if size == 0:
        raise UnusableMeshError("the file is empty")
    with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as text:
        check_counts(size // _OBJ_LINE_BYTES if size > _OBJ_LINE_BYTES * limits.MAX_VERTICES else 0, 0)
        if _OBJ_INDEX_ZERO.search(text):
            raise UnusableMeshError("a face refers to vertex 0; OBJ counts from 1")
        relative = _OBJ_RELATIVE.search(text)
        if relative and _OBJ_VERTEX.search(text, relative.end()):
            raise UnusableMeshError(
                "a face counts vertices backwards and more vertices follow; save the file with "
                "absolute indices"
            )


def _check_gltf(file: BinaryIO, size: int) -> None:
    _check_gltf_tree(_json(file.read(min(size, limits.MAX_ASSET_BYTES))), size)


def _check_glb(file: BinaryIO, size: int) -> None:
    try:
        json_bytes = glb.json_length(file.read(glb.HEADER_BYTES))
    except ValueError as error:
        raise UnusableMeshError(str(error)) from None
    if json_bytes > min(size, _GLTF_JSON_BYTES):
        raise UnusableMeshError(
            f"the GLB file's JSON has {json_bytes} bytes; at most {_GLTF_JSON_BYTES} are accepted"
        )
    _check_gltf_tree(_json(file.read(json_bytes)), size)


def _json(text: bytes) -> dict[str, Any]:
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UnusableMeshError(f"not a glTF file: {type(error).__name__}") from None
    if not isinstance(tree, dict):
        raise UnusableMeshError("not a glTF file: no object")
    return tree


def _check_gltf_tree(tree: dict[str, Any], size: int) -> None:
    for index, buffer in enumerate(_objects(tree, "buffers")):
        uri = buffer.get("uri")
        if uri is not None and not str(uri).startswith("data:"):
            raise UnusableMeshError(
                f'buffer {index} is in another file ("{str(uri)[:80]}"); expected embedded buffers, '
                f"or a GLB file"
            )
    accessors = _objects(tree, "accessors")
    counts = [_accessor_count(index, accessor, size) for index, accessor in enumerate(accessors)]
    _check_tree_of_nodes(tree)
    try:
        _refuse_sparse(tree, accessors)
        vertices, corners = _flattened_counts(tree, counts)
    except (KeyError, IndexError, TypeError, AttributeError):
        raise UnusableMeshError(
            "not a glTF file: a node, mesh or primitive refers to something that does not exist"
        ) from None
    check_counts(vertices, corners // 3)


def _refuse_sparse(tree: dict[str, Any], accessors: list[dict[str, Any]]) -> None:
    """The loader leaves out what sparse accessors replace."""
    for mesh in _objects(tree, "meshes"):
        for primitive in mesh["primitives"]:
            used = [
                *primitive["attributes"].values(),
                *([primitive["indices"]] if "indices" in primitive else []),
            ]
            if sparse := [index for index in used if "sparse" in accessors[index]]:
                raise UnusableMeshError(
                    f"accessor {sparse[0]} is sparse, which a mesh's file can't be; import it as a scene "
                    "(nocturne import), or save it without sparse accessors"
                )


def _accessor_count(index: int, accessor: dict[str, Any], size: int) -> int:
    count = accessor.get("count")
    if not isinstance(count, int) or not 0 <= count <= size:
        raise UnusableMeshError(f"accessor {index} promises {count} items, the file has {size} bytes")
    return count


def _check_tree_of_nodes(tree: dict[str, Any]) -> None:
    """glTF's nodes form trees; others could be cyclic, or stand for more triangles than fit anywhere."""
    nodes = _objects(tree, "nodes")
    children = [child for node in nodes for child in node.get("children", [])]
    roots = [root for scene in _objects(tree, "scenes") for root in scene.get("nodes", [])]
    if len(set(children)) < len(children) or set(children) & set(roots):
        raise UnusableMeshError("a node has more than one parent, or a root of the scene has one")


def _flattened_counts(tree: dict[str, Any], counts: list[int]) -> tuple[int, int]:
    """Return vertices and triangle corners of all meshes in all places where nodes put them."""
    sizes = []
    for mesh in _objects(tree, "meshes"):
        vertices = corners = 0
        for primitive in mesh["primitives"]:
            positions = counts[primitive["attributes"]["POSITION"]]
            vertices += positions
            corners += counts[primitive["indices"]] if "indices" in primitive else positions
        sizes.append((vertices, corners))
    used = [sizes[node["mesh"]] for node in _objects(tree, "nodes") if "mesh" in node] + sizes
    return sum(vertices for vertices, _ in used), sum(corners for _, corners in used)


def _objects(tree: dict[str, Any], key: str) -> list[dict[str, Any]]:
    found = tree.get(key, [])
    if not isinstance(found, list) or not all(isinstance(item, dict) for item in found):
        raise UnusableMeshError(f"not a glTF file: {key} is no list of objects")
    return found


_CHECKS: dict[MeshFormat, Callable[[BinaryIO, int], None]] = {
    "obj": _check_obj,
    "ply": _check_ply,
    "stl": _check_stl,
    "gltf": _check_gltf,
    "glb": _check_glb,
}
