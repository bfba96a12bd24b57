"""Loop's subdivision of triangles.

C. Loop, "Smooth Subdivision Surfaces Based on Triangles", thesis, University of Utah, 1987, with the weights
of pbrt: J. Warren's around a vertex, H. Hoppe et al.'s at the boundary (SIGGRAPH 1994).
"""

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.meshes.triangles import Triangles

Points = NDArray[np.float64]
Indices = NDArray[np.int64]


def subdivided(points: Points, triangles: Indices, levels: int) -> Triangles:
    """The mesh after so many steps, moved to the limit surface, with normals.

    Raises ValueError where more than two triangles share an edge.
    """
    for _ in range(levels):
        points, triangles = _step(points, triangles)
    edges, is_boundary, _ = _edges(triangles, len(points))
    count, around, at_boundary = _around(points, edges, is_boundary)
    gamma = 1 / (count + 3 / (8 * _beta(count)))
    inner = (1 - count * gamma)[:, None] * points + gamma[:, None] * around
    limit = np.where(at_boundary[:, None], 0.6 * points + 0.2 * around, inner)
    return Triangles(limit, triangles, _normals(limit, triangles), None)


def _step(points: Points, triangles: Indices) -> tuple[Points, Indices]:
    edges, is_boundary, of_triangle = _edges(triangles, len(points))
    count, around, at_boundary = _around(points, edges, is_boundary)
    beta = _beta(count)
    inner = (1 - count * beta)[:, None] * points + beta[:, None] * around
    old = np.where(at_boundary[:, None], 0.75 * points + 0.125 * around, inner)
    ends = points[edges].sum(axis=1)
    opposite = np.zeros_like(ends)
    np.add.at(opposite, of_triangle.ravel(), points[np.roll(triangles, 1, axis=1)].reshape(-1, 3))
    new = np.where(is_boundary[:, None], 0.5 * ends, 0.375 * ends + 0.125 * opposite)
    a, b, c = triangles.T
    ab, bc, ca = (of_triangle + len(points)).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([old, new]), np.concatenate([np.stack(part, 1) for part in parts])


def _edges(triangles: Indices, vertices: int) -> tuple[Indices, NDArray[np.bool_], Indices]:
    """The ends of all edges, whether one triangle alone has it, and the edges ab, bc, ca of each triangle."""
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    keys = np.sort(sides, axis=1) @ np.array([vertices, 1])
    unique, of_side, uses = np.unique(keys, return_inverse=True, return_counts=True)
    if uses.max(initial=0) > 2:
        raise ValueError("more than two triangles share an edge")
    return np.stack(np.divmod(unique, vertices), 1), uses == 1, of_side.reshape(-1, 3)


def _around(
    points: Points, edges: Indices, is_boundary: NDArray[np.bool_]
) -> tuple[Points, Points, NDArray[np.bool_]]:
    """Of each vertex: how many neighbours count, their sum, and whether it is at the boundary.

    There only neighbours along the boundary count.
    """
    at_boundary = np.zeros(len(points), bool)
    at_boundary[edges[is_boundary].ravel()] = True
    count, around = np.zeros(len(points)), np.zeros_like(points)
    for here, there in (edges.T, edges.T[::-1]):
        counts = is_boundary | ~at_boundary[here]
        np.add.at(count, here[counts], 1.0)
        np.add.at(around, here[counts], points[there[counts]])
    return np.maximum(count, 1.0), around, at_boundary


def _beta(count: Points) -> Points:
    return np.where(count == 3, 3 / 16, 3 / (8 * count))


def _normals(points: Points, triangles: Indices) -> Points:
    """Means of the triangles around, by area."""
    a, b, c = (points[corner] for corner in triangles.T)
    normals = np.zeros_like(points)
    for corner in triangles.T:
        np.add.at(normals, corner, np.cross(b - a, c - a))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(lengths > 0, normals / np.maximum(lengths, 1e-300), [0.0, 0.0, 1.0])
