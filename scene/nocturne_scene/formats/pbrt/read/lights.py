"""Lights of pbrt's. A colour's white has the luminance that `scale` says, in cd/m2, cd or lx."""

from collections.abc import Callable

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt import squares
from nocturne_scene.formats.pbrt.read import spectra
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameters
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.textures.environment_maps import read_whole
from nocturne_scene.textures.pictures import UnusableImageError, opened


def add_light(context: Context, kind: str, parameters: Parameters) -> None:
    """A `LightSource` directive."""
    if kind not in _LIGHTS:
        context.findings.lost(
            parameters.place, f'no support for the light "{kind}"; there are {", ".join(_LIGHTS)}'
        )
        return
    _LIGHTS[kind](context, parameters)
    parameters.finish()


def _scale(parameters: Parameters, amount: str, of_one: float) -> float:
    """What a light of 1 is multiplied with: `scale`, times the wanted amount over that of the light of 1.

    `amount`: of `illuminance` (lx) or `power` (lm, of white); pbrt ignores one that is not positive.
    """
    scale, wanted = float(parameters.number("scale", 1.0)), float(parameters.number(amount, 0.0))
    return scale * wanted / of_one if wanted > 0 else scale


def _infinite(context: Context, parameters: Parameters) -> None:
    if "environment" in context.writer.document:
        context.findings.lost(parameters.place, "a scene has one environment")
        parameters.ignore_all()
        return
    picture = parameters.word("filename", None)
    if picture is not None:
        context.writer.document["environment"] = _sky(context, parameters, picture)
        return
    # Of an even sky E = pi L.
    luminance = _scale(parameters, "illuminance", np.pi)
    context.writer.document["environment"] = {"radiance": spectra.light(context, parameters, "L", luminance)}


def _sky(context: Context, parameters: Parameters, picture: str) -> Json:
    """The environment of a picture in an equal-area square."""
    if parameters.take("portal") is not None:
        context.findings.lost(parameters.place, 'no support for "portal" for a sky\'s picture')
    try:
        file = context.file(picture, parameters.place)
        shown = read_whole(file)
        is_v3 = parameters.word("mapping", "equalarea") == "equirectangular"
        pixels = (_from_azimuth_pi if is_v3 else squares.latitudes)(shown)
        with opened(file) as source:
            narrow = source.spec().format.basetype == oiio.HALF
    except UnusableImageError as error:
        raise InputError.at(parameters.place, str(error)) from None
    # pbrt-v3 has no illuminance.
    measured = 0.0 if is_v3 else squares.illuminance(shown)
    if not measured > 0:
        parameters.take("illuminance")
    elif parameters.has("illuminance"):
        context.findings.note(
            parameters.place,
            'pbrt-v4 counts half of each pixel\'s solid angle, so the sky gives twice its "illuminance"',
        )
    axes = context.to_world()[:3, :3]
    size = np.linalg.norm(axes, axis=0)
    if not np.allclose(axes.T @ axes, np.diag(size**2), atol=1e-6 * size.max() ** 2):
        context.findings.lost(parameters.place, "a sky that is sheared is not supported")
    if transforms.is_mirrored(context.to_world()):
        # Rows of a frame that is no mirror image, with y the other way round.
        pixels = pixels[:, ::-1]
    return {
        "asset": context.writer.picture("sky", pixels, narrow=narrow),
        "luminance": _scale(parameters, "illuminance", measured),
        "up": axes[:, 2].tolist(),
        "forward": axes[:, 0].tolist(),
    }


def _from_azimuth_pi(pixels: NDArray[np.float32]) -> squares.Array:
    """Rows from azimuth pi to -pi, as `squares.latitudes` has them, of pbrt-v3's from 0 to 2 pi.

    Source: InfiniteAreaLight::Le in src/lights/infinite.cpp of pbrt-v3.
    """
    return np.roll(pixels[:, ::-1], pixels.shape[1] // 2, axis=1).astype(np.float64)


def _ends(context: Context, parameters: Parameters) -> tuple[np.ndarray, np.ndarray]:
    """Where a light is and where it points to, in the document's coordinates."""
    start, end = (
        parameters.numbers("from", 3) or [0.0, 0.0, 0.0],
        parameters.numbers("to", 3) or [0.0, 0.0, 1.0],
    )
    matrix = context.to_world()
    first, last = (np.asarray(matrix @ [*point, 1.0])[:3] for point in (start, end))
    return first, last


def _distant(context: Context, parameters: Parameters) -> None:
    start, end = _ends(context, parameters)
    if not np.linalg.norm(end - start) > 0:
        raise InputError.at(parameters.place, '"from" and "to" are the same point')
    scale = _scale(parameters, "illuminance", 1.0)
    context.lamps.far(start - end, spectra.light(context, parameters, "L", scale), parameters.place)


def _point(context: Context, parameters: Parameters) -> None:
    position = np.asarray(context.to_world() @ [*(parameters.numbers("from", 3) or [0.0, 0.0, 0.0]), 1.0])[:3]
    intensity = spectra.light(context, parameters, "I", _scale(parameters, "power", 4 * np.pi))
    context.later.append(lambda: context.lamps.point(position, intensity, "point", parameters.place))


def _spot(context: Context, parameters: Parameters) -> None:
    start, end = _ends(context, parameters)
    cone = float(parameters.number("coneangle", 30.0))
    edge = cone - float(parameters.number("conedeltaangle", 5.0))
    if not 0 <= edge <= cone < 180:
        raise InputError.at(parameters.place, "expected 0 <= conedeltaangle <= coneangle < 180")
    degrees = np.unique(np.concatenate([[0.0, 180.0, min(180.0, cone + 1e-3)], np.linspace(edge, cone, 65)]))
    # A smooth step of the cosine, whose mean is a half.
    cosine, low, high = np.cos(np.radians(degrees)), np.cos(np.radians(cone)), np.cos(np.radians(edge))
    intensity = spectra.light(context, parameters, "I", _scale(parameters, "power", np.pi * (2 - low - high)))
    t = np.clip((cosine - low) / max(high - low, 1e-9), 0.0, 1.0)
    profile = (degrees, t * t * (3 - 2 * t))
    context.later.append(
        lambda: context.lamps.spot(start, end - start, intensity, profile, "spot", parameters.place)
    )


_LIGHTS: dict[str, Callable[[Context, Parameters], None]] = {
    "infinite": _infinite,
    "distant": _distant,
    "point": _point,
    "spot": _spot,
}
