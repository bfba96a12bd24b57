"""Mitsuba's sensors and integrators: the camera, the film, how deep light goes."""

import math
from collections.abc import Callable

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.media import around_sensor
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.scene_writer import FilmSettings, Json
from nocturne_scene.formats.reading.transforms import Matrix

# Of 35 mm film, which focal lengths refer to, in millimetres.
_FILM_DIAGONAL = math.hypot(36.0, 24.0)

_DIRECT = ("direct", "direct_projective")
_STRAIGHT = ("path", "volpath", "volpathmis", "prb", "prbvolpath", "prb_basic", "prb_projective", "ptracer")
# How derivatives are sampled, of which an image has none.
_OF_DERIVATIVES = ("sppc", "sppp", "sppi", "guiding", "guiding_proj", "guiding_rounds", "max_rays")
_WRAPPERS = ("moment", "aov", "stokes")


def add_sensor(context: Context, element: Element) -> None:
    """Set the scene's camera."""
    if "sensor" in context.writer.document:
        context.findings.lost(element.place, "a scene has one sensor")
        return
    if element.type not in _SENSORS:
        context.findings.lost(
            element.place, f'no support for the sensor "{element.type}"; there are {", ".join(_SENSORS)}'
        )
        return
    properties = context.properties(element)
    for film in properties.take_all("film"):
        context.writer.film = _film(context, film)
    for sampler in properties.take_all("sampler"):
        inner = context.properties(sampler)
        context.writer.film.samples = inner.whole("sample_count", 16)
        inner.ignore("seed", "jitter")
        inner.finish()
    for rfilter in properties.take_all("rfilter"):
        context.findings.note(rfilter.place, "a filter belongs into the film; left out, as Mitsuba does")
    properties.without_effect("nothing is clipped", "near_clip", "far_clip")
    properties.ignore("srf")
    around_sensor(context, properties)
    to_world = properties.transform("to_world")
    if transforms.is_mirrored(to_world):
        context.findings.lost(element.place, "a camera that mirrors the image is not supported")
    context.writer.document["sensor"] = {
        "position": to_world[:3, 3].tolist(),
        "look_at": (to_world[:3, 3] + _unit(to_world[:3, 2])).tolist(),
        "up": _unit(to_world[:3, 1]).tolist(),
        **_SENSORS[element.type](context, properties, to_world),
    }
    # Cameras without a lens read it, and see the same whatever it is.
    properties.ignore("focus_distance")
    properties.finish()


def _unit(direction: Matrix) -> Matrix:
    return np.asarray(direction / np.linalg.norm(direction))


def _film(context: Context, element: Element) -> FilmSettings:
    properties = context.properties(element)
    film = FilmSettings(properties.whole("width", 768), properties.whole("height", 576))
    if not (film.width > 0 and film.height > 0):
        raise InputError.at(properties.place, "a film has at least one pixel")
    for rfilter in properties.take_all("rfilter") or [
        Element("rfilter", {"type": "gaussian"}, element.place)
    ]:
        if rfilter.type != "box":
            context.findings.note(
                rfilter.place, f"a pixel is the mean over its area, instead of the filter {rfilter.type}"
            )
    properties.ignore("pixel_format", "component_format", "file_format", "banner", "compensate")
    properties.ignore("high_quality_edges")
    properties.finish()
    return film


def vertical_field(properties: Properties, film: FilmSettings) -> float:
    """Degrees."""
    aspect = film.width / film.height
    field = properties.number("fov", None)
    axis = properties.text("fov_axis", "x")
    if field is None:
        length = properties.text("focal_length", "50mm").strip().removesuffix("mm")
        try:
            field = math.degrees(2 * math.atan(_FILM_DIAGONAL / (2 * float(length))))
        except (ValueError, ZeroDivisionError):
            raise InputError.at(
                properties.place, f'expected a focal length such as "50mm", found "{length}"'
            ) from None
        axis = "diagonal"
    if not 0 < field < 180:
        raise InputError.at(
            properties.place, f"a field of view lies between 0 and 180 degrees, found {field:g}"
        )
    half = math.tan(math.radians(field) / 2)
    axis = {"smaller": "x" if aspect < 1 else "y", "larger": "x" if aspect >= 1 else "y"}.get(axis, axis)
    match axis:
        case "x":
            half /= aspect
        case "diagonal":
            half /= math.hypot(aspect, 1)
        case "y":
            pass
        case _:
            raise InputError.at(
                properties.place, f'no axis "{axis}"; expected x, y, diagonal, smaller, larger'
            )
    return math.degrees(2 * math.atan(half))


def _perspective(context: Context, properties: Properties, to_world: Matrix) -> Json:
    del to_world
    return {
        "type": "pinhole",
        "vertical_field_of_view_degrees": vertical_field(properties, context.writer.film),
    }


def _thin_lens(context: Context, properties: Properties, to_world: Matrix) -> Json:
    radius = properties.number("aperture_radius", None)
    distance = properties.number("focus_distance", None)
    if radius is None or distance is None:
        raise InputError.at(properties.place, "a thin lens needs aperture_radius and focus_distance")
    return _perspective(context, properties, to_world) | {
        "type": "thin_lens",
        "lens_radius": radius,
        "focus_distance": distance,
    }


def _orthographic(context: Context, properties: Properties, to_world: Matrix) -> Json:
    film = context.writer.film
    # It sees -1 to 1 along x, and as much along y as the film's shape gives, before its scale.
    across, up = (float(np.linalg.norm(to_world[:3, axis])) for axis in (0, 1))
    if abs(across - up) > 1e-6 * across:
        context.findings.lost(
            properties.place, "an orthographic camera that stretches the image is not supported"
        )
    return {"type": "orthographic", "height": 2 * up * film.height / film.width}


_SENSORS: dict[str, Callable[[Context, Properties, Matrix], Json]] = {
    "perspective": _perspective,
    "thinlens": _thin_lens,
    "orthographic": _orthographic,
}


def add_integrator(context: Context, element: Element) -> None:
    """Set how deep light goes: Mitsuba counts edges, of which there is one more than interactions."""
    properties = context.properties(element)
    inside = properties.take_all("integrator")
    if element.type in _WRAPPERS and len(inside) == 1:
        if element.type == "stokes":
            context.findings.note(
                element.place, "polarisation is left out: images are those of its first part"
            )
        properties.ignore("aovs")
        properties.finish()
        add_integrator(context, inside[0])
        return
    depth = 2
    if element.type in _STRAIGHT:
        depth = properties.whole("max_depth", -1)
        properties.ignore("rr_depth", "samples_per_pass", "timeout", "block_size", *_OF_DERIVATIVES)
    elif element.type in _DIRECT:
        properties.ignore("shading_samples", "emitter_samples", "bsdf_samples", *_OF_DERIVATIVES)
    else:
        context.findings.lost(
            element.place, f'no support for the integrator "{element.type}"; light goes all its way'
        )
        return
    context.hides_emitters = properties.switch("hide_emitters", False)
    properties.finish()
    if depth in (0, 1):
        context.findings.lost(
            element.place, f"max_depth {depth} is not supported; light goes on to the first surface"
        )
        depth = 2
    if depth > 0:
        context.writer.document["tracing"] = {"maximum_depth": depth - 1}
