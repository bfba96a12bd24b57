"""Values that a mesh has at its vertices or faces, as a texture with coordinates made for it.

Each triangle gets a block of 2 x 2 texels that holds the plane through the values at its corners, which lie
on the centres of three of them: bilinear interpolation is then exactly linear over the triangle.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.textures import ATTRIBUTE
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.meshes.files import load_ply_columns
from nocturne_scene.meshes.triangles import Triangles

_Array = NDArray[np.float64]
_BLOCK = 2
# Texels along an edge.
_MAX_EDGE = 16384


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


def bake(writer: SceneWriter, mesh: Triangles, corners: _Array, name: str) -> tuple[Triangles, str]:
    """Return a mesh with coordinates of its own, and the name of the texture for them.

    `corners`: the attribute at the corners of each triangle, shape (triangles, 3, 1 or 3).
    """
    count, channels = len(corners), corners.shape[2]
    columns = int(np.ceil(np.sqrt(count)))
    rows = -(-count // columns)
    if columns * _BLOCK > _MAX_EDGE:
        raise InputError.at("", f"the attribute {name} has more triangles than a texture can hold")
    # Values at texel (i, j) of a block, corners at (0, 0), (1, 0), (0, 1).
    across, down = np.meshgrid(np.arange(_BLOCK), np.arange(_BLOCK))
    a, b, c = (corners[:, corner, None, None, :] for corner in range(3))
    blocks = a + across[..., None] * (b - a) + down[..., None] * (c - a)
    padded = np.zeros((rows * columns, _BLOCK, _BLOCK, channels))
    padded[:count] = blocks
    picture = padded.reshape(rows, columns, _BLOCK, _BLOCK, channels).swapaxes(1, 2)
    height, width = rows * _BLOCK, columns * _BLOCK
    asset = writer.picture(name, picture.reshape(height, width, channels))
    texture = writer.name(
        "textures", name, {"asset": asset, "encoding": "linear", "wrap": "clamp", "sharp": True}
    )
    row, column = np.divmod(np.arange(count), columns)
    texels = np.array([[0.5, 0.5], [1.5, 0.5], [0.5, 1.5]])
    x = (column[:, None] * _BLOCK + texels[:, 0]) / width
    y = (row[:, None] * _BLOCK + texels[:, 1]) / height
    corner = mesh.indices.ravel()
    return (
        Triangles(
            mesh.vertices[corner],
            np.arange(3 * count).reshape(-1, 3),
            None if mesh.normals is None else mesh.normals[corner],
            np.stack([x.ravel(), 1 - y.ravel()], 1),
        ),
        texture,
    )


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
