"""Participating media inside and outside of shapes.

Its media change where a ray crosses a boundary; ours are where a body is, and add up. The two agree unless
bodies with media are inside of others.
"""

from collections.abc import Callable

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.mitsuba.read.volumes import UNIT_CUBE, Volume, volume
from nocturne_scene.formats.reading import colours, grids
from nocturne_scene.formats.reading.scene_writer import Json

_CLEAR = ("dielectric", "thin_pane", "null")


def interior(context: Context, properties: Properties, surface: Json, kernel: Json) -> None:
    """Put what a shape encloses into its surface."""
    inside, outside = (properties.take(name) for name in ("interior", "exterior"))
    if inside is not None:
        name = medium(context, inside)
        context.enclosed.add(name)
        if name:
            surface["interior"] = {"media": [name]}
    # What is outside of a body of glass, or of what lets nothing through, is there anyway.
    shape_only = kernel["type"] not in _CLEAR or kernel["type"] == "dielectric"
    if outside is not None and not shape_only and medium(context, outside):
        context.findings.lost(
            outside.place, "a boundary that is not glass inside of a medium has no equal: media add up"
        )


def around_sensor(context: Context, properties: Properties) -> None:
    """Note the medium that the sensor is in: one that no shape encloses is everywhere."""
    element = properties.take("medium")
    found = [element] if element is not None else properties.take_all("medium")
    for each in found:
        name = medium(context, each)
        if name and name not in context.enclosed:
            context.writer.document.setdefault("unbounded_media", []).append(name)


def medium(context: Context, element: Element) -> str:
    """The name of a medium; each element becomes one. Empty where light does not notice it."""
    if id(element) not in context.media:
        context.media[id(element)] = _add(context, element)
    return context.media[id(element)]


def _add(context: Context, element: Element) -> str:
    if element.type not in ("homogeneous", "heterogeneous"):
        context.findings.lost(
            element.place,
            f'no equal of the medium "{element.type}"; expected homogeneous or heterogeneous. Empty',
        )
        return ""
    properties = context.properties(element)
    scale = properties.number("scale", 1.0)
    extinction = volume(context, properties, "sigma_t", 1.0)
    if element.type == "homogeneous":
        extinction = Volume(extinction.value)
    elif extinction.grid is None:
        # Of a heterogeneous medium a number, too, is there in the cube from 0 to 1 only.
        extinction = Volume(extinction.value, UNIT_CUBE)
    albedo = volume(context, properties, "albedo", 0.75)
    phases = properties.take_all("phase")
    phase = _phase(context, phases[0]) if phases else None
    properties.ignore("sample_emitters", "has_spectral_extinction")
    properties.finish()
    if scale < 0:
        raise InputError.at(element.place, "a medium's scale is not negative")
    if scale == 0 or extinction.value == 0.0:
        return ""
    made = _coefficients(context, element, scale, extinction, albedo)
    if phase is not None and "scattering" in made:
        made["phase"] = phase
    return context.writer.name("media", element.id or "medium", made)


def _coefficients(
    context: Context, element: Element, scale: float, extinction: Volume, albedo: Volume
) -> Json:
    if albedo.grid is not None:
        context.findings.lost(element.place, "an albedo that varies in space has no equal; taken as 1")
    at = colours.knots(extinction.value, albedo.value)
    total, share = (colours.values_of(each, at) for each in (extinction.value, albedo.value))
    if np.any(share > 1 + 1e-6) or np.any(share < 0):
        raise InputError.at(element.place, "an albedo lies between 0 and 1")
    # A grid's values are the density, and so is `scale`.
    factor = 1.0 if extinction.grid is not None else scale
    found: Json = {}
    for name, values in (
        ("absorption", factor * total * np.maximum(1 - share, 0)),
        ("scattering", factor * total * share),
    ):
        if np.any(values > 0):
            found[name] = colours.table(at, values)
    if not found:
        found["absorption"] = 0.0
    if extinction.grid is not None:
        found["density"] = grids.density(context.writer, extinction.grid, scale, element.place)
    return found


def _isotropic(context: Context, properties: Properties) -> Json:
    del context, properties
    return {"type": "isotropic"}


def _hg(context: Context, properties: Properties) -> Json:
    del context
    g = properties.number("g", 0.8)
    if not -1 < g < 1:
        raise InputError.at(properties.place, f"g lies between -1 and 1, found {g:g}")
    return {"type": "henyey_greenstein", "g": g} if g else {"type": "isotropic"}


def _rayleigh(context: Context, properties: Properties) -> Json:
    del context, properties
    return {"type": "rayleigh"}


def _blend(context: Context, properties: Properties) -> Json:
    phases = [_phase(context, element) for element in properties.take_all("phase")]
    weight = volume(context, properties, "weight", 0.5)
    known = [phase.get("g", 0.0) for phase in phases if phase["type"] in ("henyey_greenstein", "isotropic")]
    if len(known) != 2 or not isinstance(weight.value, float) or weight.grid is not None:
        context.findings.lost(
            properties.place, "a blend of phase functions other than two hg by a number has no equal"
        )
        return {"type": "isotropic"}
    first, second = known
    return {"type": "double_henyey_greenstein", "first": first, "second": second, "weight": 1 - weight.value}


_PHASES: dict[str, Callable[[Context, Properties], Json]] = {
    "isotropic": _isotropic,
    "hg": _hg,
    "rayleigh": _rayleigh,
    "blendphase": _blend,
}


def _phase(context: Context, element: Element) -> Json:
    if element.type not in _PHASES:
        context.findings.lost(
            element.place,
            f'no equal of the phase function "{element.type}"; there are {", ".join(_PHASES)}',
        )
        return {"type": "isotropic"}
    properties = context.properties(element)
    found = _PHASES[element.type](context, properties)
    properties.finish()
    return found
