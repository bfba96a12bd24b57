"""Participating media inside and outside of shapes.

Its media change where a ray crosses a boundary; ours are where a body is, and add up. The two agree unless
bodies with media are inside of others.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.elements import Element
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.mitsuba.read.volumes import UNIT_CUBE, Volume, volume
from nocturne_scene.formats.reading import coloured_grids, colours
from nocturne_scene.formats.reading.scene_writer import Json

_CLEAR = ("dielectric", "thin_pane", "null")


def interior(context: Context, properties: Properties, surface: Json, kernel: Json) -> None:
    """Put what a shape encloses into its surface."""
    inside, outside = (properties.take(name) for name in ("interior", "exterior"))
    if inside is not None:
        names = medium(context, inside)
        context.enclosed.update(names)
        if names:
            surface["interior"] = {"media": list(names)}
    # The medium outside of a body of glass, or of an opaque body, is there anyway.
    shape_only = kernel["type"] not in _CLEAR or kernel["type"] == "dielectric"
    if outside is not None and not shape_only and medium(context, outside):
        context.findings.lost(
            outside.place, "a boundary that is not glass inside of a medium is not supported: media add up"
        )


def around_sensor(context: Context, properties: Properties) -> None:
    """Note the medium that the sensor is in: one that no shape encloses is everywhere."""
    element = properties.take("medium")
    found = [element] if element is not None else properties.take_all("medium")
    for each in found:
        names = medium(context, each)
        if names and not context.enclosed.intersection(names):
            context.writer.document.setdefault("unbounded_media", []).extend(names)


def medium(context: Context, element: Element) -> list[str]:
    """The names of the media that stand for an element's. Empty where light does not notice it."""
    if element.number not in context.media:
        context.media[element.number] = _add(context, element)
    return context.media[element.number]


def _add(context: Context, element: Element) -> list[str]:
    if element.type not in ("homogeneous", "heterogeneous"):
        context.findings.lost(
            element.place,
            f'no support for the medium "{element.type}"; expected homogeneous or heterogeneous. Empty',
        )
        return []
    properties = context.properties(element)
    scale = properties.number("scale", 1.0)
    extinction = volume(context, properties, "sigma_t", 1.0)
    if element.type == "homogeneous":
        extinction = Volume(extinction.value)
    elif not extinction.grids:
        # Of a heterogeneous medium a number, too, is there in the cube from 0 to 1 only.
        extinction = Volume(extinction.value, (UNIT_CUBE,))
    albedo = volume(context, properties, "albedo", 0.75)
    phases = properties.take_all("phase")
    phase = _phase(context, phases[0]) if phases else None
    properties.ignore("sample_emitters", "has_spectral_extinction")
    properties.finish()
    if scale < 0:
        raise InputError.at(element.place, "a medium's scale is not negative")
    if scale == 0 or extinction.value == 0.0:
        return []
    name, scatters = element.id or "medium", {} if phase is None else {"phase": phase}
    if not extinction.grids:
        if albedo.grids:
            context.findings.lost(
                element.place,
                "a varying albedo in an even medium is not supported; taken as its mean",
            )
            means = [float(grid.values.mean()) for grid in albedo.grids]
            albedo = Volume(colours.reflectance(means if len(means) == 3 else means * 3))
        made = _coefficients(element, colours.scaled(extinction.value, scale), albedo.value)
        return [context.writer.name("media", name, made | (scatters if "scattering" in made else {}))]
    make = _varying_albedo if albedo.grids else _even_albedo
    parts = [
        (fields | (scatters if "scattering" in fields else {}), *densities)
        for fields, *densities in make(element, extinction, albedo)
    ]
    return coloured_grids.add(context.writer, name, parts, scale, element.place)


def _even_albedo(element: Element, extinction: Volume, albedo: Volume) -> list[coloured_grids.Part]:
    """A medium for each channel."""
    spectra = coloured_grids.by_channel(extinction.value, len(extinction.grids))
    return [
        (_coefficients(element, spectrum, albedo.value), grid, None)
        for spectrum, grid in zip(spectra, extinction.grids, strict=True)
    ]


def _coefficients(element: Element, extinction: Json, albedo: Json) -> Json:
    at = colours.knots(extinction, albedo)
    total, share = (colours.values_of(each, at) for each in (extinction, albedo))
    if np.any(share > 1 + 1e-6) or np.any(share < 0):
        raise InputError.at(element.place, "an albedo lies between 0 and 1")
    parts = (("absorption", total * np.maximum(1 - share, 0)), ("scattering", total * share))
    return {name: colours.table(at, values) for name, values in parts if np.any(values > 0)} or {
        "absorption": 0.0
    }


def _varying_albedo(element: Element, extinction: Volume, albedo: Volume) -> list[coloured_grids.Part]:
    """A medium that scatters and one that absorbs for each channel."""
    channels = max(len(extinction.grids), len(albedo.grids))
    found: list[coloured_grids.Part] = []
    for index, spectrum in enumerate(coloured_grids.by_channel(extinction.value, channels)):
        density = extinction.grids[index % len(extinction.grids)]
        share = albedo.grids[index % len(albedo.grids)]
        if share.values.max() > 1 + 1e-6:
            raise InputError.at(element.place, "an albedo lies between 0 and 1")
        rest = replace(share, values=np.maximum(1 - share.values, 0.0))
        found += [({"scattering": spectrum}, density, share), ({"absorption": spectrum}, density, rest)]
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
    if len(known) != 2 or not isinstance(weight.value, float) or weight.grids:
        context.findings.lost(
            properties.place, "a blend of phase functions other than two hg by a number is not supported"
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
            f'no support for the phase function "{element.type}"; there are {", ".join(_PHASES)}',
        )
        return {"type": "isotropic"}
    properties = context.properties(element)
    found = _PHASES[element.type](context, properties)
    properties.finish()
    return found
