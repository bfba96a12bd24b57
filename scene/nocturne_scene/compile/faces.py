"""Meters on faces of surfaces become meters at points, each with its normal."""

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.instruments import Faces, Instrument
from nocturne_scene.document.node import quoted_list
from nocturne_scene.document.sensors import Meters
from nocturne_scene.document.shapes import AssetMesh, Box, InlineMesh, Shape
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.triangles import area_vectors, check_indices

_Values = NDArray[np.float64]
_TRIANGLES_OF_A_SIDE = 2
"""Of a box."""
_UPRIGHT = ("cylindrical", "semicylindrical")
"""Their axis is y, or `normal`, and not that of a face."""
_PLASTIC = 1.32471795724474602596
"""The real root of x^3 = x + 1, whose powers make a sequence in the square that is spread evenly: M. Roberts,
"The unreasonable effectiveness of quasirandom sequences", 2018."""


def with_faces_found(workspace: Workspace, shapes: Shapes) -> None:
    """Puts points and normals in the place of faces, in the workspace's document. Raises Unusable."""
    sensor = workspace.document.sensor
    if not isinstance(sensor, Meters) or all(each.faces is None for each in sensor.instruments):
        return
    found = []
    for index, instrument in enumerate(sensor.instruments):
        try:
            found.append(_found(workspace, shapes, instrument))
        except (Unusable, UnusableMeshError) as error:
            raise Unusable(str(error), f".instruments[{index}].faces{getattr(error, 'suffix', '')}") from None
    changed = sensor.model_copy(update={"instruments": found})
    workspace.document = workspace.document.model_copy(update={"sensor": changed})


def _found(workspace: Workspace, shapes: Shapes, instrument: Instrument) -> Instrument:
    faces = instrument.faces
    if faces is None:
        return instrument
    surface = _surface(workspace.document.surfaces, faces.surface)
    corners = _corners(shapes, surface)
    made = _spread(corners, faces.count) if faces.spread else _middles(surface.shape, corners, faces)
    middles, normals = made
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    if faces.side == "back":
        normals = -normals
    has_own = instrument.normal is not None or instrument.measures in _UPRIGHT
    return instrument.model_copy(
        update={
            "faces": None,
            "points": [tuple(each) for each in (middles + faces.distance * normals).tolist()],
            "normals": None if has_own else [tuple(each) for each in normals.tolist()],
        }
    )


def _surface(surfaces: list[Surface], name: str) -> Surface:
    found = [each for each in surfaces if each.name == name and name]
    if not found:
        names = [each.name for each in surfaces if each.name]
        raise Unusable(f"no surface has this name; expected one of {quoted_list(names)}", ".surface")
    if len(found) > 1:
        raise Unusable(f"{len(found)} surfaces have this name; expected that of one alone", ".surface")
    if found[0].motion is not None:
        raise Unusable("this surface moves, and meters are at rest", ".surface")
    return found[0]


def _corners(shapes: Shapes, surface: Surface) -> _Values:
    """Of its triangles where they stand, shape (n, 3, 3)."""
    try:
        mesh = shapes.triangles(surface.shape)
        check_indices(len(mesh.vertices), mesh.indices)
    except (Unusable, UnusableMeshError) as error:
        raise Unusable(
            f"the surface {error}" if isinstance(error, Unusable) else str(error), ".surface"
        ) from None
    return placement_of(surface).points(mesh.vertices)[mesh.indices]


def _middles(shape: Shape, corners: _Values, faces: Faces) -> tuple[_Values, _Values]:
    """Of the faces that are asked for, each with a normal of any length."""
    if isinstance(shape, InlineMesh | AssetMesh):
        together = 1
    else:
        together = _TRIANGLES_OF_A_SIDE if isinstance(shape, Box) else len(corners)
    count = len(corners) // together
    if faces.first + faces.count > count:
        what = "one face" if count == 1 else f"{count} faces"
        raise Unusable(f"the surface has {what}; expected first + count to be {count} or less", ".count")
    chosen = corners[faces.first * together : (faces.first + faces.count) * together]
    normals = area_vectors(chosen).reshape(-1, together, 3).sum(axis=1)
    flat = np.flatnonzero(~normals.any(axis=1))
    if len(flat):
        raise Unusable(f"face {faces.first + flat[0]} has no area", ".first")
    return chosen.reshape(-1, 3 * together, 3).mean(axis=1), normals


def _spread(corners: _Values, count: int) -> tuple[_Values, _Values]:
    """One point in each of as many parts of the same area, in the order of the triangles."""
    vectors = area_vectors(corners)
    ends = np.cumsum(np.linalg.norm(vectors, axis=1))
    if not 0.0 < ends[-1] < np.inf:
        raise Unusable("the surface has no area", ".surface")
    wanted = (np.arange(count) + 0.5) / count * ends[-1]
    chosen = np.searchsorted(ends, wanted, side="right")
    steps = np.array([1.0 / _PLASTIC, 1.0 / _PLASTIC**2])
    u, v = (0.5 + np.arange(1, count + 1)[:, None] * steps).T % 1.0
    # The unit square onto a triangle, evenly (A. Glassner, Graphics Gems, 1990).
    root = np.sqrt(u)
    shares = np.stack([1.0 - root, root * (1.0 - v), root * v], axis=1)
    return np.einsum("nc,ncx->nx", shares, corners[chosen]), vectors[chosen]
