"""Colours, spectra and textures of pbrt's."""

import math

from nocturne_scene.errors import InputError
from nocturne_scene.formats.pbrt.read import pictures
from nocturne_scene.formats.pbrt.read.context import Context
from nocturne_scene.formats.pbrt.read.parameters import Parameter, Parameters
from nocturne_scene.formats.pbrt.read.tokens import read_lines
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.textures.pictures import UnusableImageError

# Glasses and metals of pbrt's that are ours too, by the name of the spectrum.
GLASSES = {"glass-BK7": "N-BK7", "glass-F11": "N-SF11", "glass-SF11": "N-SF11"}
_KINDS = ("float", "spectrum")
METALS = {f"metal-{name}-eta": name for name in ("Ag", "Al", "Au", "Cu")}


def reflectance(context: Context, parameters: Parameters, name: str, default: Json) -> Json:
    """A reflectance that may vary."""
    found = parameters.take(name)
    if found is None:
        return default
    if found.type == "texture":
        return texture(context, found, "spectrum")
    if found.type == "float":
        return found.numbers(1)[0]
    if found.type == "rgb":
        values = found.numbers(3)
        if min(values) < 0 or max(values) > 1:
            raise InputError.at(found.place, "a reflectance lies between 0 and 1")
        return colours.reflectance(values)
    return spectrum(context, found)


def scalar(context: Context, parameters: Parameters, name: str, default: Json) -> Json:
    """A number that may vary."""
    found = parameters.take(name)
    if found is None:
        return default
    return texture(context, found, "float") if found.type == "texture" else found.numbers(1)[0]


def spectrum(context: Context, found: Parameter) -> Json:
    """A table, in the file or in another one."""
    if found.type != "spectrum":
        raise InputError.at(found.place, f'"{found.name}" is a spectrum, found a {found.type}')
    if found.values and isinstance(found.values[0], float):
        values = found.numbers()
    else:
        file = context.file(found.word(), found.place)
        text = "".join(read_lines(file, context.files.shown(file)))
        try:
            values = [float(word) for line in text.split("\n") for word in line.partition("#")[0].split()]
        except ValueError:
            raise InputError.at(found.place, "the file holds no pairs of wavelength and value") from None
    if len(values) < 2 or len(values) % 2:
        raise InputError.at(found.place, "expected pairs of wavelength and value")
    return {"table": [list(pair) for pair in zip(values[::2], values[1::2], strict=True)]}


def coefficient(context: Context, parameters: Parameters, name: str, default: Json) -> Json:
    """A coefficient of a medium, 1/m."""
    found = parameters.take(name)
    if found is None:
        return default
    if found.type == "rgb":
        values = found.numbers(3)
        if not all(0 <= value < math.inf for value in values):
            raise InputError.at(found.place, "a coefficient is not negative")
        return colours.coefficient(values)
    if found.type == "float":
        [value] = found.numbers(1)
        if not 0 <= value < math.inf:
            raise InputError.at(found.place, "a coefficient is not negative")
        return value
    return spectrum(context, found)


def index(context: Context, parameters: Parameters, name: str, default: Json) -> Json:
    """An index of refraction."""
    found = parameters.take(name)
    if found is None:
        return default
    if found.type == "float":
        return found.numbers(1)[0]
    if found.type == "rgb":
        values = found.numbers(3)
        if not min(values) >= 1:
            raise InputError.at(found.place, "an index of refraction is 1 or more")
        context.findings.note(found.place, metals.FROM_RGB)
        return metals.part_of_rgb(values)
    if found.values and found.values[0] in GLASSES:
        return GLASSES[found.word()]
    return spectrum(context, found)


def light(context: Context, parameters: Parameters, name: str, luminance: float) -> Json:
    """A radiance or an intensity: a colour whose white has that luminance."""
    found = parameters.take(name)
    if found is None:
        return {"illuminant": "D65", "luminance": luminance}
    if found.type == "rgb":
        values = found.numbers(3)
        if min(values) < 0:
            raise InputError.at(found.place, "light is not negative")
        return colours.light(values, luminance)
    if found.type == "blackbody":
        return {"blackbody": found.numbers(1)[0], "luminance": luminance}
    if found.values and isinstance(found.values[0], str) and found.values[0].startswith("stdillum-"):
        return {"illuminant": found.word().removeprefix("stdillum-"), "luminance": luminance}
    return spectrum(context, found) | {"outside": "zero", "luminance": luminance}


def texture(context: Context, found: Parameter, kind: str) -> Json:
    """A texture by its name, of "float" or "spectrum", each of which has its own names."""
    name = found.word()
    for each in (kind, *_KINDS):
        if (each, name) in context.textures:
            return context.textures[each, name]
    known = ", ".join(sorted({known for _, known in context.textures})[:20]) or "none"
    raise InputError.at(found.place, f'no texture "{name[:80]}"; known: {known}')


def add_texture(context: Context, name: str, kind: str, plugin: str, parameters: Parameters) -> None:
    """A `Texture` directive."""
    if kind not in _KINDS:
        raise InputError.at(parameters.place, f'a texture is of "float" or "spectrum", found "{kind[:40]}"')
    context.textures[kind, name] = 0.5
    value: Json = 0.5
    match plugin:
        case "constant":
            value = reflectance(context, parameters, "value", 1.0)
        case "imagemap":
            value = _image(context, parameters, kind)
        case "checkerboard":
            value = _board(context, parameters)
        case "scale":
            value = _scaled(context, parameters)
        case _:
            context.findings.lost(
                parameters.place,
                f'no support for the texture "{plugin}"; there are constant, imagemap, checkerboard, scale',
            )
            return
    parameters.finish()
    if kind == "float" and isinstance(value, dict) and "spectrum" in value:
        # A number has a gain where a colour has a spectrum.
        value = {**value, "gain": value["spectrum"] * value.get("gain", 1.0)}
        del value["spectrum"]
    context.textures[kind, name] = value


def _image(context: Context, parameters: Parameters, kind: str) -> Json:
    name = parameters.word("filename", None)
    if name is None:
        raise InputError.at(parameters.place, 'an imagemap needs "filename"')
    file = context.file(name, parameters.place)
    encoding = parameters.word("encoding", "sRGB")
    wrap = parameters.word("wrap", "repeat")
    factor = float(parameters.number("scale", 1.0))
    try:
        look = pictures.Look(kind, encoding, parameters.switch("invert", False), factor)
        texture: Json = pictures.texture(context.writer, file, look)
    except UnusableImageError as error:
        raise InputError.at(parameters.place, str(error)) from None
    if wrap not in ("repeat", "clamp"):
        context.findings.lost(parameters.place, f'no support for the wrap mode "{wrap}"; taken as repeat')
    elif wrap == "clamp":
        texture["wrap"] = "clamp"
    _only_uv(context, parameters)
    parameters.ignore("filter", "maxanisotropy")
    use: Json = {"texture": context.writer.name("textures", file.stem, texture), **_mapping(parameters, 1.0)}
    return use if look.factor_left == 1.0 else use | {"spectrum": look.factor_left}


def _board(context: Context, parameters: Parameters) -> Json:
    """Squares of one unit of the mapping each, the first at u = v = 0; the picture holds two by two."""
    _only_uv(context, parameters)
    if parameters.whole("dimension", 2) != 2:
        context.findings.lost(
            parameters.place, "no support for a board in space; taken as one on the surface"
        )
    colour = [reflectance(context, parameters, name, value) for name, value in (("tex1", 1.0), ("tex2", 0.0))]
    linear = []
    for each in colour:
        if not isinstance(each, float) and "rgb" not in each:
            raise InputError.at(parameters.place, "a board of textures or measured spectra is not supported")
        linear.append([each] * 3 if isinstance(each, float) else each["rgb"])
    return {"texture": context.writer.board(linear[1], linear[0]), **_mapping(parameters, 0.5)}


def _only_uv(context: Context, parameters: Parameters) -> None:
    if parameters.word("mapping", "uv") != "uv":
        context.findings.lost(parameters.place, "no support for mappings other than uv")


def _mapping(parameters: Parameters, period: float) -> Json:
    """Fields for a picture that is repeated with that period of the mapping's unit."""
    scales = [period * float(parameters.number(f"{axis}scale", 1.0)) for axis in "uv"]
    shifts = [period * float(parameters.number(f"{axis}delta", 0.0)) for axis in "uv"]
    plain = scales == [1.0, 1.0] and shifts == [0.0, 0.0]
    return {} if plain else {"scale": scales, "offset": shifts}


def _scaled(context: Context, parameters: Parameters) -> Json:
    value = reflectance(context, parameters, "tex", 1.0)
    factor = reflectance(context, parameters, "scale", 1.0)
    if isinstance(value, float) and not isinstance(factor, float):
        value, factor = factor, value
    if not isinstance(factor, float):
        context.findings.lost(
            parameters.place, "no support for the product of two textures; the second is left out"
        )
        return value
    return reflectance_times(value, factor)


def reflectance_times(value: Json, factor: float) -> Json:
    """A reflectance times a number."""
    if factor == 1.0:
        return value
    if isinstance(value, dict) and "rgb" in value:
        return colours.reflectance([factor * part for part in value["rgb"]])
    return colours.scaled(value, factor)


def largest(value: Json) -> float:
    """The largest value of a number, a colour or a table."""
    if isinstance(value, float | int):
        return float(value)
    return float(max(value["rgb"]) if "rgb" in value else max(each for _, each in value["table"]))
