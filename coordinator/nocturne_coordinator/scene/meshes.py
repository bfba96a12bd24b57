"""Triangles from files and documents, packed as the tracer reads them. The only user of trimesh."""

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, NoReturn

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.resolvers import Resolver

from nocturne_coordinator.scene import bounds
from nocturne_coordinator.scene.fields import MeshFormat
from nocturne_coordinator.scene.mesh_headers import UnusableMeshError, check_counts, check_header
from nocturne_coordinator.scene.placement import Placement

# The loaders tell of ignored materials and other matters that are no concern of whoever sent the file.
logging.getLogger("trimesh").setLevel(logging.ERROR)

_CHUNK = 2**20  # triangles handled at once, to bound memory for intermediate results
_SMALLEST_NORMAL = float(np.finfo(np.float32).tiny)


class BadVertexError(UnusableMeshError):
    """A vertex can't be used."""

    def __init__(self, index: int, position: NDArray[np.float64], reason: str) -> None:
        self.index = index
        self.reason = f"({', '.join(f'{value:g}' for value in position)}) {reason}"
        super().__init__(f"vertex {index} {self.reason}")


@dataclass(frozen=True)
class Triangles:
    """Vertices, shape (n, 3), and triangles as indices of them, shape (m, 3); not checked yet."""

    vertices: NDArray[np.float64]
    indices: NDArray[np.int64]


@dataclass(frozen=True)
class PackedMesh:
    """A mesh as in a blob: vertices as 3 float32, then triangles as 3 uint32, little endian."""

    blob: bytes
    vertex_count: int
    triangle_count: int
    dropped_triangles: int


def load_mesh(path: Path, file_format: MeshFormat) -> Triangles:
    """Return all triangles of a file, merged, with the file's own transformations applied.

    Raises UnusableMeshError.
    """
    with path.open("rb") as file:
        check_header(file, file_format)
        scene = _load(file, file_format)
    return _merged(scene)


def inline_mesh(
    vertices: list[tuple[float, float, float]], triangles: list[tuple[int, int, int]]
) -> Triangles:
    """Return the triangles that a document holds itself."""
    return Triangles(np.array(vertices, dtype=np.float64), np.array(triangles, dtype=np.int64))


def pack_mesh(mesh: Triangles, placement: Placement) -> PackedMesh:
    """Place and pack a mesh without triangles that have no area and vertices that nothing uses.

    Raises UnusableMeshError.
    """
    check_counts(len(mesh.vertices), len(mesh.indices))
    _check_indices(mesh)
    _check_vertices(mesh.vertices, mesh.vertices)
    placed = placement.points(mesh.vertices)
    _check_vertices(placed, mesh.vertices)
    vertices = placed.astype(np.float32)
    kept = mesh.indices[_has_area(vertices, mesh.indices)]
    if len(kept) == 0:
        raise UnusableMeshError("the mesh has no triangle with an area")
    used = np.zeros(len(vertices), dtype=bool)
    used[kept] = True
    renumbered = np.cumsum(used, dtype=np.int64) - 1
    return PackedMesh(
        # Adding zero turns minus zero into zero, so that equal meshes have equal bytes.
        blob=(vertices[used] + np.float32(0)).astype("<f4").tobytes()
        + renumbered[kept].astype("<u4").tobytes(),
        vertex_count=int(used.sum()),
        triangle_count=len(kept),
        dropped_triangles=len(mesh.indices) - len(kept),
    )


class _NoOtherFiles(Resolver):
    """Refuses every file that a mesh file refers to: nothing on this machine's disk is anybody's asset."""

    def __init__(self) -> None:
        pass

    def get(self, name: str) -> NoReturn:
        raise FileNotFoundError(f"refers to another file: {name[:80]}")

    def write(self, name: str, data: object) -> NoReturn:
        raise PermissionError(f"{name[:80]}, {type(data).__name__}")

    def namespaced(self, namespace: str) -> "_NoOtherFiles":
        del namespace
        return self

    def keys(self) -> list[str]:
        return []


def _load(file: BinaryIO, file_format: MeshFormat) -> trimesh.Scene:
    try:
        return trimesh.load_scene(
            file, file_type=file_format, resolver=_NoOtherFiles(), process=False, skip_materials=True
        )
    except MemoryError:
        raise UnusableMeshError("the file needs more memory than there is") from None
    except Exception as error:
        raise UnusableMeshError(
            f"not a usable {file_format} file: {type(error).__name__}: {str(error)[:200]}"
        ) from error


def _merged(scene: trimesh.Scene) -> Triangles:
    """Merge all meshes, each as often as the scene graph uses it; points and lines are left out."""
    parts = [
        (scene.graph[node][0], scene.geometry[scene.graph[node][1]])
        for node in sorted(scene.graph.nodes_geometry)
    ]
    meshes = [(transform, part) for transform, part in parts if isinstance(part, trimesh.Trimesh)]
    check_counts(sum(len(part.vertices) for _, part in meshes), sum(len(part.faces) for _, part in meshes))
    vertices, indices, offset = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for transform, part in meshes:
        placed = _placed_part(transform, part)
        vertices.append(placed.vertices)
        indices.append(placed.indices + offset)
        offset += len(placed.vertices)
    return Triangles(np.concatenate(vertices), np.concatenate(indices))


def _placed_part(transform: NDArray[np.float64], part: trimesh.Trimesh) -> Triangles:
    vertices = np.asarray(part.vertices, dtype=np.float64)
    indices = np.asarray(part.faces, dtype=np.int64).reshape(-1, 3)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise UnusableMeshError("vertices must have three coordinates")
    own = Triangles(vertices, indices)
    _check_indices(own)  # before offsets of other parts hide a bad one
    if np.array_equal(transform, np.eye(4)):
        return own
    linear, shift = transform[:3, :3], transform[:3, 3]
    if np.linalg.det(linear) < 0:
        indices = indices[:, ::-1]  # a mirrored triangle would face inwards
    return Triangles(vertices @ linear.T + shift, indices)


def _check_indices(mesh: Triangles) -> None:
    count = len(mesh.vertices)
    if len(mesh.indices) == 0:
        raise UnusableMeshError("the mesh has no triangles")
    wrong = (mesh.indices < 0) | (mesh.indices >= count)
    if np.any(wrong):
        triangle, corner = (int(place) for place in np.argwhere(wrong)[0])
        raise UnusableMeshError(
            f"triangle {triangle} refers to vertex {mesh.indices[triangle, corner]}; "
            f"there are {count} vertices, counted from 0"
        )


def _check_vertices(vertices: NDArray[np.float64], original: NDArray[np.float64]) -> None:
    with np.errstate(invalid="ignore"):
        good = np.all(np.abs(vertices) <= bounds.LENGTH, axis=1)  # not true for NaN
    if not np.all(good):
        index = int(np.argmin(good))
        finite = np.all(np.isfinite(original[index]))
        reason = f"is farther than {bounds.LENGTH:g} m from the origin" if finite else "is not finite"
        raise BadVertexError(index, original[index], reason)


def _has_area(vertices: NDArray[np.float32], indices: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether a triangle's normal can be computed in float32, as the tracer does."""
    parts = [_chunk_has_area(vertices[indices[at : at + _CHUNK]]) for at in range(0, len(indices), _CHUNK)]
    return np.concatenate(parts)


def _chunk_has_area(corners: NDArray[np.float32]) -> NDArray[np.bool_]:
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(np.float64)
    return np.asarray(np.einsum("ij,ij->i", normal, normal) >= _SMALLEST_NORMAL, dtype=np.bool_)
