"""Shapes as triangles, with texture coordinates where v goes up the picture, and triangles as files."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.triangles import Triangles, area_vectors

_Array = NDArray[np.float64]

# Steps around a curved shape: its outline is off by 1 - cos(pi / AROUND) = 7.5e-5 of its radius.
AROUND = 256
ALONG = 128

# The faces of a cube from -1 to 1: the corner at u = v = 0, and the edges along u and v (v down the picture).
_CUBE = (
    ((-1, -1, -1), (0, 0, 2), (2, 0, 0)),
    ((1, 1, 1), (-2, 0, 0), (0, 0, -2)),
    ((1, -1, 1), (0, 2, 0), (0, 0, -2)),
    ((-1, -1, 1), (0, 2, 0), (2, 0, 0)),
    ((-1, -1, -1), (0, 2, 0), (0, 0, 2)),
    ((-1, 1, -1), (0, -2, 0), (2, 0, 0)),
)


def grid(columns: int, rows: int, at: Callable[[_Array, _Array], tuple[_Array, _Array | None]]) -> Triangles:
    """A surface over (s, t) in [0, 1]^2; `at` gives points and normals. Texture coordinates are (s, t)."""
    s, t = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1)))
    points, normals = at(s, t)
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    beyond = first + columns + 1
    indices = np.concatenate(
        [np.stack([first, first + 1, beyond], 1), np.stack([first + 1, beyond + 1, beyond], 1)]
    )
    return Triangles(points, indices, normals, np.stack([s, t], 1))


def transformed(mesh: Triangles, matrix: Matrix) -> Triangles:
    """Placed; normals stay on their side of the triangles, also in a mirror."""
    linear = matrix[:3, :3]
    normals = mesh.normals
    if normals is not None:
        # A cofactor matrix is the inverse transpose up to a factor, and exists without an inverse.
        cofactor = np.stack([np.cross(linear[(i + 1) % 3], linear[(i + 2) % 3]) for i in range(3)])
        normals = normals @ (cofactor.T if np.linalg.det(linear) >= 0 else -cofactor.T)
    indices = mesh.indices if np.linalg.det(linear) >= 0 else mesh.indices[:, ::-1]
    return Triangles(mesh.vertices @ linear.T + matrix[:3, 3], indices, normals, mesh.coordinates)


def flipped(mesh: Triangles) -> Triangles:
    """The other side out."""
    normals = None if mesh.normals is None else -mesh.normals
    return Triangles(mesh.vertices, mesh.indices[:, ::-1], normals, mesh.coordinates)


def facing_their_normals(mesh: Triangles) -> Triangles:
    """Triangles turned over where the normals at their corners say that the other side is the front."""
    if mesh.normals is None:
        return mesh
    said = mesh.normals[mesh.indices].sum(axis=1)
    wrong = np.einsum("ij,ij->i", area_vectors(mesh.vertices[mesh.indices]), said) < 0
    indices = np.where(wrong[:, None], mesh.indices[:, ::-1], mesh.indices)
    return Triangles(mesh.vertices, indices, mesh.normals, mesh.coordinates)


def ply(mesh: Triangles) -> bytes:
    """A binary PLY file, all in single precision, as the tracer keeps it.

    By hand, because trimesh writes texture coordinates in double precision.
    """
    columns = ["x", "y", "z"]
    values = [mesh.vertices]
    if mesh.normals is not None:
        columns += ["nx", "ny", "nz"]
        values.append(mesh.normals)
    if mesh.coordinates is not None:
        columns += ["s", "t"]
        values.append(mesh.coordinates)
    faces = np.empty(len(mesh.indices), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, mesh.indices
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.vertices)}"]
    header += [f"property float {column}" for column in columns]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(header).encode() + np.hstack(values).astype("<f4").tobytes() + faces.tobytes()


def sphere() -> Triangles:
    """Of radius 1; u is the azimuth from x towards y, v goes from -z up to +z."""

    def at(s: _Array, t: _Array) -> tuple[_Array, _Array]:
        azimuth, polar = 2 * np.pi * s, np.pi * (1 - t)
        points = np.stack(
            [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], 1
        )
        return points, points

    return facing_their_normals(grid(AROUND, ALONG, at))


def cylinder(smooth: bool = True) -> Triangles:
    """Of radius 1 about z from 0 to 1, without ends; u is the azimuth, v goes up the picture with -z."""

    def at(s: _Array, t: _Array) -> tuple[_Array, _Array | None]:
        azimuth = 2 * np.pi * s
        outwards = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros_like(s)], 1)
        return outwards + np.stack([0 * t, 0 * t, 1 - t], 1), outwards if smooth else None

    return facing_their_normals(grid(AROUND, 1, at))


def disc() -> Triangles:
    """Of radius 1 in the plane z = 0, facing z; u is the radius, v falls with the azimuth."""

    def at(s: _Array, t: _Array) -> tuple[_Array, _Array]:
        azimuth = 2 * np.pi * (1 - t)
        points = np.stack([s * np.cos(azimuth), s * np.sin(azimuth), 0 * s], 1)
        return points, np.tile([0.0, 0.0, 1.0], (len(s), 1))

    return facing_their_normals(grid(32, AROUND, at))


def rectangle() -> Triangles:
    """[-1, 1]^2 in the plane z = 0, facing z; u grows with x, v falls with y."""

    def at(s: _Array, t: _Array) -> tuple[_Array, _Array]:
        return np.stack([2 * s - 1, 1 - 2 * t, 0 * s], 1), np.tile([0.0, 0.0, 1.0], (len(s), 1))

    return facing_their_normals(grid(1, 1, at))


def cube() -> Triangles:
    """[-1, 1]^3, flat; on each face v falls from its corner at u = v = 0."""
    vertices, coordinates, normals = [], [], []
    for corner, u, v in np.array(_CUBE, dtype=np.float64):
        vertices += [corner, corner + u, corner + u + v, corner + v]
        coordinates += [[0, 1], [1, 1], [1, 0], [0, 0]]
        normals += [np.cross(v, u)] * 4
    first = np.arange(0, 24, 4)[:, None]
    indices = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    mesh = Triangles(np.array(vertices), indices, np.array(normals), np.array(coordinates, dtype=np.float64))
    mesh = facing_their_normals(mesh)
    return Triangles(mesh.vertices, mesh.indices, None, mesh.coordinates)


UNITS: dict[str, Callable[[], Triangles]] = {
    "sphere": sphere,
    "cylinder": cylinder,
    "disk": disc,
    "rectangle": rectangle,
    "cube": cube,
}
"""By the names that other renderers have for them."""


@cache
def outline(kind: str) -> _Array:
    """Points of one of UNITS that reach as far as all of it in every direction."""
    points = UNITS[kind]().vertices
    # Of a disc the rim will do.
    return points[np.linalg.norm(points, axis=1) > 0.99] if kind == "disk" else points
