"""Colours, spectra and numbers of Mitsuba's."""

from collections.abc import Callable

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import units
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element, hexadecimal, numbers
from nocturne_scene.formats.reading import colours
from nocturne_scene.formats.reading.scene_files import read_text
from nocturne_scene.formats.reading.scene_writer import Json


def rgb(element: Element) -> list[float]:
    """Red, green, blue, linear."""
    encoded = hexadecimal(element)
    if encoded is not None:
        return colours.decode_srgb(encoded)
    values = numbers(element.need("value"), element.place)
    if len(values) not in (1, 3):
        raise InputError.at(element.place, f"expected 1 or 3 numbers, found {len(values)}")
    return values * 3 if len(values) == 1 else values


def _rgb_reflectance(context: Context, element: Element) -> Json:
    del context
    values = rgb(element)
    if min(values) < 0 or max(values) > 1:
        raise InputError.at(element.place, "a reflectance lies between 0 and 1")
    return colours.reflectance(values)


def _not_negative(element: Element, what: str) -> list[float]:
    values = rgb(element)
    if min(values) < 0:
        raise InputError.at(element.place, f"{what} is not negative")
    return values


def _rgb_light(context: Context, element: Element) -> Json:
    del context
    return colours.light(_not_negative(element, "light"), units.white())


def _number(context: Context, element: Element) -> Json:
    del context
    return numbers(element.need("value"), element.place, 1)[0]


def _spectrum(context: Context, element: Element) -> Json:
    """A number, a table in the file or in another one."""
    if element.type:
        return _SPECTRA.get(element.type, _unknown)(context, element)
    if "filename" in element.attributes:
        return table_file(context, element, element.attributes["filename"])
    text = element.need("value")
    if ":" not in text:
        return _number(context, element)
    try:
        knots = [[float(part) for part in pair.split(":")] for pair in text.replace(",", " ").split()]
    except ValueError:
        raise InputError.at(element.place, 'expected "nm:value, nm:value ..."') from None
    return _table(element, knots)


def table_file(context: Context, element: Element, name: str) -> Json:
    """A spectrum in a text file, a wavelength in nm and a value on each line."""
    file = context.tree.file(element, name)
    shown = context.tree.files.shown(file)
    knots = []
    for number, line in enumerate(read_text(file, shown).split("\n")):
        words = line.partition("#")[0]
        if words.strip():
            knots.append(numbers(words, f"{shown}:{number + 1}", 2))
    return _table(element, knots)


def _table(element: Element, knots: list[list[float]]) -> Json:
    if not knots or any(len(knot) != 2 for knot in knots):
        raise InputError.at(element.place, 'expected "nm:value, nm:value ..."')
    return {"table": knots, "outside": "zero"}


def _uniform(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    properties.ignore("wavelength_min", "wavelength_max")
    value = properties.number("value", 1.0)
    properties.finish()
    return value


def _regular(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    first, last = properties.number("wavelength_min", 360.0), properties.number("wavelength_max", 830.0)
    values = numbers(properties.text("values", properties.text("value", "")), element.place)
    properties.finish()
    if len(values) < 2 or not last > first:
        raise InputError.at(element.place, "a table needs two values and a range")
    step = (last - first) / (len(values) - 1)
    return _table(element, [[first + i * step, value] for i, value in enumerate(values)])


def _irregular(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    wavelengths, values = (
        numbers(properties.text(name, ""), element.place) for name in ("wavelengths", "values")
    )
    properties.finish()
    if len(wavelengths) != len(values):
        raise InputError.at(element.place, "as many wavelengths as values are needed")
    return _table(element, [list(knot) for knot in zip(wavelengths, values, strict=True)])


def _d65(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    scale = properties.number("scale", 1.0)
    properties.finish()
    return {"illuminant": "D65", "luminance": units.white() * scale}


def _blackbody(context: Context, element: Element) -> Json:
    properties = context.properties(element)
    temperature, scale = properties.number("temperature", 5000.0), properties.number("scale", 1.0)
    properties.ignore("wavelength_min", "wavelength_max")
    properties.finish()
    if scale != 1.0:
        raise InputError.at(element.place, "a black body's scale is not supported; expected 1")
    return {"blackbody": temperature}


def _unknown(context: Context, element: Element) -> Json:
    context.findings.lost(element.place, f'no support for the spectrum "{element.type}"; taken as 0.5')
    return 0.5


_SPECTRA: dict[str, Callable[[Context, Element], Json]] = {
    "uniform": _uniform,
    "regular": _regular,
    "irregular": _irregular,
    "d65": _d65,
    "blackbody": _blackbody,
}
_REFLECTANCES: dict[str, Callable[[Context, Element], Json]] = {
    "rgb": _rgb_reflectance,
    "spectrum": _spectrum,
    "float": _number,
    "integer": _number,
}
_LIGHTS = _REFLECTANCES | {"rgb": _rgb_light}


def reflectance(context: Context, element: Element) -> Json:
    """A reflectance that is the same everywhere on a surface."""
    return _read(_REFLECTANCES, context, element)


def light(context: Context, element: Element) -> Json:
    """A radiance, W m-2 sr-1 nm-1, or whatever else is emitted."""
    return _read(_LIGHTS, context, element)


def _rgb_coefficient(context: Context, element: Element) -> Json:
    del context
    values = _not_negative(element, "a coefficient")
    return colours.reflectance(values) if max(values) <= 1 else colours.coefficient(values)


_COEFFICIENTS = _REFLECTANCES | {"rgb": _rgb_coefficient}


def coefficient(context: Context, element: Element) -> Json:
    """A coefficient or an albedo of a medium: a number or a table."""
    found = _read(_COEFFICIENTS, context, element)
    if isinstance(found, dict) and not {"table", "rgb"} & found.keys():
        raise InputError.at(element.place, "a coefficient is a number, a colour or a table")
    if isinstance(found, float | int) and found < 0:
        raise InputError.at(element.place, "a coefficient is not negative")
    return found


def _read(table: dict[str, Callable[[Context, Element], Json]], context: Context, element: Element) -> Json:
    if element.tag not in table:
        raise InputError.at(element.place, f"<{element.tag}>; expected <{'>, <'.join(table)}>")
    return table[element.tag](context, element)
