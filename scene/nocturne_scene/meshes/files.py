"""Triangles from mesh files. The only user of trimesh."""

import logging
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.resolvers import Resolver

from nocturne_scene.document.fields import MeshFormat
from nocturne_scene.library_words import without_paths
from nocturne_scene.meshes.headers import UnusableMeshError, check_counts, check_header
from nocturne_scene.meshes.plain_text import plain_text
from nocturne_scene.meshes.triangles import Triangles, check_indices, merge

# The loaders log ignored materials and other matters that are no concern of whoever sent the file.
logging.getLogger("trimesh").setLevel(logging.ERROR)


def load_mesh(path: Path, file_format: MeshFormat, *, normals: bool = False) -> Triangles:
    """Return all triangles of a file, merged, with the file's own transformations applied.

    Texture coordinates are there if all parts of the file have them. `normals`: also those of the
    vertices, the file's or else the mean of the adjoining triangles'. Raises UnusableMeshError.
    """
    with path.open("rb") as opened, plain_text(opened, file_format) as file:
        check_header(file, file_format)
        scene = _load(file, file_format)
    return _merged(scene, normals)


# Of a header that lists every property that there is a name for.
_PLY_HEADER_BYTES = 65536


def load_ply_columns(path: Path, element: str, names: tuple[str, ...]) -> NDArray[np.float64] | None:
    """Return numbers of a PLY file by the names of their properties, shape (rows, names); None without them.

    `element` is "vertex" or "face". Raises UnusableMeshError.
    """
    with path.open("rb") as opened, plain_text(opened, "ply") as file:
        check_header(file, "ply")
        [part] = _load(file, "ply").geometry.values()
    return _ply_columns(part, element, names)


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
    options: dict[str, Any] = (
        {"fix_texture": _has_coordinates_of_corners(file)} if file_format == "ply" else {}
    )
    try:
        return trimesh.load_scene(
            file,
            file_type=file_format,
            resolver=_NoOtherFiles(),
            process=False,
            skip_materials=True,
            **options,
        )
    except MemoryError:
        raise UnusableMeshError("the file needs more memory than there is") from None
    except Exception as error:
        raise UnusableMeshError(f"not a usable {file_format} file: {_words_of(error)}") from error


def _words_of(error: Exception) -> str:
    """The meaning of the loader's error, without names of its variables and indices."""
    if isinstance(error, IndexError):
        return "a number in it points beyond what there is"
    if isinstance(error, ValueError | FileNotFoundError):
        return without_paths(str(error))
    return "something that it needs is missing in it"


def _has_coordinates_of_corners(file: BinaryIO) -> bool:
    """Whether a PLY file has texture coordinates at each face's corners, so that vertices must be split.

    Where vertices have them nothing may be split, or the file's normals would no longer fit.
    """
    header = file.read(_PLY_HEADER_BYTES).partition(b"end_header")[0]
    file.seek(0)
    return b" texcoord" in header


def _merged(scene: trimesh.Scene, normals: bool) -> Triangles:
    """Merge all meshes, each as often as the scene graph uses it; points and lines are left out."""
    parts = [
        (scene.graph[node][0], scene.geometry[scene.graph[node][1]])
        for node in sorted(scene.graph.nodes_geometry)
    ]
    meshes = [(transform, part) for transform, part in parts if isinstance(part, trimesh.Trimesh)]
    check_counts(sum(len(part.vertices) for _, part in meshes), sum(len(part.faces) for _, part in meshes))
    return merge([_placed_part(transform, part, normals) for transform, part in meshes])


def _placed_part(transform: NDArray[np.float64], part: trimesh.Trimesh, normals: bool) -> Triangles:
    vertices = np.asarray(part.vertices, dtype=np.float64)
    indices = np.asarray(part.faces, dtype=np.int64).reshape(-1, 3)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise UnusableMeshError("vertices must have three coordinates")
    check_indices(len(vertices), indices)  # before offsets of other parts hide a bad one
    own = Triangles(vertices, indices, _normals(part) if normals else None, _coordinates(part))
    if np.array_equal(transform, np.eye(4)):
        return own
    linear, shift = transform[:3, :3], transform[:3, 3]
    if np.linalg.det(linear) < 0:
        indices = indices[:, ::-1]  # a mirrored triangle would face inwards
    turned = None if own.normals is None else own.normals @ _inverse(linear)
    return Triangles(vertices @ linear.T + shift, indices, turned, own.coordinates)


def _normals(part: trimesh.Trimesh) -> NDArray[np.float64]:
    of_file = _ply_columns(part, "vertex", ("nx", "ny", "nz"))
    if of_file is not None and len(of_file) == len(part.vertices):
        return of_file
    with np.errstate(all="ignore"):  # triangles without an area have none
        return np.asarray(np.nan_to_num(part.vertex_normals), dtype=np.float64)


def _ply_columns(part: trimesh.Trimesh, element: str, names: tuple[str, ...]) -> NDArray[np.float64] | None:
    """Numbers that trimesh leaves aside."""
    found = part.metadata.get("_ply_raw", {}).get(element, {}).get("data")
    # Rows of a binary file are an array, those of a text file a dictionary.
    known = found.dtype.names if isinstance(found, np.ndarray) else found
    if not known or not all(name in known for name in names):
        return None
    return np.stack([np.asarray(found[name], dtype=np.float64).ravel() for name in names], axis=1)


def _inverse(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normals are rows, so they go by the inverse from the right: (M^-T n)^T = n^T M^-1."""
    try:
        return np.asarray(np.linalg.inv(linear), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise UnusableMeshError("a part of the file is scaled to nothing") from None


def _coordinates(part: trimesh.Trimesh) -> NDArray[np.float64] | None:
    found = getattr(part.visual, "uv", None)
    if found is None or np.shape(found) != (len(part.vertices), 2):
        return None
    return np.asarray(found, dtype=np.float64)
