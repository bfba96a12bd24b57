"""Shapes of pbrt's. All of them but whole spheres become meshes where they stand."""

import json
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import area_lights
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.media import interior
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.pbrt.read.tokens import decompressed
from nocturne_scene.formats.reading import shapes, subdivision, transforms, tubes
from nocturne_scene.formats.reading.crowds import Base, Crowds, Placed, ball
from nocturne_scene.formats.reading.scene_files import read_bytes
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.limits import MAX_ASSET_BYTES
from nocturne_scene.meshes.files import load_mesh, load_ply_columns
from nocturne_scene.meshes.headers import UnusableMeshError, check_counts
from nocturne_scene.meshes.triangles import Triangles, check_indices

_MAX_LEVELS = 12


def add_surface(
    context: Context, crowds: Crowds, kind: str, parameters: Parameters, *, of_object: bool = False
) -> None:
    """Add the surface of a `Shape` directive, where it is supported.

    `of_object`: it is part of an object, where pbrt has no area lights. Elsewhere curves are kept for
    `gathered`, as hair has one directive for each.
    """
    if kind not in _SHAPES:
        context.findings.lost(
            parameters.place, f'no support for the shape "{kind}"; there are {", ".join(sorted(_SHAPES))}'
        )
        return
    state = context.state
    kernel = state.material
    opacity = area_lights.opacity(context, parameters)
    named = (
        context.writer.document.get("kernels", {}).get(state.material)
        if isinstance(state.material, str)
        else None
    )
    shines = area_lights.shines(context, named or state.material, of_object=of_object)
    if opacity == 0.0 and shines:
        kernel = {"type": "null"}
    elif opacity != 1.0:
        kernel = {"type": "mask", "kernel": kernel, "opacity": opacity}
    found: Json = {"kernel": kernel}
    if kernel != {"type": "null"}:
        found |= state.normal_or_bump
    interior(context, parameters.place, found, kernel if named is None or isinstance(kernel, dict) else named)
    textured = any(word in json.dumps([found, named]) for word in ('"texture"', '"roughness_u"'))
    if kind == "curve" and not of_object:
        if shines:
            found["luminaire"] = area_lights.luminaire(context, opacity, kind, None)
        curve = _curve(context, parameters)
        context.curves.setdefault(json.dumps(found), []).append(curve)
        parameters.finish()
        return
    shape = _SHAPES[kind](context, parameters, textured)
    parameters.finish()
    if shines:
        found["luminaire"] = area_lights.luminaire(context, opacity, kind, shape)
    crowds.add(found, shape)


def gathered(context: Context) -> Iterator[Json]:
    """The surfaces of curves, one for all that look the same."""
    for looks, curves in context.curves.items():
        yield {**json.loads(looks), "shape": _tubes(context, curves)}


def _oriented(context: Context, mesh: Triangles, textured: bool) -> Triangles:
    """A mesh in its own coordinates, with what its surface needs."""
    if context.state.reversed:
        mesh = shapes.flipped(mesh)
    if mesh.coordinates is None and textured:
        # pbrt gives each triangle (0, 0), (1, 0), (1, 1).
        corner = mesh.indices.ravel()
        mesh = Triangles(
            mesh.vertices[corner],
            np.arange(len(corner)).reshape(-1, 3),
            None if mesh.normals is None else mesh.normals[corner],
            np.tile([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], (len(mesh.indices), 1)),
        )
    return mesh


def _placed(context: Context, mesh: Triangles, textured: bool, name: str) -> Json:
    mesh = shapes.transformed(_oriented(context, mesh, textured), context.to_world())
    context.extent.add(mesh.vertices)
    return context.writer.mesh(name, mesh)


def _generated(context: Context, matrix: Matrix, kind: str) -> Placed:
    """A shape that is made up, placed in the coordinates of now."""
    to_world = context.to_world() @ matrix
    base = _base(kind, context.state.reversed)
    context.extent.add(shapes.outline(kind) @ to_world[:3, :3].T + to_world[:3, 3])
    return Placed(base, to_world)


@cache
def _base(kind: str, is_reversed: bool) -> Base:
    """One for all that are alike, as those are put together that have the same one."""
    mesh = shapes.UNITS[kind]()
    return Base(kind, shapes.flipped(mesh) if is_reversed else mesh)


def _sphere(context: Context, parameters: Parameters, textured: bool) -> Placed:
    radius = float(parameters.number("radius", 1.0))
    whole = (-radius, radius, 360.0)
    given = tuple(
        parameters.number(name, value) for name, value in zip(("zmin", "zmax", "phimax"), whole, strict=True)
    )
    if given != whole:
        context.findings.lost(parameters.place, "no support for a part of a sphere; all of it is there")
    matrix = context.to_world()
    factor = transforms.similarity(matrix)
    if factor is not None and not textured and not context.state.reversed:
        centre = matrix[:3, 3]
        context.extent.add(np.array([centre - factor * radius, centre + factor * radius]))
        return ball(centre, factor * radius)
    return _generated(context, transforms.scaling([radius] * 3), "sphere")


def _curve(context: Context, parameters: Parameters) -> np.ndarray:
    """Points and radii along a curve where it stands, shape (n, 4)."""
    points = _rows(parameters, "P", 3)
    degree, basis = int(parameters.number("degree", 3)), parameters.word("basis", "bezier")
    form = parameters.word("type", "flat")
    if form == "ribbon":
        context.findings.lost(parameters.place, "no support for ribbons; taken as round")
    parameters.ignore("N", "splitdepth")
    if points is None or degree not in (2, 3) or basis not in tubes.BASES:
        raise InputError.at(
            parameters.place, 'a curve needs "P", a degree of 2 or 3, basis bezier or bspline'
        )
    width = parameters.number("width", 1.0)
    ends = [float(parameters.number(name, width)) for name in ("width0", "width1")]
    matrix = context.to_world()
    try:
        found = tubes.along(points @ matrix[:3, :3].T + matrix[:3, 3], degree, basis)
    except ValueError as error:
        raise InputError.at(parameters.place, str(error)) from None
    # What stretches is taken by its mean.
    scale = float(np.abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3))
    radii = scale / 2 * np.linspace(ends[0], ends[1], len(found))
    return np.hstack([found, radii[:, None]])


def _tubes(context: Context, curves: list[np.ndarray]) -> Json:
    mesh = tubes.tubes(curves)
    context.extent.add(mesh.vertices)
    context.findings.note("", f"{len(curves)} curves became a mesh of {len(mesh.indices)} triangles")
    return context.writer.mesh("curves", mesh)


def _single_curve(context: Context, parameters: Parameters, textured: bool) -> Json:
    del textured
    return _tubes(context, [_curve(context, parameters)])


def _disk(context: Context, parameters: Parameters, textured: bool) -> Placed:
    del textured  # it has coordinates
    radius, height = float(parameters.number("radius", 1.0)), float(parameters.number("height", 0.0))
    if parameters.number("innerradius", 0.0) != 0.0 or parameters.number("phimax", 360.0) != 360.0:
        context.findings.lost(parameters.place, "no support for a part of a disk; all of it is there")
    own = transforms.translation([0, 0, height]) @ transforms.scaling([radius, radius, 1.0])
    return _generated(context, own, "disk")


def _cylinder(context: Context, parameters: Parameters, textured: bool) -> Placed:
    del textured  # it has coordinates
    radius = float(parameters.number("radius", 1.0))
    low, high = float(parameters.number("zmin", -1.0)), float(parameters.number("zmax", 1.0))
    if parameters.number("phimax", 360.0) != 360.0:
        context.findings.lost(parameters.place, "no support for a part of a cylinder; all of it is there")
    own = transforms.translation([0, 0, low]) @ transforms.scaling([radius, radius, high - low])
    return _generated(context, own, "cylinder")


def _triangle_mesh(context: Context, parameters: Parameters, textured: bool) -> Json:
    points = _rows(parameters, "P", 3)
    if points is None:
        raise InputError.at(parameters.place, 'a mesh needs "P"')
    given = parameters.numbers("indices")
    if given is None and len(points) != 3:
        raise InputError.at(parameters.place, 'a mesh needs "indices"')
    indices = np.array([0, 1, 2] if given is None else given).astype(np.int64)
    if len(indices) % 3:
        raise InputError.at(parameters.place, '"indices" come in threes')
    parameters.ignore("S", "faceIndices")
    return _mesh(context, parameters, textured, points, indices.reshape(-1, 3))


def _bilinear_mesh(context: Context, parameters: Parameters, textured: bool) -> Json:
    points = _rows(parameters, "P", 3)
    if points is None:
        raise InputError.at(parameters.place, 'a mesh needs "P"')
    given = parameters.numbers("indices")
    indices = np.array([0, 1, 2, 3] if given is None else given).astype(np.int64)
    if len(indices) % 4:
        raise InputError.at(parameters.place, '"indices" come in fours')
    quads = indices.reshape(-1, 4)
    context.findings.note(parameters.place, "bilinear patches became two triangles each")
    split = np.concatenate([quads[:, [0, 1, 3]], quads[:, [0, 3, 2]]])
    return _mesh(context, parameters, textured, points, split)


def _mesh(
    context: Context, parameters: Parameters, textured: bool, points: transforms.Matrix, indices: np.ndarray
) -> Json:
    normals = _rows(parameters, "N", 3)
    coordinates = _rows(parameters, "uv", 2)
    if any(each is not None and len(each) != len(points) for each in (normals, coordinates)):
        raise InputError.at(parameters.place, '"N" and "uv" are as many as "P"')
    try:
        check_counts(len(points), len(indices))
        check_indices(len(points), indices)
    except UnusableMeshError as error:
        raise InputError.at(parameters.place, str(error)) from None
    mesh = shapes.facing_their_normals(Triangles(points, indices, normals, coordinates))
    return _placed(context, mesh, textured, "mesh")


def _loop_subdivision(context: Context, parameters: Parameters, textured: bool) -> Json:
    """Loop's surface, as the mesh of so many steps whose vertices lie on it."""
    points, given = _rows(parameters, "P", 3), parameters.numbers("indices")
    levels = parameters.whole("levels", 3)
    parameters.ignore("scheme")
    if points is None or given is None or len(given) % 3:
        raise InputError.at(parameters.place, 'a loopsubdiv needs "P", and "indices" in threes')
    triangles = np.array(given).astype(np.int64).reshape(-1, 3)
    try:
        check_indices(len(points), triangles)
        # Each step makes four of each triangle.
        if not 0 <= levels <= _MAX_LEVELS:
            raise InputError.at(parameters.place, f'"levels" lies between 0 and {_MAX_LEVELS}')
        check_counts(len(points), len(triangles) * 4**levels)
        mesh = subdivision.subdivided(points, triangles, levels)
    except (UnusableMeshError, ValueError) as error:
        raise InputError.at(parameters.place, str(error)) from None
    return _placed(context, mesh, textured, "subdivided")


def _rows(parameters: Parameters, name: str, columns: int) -> np.ndarray | None:
    values = parameters.numbers(name)
    if values is None:
        return None
    if len(values) % columns:
        raise InputError.at(parameters.place, f'"{name}" has {len(values)} numbers, no multiple of {columns}')
    return np.array(values).reshape(-1, columns)


def _ply_mesh(context: Context, parameters: Parameters, textured: bool) -> Json:
    name = parameters.word("filename", None)
    if name is None:
        raise InputError.at(parameters.place, 'a plymesh needs "filename"')
    if parameters.take("displacement") is not None:
        context.findings.lost(parameters.place, "no support for displaced triangles")
    parameters.ignore("edgelength")
    file = context.file(name, parameters.place)
    shown = context.files.shown(file)
    try:
        if file.suffix != ".gz":
            mesh = _read(file)
        else:
            plain = decompressed(read_bytes(file, MAX_ASSET_BYTES, shown), MAX_ASSET_BYTES, shown)
            with tempfile.TemporaryDirectory() as folder:
                unpacked = Path(folder) / "mesh.ply"
                unpacked.write_bytes(plain)
                mesh = _read(unpacked)
    except UnusableMeshError as error:
        raise InputError.at(shown, str(error)) from None
    return _placed(context, shapes.facing_their_normals(mesh), textured, Path(file.stem).stem)


def _read(file: Path) -> Triangles:
    """Without normals in the file, triangles are flat."""
    smooth = load_ply_columns(file, "vertex", ("nx", "ny", "nz")) is not None
    return load_mesh(file, "ply", normals=smooth)


_SHAPES: dict[str, Callable[[Context, Parameters, bool], Json | Placed]] = {
    "sphere": _sphere,
    "disk": _disk,
    "cylinder": _cylinder,
    "curve": _single_curve,
    "trianglemesh": _triangle_mesh,
    "bilinearmesh": _bilinear_mesh,
    "loopsubdiv": _loop_subdivision,
    "plymesh": _ply_mesh,
}
