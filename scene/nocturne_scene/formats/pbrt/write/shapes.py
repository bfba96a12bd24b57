"""Surfaces, groups and instances as pbrt's shapes and objects."""

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.pbrt.write.context import Context
from nocturne_scene.formats.pbrt.write.directives import (
    directive,
    light,
    placement,
    quoted,
    real,
    rows,
    switch,
    text,
    whole,
)
from nocturne_scene.formats.pbrt.write.materials import Material, material
from nocturne_scene.formats.pbrt.write.media import medium
from nocturne_scene.formats.reading import shapes
from nocturne_scene.formats.writing.compiled import Body


def add_surfaces(context: Context, around: Body) -> None:
    """Put all surfaces into the world; `around` fills all of space."""
    message = context.compiled.message
    lit = {luminaire.surface: luminaire for luminaire in message.luminaires}
    groups: dict[int, list[str]] = {}
    for index, surface in enumerate(message.surfaces):
        lines = _surface(context, index, surface, lit.get(index), around)
        if surface.group:
            groups.setdefault(surface.group, []).extend(lines)
        else:
            context.world.extend(lines)
    for group, lines in groups.items():
        name = quoted(f"group{group}")
        context.world += [directive("ObjectBegin", name), *lines, "ObjectEnd"]
    for instance in message.instances:
        matrix = context.compiled.placement(instance)
        context.world += [
            "AttributeBegin",
            directive("ConcatTransform", placement(matrix[:, :3].T, matrix[:, 3])),
            directive("ObjectInstance", quoted(f"group{instance.group}")),
            "AttributeEnd",
        ]


def _surface(
    context: Context,
    index: int,
    surface: scene_pb2.Surface,
    luminaire: scene_pb2.Luminaire | None,
    around: Body,
) -> list[str]:
    place = context.compiled.place(index)
    if surface.HasField("normal_map") or surface.HasField("bump_map"):
        context.findings.lost(place, "maps of normals and heights can't be exported")
    body = context.compiled.body(surface, place)
    made = material(context, surface, body, place)
    lines = ["AttributeBegin"]
    if body is not None:
        lines.append(_boundary(context, surface, body, around, place))
    lines.append(made.line)
    if luminaire is not None:
        lines.append(_luminaire(context, surface, luminaire, made, f"{place}.luminaire"))
    return [*lines, *_shape(context, index, surface, made, place), "AttributeEnd"]


def _boundary(context: Context, surface: scene_pb2.Surface, body: Body, around: Body, place: str) -> str:
    if surface.group:
        context.findings.lost(place, "bodies in groups can't be exported")
    if around.media and body.index is None:
        context.findings.lost(place, "media in a medium that is everywhere can't be exported")
    inside = medium(context, body, f"{place}.interior")
    outside = medium(context, around, "$.unbounded_media")
    return directive("MediumInterface", quoted(inside), quoted(outside))


def _luminaire(
    context: Context,
    surface: scene_pb2.Surface,
    luminaire: scene_pb2.Luminaire,
    made: Material,
    place: str,
) -> str:
    context.compiled.refuse_other_luminaires(luminaire, surface.group, place)
    if made.is_interface or made.opacity:
        context.findings.lost(place, "a luminaire that lets light through is not supported by pbrt")
    radiance = light("L", context.compiled.table(luminaire.radiance.spectrum))
    return directive("AreaLightSource", quoted("diffuse"), *radiance, switch("twosided", luminaire.two_sided))


def _shape(context: Context, index: int, surface: scene_pb2.Surface, made: Material, place: str) -> list[str]:
    opacity = [made.opacity] if made.opacity else []
    match surface.WhichOneof("shape"):
        case "sphere":
            centre, radius = context.compiled.sphere(surface.sphere, place)
            if context.compiled.is_textured(surface):
                context.findings.lost(place, "textures on spheres can't be exported")
            return [
                directive("Translate", *centre),
                directive("Shape", quoted("sphere"), real("radius", radius), *opacity),
            ]
        case "quad":
            corner, u, v = context.compiled.quad(surface.quad)
            points = np.array([corner, corner + u, corner + u + v, corner + v])
            coordinates = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
            return [
                directive(
                    "Shape",
                    quoted("trianglemesh"),
                    whole("indices", 0, 1, 2, 0, 2, 3),
                    rows("point3", "P", points),
                    rows("point2", "uv", coordinates),
                    *opacity,
                )
            ]
    mesh = context.compiled.mesh(surface.mesh, place)
    name = context.writer.file(f"mesh{index}.ply", shapes.ply(mesh))
    return [directive("Shape", quoted("plymesh"), text("filename", name), *opacity)]
