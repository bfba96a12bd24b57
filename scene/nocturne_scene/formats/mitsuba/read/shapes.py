"""Mitsuba's shape plugins as surfaces, those of files as meshes where they stand."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import attributes, textures
from nocturne_scene.formats.mitsuba.read.bsdfs import bsdf, front_only
from nocturne_scene.formats.mitsuba.read.context import Bsdf, Context
from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.generated import GENERATED
from nocturne_scene.formats.mitsuba.read.media import interior
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.mitsuba.read.serialized import read_serialized
from nocturne_scene.formats.mitsuba.read.units import white
from nocturne_scene.formats.reading import shapes, transforms, tubes
from nocturne_scene.formats.reading.baking import LOOKUP, bake
from nocturne_scene.formats.reading.crowds import Crowds, Placed
from nocturne_scene.formats.reading.scene_files import read_bytes, read_text
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


def add_shape(context: Context, element: Element) -> None:
    """Put a shape into the scene."""
    if element.type == "shapegroup":
        return  # made when an instance needs it
    if element.type == "instance":
        _instance(context, element)
        return
    _add(context, context.crowds, element, IDENTITY)


def _add(context: Context, crowds: Crowds, element: Element, outer: Matrix) -> None:
    """Add the surface of one shape, `outer` being what places it once more."""
    properties = context.properties(element)
    if element.type not in _SHAPES and element.type not in GENERATED:
        known = ", ".join(sorted((*_SHAPES, *GENERATED)))
        context.findings.lost(element.place, f'no support for the shape "{element.type}"; there are {known}')
        return
    material = _material(context, properties)
    to_world = outer @ properties.transform("to_world")
    shape: Json | Placed
    if element.type in GENERATED:
        shape = GENERATED[element.type](context, properties, to_world, material.textured)
    else:
        shape = _SHAPES[element.type](context, properties, to_world, material)
    if properties.element.id:
        material.surface["name"] = properties.element.id
    properties.finish()
    crowds.add(material.surface, shape)


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
            context.findings.lost(emitter.place, f'no support for the emitter "{emitter.type}" on a shape')
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
    file = context.file(properties, f"a shape of type {properties.element.type}")
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
        context.findings.lost(properties.place, "of several attributes on a mesh only one is supported")
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
    file = context.file(properties, f"a shape of type {properties.element.type}")
    number = properties.whole("shape_index", 0)
    content = read_bytes(file, MAX_ASSET_BYTES, context.tree.files.shown(file))
    mesh = read_serialized(content, number, properties.place)
    if mesh.coordinates is not None and not properties.switch("flip_tex_coords", False):
        mesh = Triangles(mesh.vertices, mesh.indices, mesh.normals, _turned_over(mesh.coordinates))
    return _mesh(context, properties, to_world, material, shapes.facing_their_normals(mesh), file.stem)


def _curves(context: Context, properties: Properties, to_world: Matrix, material: _Material) -> Json:
    """Control points and radii, a line for each; empty lines between curves."""
    file = context.file(properties, f"a shape of type {properties.element.type}")
    shown = context.tree.files.shown(file)
    curves: list[list[list[float]]] = [[]]
    for number, line in enumerate(read_text(file, shown).split("\n")):
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


def _instance(context: Context, element: Element) -> None:
    properties = context.properties(element)
    groups = [each for each in properties.take_all("shape") if each.type == "shapegroup"]
    to_world = properties.transform("to_world")
    properties.finish()
    if len(groups) != 1 or not groups[0].id:
        raise InputError.at(element.place, "an instance refers to one shapegroup")
    group = groups[0]
    if not transforms.is_even(to_world):
        context.findings.note(element.place, "an instance that is stretched or mirrored became a copy")
        _add_members(context, context.crowds, group, to_world)
        return
    if group.id not in context.groups:
        crowds = Crowds(context.writer, context.findings)
        _add_members(context, crowds, group, IDENTITY)
        members = [each for found in crowds.written() for each in found]
        context.groups[group.id] = context.writer.name("groups", group.id, members) if members else ""
    if context.groups[group.id]:
        context.crowds.instance(context.groups[group.id], to_world)


def _add_members(context: Context, crowds: Crowds, group: Element, outer: Matrix) -> None:
    properties = context.properties(group)
    members = properties.take_all("shape")
    properties.finish()
    for member in chain(members, context.tree.members(group)):
        _add(context, crowds, member, outer)


_SHAPES: dict[str, Callable[[Context, Properties, Matrix, _Material], Json]] = {
    "obj": _mesh_file,
    "ply": _mesh_file,
    "serialized": _serialized,
    "bsplinecurve": _curves,
    "linearcurve": _curves,
}
