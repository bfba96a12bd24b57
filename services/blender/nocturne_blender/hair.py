"""Hair and other curves as tubes: straight between their points."""

from typing import Any

import numpy as np

from .files import Files, Floats, ply
from .meshes import Part

_SIDES = 6
# Of points that have no radius, as Blender has it.
_RADIUS = 0.005


def parts_of(thing: Any, files: Files, transform: Any = None) -> list[Part]:
    """One mesh of all curves of an evaluated object; `transform`: where the points go."""
    data = thing.data
    count = len(data.points)
    if not count:
        return []
    points, radii = np.empty(3 * count, np.float32), np.full(count, _RADIUS, np.float32)
    data.points.foreach_get("position", points)
    if "radius" in data.attributes:
        data.attributes["radius"].data.foreach_get("value", radii)
    lengths = np.empty(len(data.curves), np.int32)
    data.curves.foreach_get("points_length", lengths)
    placed = points.reshape(-1, 3)
    if transform is not None:
        matrix = np.array(transform, np.float32)
        placed = placed @ matrix[:3, :3].T + matrix[:3, 3]
        radii = radii * np.float32(abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3))
    file = tubes(placed, radii, lengths)
    if file is None:
        return []
    return [Part(0, {"type": "mesh", "asset": files.add(file), "format": "ply", "smooth": True})]


def tubes(points: Floats, radii: Floats, lengths: Any) -> bytes | None:
    """A PLY file with a tube around each curve of so many points; None where none has two."""
    vertices, normals, triangles = [], [], []
    starts, first = np.concatenate([[0], np.cumsum(lengths)[:-1]]), 0
    for length in np.unique(lengths[lengths > 1]):
        index = starts[lengths == length][:, None] + np.arange(length)
        around = _rings(points[index])
        vertices.append((points[index][:, :, None] + radii[index][:, :, None, None] * around).reshape(-1, 3))
        normals.append(around.reshape(-1, 3))
        corner = np.arange(len(index) * length * _SIDES).reshape(len(index), length, _SIDES) + first
        a, d = corner[:, :-1], corner[:, 1:]
        b, c = np.roll(a, -1, axis=2), np.roll(d, -1, axis=2)
        triangles += [np.stack([a, b, c], 3).reshape(-1, 3), np.stack([a, c, d], 3).reshape(-1, 3)]
        first += corner.size
    if not vertices:
        return None
    return ply(
        np.concatenate(vertices).astype(np.float32),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(normals).astype(np.float32),
    )


def _rings(points: Floats) -> Floats:
    """Directions around curves, shape (curves, points, sides, 3), turned as little as possible along them."""
    along = _unit(np.gradient(points, axis=1))
    side = _unit(np.cross(along[:, 0], np.eye(3)[np.argmin(np.abs(along[:, 0]), axis=1)]))
    angles = 2 * np.pi * np.arange(_SIDES) / _SIDES
    found = np.empty((*points.shape[:2], _SIDES, 3), np.float32)
    for place in range(points.shape[1]):
        forward = along[:, place]
        side = _unit(side - np.sum(side * forward, axis=1, keepdims=True) * forward)
        other = np.cross(forward, side)
        found[:, place] = np.cos(angles)[:, None] * side[:, None] + np.sin(angles)[:, None] * other[:, None]
    return found


def _unit(vectors: Any) -> Any:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(lengths > 0, vectors / np.maximum(lengths, 1e-30), (0.0, 0.0, 1.0))
