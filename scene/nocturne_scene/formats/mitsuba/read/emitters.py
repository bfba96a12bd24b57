"""Mitsuba's emitters that stand by themselves. Those without a size get one of the same power."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import spectra, textures
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.daylight import add_daylight
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.mitsuba.read.sensors import vertical_field
from nocturne_scene.formats.mitsuba.read.units import white
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.beams import Array, beam, looked_up
from nocturne_scene.formats.reading.scene_writer import FilmSettings, Json
from nocturne_scene.spectra.published import SRGB_LUMINANCE
from nocturne_scene.textures.image_files import decoded
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

_MAX_PIXELS = 2**23


def add_emitter(context: Context, element: Element) -> None:
    """Put an emitter into the scene."""
    if element.type == "area":
        # One that shapes refer to is made where they do.
        if not element.id:
            context.findings.lost(
                element.place, "an area emitter belongs into a shape, or has an id that shapes refer to"
            )
        return
    if element.type not in _EMITTERS:
        context.findings.lost(
            element.place,
            f'no support for the emitter "{element.type}"; there are {", ".join(_EMITTERS)}, and area on '
            "shapes",
        )
        return
    properties = context.properties(element)
    properties.ignore("sampling_weight")
    _EMITTERS[element.type](context, properties)
    properties.finish()


def _standard() -> Json:
    return {"illuminant": "D65", "luminance": white()}


def _constant(context: Context, properties: Properties) -> None:
    radiance = textures.light(context, properties, "radiance", _standard())
    _set_environment(context, properties, {"radiance": radiance})


def _set_environment(context: Context, properties: Properties, environment: Json) -> None:
    if "environment" in context.writer.document:
        context.findings.lost(properties.place, "a scene has one environment")
        return
    context.writer.document["environment"] = environment


def _point(context: Context, properties: Properties) -> None:
    position = properties.vector("position")
    to_world = properties.transform("to_world")
    place = to_world[:3, 3] if position is None else np.array(position)
    intensity = textures.light(context, properties, "intensity", _standard())
    context.lamps.point(place, intensity, properties.element.id or "point", properties.place)


def _spot(context: Context, properties: Properties) -> None:
    to_world = properties.transform("to_world")
    cutoff = properties.number("cutoff_angle", 20.0)
    beam = properties.number("beam_width", 0.75 * cutoff)
    intensity = textures.light(context, properties, "intensity", _standard())
    texture = properties.take("texture")
    if not 0 < beam <= cutoff < 180:
        raise InputError.at(properties.place, "expected 0 < beam_width <= cutoff_angle < 180")
    # Full up to the beam's width, from there to the cut-off in proportion to the angle, then none.
    degrees = np.unique(np.array([0.0, beam, cutoff, min(180.0, cutoff + 1e-3), 180.0]))
    part = np.clip((cutoff - degrees) / max(cutoff - beam, 1e-3), 0.0, 1.0)
    if texture is not None:
        slide = _slide(context, texture)
        spread = math.tan(math.radians(cutoff))

        def values(x: Array, y: Array) -> Array:
            fall = np.interp(np.degrees(np.arctan(np.hypot(x, y))), degrees, part)
            return fall[..., None] * looked_up(slide, 0.5 + 0.5 * x / spread, 0.5 + 0.5 * y / spread)

        if cutoff >= 90:
            raise InputError.at(properties.place, "expected a cutoff_angle below 90 of a spot with a texture")
        _add_beam(context, properties, to_world, spread, (values, max(slide.shape)), intensity)
        return
    name = properties.element.id or "spot"
    position, axis = to_world[:3, 3], to_world[:3, 2]
    context.lamps.spot(position, axis, intensity, (degrees, part), name, properties.place)


def _projector(context: Context, properties: Properties) -> None:
    """A picture on a plane before the lamp, upright for someone who looks along its axis."""
    to_world = properties.transform("to_world")
    scale = properties.number("scale", 1.0)
    element = properties.take("irradiance")
    if element is None or element.tag == "texture":
        # Light of equal energy goes through a slide, as Mitsuba has it.
        colour = 1.0
        slide = np.ones((1, 1, 3)) if element is None else _slide(context, element)
    else:
        colour, slide = spectra.light(context, element), np.ones((1, 1, 3))
    rows, columns = slide.shape[:2]
    field = vertical_field(properties, FilmSettings(columns, rows))
    high = math.tan(math.radians(field) / 2)
    wide = high * columns / rows

    def values(x: Array, y: Array) -> Array:
        # On a plane at a distance of one, pi times the picture: intensity is that over the cosine's cube.
        rise = math.pi * scale * (1 + x**2 + y**2) ** 1.5
        return rise[..., None] * looked_up(slide, 0.5 - 0.5 * x / wide, 0.5 - 0.5 * y / high)

    made = (values, max(rows, columns))
    _add_beam(context, properties, to_world, math.hypot(wide, high), made, colour)


def _slide(context: Context, element: Element) -> Array:
    """Linear sRGB of a texture, shape (rows, columns, 3)."""
    use = textures.texture(context, element)
    if use is None or isinstance(use, float):
        return np.full((1, 1, 3), 1.0 if use is None else use)
    if {"scale", "offset"} & use.keys():
        context.findings.lost(element.place, "no support for a lamp's picture with a to_uv; taken without")
    pixels = textures.pixels_of(context, use, element.place)
    return np.broadcast_to(pixels, (*pixels.shape[:2], 3))


def _add_beam(
    context: Context,
    properties: Properties,
    to_world: Array,
    widest: float,
    made: tuple[Callable[[Array, Array], Array], int],
    colour: Json,
) -> None:
    """Lamps that throw a picture in light of a colour."""
    values, pixels = made
    radius = context.lamps.radius(to_world[:3, 3])
    luminance = colours.luminance_of(colour)
    tint = np.ones(3)
    if isinstance(colour, dict) and "rgb" in colour:
        tint = np.array(colour["rgb"]) / (np.array(SRGB_LUMINANCE) @ colour["rgb"])
    elif colour != 1.0 and not (isinstance(colour, dict) and colour.get("illuminant") == "D65"):
        context.findings.note(properties.place, "a picture is thrown in the light of D65")
    context.findings.note(
        properties.place,
        f"the lamp and its picture became spheres of radius {radius:.4g} m with intensities by angle",
    )
    for lamp in beam(
        context.writer,
        to_world,
        radius,
        widest,
        lambda x, y: luminance * tint * values(x, y),
        pixels,
        properties.element.id or properties.element.type,
        flat=colour == 1.0,
    ):
        context.writer.add("surfaces", lamp)


def _directional(context: Context, properties: Properties) -> None:
    direction = properties.vector("direction")
    to_world = properties.transform("to_world")
    ahead = to_world[:3, 2] if direction is None else to_world[:3, :3] @ np.array(direction)
    if not np.linalg.norm(ahead) > 0:
        raise InputError.at(properties.place, "the direction has no length")
    irradiance = textures.light(context, properties, "irradiance", _standard())
    context.lamps.far(-ahead, irradiance, properties.place)


def _envmap(context: Context, properties: Properties) -> None:
    file = context.file(properties, "an envmap")
    scale = properties.number("scale", 1.0)
    to_world = properties.transform("to_world")
    properties.ignore("mis_compensation")
    try:
        asset = _sky(context, file)
    except UnusableImageError as error:
        raise InputError.at(properties.place, str(error)) from None
    _set_environment(
        context,
        properties,
        {
            "asset": asset,
            "pixels": "points",
            "luminance": white() * scale,
            # The picture's middle is its +z, and its +x is to the left of that.
            "up": to_world[:3, 1].tolist(),
            "forward": to_world[:3, 2].tolist(),
        },
    )


def _sky(context: Context, file: Path) -> str:
    """The picture as it is where a scene can have it, else decoded."""
    with opened(file) as picture:
        spec = picture.spec()
        check_size(spec, _MAX_PIXELS, 8192)
        if spec.nchannels < 3:
            raise UnusableImageError("the picture has no colours")
        if spec.width < 2 or spec.height < 2:
            raise UnusableImageError("the picture needs at least 2 x 2 pixels")
        if spec.nchannels <= 4 and spec.format.basetype in (oiio.HALF, oiio.FLOAT):
            return context.writer.copy(file)
        is_linear = spec.format.basetype in (oiio.HALF, oiio.FLOAT)
        pixels = np.asarray(picture.read_image(0, 0, 0, 3, oiio.FLOAT), dtype=np.float64)
    return context.writer.picture("sky", pixels if is_linear else decoded(pixels), narrow=True)


def _daylight(context: Context, properties: Properties) -> None:
    """What an upgrade makes of the emitters sky, sun and sunsky of Mitsuba 0.x."""
    environment = add_daylight(context, properties)
    if environment is not None:
        _set_environment(context, properties, environment)


_EMITTERS: dict[str, Callable[[Context, Properties], None]] = {
    "constant": _constant,
    "envmap": _envmap,
    "point": _point,
    "projector": _projector,
    "spot": _spot,
    "directional": _directional,
    "daylight": _daylight,
}
