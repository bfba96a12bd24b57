"""Triangles of shapes that a document describes in a few numbers or holds itself."""

import itertools

import numpy as np

from nocturne_scene.document.shapes import Box, Disc, InlineMesh, Quad
from nocturne_scene.meshes.triangles import Triangles

_TWO = np.array([[0, 1, 2], [0, 2, 3]])
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def simple_mesh(shape: InlineMesh | Quad | Disc | Box) -> Triangles:
    """Return the triangles of any of these shapes."""
    match shape:
        case InlineMesh():
            return inline_mesh(shape)
        case Quad():
            return quad_mesh(shape)
        case Disc():
            return disc_mesh(shape)
        case Box():
            return box_mesh(shape)


def inline_mesh(shape: InlineMesh) -> Triangles:
    """Return the triangles that a document holds itself."""
    return Triangles(
        np.array(shape.vertices, dtype=np.float64),
        np.array(shape.triangles, dtype=np.int64),
        None if shape.normals is None else np.array(shape.normals, dtype=np.float64),
        None if shape.texture_coordinates is None else np.array(shape.texture_coordinates, dtype=np.float64),
    )


def quad_mesh(quad: Quad) -> Triangles:
    """Return a parallelogram with texture coordinates (s, t)."""
    corner, u, v = (np.array(edge) for edge in (quad.corner, quad.edge_u, quad.edge_v))
    return Triangles(np.stack([corner, corner + u, corner + u + v, corner + v]), _TWO, None, _SQUARE)


def disc_mesh(disc: Disc) -> Triangles:
    """Return a fan around the centre, counter-clockwise seen against the normal."""
    normal = np.array(disc.normal) / np.linalg.norm(disc.normal)
    # Across the axis that the normal is farthest from.
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    across /= np.linalg.norm(across)
    angles = 2 * np.pi * np.arange(disc.segments) / disc.segments
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    edge = np.array(disc.centre) + disc.radius * (circle @ np.stack([across, np.cross(normal, across)]))
    corners = 1 + np.arange(disc.segments)
    return Triangles(
        np.concatenate([[disc.centre], edge]),
        np.stack([np.zeros_like(corners), corners, np.roll(corners, -1)], axis=1),
        None,
        0.5 + 0.5 * np.concatenate([[[0.0, 0.0]], circle]),
    )


def box_mesh(box: Box) -> Triangles:
    """Return six faces with normals outwards, each with its own texture coordinates."""
    vertices, indices = [], []
    for axis, high in itertools.product(range(3), (False, True)):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        if not high:
            u, v = v, u
        for s, t in _SQUARE:
            corner = [0.0, 0.0, 0.0]
            corner[axis] = (box.maximum if high else box.minimum)[axis]
            corner[u] = (box.maximum if s else box.minimum)[u]
            corner[v] = (box.maximum if t else box.minimum)[v]
            vertices.append(corner)
        indices.append(_TWO + len(vertices) - 4)
    return Triangles(np.array(vertices), np.concatenate(indices), None, np.tile(_SQUARE, (6, 1)))
