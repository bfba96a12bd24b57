"""Surfaces, groups and instances as Mitsuba's shapes."""

from xml.etree.ElementTree import Element

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.mitsuba.write.context import Context
from nocturne_scene.formats.mitsuba.write.elements import matrix, plugin, reference, spectrum
from nocturne_scene.formats.mitsuba.write.materials import material
from nocturne_scene.formats.mitsuba.write.media import medium
from nocturne_scene.formats.reading import shapes
from nocturne_scene.formats.writing.compiled import Body


def add_surfaces(context: Context, around: Body) -> None:
    """Put all surfaces into the scene; `around` fills all of space."""
    message = context.compiled.message
    lit = {luminaire.surface: luminaire for luminaire in message.luminaires}
    groups: dict[int, Element] = {}
    for index, surface in enumerate(message.surfaces):
        shape = _shape(context, index, surface, lit.get(index), around)
        if surface.group == 0:
            context.root.append(shape)
            continue
        if surface.group not in groups:
            groups[surface.group] = plugin("shape", "shapegroup", id_=f"group{surface.group}")
            context.root.append(groups[surface.group])
        groups[surface.group].append(shape)
    for instance in message.instances:
        context.root.append(_instance(context, instance))


def _shape(
    context: Context,
    index: int,
    surface: scene_pb2.Surface,
    luminaire: scene_pb2.Luminaire | None,
    around: Body,
) -> Element:
    place = context.compiled.place(index)
    if surface.HasField("normal_map") or surface.HasField("bump_map"):
        context.findings.lost(place, "maps of normals and heights can't be exported")
    body = context.compiled.body(surface, place)
    found = _geometry(context, index, surface, place)
    found.append(material(context, surface, body, place))
    if body is not None:
        if around.media and body.index is None:
            context.findings.lost(place, "media in a medium that is everywhere can't be exported")
        found.extend(medium(context, body, "interior", f"{place}.interior"))
        found.extend(medium(context, around, "exterior", "$.unbounded_media"))
    if luminaire is not None:
        context.compiled.refuse_other_luminaires(luminaire, surface.group, f"{place}.luminaire")
        found.append(_emitter(context, luminaire, f"{place}.luminaire"))
    return found


def _geometry(context: Context, index: int, surface: scene_pb2.Surface, place: str) -> Element:
    match surface.WhichOneof("shape"):
        case "sphere":
            centre, radius = context.compiled.sphere(surface.sphere, place)
            if context.compiled.is_textured(surface):
                context.findings.lost(place, "textures on spheres can't be exported")
            found = plugin("shape", "sphere", radius=radius)
            x, y, z = (repr(float(value)) for value in centre)
            found.append(Element("point", {"name": "center", "x": x, "y": y, "z": z}))
            return found
        case "quad":
            # Its rectangle is [-1, 1]^2 in x and y.
            corner, u, v = context.compiled.quad(surface.quad)
            normal = np.cross(u, v)
            found = plugin("shape", "rectangle")
            axes = [u / 2, v / 2, normal / np.linalg.norm(normal)]
            found.append(matrix("to_world", axes, corner + (u + v) / 2))
            return found
    mesh = context.compiled.mesh(surface.mesh, place)
    name = context.writer.file(f"mesh{index}.ply", shapes.ply(mesh))
    return plugin("shape", "ply", filename=name, face_normals=mesh.normals is None)


def _emitter(context: Context, luminaire: scene_pb2.Luminaire, place: str) -> Element:
    if luminaire.two_sided:
        context.findings.lost(f"{place}.two_sided", "a luminaire with two sides is not supported by Mitsuba")
    found = plugin("emitter", "area")
    found.append(spectrum("radiance", context.compiled.table(luminaire.radiance.spectrum)))
    return found


def _instance(context: Context, instance: scene_pb2.Instance) -> Element:
    rows = context.compiled.placement(instance)
    found = plugin("shape", "instance")
    found.append(reference(f"group{instance.group}"))
    found.append(matrix("to_world", list(rows[:, :3].T), rows[:, 3]))
    return found
