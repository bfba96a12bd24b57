"""A whole scene for pbrt."""

import math

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.film import Film
from nocturne_scene.formats.pbrt import squares
from nocturne_scene.formats.pbrt.write.context import Context
from nocturne_scene.formats.pbrt.write.directives import (
    directive,
    light,
    placement,
    quoted,
    real,
    text,
    whole,
)
from nocturne_scene.formats.pbrt.write.media import medium
from nocturne_scene.formats.pbrt.write.shapes import add_surfaces
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.writing import skies
from nocturne_scene.formats.writing.compiled import Body, Compiled, array
from nocturne_scene.formats.writing.placed_bodies import refuse_bodies_across_film, refuse_overlaps
from nocturne_scene.formats.writing.tables import Array

_ABOUT = "# For pbrt-v4. Its image's Y is the luminance in cd/m2."

# Interactions that are followed where ours have no limit.
_NO_LIMIT = 100_000


def export_pbrt(compiled: Compiled, writer: SceneWriter, film: Film) -> str:
    """Write scene.pbrt and its files; return its name. Losses are among the findings."""
    context = Context(compiled, writer, compiled.findings)
    refuse_overlaps(compiled)
    compiled.refuse_other_sensors()
    refuse_bodies_across_film(compiled, film)
    around = compiled.everywhere()
    add_surfaces(context, around)
    _add_environment(context)
    image = _image(compiled, film)
    camera = _camera(context, film, around)
    lines = [_ABOUT, *image, *context.head, *camera, "WorldBegin", *context.world]
    return writer.file("scene.pbrt", ("\n".join(lines) + "\n").encode())


def _image(compiled: Compiled, film: Film) -> list[str]:
    # Both count interactions.
    depth = compiled.message.tracing.maximum_depth or _NO_LIMIT
    return [
        directive("Integrator", quoted("volpath"), whole("maxdepth", depth)),
        directive("Sampler", quoted("independent"), whole("pixelsamples", film.samples)),
        directive("PixelFilter", quoted("box")),
        directive(
            "Film",
            quoted("rgb"),
            text("filename", "image.exr"),
            whole("xresolution", film.width),
            whole("yresolution", film.height),
        ),
    ]


def _camera(context: Context, film: Film, around: Body) -> list[str]:
    """The directives after all media, of which the camera is in one."""
    sensor = context.compiled.message.sensor
    position = context.compiled.point(sensor.position)
    axes = [array(sensor.right), array(sensor.up), array(sensor.forward)]
    # Its field of view is that of the shorter side.
    shorter = min(1.0, film.width / film.height)
    half = math.tan(sensor.vertical_field_of_view / 2) * shorter
    degrees = real("fov", math.degrees(2 * math.atan(half)))
    match sensor.model:
        case scene_pb2.SENSOR_MODEL_PERSPECTIVE if sensor.lens_radius > 0:
            lens = [real("lensradius", sensor.lens_radius), real("focaldistance", sensor.focus_distance)]
            camera = directive("Camera", quoted("perspective"), degrees, *lens)
        case scene_pb2.SENSOR_MODEL_PERSPECTIVE:
            camera = directive("Camera", quoted("perspective"), degrees)
        case scene_pb2.SENSOR_MODEL_ORTHOGRAPHIC:
            axes = [0.5 * sensor.height * shorter * axis for axis in axes[:2]] + axes[2:]
            camera = directive("Camera", quoted("orthographic"))
        case model:
            name = scene_pb2.SensorModel.Name(model).removeprefix("SENSOR_MODEL_").lower()
            context.findings.lost("$.sensor", f"a sensor of the kind {name} can't be exported")
            return []
    inverse = np.linalg.inv(np.array(axes).T)
    inside = medium(context, *context.compiled.around_sensor(around))
    return [
        directive("MediumInterface", quoted(""), quoted(inside)),
        directive("Transform", placement(inverse.T, -inverse @ position)),
        camera,
    ]


def _add_environment(context: Context) -> None:
    message = context.compiled.message
    if message.distant_discs:
        context.findings.lost("$.distant", "discs at infinity are not supported by pbrt")
    match message.environment.WhichOneof("radiance"):
        case "constant":
            radiance = light("L", context.compiled.table(message.environment.constant))
            context.world.append(directive("LightSource", quoted("infinite"), *radiance))
        case "map" if isinstance(context.compiled.document.environment, StandardSky | WeatherSky):
            context.findings.lost("$.environment", "a formula's sky can't be exported; use a picture of it")
        case "map":
            context.world += _sky(context, message.environment.map)


def _sky(context: Context, frame: scene_pb2.EnvironmentMap) -> list[str]:
    environment = context.compiled.document.environment
    assert isinstance(environment, EnvironmentMap)  # noqa: S101 - it was compiled to a map
    texels: Array = skies.texels_of(environment, context.compiled.blobs)
    name = context.writer.picture("sky", squares.equal_area_square(texels))
    axes = [array(axis) for axis in (frame.x, frame.y, frame.z)]
    return [
        "AttributeBegin",
        directive("ConcatTransform", placement(axes, np.zeros(3))),
        directive(
            "LightSource",
            quoted("infinite"),
            text("filename", name),
            real("scale", environment.luminance),
        ),
        "AttributeEnd",
    ]
