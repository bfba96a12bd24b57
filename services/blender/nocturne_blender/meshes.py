"""Triangles of evaluated objects, one file for each material of an object."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .files import Files, Floats, Indices, ply

Json = Any

# Corner normals nearer to the face's than this are the face's.
_FLAT = 1e-4
# Digits by which normals and coordinates of corners are compared.
_NORMAL_STEPS, _COORDINATE_STEPS = 1e4, 1e6


@dataclass(frozen=True)
class Part:
    """The triangles of one material slot."""

    slot: int
    shape: Json


def parts_of(thing: Any, depsgraph: Any, files: Files, transform: Any = None) -> list[Part]:
    """Shapes of an evaluated object that has geometry; `transform`: where the vertices go."""
    mesh = thing.to_mesh(preserve_all_data_layers=False, depsgraph=depsgraph)
    if mesh is None:
        return []
    try:
        if transform is not None:
            mesh.transform(transform)
            if transform.determinant() < 0:
                mesh.flip_normals()
        return [Part(slot, shape) for slot, shape in _shapes(mesh, files)]
    finally:
        thing.to_mesh_clear()


def _shapes(mesh: Any, files: Files) -> "list[tuple[int, Json]]":
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    if not len(triangles):
        return []
    corners = _got(triangles, "vertices", (-1, 3), np.int32)
    loops = _got(triangles, "loops", (-1, 3), np.int32)
    slots = _got(triangles, "material_index", (-1,), np.int32)
    positions = _got(mesh.vertices, "co", (-1, 3), np.float32)
    faces = _got(triangles, "normal", (-1, 3), np.float32)
    normals = _got(mesh.corner_normals, "vector", (-1, 3), np.float32)
    layer = mesh.uv_layers.active
    coordinates = None if layer is None else _got(layer.uv, "vector", (-1, 2), np.float32)
    found = []
    for slot in np.unique(slots):
        chosen = slots == slot
        smooth = bool(np.abs(normals[loops[chosen]] - faces[chosen][:, None]).max() > _FLAT)
        file = _file(positions, corners[chosen], loops[chosen], normals if smooth else None, coordinates)
        shape = {"type": "mesh", "asset": files.add(file), "format": "ply", "smooth": smooth}
        found.append((int(slot), shape))
    return found


def _file(
    positions: Floats, corners: Indices, loops: Indices, normals: Floats | None, coordinates: Floats | None
) -> bytes:
    """Vertices that several triangles share stay shared where all that corners have is the same."""
    flat, at = corners.ravel(), loops.ravel()
    keys = [flat[:, None].astype(np.int64)]
    if normals is not None:
        keys.append(np.rint(normals[at] * _NORMAL_STEPS).astype(np.int64))
    if coordinates is not None:
        keys.append(np.rint(coordinates[at] * _COORDINATE_STEPS).astype(np.int64))
    _, first, index = np.unique(np.hstack(keys), axis=0, return_index=True, return_inverse=True)
    return ply(
        positions[flat[first]],
        index.reshape(-1, 3).astype(np.int32),
        None if normals is None else normals[at[first]],
        None if coordinates is None else coordinates[at[first]],
    )


def _got(items: Any, name: str, shape: tuple[int, ...], kind: type) -> Any:
    width = shape[1] if len(shape) > 1 else 1
    values: Any = np.empty(len(items) * width, kind)
    items.foreach_get(name, values)
    return values.reshape(shape)
