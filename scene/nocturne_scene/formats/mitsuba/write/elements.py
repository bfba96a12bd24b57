"""XML elements as Mitsuba's scenes have them."""

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from nocturne_scene.formats.writing.tables import Array, Table

__all__ = ["Element", "matrix", "parameter", "plugin", "reference", "spectrum", "write"]

Value = float | int | bool | str


def plugin(tag: str, kind: str, *, name: str = "", id_: str = "", **parameters: Value) -> Element:
    """A plugin with its numbers, switches and strings."""
    element = Element(tag, {"type": kind})
    if name:
        element.set("name", name)
    if id_:
        element.set("id", id_)
    for key, value in parameters.items():
        parameter(element, key, value)
    return element


def parameter(parent: Element, name: str, value: Value) -> None:
    """Add a number, a switch or a string."""
    tags = {bool: "boolean", int: "integer", float: "float", str: "string"}
    text = str(value).lower() if isinstance(value, bool) else str(value)
    SubElement(parent, tags[type(value)], {"name": name, "value": text})


def reference(id_: str, name: str = "") -> Element:
    """A reference to the element with an id."""
    return Element("ref", {"id": id_, **({"name": name} if name else {})})


def spectrum(name: str, table: Table) -> Element:
    """A function of wavelength."""
    # Its tables must not be zero everywhere.
    if table.constant is not None or table.is_black:
        return Element("spectrum", {"name": name, "value": repr(table.constant or 0.0)})
    assert table.wavelengths is not None  # noqa: S101 - it is no constant
    pairs = zip(table.wavelengths, table.values, strict=True)
    return Element("spectrum", {"name": name, "value": ", ".join(f"{at:.9g}:{v:.9g}" for at, v in pairs)})


def matrix(name: str, axes: Iterable[Array], origin: Array) -> Element:
    """What places: the images of x, y and z, and of the origin."""
    rows = np.eye(4)
    rows[:3, :3] = np.column_stack(list(axes))
    rows[:3, 3] = origin
    element = Element("transform", {"name": name})
    SubElement(element, "matrix", {"value": " ".join(repr(float(value)) for value in rows.ravel())})
    return element


def write(root: Element) -> bytes:
    """The file."""
    indent(root, "  ")
    text: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
