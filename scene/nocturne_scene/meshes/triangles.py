"""Triangles as the compiler handles them, and packed into a blob as the tracer reads them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nocturne_scene import limits
from nocturne_scene.document import bounds
from nocturne_scene.meshes.headers import UnusableMeshError, check_counts
from nocturne_scene.meshes.similarity import Similarity

_CHUNK = 2**20  # triangles handled at once, to bound memory for intermediate results


class BadVertexError(UnusableMeshError):
    """A vertex can't be used."""

    def __init__(self, index: int, position: NDArray[np.float64], reason: str) -> None:
        self.index = index
        self.reason = f"({', '.join(f'{value:g}' for value in position)}) {reason}"
        super().__init__(f"vertex {index} {self.reason}")


@dataclass(frozen=True)
class Triangles:
    """Vertices, shape (n, 3), and triangles as indices of them, shape (m, 3); not checked yet.

    Perhaps with directions of normals, shape (n, 3), and texture coordinates, shape (n, 2).
    """

    vertices: NDArray[np.float64]
    indices: NDArray[np.int64]
    normals: NDArray[np.float64] | None = None
    coordinates: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class PackedMesh:
    """A mesh as in a blob; `Mesh` in scene.proto has the layout."""

    blob: bytes
    vertex_count: int
    triangle_count: int
    dropped_triangles: int


def merge(parts: Sequence[Triangles]) -> Triangles:
    """Return all triangles of several meshes; normals and coordinates if all of the meshes have them."""
    offsets = np.cumsum([0, *(len(part.vertices) for part in parts)])
    normals = [part.normals for part in parts if part.normals is not None]
    coordinates = [part.coordinates for part in parts if part.coordinates is not None]
    indices = [part.indices + offset for part, offset in zip(parts, offsets, strict=False)]
    return Triangles(
        np.concatenate([np.zeros((0, 3)), *(part.vertices for part in parts)]),
        np.concatenate([np.zeros((0, 3), dtype=np.int64), *indices]),
        np.concatenate(normals) if parts and len(normals) == len(parts) else None,
        np.concatenate(coordinates) if parts and len(coordinates) == len(parts) else None,
    )


def pack_mesh(mesh: Triangles, steps: Sequence[Similarity]) -> PackedMesh:
    """Place and pack a mesh without triangles that have no area and vertices that nothing uses.

    `steps` are its placements at equally spaced times. Normals and coordinates are packed if they are there.
    Raises UnusableMeshError.
    """
    check_counts(len(mesh.vertices), len(mesh.indices))
    _check_size(mesh, len(steps))
    check_indices(len(mesh.vertices), mesh.indices)
    _check_vertices(mesh.vertices, mesh.vertices)
    vertices = np.stack([_placed(mesh, step) for step in steps])
    _check_extent(vertices[0])
    kept = mesh.indices[has_area(vertices[0], mesh.indices)]
    if len(kept) == 0:
        raise UnusableMeshError("the mesh has no triangle with an area")
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[kept] = True
    renumbered = np.cumsum(used, dtype=np.int64) - 1
    parts = [_float_bytes(vertices[:, used])]
    if mesh.normals is not None:
        unit = unit_normals(mesh)[used]
        parts.append(_float_bytes(np.stack([step.turned(unit) for step in steps])))
    if mesh.coordinates is not None:
        _check_coordinates(mesh.coordinates)
        parts.append(_float_bytes(mesh.coordinates[used]))
    parts.append(renumbered[kept].astype("<u4").tobytes())
    return PackedMesh(
        blob=b"".join(parts),
        vertex_count=int(used.sum()),
        triangle_count=len(kept),
        dropped_triangles=len(mesh.indices) - len(kept),
    )


def unit_normals(mesh: Triangles) -> NDArray[np.float64]:
    """Return unit normals at the vertices: the mesh's own, or where there are none the triangles' mean."""
    given = mesh.normals if mesh.normals is not None else np.zeros_like(mesh.vertices)
    lengths = np.linalg.norm(given, axis=1)
    good = np.isfinite(lengths) & (lengths > 0)
    if not np.all(good):
        given = np.where(good[:, None], given, _mean_normals(mesh))
        lengths = np.linalg.norm(given, axis=1)
    # A vertex that only degenerate triangles use is dropped later, so any direction will do.
    given = np.where(lengths[:, None] > 0, given, [0.0, 0.0, 1.0])
    return np.asarray(given / np.where(lengths > 0, lengths, 1.0)[:, None], dtype=np.float64)


def check_indices(vertices: int, indices: NDArray[np.int64]) -> None:
    """Raise UnusableMeshError unless all triangles have vertices."""
    if len(indices) == 0:
        raise UnusableMeshError("the mesh has no triangles")
    wrong = (indices < 0) | (indices >= vertices)
    if np.any(wrong):
        triangle, corner = (int(place) for place in np.argwhere(wrong)[0])
        raise UnusableMeshError(
            f"triangle {triangle} refers to vertex {indices[triangle, corner]}; "
            f"there are {vertices} vertices, counted from 0"
        )


def _check_size(mesh: Triangles, steps: int) -> None:
    """A moving mesh is large: refuse it before memory is taken."""
    floats = 3 * steps * (1 if mesh.normals is None else 2) + (0 if mesh.coordinates is None else 2)
    size = 4 * floats * len(mesh.vertices) + 12 * len(mesh.indices)
    if size > limits.MAX_ASSET_BYTES:
        raise UnusableMeshError(
            f"the mesh would take {size} bytes with its {steps} time steps; "
            f"at most {limits.MAX_ASSET_BYTES} are accepted"
        )


def _placed(mesh: Triangles, step: Similarity) -> NDArray[np.float32]:
    placed = step.points(mesh.vertices)
    _check_vertices(placed, mesh.vertices)
    return placed.astype(np.float32)


def _float_bytes(values: NDArray[np.floating]) -> bytes:
    # Adding zero turns minus zero into zero, so that equal meshes have equal bytes.
    return (values.astype(np.float32) + np.float32(0)).astype("<f4").tobytes()


def _mean_normals(mesh: Triangles) -> NDArray[np.float64]:
    """Return the mean normal of the triangles around each vertex, by area, not normalised."""
    normals = area_vectors(mesh.vertices[mesh.indices])
    mean = np.zeros_like(mesh.vertices)
    for corner in range(3):
        np.add.at(mean, mesh.indices[:, corner], normals)
    return mean


def _check_coordinates(coordinates: NDArray[np.float64]) -> None:
    good = np.all(np.abs(coordinates) <= bounds.TEXTURE_SCALE, axis=1)
    if not np.all(good):
        index = int(np.argmin(good))
        raise UnusableMeshError(
            f"the texture coordinates of vertex {index} are not finite or beyond {bounds.TEXTURE_SCALE:g}"
        )


def _check_vertices(vertices: NDArray[np.float64], original: NDArray[np.float64]) -> None:
    with np.errstate(invalid="ignore"):
        good = np.all(np.abs(vertices) <= bounds.LENGTH, axis=1)  # not true for NaN
    if not np.all(good):
        index = int(np.argmin(good))
        finite = np.all(np.isfinite(original[index]))
        reason = f"is farther than {bounds.LENGTH:g} m from the origin" if finite else "is not finite"
        raise BadVertexError(index, original[index], reason)


def _check_extent(vertices: NDArray[np.float32]) -> None:
    extent = float(np.linalg.norm(np.ptp(vertices.astype(np.float64), axis=0))) if len(vertices) else 0.0
    if extent < bounds.MIN_SIZE:
        raise UnusableMeshError(f"is {extent:g} m large once scaled; expected at least {bounds.MIN_SIZE:g} m")


def has_area(vertices: NDArray[np.float32], indices: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether the tracer meets a triangle where its rays do."""
    parts = []
    for at in range(0, len(indices), _CHUNK):
        normal = area_vectors(vertices[indices[at : at + _CHUNK]]).astype(np.float64)
        parts.append(np.einsum("ij,ij->i", normal, normal) >= bounds.EMBREE_AREA**2)
    return np.concatenate(parts)


def area_vectors(corners: NDArray[Any]) -> NDArray[Any]:
    """Return normals twice as long as the areas of triangles, whose corners have the shape (n, 3, 3)."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
