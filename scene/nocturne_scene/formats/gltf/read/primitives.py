"""Primitives as triangles: strips and fans, morph targets, skins, and colours at vertices."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.gltf.read import draco
from nocturne_scene.formats.gltf.read.container import Container, Json, value
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.headers import UnusableMeshError, check_counts
from nocturne_scene.meshes.triangles import Triangles, check_indices

_Array = NDArray[np.float64]

_POINTS_AND_LINES = (0, 1, 2, 3)
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
# Extensions of primitives that hold the vertices themselves.
_COMPRESSED = {
    "EXT_mesh_polygon": "consists of polygons, which can't be read",
}
# Those that change nothing that is seen.
_HARMLESS = ("KHR_materials_variants", "EXT_mesh_features", "EXT_structural_metadata")


@dataclass(frozen=True)
class Primitive:
    """Triangles in a node's coordinates, or with a skin in the scene's, and a colour at each vertex."""

    triangles: Triangles
    colours: _Array | None
    """Linear red, green, blue, alpha; None without any, or if all are white."""


@dataclass(frozen=True)
class Skin:
    """From the coordinates of a mesh to the scene's, for each joint."""

    joints: _Array
    """Shape (joints, 4, 4)."""


def read_primitive(
    container: Container,
    findings: Findings,
    primitive: Json,
    weights: list[float],
    skin: Skin | None,
    coordinates: tuple[int, Matrix],
    place: str,
) -> Primitive | None:
    """Return a primitive's triangles; None, and a loss, for points and lines. Raises InputError.

    `coordinates`: the set of texture coordinates that its material uses, and a 3 x 3 matrix for them.
    """
    shown = container.at(place)
    mode = value(primitive, "mode", _TRIANGLES)
    if mode in _POINTS_AND_LINES:
        findings.lost(shown, "points and lines have no surface, so they are not supported; left out")
        return None
    attributes = value(primitive, "attributes", {})
    for name in value(primitive, "extensions", {}):
        if name in _COMPRESSED:
            # Unless the vertices are there uncompressed, too.
            stored = container.item("accessors", value(attributes, "POSITION", None), place)
            if "bufferView" in stored:
                continue
            raise InputError.at(shown, f"not supported: it {_COMPRESSED[name]}; decompress the file first")
        if name == draco.NAME:
            primitive, mode = draco.decompress(container, primitive, place), _TRIANGLES
            continue
        if name not in _HARMLESS:
            findings.lost(shown, f"no support for the extension {name}")
    points = container.numbers(value(attributes, "POSITION", None), place, "VEC3")
    normals = container.numbers(attributes["NORMAL"], place, "VEC3") if "NORMAL" in attributes else None
    uv = _coordinates(container, attributes, *coordinates, place)
    colours = _colours(container, attributes, place)
    if any(each is not None and len(each) != len(points) for each in (normals, uv, colours)):
        raise InputError.at(shown, "its attributes have different counts")
    if "indices" in primitive:
        indices = container.numbers(primitive["indices"], place, "SCALAR").astype(np.int64).ravel()
    else:
        indices = np.arange(len(points))
    corners = _corners(indices, mode, shown)
    if len(points) == 0 or len(corners) == 0:
        raise InputError.at(shown, "has no whole triangles")
    try:
        check_counts(len(points), len(corners))
        check_indices(len(points), corners)
    except UnusableMeshError as error:
        raise InputError.at(shown, str(error)) from None
    points, normals = _morphed(container, findings, primitive, weights, points, normals, place)
    if skin is not None:
        points, normals = _skinned(container, attributes, skin, points, normals, place)
    mesh = Triangles(points, corners, normals, np.zeros((len(points), 2)) if uv is None else uv)
    return Primitive(mesh, colours)


def _corners(indices: NDArray[np.int64], mode: int, shown: str) -> NDArray[np.int64]:
    """Three indices of each triangle, turned so that all face the same side."""
    match mode:
        case 4:
            if len(indices) % 3:
                raise InputError.at(shown, "has no whole triangles")
            return indices.reshape(-1, 3)
        case 5:
            found = np.stack([indices[:-2], indices[1:-1], indices[2:]], 1)
            found[1::2] = found[1::2, [0, 2, 1]]
        case 6:
            found = np.stack(
                [indices[1:-1], indices[2:], np.broadcast_to(indices[:1], max(0, len(indices) - 2))], 1
            )
        case _:
            raise InputError.at(shown, f"no mode {str(mode)[:20]}; expected 0 to 6")
    # Strips are joined by triangles that are none.
    a, b, c = found.T
    return np.asarray(found[(a != b) & (b != c) & (c != a)])


def _coordinates(
    container: Container, attributes: Json, number: int, matrix: Matrix, place: str
) -> _Array | None:
    """Texture coordinates, v going up the picture."""
    name = f"TEXCOORD_{number}"
    if name not in attributes:
        return None
    found = container.numbers(attributes[name], place, "VEC2") @ matrix[:2, :2].T + matrix[:2, 2]
    return np.stack([found[:, 0], 1 - found[:, 1]], 1)


def _colours(container: Container, attributes: Json, place: str) -> _Array | None:
    if "COLOR_0" not in attributes:
        return None
    found = np.clip(container.numbers(attributes["COLOR_0"], place, "VEC3", "VEC4"), 0.0, 1.0)
    if found.shape[1] == 3:
        found = np.hstack([found, np.ones((len(found), 1))])
    return None if np.all(found == 1.0) else found


def _morphed(
    container: Container,
    findings: Findings,
    primitive: Json,
    weights: list[float],
    points: _Array,
    normals: _Array | None,
    place: str,
) -> tuple[_Array, _Array | None]:
    targets = value(primitive, "targets", [])
    for weight, target in zip(weights, targets if isinstance(targets, list) else [], strict=False):
        if weight == 0.0:
            continue
        for name in value(target, "POSITION", None), value(target, "NORMAL", None):
            if name is not None and container.item("accessors", name, place).get("count") != len(points):
                raise InputError.at(container.at(place), "its morph targets have other counts")
        if "POSITION" in target:
            points = points + weight * container.numbers(target["POSITION"], place, "VEC3")
        if "NORMAL" in target and normals is not None:
            normals = normals + weight * container.numbers(target["NORMAL"], place, "VEC3")
        for name in target:
            if name not in ("POSITION", "NORMAL", "TANGENT"):
                findings.lost(container.at(place), f"no support for a morph target's {name}")
    return points, normals


def _skinned(
    container: Container,
    attributes: Json,
    skin: Skin,
    points: _Array,
    normals: _Array | None,
    place: str,
) -> tuple[_Array, _Array | None]:
    """Each vertex moved by the mean of its joints' matrices."""
    blended = np.zeros((len(points), 4, 4))
    for number in range(64):
        joints, parts = (attributes.get(f"{name}_{number}") for name in ("JOINTS", "WEIGHTS"))
        if joints is None or parts is None:
            break
        which = container.numbers(joints, place, "VEC4").astype(np.int64)
        much = container.numbers(parts, place, "VEC4")
        if len(which) != len(points) or len(much) != len(points) or which.max() >= len(skin.joints):
            raise InputError.at(container.at(place), "its joints are not those of its skin, or too few")
        for column in range(4):
            blended += much[:, column, None, None] * skin.joints[which[:, column]]
    if not np.any(blended):
        raise InputError.at(container.at(place), "has a skin, and no joints and weights")
    # Weights add up to 1, but for rounding.
    total = blended[:, 3, 3]
    blended /= np.where(total > 0, total, 1.0)[:, None, None]
    moved = np.einsum("nij,nj->ni", blended[:, :3, :3], points) + blended[:, :3, 3]
    if normals is not None:
        rows = blended[:, :3, :3]
        cofactors = np.stack([np.cross(rows[:, (i + 1) % 3], rows[:, (i + 2) % 3]) for i in range(3)], axis=1)
        normals = np.einsum("nij,nj->ni", cofactors, normals)
    return moved, normals
