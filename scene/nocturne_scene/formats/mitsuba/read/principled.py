"""Mitsuba's principled material, where it is one of the kernels: metal, or glass.

Between the two, and where nothing is let through, it adds a diffuse lobe to a glossy one without regard to
each other; that has no equal, and our own principled kernel stands in its place.
"""

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import textures
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import metals
from nocturne_scene.formats.reading.scene_writer import Json

_LEAST_ALPHA = 1e-3
# Parts of the diffuse lobe, and how its lobes are sampled.
_OF_DIFFUSE = ("sheen", "sheen_tint", "flatness")
_SAMPLING = ("main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate")


def principled(context: Context, properties: Properties) -> Json:
    """A kernel: of metal a conductor, to be seen from the front; of glass a dielectric; else ours."""
    metallic = textures.number(context, properties, "metallic", 0.0)
    transmission = textures.number(context, properties, "spec_trans", 0.0)
    base = textures.colour(context, properties, "base_color", 0.5)
    index = _index(properties)
    roughness = _roughness(context, properties)
    _need(context, properties, "clearcoat", 0.0)
    _need(context, properties, "anisotropic", 0.0)
    properties.ignore("clearcoat_gloss", *_SAMPLING)
    if metallic == 1.0:
        properties.ignore("spec_tint", *_OF_DIFFUSE)
        return {"type": "conductor", "index": _metal(context, properties, base)} | roughness
    _need(context, properties, "spec_tint", 0.0)
    if metallic == 0.0 and transmission == 1.0:
        properties.ignore(*_OF_DIFFUSE)
        if base != 1.0:
            context.findings.lost(
                properties.place, 'no equal of a principled "base_color" of glass other than 1'
            )
        return {"type": "dielectric", "index": index} | roughness
    context.findings.lost(
        properties.place,
        'no equal of a principled "metallic" other than 1, or 0 with a "spec_trans" of 1. Taken as ours',
    )
    properties.ignore(*_OF_DIFFUSE)
    return {
        "type": "principled",
        "base": base,
        "metallic": metallic,
        "roughness": float(roughness["roughness"] ** 0.5),
        "index": index,
    }


def _index(properties: Properties) -> float:
    """`eta`, or `specular`: 0.08 of it is the reflectance at normal incidence."""
    eta, specular = properties.number("eta", None), properties.number("specular", None)
    if eta is not None and specular is not None:
        raise InputError.at(properties.place, 'expected "eta" or "specular", found both')
    if eta is None:
        specular = 0.5 if specular is None else specular
        if not 0 <= specular <= 1:
            raise InputError.at(properties.place, f'"specular" lies between 0 and 1, found {specular:g}')
        # 0 is 0.001 there.
        eta = float(2 / (1 - (0.08 * max(specular, 1e-3)) ** 0.5) - 1)
    if not eta > 0:
        raise InputError.at(properties.place, f"an index of refraction is positive, found {eta:g}")
    return eta


def _roughness(context: Context, properties: Properties) -> Json:
    roughness = textures.number(context, properties, "roughness", 0.5)
    if not isinstance(roughness, float):
        context.findings.lost(
            properties.place, 'no equal of a principled "roughness" that varies; taken as 0.5'
        )
        roughness = 0.5
    return {"roughness": max(_LEAST_ALPHA, roughness**2)}


def _need(context: Context, properties: Properties, name: str, value: float) -> None:
    if textures.number(context, properties, name, value) != value:
        context.findings.lost(properties.place, f'no equal of a principled "{name}" other than {value:g}')


def _metal(context: Context, properties: Properties, base: Json) -> Json:
    if isinstance(base, dict) and "texture" in base:
        context.findings.lost(
            properties.place, 'no equal of a principled "base_color" of metal that varies; taken as 0.5'
        )
        base = 0.5
    context.findings.note(
        properties.place, "metal has its base colour at normal incidence, and Fresnel's at others"
    )
    return metals.of_colour(base)
