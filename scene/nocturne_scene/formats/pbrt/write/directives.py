"""Directives and parameters as pbrt's scenes have them."""

from collections.abc import Iterable

import numpy as np

from nocturne_scene.formats.writing.tables import Array, Table
from nocturne_scene.spectra.published import FIRST, LAST, MAX_LUMINOUS_EFFICACY, observer, visible_wavelengths


def directive(name: str, *words: str | float) -> str:
    """A line: strings are quoted, parameters follow as they are."""
    return " ".join([name, *(word if isinstance(word, str) else _number(word) for word in words)])


def quoted(text: str) -> str:
    """A string; ours have no quotes inside."""
    return f'"{text}"'


def real(name: str, *values: float) -> str:
    """A parameter of numbers."""
    return f'"float {name}" {_list(values)}'


def whole(name: str, *values: int) -> str:
    """A parameter of whole numbers."""
    return f'"integer {name}" [ {" ".join(map(str, values))} ]'


def rows(kind: str, name: str, values: Array) -> str:
    """A parameter of points or the like, shape (n, 2 or 3)."""
    return f'"{kind} {name}" {_list(values.ravel())}'


def text(name: str, value: str) -> str:
    """A parameter that is a string."""
    return f'"string {name}" {quoted(value)}'


def switch(name: str, value: bool) -> str:
    """A parameter that is true or false."""
    return f'"bool {name}" {str(value).lower()}'


def texture(name: str, value: str) -> str:
    """A parameter that is a texture."""
    return f'"texture {name}" {quoted(value)}'


def spectrum(name: str, table: Table) -> str:
    """A function of wavelength, zero beyond its ends there as here."""
    if table.wavelengths is None:
        pairs = np.array([[FIRST, table.values[0]], [LAST, table.values[0]]])
    else:
        pairs = np.stack([table.wavelengths, table.values], axis=1)
    return f'"spectrum {name}" {_list(pairs.ravel())}'


def reflectance(name: str, table: Table) -> str:
    """A reflectance; a colour with equal channels is the same at every wavelength there."""
    return spectrum(name, table) if table.constant is None else f'"rgb {name}" {_list([table.constant] * 3)}'


def light(name: str, table: Table) -> list[str]:
    """A radiance: pbrt divides by the luminance, a sum over whole nm, and `scale` gives it back."""
    at = visible_wavelengths()
    luminance = MAX_LUMINOUS_EFFICACY * float(table.at(at) @ observer("CIE 1931 2 degree")[:, 1])
    return [spectrum(name, table), real("scale", luminance)]


def placement(axes: Iterable[Array], origin: Array) -> str:
    """The images of x, y and z, and of the origin: 16 numbers by columns."""
    columns = np.zeros((4, 4))
    columns[:3, :3] = np.array(list(axes))
    columns[3] = [*origin, 1.0]
    return _list(columns.ravel())


def _list(values: Iterable[float]) -> str:
    return f"[ {' '.join(_number(value) for value in values)} ]"


def _number(value: float) -> str:
    return repr(float(value)).removesuffix(".0")
