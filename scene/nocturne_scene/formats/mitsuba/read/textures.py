"""Textures of Mitsuba's, and values that may come from one.

Its v goes down the picture and ours up: meshes are written with v' = 1 - v, so that v -> s v + o becomes
v' -> s v' + (1 - s - o).
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import spectra
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.properties import Properties, vector
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.textures.image_files import MAX_EDGE, MAX_PIXELS, decoded
from nocturne_scene.textures.pictures import UnusableImageError, check_size, opened

Pixels = NDArray[np.float64]

# The name of a texture that is yet to be made of a mesh's attribute: no name in a document has a colon.
ATTRIBUTE = "attribute:"


def _bitmap(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    file = context.file(properties)
    raw = properties.switch("raw", False)
    if properties.text("filter_type", "bilinear") != "bilinear":
        context.findings.note(
            element.place, "looked up by bilinear interpolation instead of the nearest texel"
        )
    wrap = properties.text("wrap_mode", "repeat")
    if wrap not in ("repeat", "clamp", "mirror"):
        context.findings.lost(element.place, f'no support for the wrap mode "{wrap}"; taken as "repeat"')
        wrap = "repeat"
    properties.ignore("format", "accel")
    mirrored = wrap == "mirror"
    use = _coordinates(context, properties, 0.5 if mirrored else 1.0)
    properties.finish()
    texture: Json = {
        "asset": _with_mirror_images(context, file, element) if mirrored else context.writer.copy(file),
        "wrap": "repeat" if mirrored else wrap,
        "encoding": _encoding(file, raw, element),
    }
    texture["sharp"] = True  # as Mitsuba looks it up
    return {"texture": context.writer.name("textures", file.stem, texture), **use}


def _encoding(file: Path, raw: bool, element: Element) -> str:
    try:
        with opened(file) as picture:
            is_float = picture.spec().format.basetype in (oiio.HALF, oiio.FLOAT)
    except UnusableImageError as error:
        raise InputError.at(element.place, str(error)) from None
    return "linear" if raw or is_float else "sRGB"


def _with_mirror_images(context: Context, file: Path, element: Element) -> str:
    """A picture of twice the size that repeats as the mirrored one goes on; values as they are stored."""
    pixels = _stored(file, element.place, 2)
    pixels = np.concatenate([pixels, pixels[:, ::-1]], axis=1)
    return context.writer.picture(file.stem, np.concatenate([pixels, pixels[::-1]]), narrow=True)


def _coordinates(context: Context, properties: Properties, factor: float = 1.0) -> Json:
    """The fields for `to_uv`, of a picture that shows 1 / `factor` of the range of its coordinates."""
    matrix = properties.transform("to_uv")
    if np.any(np.abs(matrix[[0, 1], [1, 0]]) > 1e-9):
        context.findings.lost(properties.place, "texture coordinates that are turned are not supported")
    scale = [factor * float(matrix[i, i]) for i in (0, 1)]
    offset = [factor * float(matrix[i, 3]) for i in (0, 1)]
    if scale == [1.0, 1.0] and offset == [0.0, 0.0]:
        return {}
    return {"scale": scale, "offset": [offset[0], 1.0 - scale[1] - offset[1]]}


def _checkerboard(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    squares = [
        _board_colour(context, properties.take(name), default)
        for name, default in (("color0", 0.4), ("color1", 0.2))
    ]
    use = _coordinates(context, properties)
    properties.finish()
    return {"texture": context.writer.board(squares[0], squares[1]), **use}


def _board_colour(context: Context, element: Element | None, default: float) -> list[float]:
    if element is None:
        return [default] * 3
    value = spectra.reflectance(context, element)
    if isinstance(value, float):
        return [value] * 3
    if "rgb" not in value:
        raise InputError.at(element.place, "a board of measured spectra is not supported; expected <rgb>")
    found: list[float] = value["rgb"]
    return found


def _mesh_attribute(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    name = properties.text("name", "")
    if properties.number("scale", 1.0) != 1.0:
        context.findings.lost(element.place, "no support for an attribute's scale")
    properties.finish()
    return {"texture": ATTRIBUTE + name}


def _raw_constant(context: Context, element: Element) -> Json:
    """A number; or three of them, which a picture of one colour stands for."""
    properties = context.properties(element)
    value = properties.take("value")
    properties.finish()
    if value is None or value.tag not in ("float", "integer", "vector", "point"):
        raise InputError.at(element.place, 'a rawconstant needs a "value", <float> or <vector>')
    if value.tag in ("float", "integer"):
        return numbers(value.need("value"), value.place, 1)[0]
    asset = context.writer.picture("constant", np.array(vector(value)).reshape(1, 1, 3))
    return {"texture": context.writer.name("textures", "constant", {"asset": asset, "encoding": "linear"})}


def _scale(context: Context, element: Element) -> Json:
    """Of Mitsuba 0.x alone: another texture or a value, times a factor (textures/scale.cpp of 0.6)."""
    properties = context.properties(element)
    nested = properties.take_all("texture")
    inside = nested[0] if nested else properties.take("value")
    factor = spectra.rgb(found) if (found := properties.take("scale")) is not None else [1.0] * 3
    properties.finish()
    if inside is None:
        raise InputError.at(element.place, "a scale needs a texture inside")
    if inside.tag != "texture":
        return colours.reflectance(np.multiply(spectra.rgb(inside), factor).tolist())
    use = texture(context, inside)
    if use is None or factor == [1.0] * 3:
        return use
    if isinstance(use, float):
        return colours.reflectance([use * each for each in factor])
    if len(set(factor)) == 1:
        factor = factor[:1]
    return changed(context, use, lambda pixels: pixels * np.array(factor), element.place)


_TEXTURES: dict[str, Callable[[Context, Element], Json]] = {
    "bitmap": _bitmap,
    "checkerboard": _checkerboard,
    "mesh_attribute": _mesh_attribute,
    "rawconstant": _raw_constant,
    "scale": _scale,
}


def changed(context: Context, use: Json, change: Callable[[Pixels], Pixels], place: str) -> Json:
    """The use of a picture whose linear values are changed, texel by texel."""
    if use["texture"].startswith(ATTRIBUTE):
        context.findings.lost(place, "no support for a mesh's attribute as the base under a coat")
        return use
    texture = context.writer.document["textures"][use["texture"]]
    pixels = pixels_of(context, use, place)
    asset = context.writer.picture("base", change(pixels))
    name = context.writer.name("textures", "base", texture | {"asset": asset, "encoding": "linear"})
    return use | {"texture": name}


def pixels_of(context: Context, use: Json, place: str) -> Pixels:
    """The linear values of a picture, shape (rows, columns, 1 or 3). Raises InputError."""
    texture = context.writer.document["textures"][use["texture"]]
    pixels = _stored(context.writer.folder / texture["asset"], place)
    if texture["encoding"] == "sRGB":
        pixels = decoded(pixels).astype(np.float64)
    return pixels


def _stored(file: Path, place: str, repeats: int = 1) -> Pixels:
    """The values of a picture that will be repeated in both directions, as they are stored."""
    try:
        with opened(file) as picture:
            check_size(picture.spec(), MAX_PIXELS // repeats**2, MAX_EDGE // repeats)
            pixels = np.atleast_3d(np.asarray(picture.read_image(oiio.FLOAT), dtype=np.float64))
    except UnusableImageError as error:
        raise InputError.at(place, str(error)) from None
    return pixels[..., : 3 if pixels.shape[2] >= 3 else 1]


def mean(context: Context, use: Json, unknown: float, place: str) -> float:
    """Of a picture; `unknown` for a mesh's attribute."""
    if use["texture"].startswith(ATTRIBUTE):
        return unknown
    return float(pixels_of(context, use, place).mean())


def texture(context: Context, element: Element) -> Json:
    """The use of a texture, or the number that it is everywhere; None where it has no counterpart.

    Each element becomes one texture, however often it is used.
    """
    if element.type not in _TEXTURES:
        context.findings.lost(
            element.place, f'no support for the texture "{element.type}"; there are {", ".join(_TEXTURES)}'
        )
        return None
    if element.number not in context.textures:
        context.textures[element.number] = _TEXTURES[element.type](context, element)
    return context.textures[element.number]


def colour(context: Context, properties: Properties, name: str, default: Json) -> Json:
    """A reflectance that may vary."""
    element = properties.take(name)
    if element is None:
        return default
    if element.tag == "texture":
        found = texture(context, element)
        return default if found is None else found
    return spectra.reflectance(context, element)


def number(context: Context, properties: Properties, name: str, default: float) -> Json:
    """A number that may vary."""
    element = properties.take(name)
    if element is None:
        return default
    if element.tag == "texture":
        found = texture(context, element)
        return default if found is None else found
    value = spectra.reflectance(context, element)
    if not isinstance(value, float):
        raise InputError.at(element.place, f'"{name}" is a number')
    return value


def light(context: Context, properties: Properties, name: str, default: Json) -> Json:
    """A radiance or an intensity that may vary."""
    element = properties.take(name)
    if element is None:
        return default
    if element.tag != "texture":
        return spectra.light(context, element)
    use = texture(context, element)
    if use is None or isinstance(use, float):
        return default if use is None else use
    return use | {"spectrum": default}
