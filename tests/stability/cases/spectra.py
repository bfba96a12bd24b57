"""Lines, edges and other spectra that uniform wavelengths miss."""

from math import pi
from typing import Any

from tests.accuracy.tracing import Document
from tests.stability.build import film, lit, walls
from tests.stability.case import Case

_Y_OF_FLAT = 106.856895
"""Integral of the CIE 1931 y-bar over wavelength, nm: a flat spectrum's Y over 683."""

_ABOVE_550 = 62.614882
"""The same from 550 nm: the table at 1 nm, by the trapezoidal rule, exact for curves that are linear in
between."""


def _lamp_box(radiance: Any, albedo: Any = 0.0) -> Document:
    """A film in a box whose walls emit."""
    document = lit(film([0.5, 0.5, 0.5], [0, 0, 1], 0.5), [], None)
    document["surfaces"] = walls([0, 0, 0], 1.0, {"type": "lambertian", "reflectance": albedo}, 1.0)
    for wall in document["surfaces"]:
        wall["luminaire"] = {"radiance": radiance}
    return document


def _sodium(width: float) -> Case:
    lines = [{"nm": 588.995, "power": 2.0, "width": width}, {"nm": 589.592, "power": 1.0, "width": width}]
    return Case(
        f"sodium lines, {width:g} nm wide",
        "all light in two lines",
        _lamp_box({"lines": lines}),
        pi * 3.0 * 0.7667963 / _Y_OF_FLAT,
        "CIE 1931 observer, linear in between: 0.7667963 lm/W over 683",
        allowed=1e-3 if width > 0.5 else 1e-4,
        remedy="the sensor's wavelengths by response, which draws half of the photons for lines",
    )


def _laser() -> Case:
    line = {"nm": 632.8, "power": 1.0, "width": 0.01}
    return Case(
        "laser, 0.01 nm wide",
        "a line that uniform wavelengths never meet",
        _lamp_box({"lines": [line]}),
        pi * 0.23724544 / _Y_OF_FLAT,
        "CIE 1931 observer at 632.8 nm: 0.23724544",
        allowed=1e-4,
        remedy="the sensor's wavelengths by response, which draws half of the photons for lines",
    )


def _line_beside_lamp() -> Case:
    """Half of the photons are drawn for lines; flat light must not suffer."""
    document = _lamp_box(1.0, 0.5)
    document["surfaces"][0]["luminaire"] = {
        "radiance": {"table": [[300, 1], [900, 1]]},
    }
    document["spectra"] = {"line": {"lines": [{"nm": 589.3, "power": 1e-9, "width": 0.01}]}}
    lamp = document["surfaces"][1]
    lamp["luminaire"] = {"radiance": 1.0}
    document["distant"] = [{"direction": [0, 0, 1], "irradiance": "line"}]
    return Case(
        "a line too weak to be seen beside flat light",
        "half of the photons go to a line that carries nothing",
        document,
        2.0 * pi,
        "energy balance: irradiance pi L / (1 - albedo) in a closed box",
    )


def _edge() -> Case:
    """A reflectance that jumps within 0.01 nm."""
    edge = {"table": [[360, 0.0], [549.99, 0.0], [550.0, 1.0], [830, 1.0]]}
    both = {"table": [[360, 0.5], [830, 0.5]]}
    document = _lamp_box(1.0, both)
    # Light of the kind that the edge lets pass: emission by a table with the same edge.
    for wall in document["surfaces"]:
        wall["luminaire"] = {"radiance": edge | {"outside": "zero"}}
    return Case(
        "a spectrum with an edge of 0.01 nm",
        "emission that begins at 550 nm at once",
        document,
        2.0 * pi * _ABOVE_550 / _Y_OF_FLAT,
        "sum of the CIE 1931 observer from 550 nm",
        allowed=2e-4,
    )


CASES = [*map(_sodium, (1.0, 0.1, 0.01)), _laser(), _line_beside_lamp(), _edge()]
