"""Curves with a thickness, such as hair, as meshes around them."""

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.meshes.triangles import Triangles

Array = NDArray[np.float64]

# Steps of a spline between two of its control points.
STEPS = 8

# Sides of a tube, by the most pieces that a shape may have for them: hair is seen as thin as a pixel.
_SIDES = ((2_000, 32), (100_000, 8))
_FEWEST_SIDES = 4

# Rows are powers of t from 1 on, columns are control points; by basis and degree.
_MATRICES = {
    ("bspline", 3): np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6,
    ("bspline", 2): np.array([[1, 1, 0], [-2, 2, 0], [1, -2, 1]]) / 2,
    ("bezier", 3): np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]),
    ("bezier", 2): np.array([[1, 0, 0], [-2, 2, 0], [1, -2, 1]]),
}
BASES = ("bezier", "bspline")


def along(points: Array, degree: int, basis: str) -> Array:
    """Points on a curve of uniform B-splines or of Bezier curves that follow each other, shape (n, width).

    `points`: its control points, of the same width. ValueError for a number of them that no curve has.
    """
    # Control points from the first of a piece to that of the next one.
    step = 1 if basis == "bspline" else degree
    pieces, left = divmod(len(points) - degree - 1, step)
    if pieces < 0 or left:
        raise ValueError(f"no {basis} curve of degree {degree} has {len(points)} control points")
    t = np.linspace(0.0, 1.0, STEPS + 1)
    weights = np.stack([t**power for power in range(degree + 1)], 1) @ _MATRICES[basis, degree]
    spans = np.stack([points[i * step : i * step + degree + 1] for i in range(pieces + 1)])
    found = np.einsum("tk,skw->stw", weights, spans)
    return np.concatenate([found[:, :-1].reshape(-1, points.shape[1]), found[-1, -1:]])


def tubes(curves: list[Array]) -> Triangles:
    """A mesh around curves, each of shape (n, 4) with n > 1: points and radii.

    v goes along a curve. Ends are open.
    """
    sides = _sides(curves)
    by_length: dict[int, list[Array]] = {}
    for curve in curves:
        by_length.setdefault(len(curve), []).append(curve)
    return _together([_around(np.stack(each), sides) for each in by_length.values()])


def beads(curves: list[Array]) -> Triangles:
    """A mesh around polylines, each of shape (n, 4): balls at their points, and the cones that touch two."""
    sides = _sides(curves)
    points = np.concatenate(curves)
    start, end = (np.concatenate([curve[i : len(curve) - 1 + i] for curve in curves]) for i in (0, 1))
    along = end[:, :3] - start[:, :3]
    length = np.linalg.norm(along, axis=1)
    # Of a ball in a larger one nothing is seen.
    seen = length > np.abs(end[:, 3] - start[:, 3])
    start, end, along, length = start[seen], end[seen], along[seen], length[seen]
    fall = (start[:, 3] - end[:, 3]) / length
    touching = []
    for each in (start, end):
        middle = each[:, :3] + (each[:, 3] * fall / length)[:, None] * along
        touching.append(np.hstack([middle, (each[:, 3] * np.sqrt(1 - fall**2))[:, None]]))
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    polar = np.pi * np.arange(sides // 2 + 1) / (sides // 2)
    rings = points[:, None, :3] - (points[:, 3:] * np.cos(polar))[..., None] * up[:, None]
    balls = np.concatenate([rings, (points[:, 3:] * np.sin(polar))[..., None]], axis=2)
    parts = [_from_centres(_around(balls, sides), points[:, None, :3])]
    if len(start):
        centres = np.stack([start[:, :3], end[:, :3]], 1)
        parts.append(_from_centres(_around(np.stack(touching, 1), sides), centres))
    return _together(parts)


def _from_centres(mesh: Triangles, centres: Array) -> Triangles:
    """The same with the normals of balls, `centres` being of those whose rings follow each other."""
    count = centres.shape[0] * centres.shape[1]
    normals = _unit(mesh.vertices.reshape(count, -1, 3) - centres.reshape(count, 1, 3)).reshape(-1, 3)
    return Triangles(mesh.vertices, mesh.indices, normals, mesh.coordinates)


def _sides(curves: list[Array]) -> int:
    pieces = sum(len(curve) - 1 for curve in curves)
    return next((each for most, each in _SIDES if pieces <= most), _FEWEST_SIDES)


def _together(parts: list[Triangles]) -> Triangles:
    first = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Triangles(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.indices + start for part, start in zip(parts, first, strict=False)]),
        np.concatenate([part.normals for part in parts if part.normals is not None]),
        np.concatenate([part.coordinates for part in parts if part.coordinates is not None]),
    )


def _around(curves: Array, sides: int) -> Triangles:
    """Of curves with the same number of points, shape (curves, n, 4)."""
    number, count = curves.shape[:2]
    points, radii = curves[..., :3], curves[..., 3]
    along = _unit(np.gradient(points, axis=1))
    across = np.empty_like(along)
    across[:, 0] = _unit(np.cross(along[:, 0], np.eye(3)[np.abs(along[:, 0]).argmin(axis=1)]))
    for i in range(1, count):
        # Turned as little as the curve allows.
        before = across[:, i - 1]
        across[:, i] = _unit(before - np.sum(before * along[:, i], axis=1, keepdims=True) * along[:, i])
    third = np.cross(along, across)
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    outwards = np.cos(angle)[:, None] * across[:, :, None, :] + np.sin(angle)[:, None] * third[:, :, None, :]
    vertices = points[:, :, None, :] + radii[:, :, None, None] * outwards
    u, v = np.meshgrid(angle / (2 * np.pi), np.linspace(0.0, 1.0, count))
    corner = (np.arange(count - 1)[:, None] * (sides + 1) + np.arange(sides)).ravel()
    beyond = corner + sides + 1
    faces = np.concatenate(
        [np.stack([corner, corner + 1, beyond], 1), np.stack([corner + 1, beyond + 1, beyond], 1)]
    )
    starts = np.arange(number)[:, None, None] * (count * (sides + 1))
    return Triangles(
        vertices.reshape(-1, 3),
        (faces + starts).reshape(-1, 3),
        outwards.reshape(-1, 3),
        np.tile(np.stack([u.ravel(), v.ravel()], 1), (number, 1)),
    )


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0))
