"""Mitsuba's shape plugins as surfaces. All but spheres and rectangles become meshes where they stand."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import attributes, textures
from nocturne_scene.formats.mitsuba.read.bsdfs import Bsdf, bsdf, front_only
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.media import interior
from nocturne_scene.formats.mitsuba.read.properties import Properties, numbers
from nocturne_scene.formats.mitsuba.read.serialized import read_serialized
from nocturne_scene.formats.mitsuba.read.units import white
from nocturne_scene.formats.reading import shapes, transforms, tubes
from nocturne_scene.formats.reading.baking import LOOKUP, bake
from nocturne_scene.formats.reading.scene_files import TEXT_BYTES, read_bytes
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.formats.reading.transforms import IDENTITY, Matrix
from nocturne_scene.limits import MAX_ASSET_BYTES
from nocturne_scene.meshes.files import load_mesh
from nocturne_scene.meshes.headers import UnusableMeshError
from nocturne_scene.meshes.triangles import Triangles


@dataclass
class _Material:
    """A surface that has no shape yet."""

    surface: Json
    textured: bool
    """Whether it needs texture coordinates."""


_DEFAULT = Bsdf(front_only({"type": "lambertian", "reflectance": 0.5}))
_OF_LAMPS = Bsdf({"type": "lambertian", "reflectance": 0.0})
"""What nothing is said of: a lamp reflects nothing then."""

# The faces of a cube from -1 to 1: the corner at u = v = 0, and the edges along u and v (v down the picture).
_CUBE = (
    ((-1, -1, -1), (0, 0, 2), (2, 0, 0)),
    ((1, 1, 1), (-2, 0, 0), (0, 0, -2)),
    ((1, -1, 1), (0, 2, 0), (0, 0, -2)),
    ((-1, -1, 1), (0, 2, 0), (2, 0, 0)),
    ((-1, -1, -1), (0, 2, 0), (0, 0, 2)),
    ((-1, 1, -1), (0, -2, 0), (2, 0, 0)),
)


def add_shape(context: Context, element: Element) -> None:
    """Put a shape into the scene."""
    if element.type == "shapegroup":
        return  # made when an instance needs it
    if element.type == "instance":
        _instance(context, element)
        return
    for surface in surfaces(context, element, IDENTITY):
        context.writer.add("surfaces", surface)


def surfaces(context: Context, element: Element, outer: Matrix) -> list[Json]:
    """Return the surfaces of one shape, `outer` being what places it once more."""
    properties = context.properties(element)
    if element.type not in _SHAPES:
        context.findings.lost(
            element.place, f'no equal of the shape "{element.type}"; there are {", ".join(sorted(_SHAPES))}'
        )
        return []
    material = _material(context, properties)
    to_world = outer @ properties.transform("to_world")
    shape = _SHAPES[element.type](context, properties, to_world, material)
    if properties.element.id:
        material.surface["name"] = properties.element.id
    properties.finish()
    return [{**material.surface, "shape": shape}]


def _material(context: Context, properties: Properties) -> _Material:
    found = properties.take_all("bsdf")
    if len(found) > 1:
        raise InputError.at(properties.place, f"a shape has one material, found {len(found)}")
    emitters = properties.take_all("emitter")
    unsaid = _OF_LAMPS if emitters else _DEFAULT
    material = bsdf(context, found[0]) if found else unsaid
    surface: Json = {"kernel": _named(context, found, material), **material.normal_or_bump}
    interior(context, properties, surface, material.kernel)
    if len(emitters) > 1:
        raise InputError.at(properties.place, f"a shape has one emitter, found {len(emitters)}")
    for emitter in emitters:
        if emitter.type != "area":
            context.findings.lost(emitter.place, f'no equal of the emitter "{emitter.type}" on a shape')
            continue
        inner = context.properties(emitter)
        radiance = textures.light(context, inner, "radiance", {"illuminant": "D65", "luminance": white()})
        surface["luminaire"] = {"radiance": radiance}
        inner.ignore("sampling_weight")
        inner.finish()
    written = json.dumps([material.kernel, surface])
    return _Material(surface, '"texture"' in written or '"roughness_u"' in written)


def _named(context: Context, found: list[Element], material: Bsdf) -> Json:
    """Kernels that several shapes share are written once."""
    if not found or not found[0].id or attributes.wanted(material.kernel):
        return material.kernel
    name = found[0].id
    if name not in context.bsdfs:
        context.bsdfs[name] = context.writer.name("kernels", name, material.kernel)
    return context.bsdfs[name]


def _file(properties: Properties, context: Context) -> Path:
    name = properties.text("filename", None)
    if name is None:
        raise InputError.at(properties.place, f'a shape of type {properties.element.type} needs "filename"')
    return context.tree.file(properties.element, name)


def _mesh(
    context: Context,
    properties: Properties,
    to_world: Matrix,
    material: _Material,
    mesh: Triangles,
    name: str,
) -> Json:
    """The shape of a mesh in its own coordinates; v goes up the picture."""
    mesh = shapes.transformed(mesh, to_world)
    if properties.switch("flip_normals", False):
        mesh = shapes.flipped(mesh)
    if properties.switch("face_normals", False):
        mesh = Triangles(mesh.vertices, mesh.indices, None, mesh.coordinates)
    if mesh.coordinates is None and material.textured:
        # Mitsuba says (0, 0) everywhere.
        mesh = Triangles(mesh.vertices, mesh.indices, mesh.normals, np.zeros((len(mesh.vertices), 2)))
    if len(mesh.vertices) == 0:
        raise InputError.at(properties.place, "the mesh is empty")
    context.extent.add(mesh.vertices)
    return context.writer.mesh(name, mesh)


def _mesh_file(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    kind = "obj" if properties.element.type == "obj" else "ply"
    file = _file(properties, context)
    # Of a file with v up the picture, as OBJ has it, nothing is to be turned over.
    upwards = properties.switch("flip_tex_coords", kind == "obj")
    if (file, kind) not in context.meshes:
        try:
            context.meshes[file, kind] = load_mesh(file, "obj" if kind == "obj" else "ply", normals=True)
        except UnusableMeshError as error:
            raise InputError.at(properties.place, str(error)) from None
    mesh = context.meshes[file, kind]
    wanted = sorted(attributes.wanted(material.surface))
    if len(wanted) > 1:
        context.findings.lost(properties.place, "of several attributes on a mesh only one has an equal")
    for attribute in wanted[:1]:
        corners = attributes.read_ply(file, attribute, mesh) if kind == "ply" else None
        if corners is None:
            raise InputError.at(properties.place, f'the mesh has no attribute "{attribute}"')
        mesh, picture = bake(mesh, corners, attribute)
        asset = context.writer.picture(attribute, picture)
        texture = context.writer.name("textures", attribute, {"asset": asset, "encoding": "linear", **LOOKUP})
        material.surface = attributes.renamed(material.surface, attribute, texture)
        upwards = True
    if mesh.coordinates is not None and not upwards:
        mesh = Triangles(mesh.vertices, mesh.indices, mesh.normals, _turned_over(mesh.coordinates))
    return _mesh(context, properties, to_world, material, shapes.facing_their_normals(mesh), file.stem)


def _turned_over(coordinates: Matrix) -> Matrix:
    return np.stack([coordinates[:, 0], 1 - coordinates[:, 1]], 1)


def _serialized(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    file = _file(properties, context)
    number = properties.whole("shape_index", 0)
    content = read_bytes(file, MAX_ASSET_BYTES, context.tree.files.shown(file))
    mesh = read_serialized(content, number, properties.place)
    if mesh.coordinates is not None and not properties.switch("flip_tex_coords", False):
        mesh = Triangles(mesh.vertices, mesh.indices, mesh.normals, _turned_over(mesh.coordinates))
    return _mesh(context, properties, to_world, material, shapes.facing_their_normals(mesh), file.stem)


def _sphere(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    radius = properties.number("radius", 1.0)
    centre = properties.vector("center") or [0.0, 0.0, 0.0]
    placed = to_world @ transforms.translation(centre) @ transforms.scaling([radius] * 3)
    factor = transforms.similarity(placed)
    if factor is not None and not material.textured and not properties.has("flip_normals"):
        middle = placed[:3, 3]
        context.extent.add(np.array([middle - factor, middle + factor]))
        return {"type": "sphere", "centre": middle.tolist(), "radius": factor}
    context.findings.note(
        properties.place, f"the sphere became a mesh of {2 * shapes.AROUND * shapes.ALONG} triangles"
    )
    return _mesh(context, properties, placed, material, shapes.sphere(), "sphere")


def _cylinder(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
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
    return _mesh(context, properties, to_world @ frame, material, shapes.cylinder(), "cylinder")


def _curves(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    """Control points and radii, a line for each; empty lines between curves."""
    file = _file(properties, context)
    shown = context.tree.files.shown(file)
    text = read_bytes(file, TEXT_BYTES, shown).decode("utf-8", "replace")
    curves: list[list[list[float]]] = [[]]
    for number, line in enumerate(text.split("\n")):
        if line.strip():
            curves[-1].append(numbers(line, f"{shown}:{number + 1}", 4))
        elif curves[-1]:
            curves.append([])
    is_spline = properties.element.type == "bsplinecurve"
    found = [np.array(curve) for curve in curves if len(curve) >= (4 if is_spline else 2)]
    if not found:
        raise InputError.at(shown, f"has no curve of {4 if is_spline else 2} points")
    for curve in found:
        # Radii stay as they are, whatever the scale.
        curve[:, :3] = curve[:, :3] @ to_world[:3, :3].T + to_world[:3, 3]
    mesh = (
        tubes.tubes([tubes.along(curve, 3, "bspline") for curve in found])
        if is_spline
        else tubes.beads(found)
    )
    context.findings.note(
        properties.place, f"{len(found)} curves became a mesh of {len(mesh.indices)} triangles"
    )
    return _mesh(context, properties, IDENTITY, material, mesh, file.stem)


def _disk(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    return _mesh(context, properties, to_world, material, shapes.disc(), "disk")


def _rectangle(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    if material.textured or properties.has("flip_normals") or transforms.is_mirrored(to_world):
        return _mesh(context, properties, to_world, material, shapes.rectangle(), "rectangle")
    corners = np.array([[-1, -1, 0, 1], [1, -1, 0, 1], [-1, 1, 0, 1]]) @ to_world.T
    corner, right, top = corners[:, :3]
    context.extent.add(np.array([corner, right, top, right + top - corner]))
    edges = {"edge_u": (right - corner).tolist(), "edge_v": (top - corner).tolist()}
    return {"type": "quad", "corner": corner.tolist(), **edges}


def _cube(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    vertices, coordinates, normals = [], [], []
    for corner, u, v in np.array(_CUBE, dtype=np.float64):
        vertices += [corner, corner + u, corner + u + v, corner + v]
        coordinates += [[0, 1], [1, 1], [1, 0], [0, 0]]
        normals += [np.cross(v, u)] * 4
    first = np.arange(0, 24, 4)[:, None]
    indices = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])
    mesh = Triangles(np.array(vertices), indices, np.array(normals), np.array(coordinates, dtype=np.float64))
    flat = Triangles(*vars(shapes.facing_their_normals(mesh)).values())
    mesh = Triangles(flat.vertices, flat.indices, None, flat.coordinates)
    return _mesh(context, properties, to_world, material, mesh, "cube")


def _instance(context: Context, element: Element) -> None:
    properties = context.properties(element)
    groups = [each for each in properties.take_all("shape") if each.type == "shapegroup"]
    to_world = properties.transform("to_world")
    properties.finish()
    if len(groups) != 1 or not groups[0].id:
        raise InputError.at(element.place, "an instance refers to one shapegroup")
    group = groups[0]
    factor = transforms.similarity(to_world)
    if factor is None or transforms.is_mirrored(to_world):
        context.findings.note(element.place, "an instance that is stretched or mirrored became a copy")
        for surface in _members(context, group, to_world):
            context.writer.add("surfaces", surface)
        return
    if group.id not in context.groups:
        members = _members(context, group, IDENTITY)
        if not members:
            return
        context.groups[group.id] = context.writer.name("groups", group.id, members)
    instance: Json = {
        "group": context.groups[group.id],
        "translate": to_world[:3, 3].tolist(),
        "scale": factor,
    }
    turn = transforms.rotation_of(to_world[:3, :3] / factor)
    if turn is not None:
        instance["rotate"] = {"axis": turn[0], "degrees": turn[1]}
    context.writer.add("instances", instance)


def _members(context: Context, group: Element, outer: Matrix) -> list[Json]:
    properties = context.properties(group)
    members = properties.take_all("shape")
    properties.finish()
    return [surface for member in members for surface in surfaces(context, member, outer)]


_SHAPES: dict[str, Callable[[Context, Properties, Matrix, _Material], Json]] = {
    "obj": _mesh_file,
    "ply": _mesh_file,
    "serialized": _serialized,
    "sphere": _sphere,
    "cylinder": _cylinder,
    "bsplinecurve": _curves,
    "linearcurve": _curves,
    "disk": _disk,
    "rectangle": _rectangle,
    "cube": _cube,
}
