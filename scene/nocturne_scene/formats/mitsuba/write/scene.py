"""A whole scene for Mitsuba."""

import math
from xml.etree.ElementTree import Comment, Element

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.sensors import unit
from nocturne_scene.document.luminaires import EnvironmentMap
from nocturne_scene.document.skies import StandardSky, WeatherSky
from nocturne_scene.film import Film
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT, white
from nocturne_scene.formats.mitsuba.write.context import Context
from nocturne_scene.formats.mitsuba.write.elements import matrix, parameter, plugin, spectrum, write
from nocturne_scene.formats.mitsuba.write.media import medium
from nocturne_scene.formats.mitsuba.write.shapes import add_surfaces
from nocturne_scene.formats.reading.scene_writer import SceneWriter
from nocturne_scene.formats.writing import skies
from nocturne_scene.formats.writing.compiled import Body, Compiled, array
from nocturne_scene.formats.writing.placed_bodies import refuse_bodies_across_film, refuse_overlaps
from nocturne_scene.formats.writing.tables import Table
from nocturne_scene.spectra.published import visible_wavelengths

# Its rays start this far, and as much of their coordinates, from where they left a surface: 1500 times the
# rounding of a float, RayEpsilon in its include/mitsuba/core/math.h. Scenes are written so large that only
# the second counts.
_LARGE = 1000.0
_FAR = 100.0

# Of a disc at infinity, in sizes of the scene: directions to it differ by this part of a radian.
_DISTANCE = 1e4
_WIDEST = math.radians(80)

# Vertices before its roulette, which ends one path in twenty at every further vertex, whatever its weight: so
# early that paths in milk are ended often, it makes the few that go on too bright to average.
_ROULETTE = 1000

_ABOUT = f""" Render it with a spectral variant, such as
    mitsuba -m scalar_spectral -Dspp=64 -Dsampler=multijitter scene.xml
  Its image's Y times {CANDELAS_PER_UNIT:.7g} is the luminance in cd/m2. One metre is {{metre:g}} units. """


def export_mitsuba(compiled: Compiled, writer: SceneWriter, film: Film) -> str:
    """Write scene.xml and its files; return its name. Losses are among the findings."""
    compiled.renderer = "Mitsuba"
    compiled.metre = max(1.0, 10.0 ** math.ceil(math.log10(_LARGE / compiled.size())))
    root = Element("scene", {"version": "3.0.0"})
    root.append(Comment(_ABOUT.format(metre=compiled.metre)))
    for name, value in (("spp", str(film.samples)), ("sampler", "independent")):
        root.append(Element("default", {"name": name, "value": value}))
    context = Context(compiled, writer, compiled.findings, root)
    refuse_overlaps(compiled)
    compiled.refuse_other_sensors()
    refuse_bodies_across_film(compiled, film)
    around = compiled.everywhere()
    root.append(_integrator(compiled))
    root.append(_sensor(context, film, around))
    add_surfaces(context, around)
    _add_environment(context)
    _count_all_paths(context)
    return writer.file("scene.xml", write(root))


def _integrator(compiled: Compiled) -> Element:
    message = compiled.message
    depth = message.tracing.maximum_depth
    # It counts edges, of which there is one more than interactions.
    edges = depth + 1 if depth else -1
    coefficients = [index for each in message.media for index in (each.absorption, each.scattering)]
    coefficients += [each.absorption for each in message.interiors if each.HasField("absorption")]
    if coefficients:
        # By multiple importance sampling over wavelengths, extinction may depend on them. It costs up to a
        # quarter more where it does not.
        grey = all(compiled.table(index).constant is not None for index in coefficients)
        return plugin("integrator", "volpath" if grey else "volpathmis", max_depth=edges, rr_depth=_ROULETTE)
    return plugin("integrator", "path", max_depth=edges)


def _sensor(context: Context, film: Film, around: Body) -> Element:
    compiled = context.compiled
    sensor = compiled.message.sensor
    position, forward = compiled.point(sensor.position), array(sensor.forward)
    # Its x points to the left.
    axes = [-array(sensor.right), array(sensor.up), forward]
    degrees = math.degrees(sensor.vertical_field_of_view)
    match sensor.model:
        case scene_pb2.SENSOR_MODEL_PERSPECTIVE if sensor.lens_radius > 0:
            found = plugin(
                "sensor",
                "thinlens",
                fov=degrees,
                fov_axis="y",
                aperture_radius=compiled.metre * sensor.lens_radius,
                focus_distance=compiled.metre * sensor.focus_distance,
            )
        case scene_pb2.SENSOR_MODEL_PERSPECTIVE:
            found = plugin("sensor", "perspective", fov=degrees, fov_axis="y")
        case scene_pb2.SENSOR_MODEL_ORTHOGRAPHIC:
            # It sees -1 to 1 in x, and as much in y as the film's shape gives.
            half_width = 0.5 * compiled.metre * sensor.height * film.width / film.height
            axes = [half_width * axes[0], half_width * axes[1], forward]
            found = plugin("sensor", "orthographic")
        case scene_pb2.SENSOR_MODEL_PLANE:
            found = plugin("sensor", "irradiancemeter")
        case model:
            name = scene_pb2.SensorModel.Name(model).removeprefix("SENSOR_MODEL_").lower()
            context.findings.lost("$.sensor", f"a sensor of the kind {name} can't be exported")
            found = plugin("sensor", "perspective")
    if sensor.model != scene_pb2.SENSOR_MODEL_PLANE:
        # Else it sees no farther than 10,000.
        far = _DISTANCE if compiled.message.distant_discs else 1.0
        parameter(found, "far_clip", _FAR * far * compiled.size())
        found.append(matrix("to_world", axes, position))
    pixels = plugin(
        "film",
        "hdrfilm",
        width=film.width,
        height=film.height,
        pixel_format="xyz",
        component_format="float32",
    )
    pixels.append(plugin("rfilter", "box"))
    sampler = plugin("sampler", "$sampler", sample_count="$spp")
    sampler[0].tag = "integer"
    body, place = compiled.around_sensor(around)
    found.extend([pixels, sampler, *medium(context, body, "", place)])
    return _plane(context, film, found) if sensor.model == scene_pb2.SENSOR_MODEL_PLANE else found


def _plane(context: Context, film: Film, meter: Element) -> Element:
    """A rectangle that light does not notice, with a meter on it; its first row is that of the lowest y."""
    sensor = context.compiled.message.sensor
    half = 0.5 * context.compiled.metre * sensor.height
    axes = [half * film.width / film.height * array(sensor.right), -half * array(sensor.up)]
    found = plugin("shape", "rectangle")
    found.append(matrix("to_world", [*axes, array(sensor.forward)], context.compiled.point(sensor.position)))
    found.extend([plugin("bsdf", "null"), meter])
    return found


def _add_environment(context: Context) -> None:
    message = context.compiled.message
    for disc in message.distant_discs:
        context.root.append(_disc(context, disc))
    match message.environment.WhichOneof("radiance"):
        case "constant":
            found = plugin("emitter", "constant")
            found.append(spectrum("radiance", context.compiled.table(message.environment.constant)))
            context.root.append(found)
        case "map" if isinstance(context.compiled.document.environment, StandardSky | WeatherSky):
            context.findings.lost("$.environment", "a formula's sky can't be exported; use a picture of it")
        case "map":
            context.root.append(_sky(context, message.environment.map))


def _count_all_paths(context: Context) -> None:
    """A sky of no light where there is no other and light passes a surface straight.

    A path of Mitsuba (3.9.1: `valid_ray` in src/integrators/path.cpp and volpath.cpp) that is turned by no
    surface is black unless the scene has a sky, also where it sees a lamp on a surface of the kind `null` and
    where next event estimation at a surface with a mask has found light before the path passed the mask.
    """
    emitters = {each.get("type") for each in context.root.iter("emitter")}
    straight = {"null", "mask"} & {each.get("type") for each in context.root.iter("bsdf")}
    if straight and not emitters & {"constant", "envmap"}:
        found = plugin("emitter", "constant")
        found.append(spectrum("radiance", Table(np.zeros(1))))
        context.root.append(found)


def _disc(context: Context, disc: scene_pb2.DistantDisc) -> Element:
    """A disc far away, even; where ours is darker towards its edge, with the same light in all."""
    compiled = context.compiled
    if disc.half_angle > _WIDEST:
        context.findings.lost("$.distant", "a disc wider than 160 degrees is not supported by Mitsuba")
    table = compiled.table(disc.radiance)
    if disc.limb_plus:
        context.findings.note("$.distant", "limb darkening is left out: an even disc of the same light")
        at = visible_wavelengths()
        # Of mu^k over a disc.
        part = sum(
            2 / (power + 2) * (compiled.table(plus).at(at) - compiled.table(minus).at(at))
            for power, (plus, minus) in enumerate(zip(disc.limb_plus, disc.limb_minus, strict=True))
        )
        table = Table.visible(table.at(at) * part)
    forward = -array(disc.direction)
    right = unit(np.cross(forward, np.eye(3)[np.argmin(np.abs(forward))]))
    distance = _DISTANCE * compiled.size()
    radius = distance * math.tan(disc.half_angle)
    found = plugin("shape", "disk")
    axes = [radius * right, radius * np.cross(forward, right), forward]
    found.append(matrix("to_world", axes, -distance * forward))
    emitter = plugin("emitter", "area")
    emitter.append(spectrum("radiance", table))
    # The sky or another disc behind it adds its light.
    found.extend([plugin("bsdf", "null"), emitter])
    return found


def _sky(context: Context, frame: scene_pb2.EnvironmentMap) -> Element:
    environment = context.compiled.document.environment
    assert isinstance(environment, EnvironmentMap)  # noqa: S101 - it was compiled to a map
    texels = skies.texels_of(environment, context.compiled.blobs)
    # A texel of 1 is D65 of `white`.
    found = plugin(
        "emitter",
        "envmap",
        filename=context.picture("sky", skies.latitudes_with_poles(texels)),
        scale=environment.luminance / white(),
    )
    # Its picture has +z in the middle, +x to the left of that, and y up.
    found.append(matrix("to_world", [array(frame.y), array(frame.z), array(frame.x)], np.zeros(3)))
    return found
