"""Colours and transformations of Mitsuba 0.x in the words of Mitsuba 3.

Source, where none is named: endElement in src/librender/scenehandler.cpp of Mitsuba 0.6.
"""

import re

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.elements import Element, hexadecimal, numbers
from nocturne_scene.formats.reading import colours
from nocturne_scene.spectra.published import planck

_LETTERS = re.compile(r"(?<=[a-z])([A-Z]+)")


def snake_case(name: str) -> str:
    """toWorld as to_world, intIOR as int_ior: camel_to_underscore_case in parser.cpp of Mitsuba 3."""
    return _LETTERS.sub(lambda match: "_" + match[1].lower(), name)


def made(tag: str, place: str, *children: Element, **attributes: str) -> Element:
    """A new element at the place of an old one."""
    return Element(tag, attributes, place, list(children))


def said(tag: str, name: str, value: object, place: str) -> Element:
    """A new parameter."""
    return made(tag, place, name=name, value=str(value))


def upgrade_colour(element: Element, *, emitted: bool) -> None:
    """Change a colour or spectrum in place. Raises InputError for any other element."""
    intent = element.attributes.pop("intent", "illuminant" if emitted else "reflectance").lower()
    match element.tag:
        case "rgb" | "srgb":
            _upgrade_rgb(element)
        case "blackbody":
            _upgrade_blackbody(element)
        case "spectrum" if "value" in element.attributes and ":" not in element.attributes["value"]:
            _upgrade_numbers(element, emitted=intent == "illuminant")


def _upgrade_rgb(element: Element) -> None:
    """Hexadecimal numbers of an <rgb> are linear; an <srgb> is encoded whatever its form."""
    values = hexadecimal(element)
    if values is None and element.tag != "srgb":
        return
    if values is None:
        values = numbers(element.need("value"), element.place)
    if element.tag == "srgb":
        values = colours.decode_srgb(values)
    element.tag = "rgb"
    element.attributes["value"] = " ".join(map(str, values))


def _upgrade_numbers(element: Element, *, emitted: bool) -> None:
    """One number is grey, as light D65 (getD65); three are linear sRGB, of which 0.x's colours consist."""
    values = numbers(element.attributes["value"], element.place)
    if len(values) == 3:
        element.tag = "rgb"
    elif len(values) == 1 and emitted:
        del element.attributes["value"]
        element.attributes["type"] = "d65"
        element.children = [said("float", "scale", values[0], element.place)]
    elif len(values) != 1:
        raise InputError.at(
            element.place, f"expected 1 or 3 numbers, or nm:value pairs, found {len(values)} numbers"
        )


def _upgrade_blackbody(element: Element) -> None:
    """In W m-2 sr-1 nm-1, as Mitsuba 3 has it; one that is scaled becomes a table."""
    text = element.attributes.pop("temperature", "").strip().removesuffix("K").removesuffix("k")
    kelvin = numbers(text, element.place, 1)[0]
    scale = numbers(
        element.attributes.pop("scale", element.attributes.pop("multiplier", "1")), element.place, 1
    )[0]
    if not kelvin > 0:
        raise InputError.at(element.place, f"a temperature is positive, found {kelvin:g}")
    element.tag = "spectrum"
    if scale == 1:
        element.attributes["type"] = "blackbody"
        element.children = [said("float", "temperature", kelvin, element.place)]
        return
    values = (scale * planck(kelvin, colours.SMOOTH)).tolist()
    knots = zip(colours.SMOOTH.tolist(), values, strict=True)
    element.attributes["value"] = " ".join(f"{nm:g}:{value!r}" for nm, value in knots)


def upgrade_steps(element: Element) -> None:
    """Change the steps of a transformation in place."""
    steps: list[Element] = []
    for step in element.children:
        if step.tag.lower() == "lookat":
            step.tag = "lookat"
        if "ox" in step.attributes and step.tag == "lookat":
            # data/schema/upgrade_0.3.0.xsl.
            steps.append(made("scale", step.place, x="-1"))
            taken = {axis: step.attributes.pop(axis, "0") for axis in _OLD_LOOK_AT}
            for name, first in (("origin", "o"), ("target", "t"), ("up", "u")):
                step.attributes[name] = " ".join(taken[first + axis] for axis in "xyz")
        steps.append(step)
    element.children = steps


_OLD_LOOK_AT = [first + axis for first in "otu" for axis in "xyz"]
