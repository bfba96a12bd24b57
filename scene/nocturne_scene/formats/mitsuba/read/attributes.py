"""Values that a mesh has at its vertices or faces, as a texture with coordinates made for it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.mitsuba.read.textures import ATTRIBUTE
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.meshes.files import load_ply_columns
from nocturne_scene.meshes.triangles import Triangles

_Array = NDArray[np.float64]


def wanted(value: Json) -> set[str]:
    """Names of the attributes that a kernel or another part of a document refers to."""
    if isinstance(value, dict):
        own = value.get("texture")
        found = {own.removeprefix(ATTRIBUTE)} if isinstance(own, str) and own.startswith(ATTRIBUTE) else set()
        return found.union(*(wanted(inner) for inner in value.values()))
    return set().union(*(wanted(inner) for inner in value)) if isinstance(value, list) else set()


def renamed(value: Json, attribute: str, texture: str) -> Json:
    """The same with a texture's name in place of the attribute's."""
    if isinstance(value, dict):
        return {key: renamed(inner, attribute, texture) for key, inner in value.items()}
    if isinstance(value, list):
        return [renamed(inner, attribute, texture) for inner in value]
    return texture if value == ATTRIBUTE + attribute else value


def read_ply(file: Path, attribute: str, mesh: Triangles) -> _Array | None:
    """`vertex_NAME` or `face_NAME` of a PLY file at its triangles' corners, shape (triangles, 3, channels).

    None if the file has no such attribute. Vertices must be those of the file, in its order.
    """
    kind, _, name = attribute.partition("_")
    for suffixes in (("_0", "_1", "_2"), ("_r", "_g", "_b"), ("_0",), ("",)):
        values = load_ply_columns(file, kind, tuple(name + suffix for suffix in suffixes))
        if values is None:
            continue
        if kind == "vertex":
            return values[mesh.indices] if len(values) == len(mesh.vertices) else None
        return np.repeat(values[:, None], 3, axis=1) if len(values) == len(mesh.indices) else None
    return None
