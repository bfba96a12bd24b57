"""Mitsuba's shapes that are a few numbers."""

from collections.abc import Callable
from functools import cache

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import shapes, transforms
from nocturne_scene.formats.reading.crowds import Base, Placed, ball
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.meshes.triangles import Triangles


def _generated(
    context: Context, properties: Properties, to_world: Matrix, textured: bool, kind: str
) -> Placed:
    """A shape that is made up, in its own coordinates; v goes up the picture."""
    flipped, flat = (properties.switch(name, False) for name in ("flip_normals", "face_normals"))
    base = _base(kind, flipped, flat, textured)
    context.extent.add(shapes.outline(kind) @ to_world[:3, :3].T + to_world[:3, 3])
    return Placed(base, to_world)


@cache
def _base(kind: str, flipped: bool, flat: bool, textured: bool) -> Base:
    """One for all that are alike, as those are put together that have the same one."""
    mesh = shapes.UNITS[kind]()
    if not textured and kind == "cube":
        mesh = _with_shared_corners(mesh)
    if flipped:
        mesh = shapes.flipped(mesh)
    return Base(kind, Triangles(mesh.vertices, mesh.indices, None, mesh.coordinates) if flat else mesh)


def _with_shared_corners(mesh: Triangles) -> Triangles:
    corners, number = np.unique(mesh.vertices, axis=0, return_inverse=True)
    return Triangles(corners, number.reshape(-1)[mesh.indices], None, None)


def _sphere(context: Context, properties: Properties, to_world: Matrix, textured: bool) -> Placed:
    radius = properties.number("radius", 1.0)
    centre = properties.vector("center") or [0.0, 0.0, 0.0]
    placed = to_world @ transforms.translation(centre) @ transforms.scaling([radius] * 3)
    factor = transforms.similarity(placed)
    if factor is not None and not textured and not properties.has("flip_normals"):
        middle = placed[:3, 3]
        context.extent.add(np.array([middle - factor, middle + factor]))
        return ball(middle, factor)
    context.findings.note(
        properties.place, f"the sphere became a mesh of {2 * shapes.AROUND * shapes.ALONG} triangles"
    )
    return _generated(context, properties, placed, textured, "sphere")


def _cylinder(context: Context, properties: Properties, to_world: Matrix, textured: bool) -> Placed:
    radius = properties.number("radius", 1.0)
    start, end = properties.vector("p0") or [0.0, 0.0, 0.0], properties.vector("p1") or [0.0, 0.0, 1.0]
    along = np.subtract(end, start)
    length = float(np.linalg.norm(along))
    if not length > 0:
        raise InputError.at(properties.place, "p0 and p1 are the same point")
    # Any direction across will do but for textures, which Mitsuba starts where its frame does.
    across = np.eye(3)[int(np.argmin(np.abs(along)))]
    frame = np.eye(4)
    z = along / length
    x = (
        np.array([1.0, 0.0, 0.0])
        if z[2] == 1.0
        else np.cross(across, z) / np.linalg.norm(np.cross(across, z))
    )
    frame[:3, :3] = np.column_stack([radius * x, radius * np.cross(z, x), along])
    frame[:3, 3] = start
    context.findings.note(properties.place, f"the cylinder became a mesh of {2 * shapes.AROUND} triangles")
    return _generated(context, properties, to_world @ frame, textured, "cylinder")


def _disk(context: Context, properties: Properties, to_world: Matrix, textured: bool) -> Placed:
    return _generated(context, properties, to_world, textured, "disk")


def _parallelogram(matrix: Matrix) -> Json:
    corner, right, top = (np.array([[-1, -1, 0, 1], [1, -1, 0, 1], [-1, 1, 0, 1]]) @ matrix.T)[:, :3]
    edges = {"edge_u": (right - corner).tolist(), "edge_v": (top - corner).tolist()}
    return {"type": "quad", "corner": corner.tolist(), **edges}


_FLAT = shapes.rectangle()
_RECTANGLE = Base("rectangle", Triangles(_FLAT.vertices, _FLAT.indices, None, None), _parallelogram)


def _rectangle(context: Context, properties: Properties, to_world: Matrix, textured: bool) -> Placed:
    is_mesh = textured or properties.has("flip_normals") or transforms.is_mirrored(to_world)
    placed = _generated(context, properties, to_world, textured, "rectangle")
    return placed if is_mesh else Placed(_RECTANGLE, to_world)


def _cube(context: Context, properties: Properties, to_world: Matrix, textured: bool) -> Placed:
    return _generated(context, properties, to_world, textured, "cube")


GENERATED: dict[str, Callable[[Context, Properties, Matrix, bool], Placed]] = {
    "sphere": _sphere,
    "cylinder": _cylinder,
    "disk": _disk,
    "rectangle": _rectangle,
    "cube": _cube,
}
"""By the type of a shape: context, parameters, placement, whether texture coordinates are needed."""
