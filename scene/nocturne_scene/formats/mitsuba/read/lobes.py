"""Materials of Mitsuba 0.x that Mitsuba 3 has no plugin for: a lobe with a diffuse part, and thin leaves.

Sources: bsdfs/phong.cpp, bsdfs/ward.cpp and bsdfs/difftrans.cpp of Mitsuba 0.6.
"""

from collections.abc import Callable

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import textures
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.scene_writer import Json

# Of two parts that reflect more than all light, what 0.6 lets them reflect: librender/bsdf.cpp.
_CONSERVED = 0.99


def phong(context: Context, properties: Properties) -> Json:
    """The modified Phong lobe of Lafortune and Willems (1994), (n + 2) / 2 pi cos^n, and a diffuse part."""
    exponent = textures.number(context, properties, "exponent", 30.0)
    if not isinstance(exponent, float | int):
        context.findings.lost(properties.place, "no support for an exponent that varies; taken as 30")
        exponent = 30.0
    if exponent < 0:
        raise InputError.at(properties.place, f"an exponent is not negative, found {exponent:g}")
    return _beside_diffuse(
        context, properties, lambda colour: {"type": "phong", "reflectance": colour, "exponent": exponent}
    )


def ward(context: Context, properties: Properties) -> Json:
    """Ward's lobe as a metal: Beckmann's facets of the same alpha, equal at normal incidence.

    That is B. Walter's derivation of Ward's model ("Notes on the Ward BRDF", 2005): it has the slopes of
    Beckmann's facets without their shadows.
    """
    properties.ignore("variant")
    both = properties.number("alpha", 0.1)
    found: dict[str, float] = {}
    for axis in ("u", "v"):
        found[f"roughness_{axis}"] = textures.number(context, properties, f"alpha_{axis}", both)
    if found["roughness_u"] == found["roughness_v"]:
        found = {"roughness": found["roughness_u"]}
    context.findings.note(
        "", "a ward lobe became that of metal with Beckmann's facets: equal but for grazing angles"
    )

    def lobe(colour: Json) -> Json:
        if isinstance(colour, dict) and "texture" in colour:
            colour = textures.mean(context, colour, 0.2, properties.place)
            context.findings.lost(
                properties.place, "no support for a ward lobe that varies; taken as its mean"
            )
        index = metals.of_colour(colour)
        return {"type": "conductor", "index": index, "distribution": "beckmann", **found}

    return _beside_diffuse(context, properties, lobe)


def leaf(context: Context, properties: Properties) -> Json:
    """A diffuse surface that all scattered light goes through."""
    name = "transmittance" if properties.has("transmittance") else "diffuse_transmittance"
    passing = textures.colour(context, properties, name, 0.5)
    return {"type": "diffuse_transmitter", "reflectance": 0.0, "transmittance": passing}


def _beside_diffuse(context: Context, properties: Properties, lobe: Callable[[Json], Json]) -> Json:
    """The sum of both as a blend: parts whose colours are as much brighter as the other takes away."""
    diffuse = textures.colour(context, properties, "diffuse_reflectance", 0.5)
    glossy = textures.colour(context, properties, "specular_reflectance", 0.2)
    most_diffuse, most_glossy = (_brightest(context, each, properties.place) for each in (diffuse, glossy))
    total = most_diffuse + most_glossy
    if total > 1:
        context.findings.note(
            properties.place,
            f"both parts together reflect up to {total:.3g}; taken {_CONSERVED / total:.3g} times each",
        )
    # A part with weight w has to be 1 / w times as bright; both are as bright as their sum then.
    bright = _CONSERVED if total > 1 else total
    parts = [
        {
            "type": "lambertian",
            "reflectance": _scaled(context, diffuse, most_diffuse, bright, properties.place),
        },
        lobe(_scaled(context, glossy, most_glossy, bright, properties.place)),
    ]
    if most_glossy == 0 or most_diffuse == 0:
        return parts[0] if most_glossy == 0 else parts[1]
    return {"type": "blend", "first": parts[0], "second": parts[1], "weight": most_glossy / total}


def _brightest(context: Context, colour: Json, place: str) -> float:
    """The largest value of a colour, a table or a picture."""
    if isinstance(colour, float | int):
        return float(colour)
    if "texture" in colour:
        return float(textures.pixels_of(context, colour, place).max())
    return float(max(colour["rgb"]) if "rgb" in colour else max(value for _, value in colour["table"]))


def _scaled(context: Context, colour: Json, brightest: float, wanted: float, place: str) -> Json:
    """A colour whose largest value is changed."""
    factor = wanted / brightest if brightest > 0 else 1.0
    if factor == 1.0:
        return colour
    if isinstance(colour, float | int):
        return colour * factor
    if "texture" in colour:
        return textures.changed(context, colour, lambda pixels: np.minimum(pixels * factor, 1.0), place)
    if "rgb" in colour:
        return {"rgb": [min(value * factor, 1.0) for value in colour["rgb"]]}
    return colours.scaled(colour, factor)
