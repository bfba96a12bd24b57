"""pbrt's cameras, films and integrators."""

import math

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.media import camera_medium
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.scene_writer import Json

_PATHS = ("path", "volpath", "simplepath", "simplevolpath", "bdpt", "mlt", "sppm", "lightpath")


def add_camera(context: Context, kind: str, parameters: Parameters) -> None:
    """A `Camera` directive; the film comes before it or after."""
    matrix = transforms.inverse(context.state.transform)
    context.coordinate_systems["camera"] = matrix
    # pbrt's x points to the right in a left-handed world. Where its axes are right-handed as numbers, its
    # image is the mirror image of ours, and a mirrored world makes up for that.
    context.outer = transforms.IDENTITY
    if not transforms.is_mirrored(matrix):
        context.outer = transforms.scaling([1.0, 1.0, -1.0])
    matrix = context.outer @ matrix
    ahead, up = (matrix[:3, axis] / np.linalg.norm(matrix[:3, axis]) for axis in (2, 1))
    sensor: Json = {
        "position": matrix[:3, 3].tolist(),
        "look_at": (matrix[:3, 3] + ahead).tolist(),
        "up": up.tolist(),
    }
    parameters.ignore("shutteropen", "shutterclose")
    if parameters.take("frameaspectratio") is not None:
        context.findings.lost(parameters.place, 'no support for the camera\'s "frameaspectratio"')
    window = parameters.numbers("screenwindow", 4)
    match kind:
        case "perspective":
            sensor |= _perspective(context, parameters, window)
        case "orthographic":
            size = float(np.linalg.norm(matrix[:3, 1])) * _half_height(context, parameters.place, window)
            context.later.append(lambda: _set_height(context, sensor, size))
            sensor |= {"type": "orthographic", "height": 2 * size}
        case _:
            context.findings.lost(
                parameters.place,
                f'no support for the camera "{kind}"; there are perspective and orthographic',
            )
            sensor |= {"type": "pinhole", "vertical_field_of_view_degrees": 90.0}
    parameters.finish()
    camera_medium(context, parameters.place)
    context.writer.document["sensor"] = sensor


def _half_height(context: Context, place: str, window: list[float] | None) -> float:
    """Of the `screenwindow`, over that of the default, 1 for the shorter side."""
    if window is None:
        return 1.0
    left, right, bottom, top = window

    def check() -> None:
        film = context.writer.film
        middle = abs(left + right) <= 1e-3 * (right - left) and abs(bottom + top) <= 1e-3 * (top - bottom)
        if (
            not middle
            or abs((right - left) * film.height - (top - bottom) * film.width) > film.width * top * 1e-2
        ):
            context.findings.lost(
                place,
                'no support for a "screenwindow" that is off the middle or has other sides than the film',
            )

    if not (right > left and top > bottom):
        raise InputError.at(place, '"screenwindow" is left, right, bottom, top')
    context.later.append(check)
    return min(right - left, top - bottom) / 2


def _perspective(context: Context, parameters: Parameters, window: list[float] | None) -> Json:
    field = float(parameters.number("fov", 90.0))
    if not 0 < field < 180:
        raise InputError.at(
            parameters.place, f"a field of view lies between 0 and 180 degrees, found {field:g}"
        )
    lens, focus = float(parameters.number("lensradius", 0.0)), float(parameters.number("focaldistance", 1e6))
    sensor: Json = {"type": "pinhole", "vertical_field_of_view_degrees": field}
    if lens > 0:
        sensor |= {"type": "thin_lens", "lens_radius": lens, "focus_distance": focus}

    part = _half_height(context, parameters.place, window)

    def upright() -> None:
        # The field of view is that of the shorter side.
        film = context.writer.film
        half = math.tan(math.radians(field) / 2) * part * max(1.0, film.height / film.width)
        angle = math.degrees(2 * math.atan(half))
        context.writer.document["sensor"]["vertical_field_of_view_degrees"] = angle

    context.later.append(upright)
    return sensor


def _set_height(context: Context, sensor: Json, size: float) -> None:
    film = context.writer.film
    sensor["height"] = 2 * size * max(1.0, film.height / film.width)


def add_film(context: Context, kind: str, parameters: Parameters) -> None:
    """A `Film` directive."""
    film = context.writer.film
    film.width, film.height = parameters.whole("xresolution", 1280), parameters.whole("yresolution", 720)
    if not (film.width > 0 and film.height > 0):
        raise InputError.at(parameters.place, "a film has at least one pixel")
    parameters.ignore(
        "filename", "savefp16", "diagonal", "maxcomponentvalue", "nbuckets", "lambdamin", "lambdamax"
    )
    if parameters.word("sensor", "cie1931") != "cie1931":
        context.findings.note(parameters.place, "the film's sensor is left out: images are CIE 1931 XYZ")
    for name in ("iso", "exposuretime", "whitebalance"):
        if parameters.take(name) is not None:
            context.findings.note(parameters.place, f'"{name}" is left out: images are in cd/m2')
    for name in ("cropwindow", "pixelbounds"):
        if parameters.take(name) is not None:
            context.findings.lost(
                parameters.place, f'no support for the film\'s "{name}"; all of it is rendered'
            )
    del kind
    parameters.finish()


def add_integrator(context: Context, kind: str, parameters: Parameters) -> None:
    """An `Integrator` directive."""
    if kind not in _PATHS:
        context.findings.note(
            parameters.place, f'all light is traced, instead of what the integrator "{kind}" does'
        )
        return
    depth = parameters.whole("maxdepth", 5)
    if depth < 1:
        context.findings.lost(
            parameters.place, "maxdepth 0 is not supported; light goes on to the first surface"
        )
    context.writer.document["tracing"] = {"maximum_depth": max(1, depth)}
    context.findings.note(parameters.place, "of the integrator only maxdepth is used")


def add_sampler(context: Context, kind: str, parameters: Parameters) -> None:
    """A `Sampler` directive."""
    del kind
    context.writer.film.samples = parameters.whole("pixelsamples", 16)


def add_filter(context: Context, kind: str, parameters: Parameters) -> None:
    """A `PixelFilter` directive."""
    if kind != "box":
        context.findings.note(
            parameters.place, f"a pixel is the mean over its area, instead of the filter {kind}"
        )
