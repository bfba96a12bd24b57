"""Mitsuba's principled material: metal is a conductor, glass a dielectric, all else our principled kernel.

Mitsuba's adds its lobes without regard to each other, so that they may send back more than came in. In ours
the base gets what the glossy part lets through; it is made lighter so that in even light there is no
difference (burley.py).
"""

from collections.abc import Sequence

from nocturne_scene.errors import InputError
from nocturne_scene.formats.mitsuba.read import burley, textures
from nocturne_scene.formats.mitsuba.read.context import Context
from nocturne_scene.formats.mitsuba.read.properties import Properties
from nocturne_scene.formats.reading import colours, metals
from nocturne_scene.formats.reading.scene_writer import Json
from nocturne_scene.spectra.published import SRGB_LUMINANCE

_LEAST_ALPHA = 1e-3
_WHITE = [1.0] * 3
# How its lobes are sampled.
_SAMPLING = ("main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate")
# A clear coat is a quarter of a coat of this index, and reflects of even light so much.
_COAT, _COAT_INDEX, _COAT_REFLECTS = 0.25, 1.5, 0.0918


def principled(context: Context, properties: Properties) -> Json:
    """A kernel; of metal to be seen from the front."""
    metallic = textures.number(context, properties, "metallic", 0.0)
    transmission = textures.number(context, properties, "spec_trans", 0.0)
    base = textures.colour(context, properties, "base_color", 0.5)
    index = _index(properties)
    roughness = textures.number(context, properties, "roughness", 0.5)
    anisotropic = _number(context, properties, "anisotropic", 0.0)
    coat = _number(context, properties, "clearcoat", 0.0)
    gloss = _number(context, properties, "clearcoat_gloss", 0.0)
    properties.ignore(*_SAMPLING)
    even = isinstance(roughness, float) and not (isinstance(base, dict) and "texture" in base)
    if metallic == 1.0 and coat == 0.0 and anisotropic == 0.0 and even:
        properties.ignore("spec_tint", "sheen", "sheen_tint", "flatness")
        context.findings.note(
            properties.place, "metal has its base colour at normal incidence, and Fresnel's at others"
        )
        return {"type": "conductor", "index": metals.of_colour(base), "roughness": _alpha(roughness)}
    if metallic == 0.0 and transmission == 1.0:
        properties.ignore("sheen", "sheen_tint", "flatness")
        _need(context, properties, "spec_tint", 0.0)
        return _glass(context, properties, base, index, roughness)
    found = {"type": "principled", "metallic": metallic, "index": index}
    hue = _hue(context, properties, base, "spec_tint")
    found |= _facets(roughness, anisotropic) | _tinted(hue, index)
    found |= _sheen(context, properties, base, metallic)
    flatness = _number(context, properties, "flatness", 0.0)
    found["base"] = _base(base, metallic, flatness, (index, hue), roughness, coat)
    if coat > 0:
        alpha = 0.1 + gloss * (0.001 - 0.1)
        found |= {"coat": min(1.0, _COAT * coat), "coat_roughness": alpha**0.5, "coat_index": _COAT_INDEX}
    context.findings.note(
        properties.place,
        "a principled material became ours, in which no part gets light that another one reflects; "
        "in even light the diffuse part sends back as much",
    )
    if transmission == 0.0 or metallic == 1.0:
        return found
    if metallic != 0.0:
        context.findings.lost(properties.place, "no support for a principled glass that is partly metal")
    glass = _glass(context, properties, base, index, roughness)
    return {"type": "blend", "first": found, "second": glass, "weight": transmission}


def _number(context: Context, properties: Properties, name: str, default: float) -> float:
    found = textures.number(context, properties, name, default)
    if isinstance(found, float | int):
        return float(found)
    mean = textures.mean(context, found, default, properties.place)
    context.findings.lost(
        properties.place, f'no support for a principled "{name}" that varies; taken as its mean, {mean:.3g}'
    )
    return mean


def _alpha(roughness: float) -> float:
    return float(max(_LEAST_ALPHA, roughness**2))


def _glass(context: Context, properties: Properties, base: Json, index: float, roughness: Json) -> Json:
    if base != 1.0:
        context.findings.lost(
            properties.place, 'no support for a principled "base_color" of glass other than 1'
        )
    if not isinstance(roughness, float):
        roughness = textures.mean(context, roughness, 0.5, properties.place)
        context.findings.lost(
            properties.place,
            f'no support for a principled "roughness" of glass that varies; taken as its mean, '
            f"{roughness:.3g}",
        )
    return {"type": "dielectric", "index": index, "roughness": _alpha(roughness)}


def _facets(roughness: Json, anisotropic: float) -> Json:
    """Alpha along u and across: the square of roughness, over and times an aspect."""
    if anisotropic == 0.0:
        return {"roughness": roughness}
    root = (1 - 0.9 * min(1.0, anisotropic)) ** 0.25
    if not isinstance(roughness, float):
        gain = roughness.get("gain", 1.0)
        return {
            "roughness": roughness | {"gain": gain / root},
            "roughness_across": roughness | {"gain": gain * root},
        }
    return {"roughness": min(1.0, roughness / root), "roughness_across": roughness * root}


def _hue(context: Context, properties: Properties, base: Json, name: str) -> list[float]:
    """White, of which `name` says how much has the hue of the base: linear sRGB of luminance 1."""
    amount = _number(context, properties, name, 0.0)
    if amount == 0.0 or isinstance(base, float):
        return _WHITE
    if "rgb" not in base or not max(base["rgb"]) > 0:
        context.findings.lost(properties.place, f'no support for a "{name}" whose "base_color" is no rgb')
        return _WHITE
    luminance = sum(part * each for part, each in zip(SRGB_LUMINANCE, base["rgb"], strict=True))
    return [1 + amount * (each / luminance - 1) for each in base["rgb"]]


def _tinted(hue: Sequence[float], index: float) -> Json:
    if hue == _WHITE:
        return {}
    own = _at_normal(index)
    return {"specular_colour": colours.reflectance([min(1.0, own * each) for each in hue])}


def _sheen(context: Context, properties: Properties, base: Json, metallic: Json) -> Json:
    amount = _number(context, properties, "sheen", 0.0)
    hue = _hue(context, properties, base, "sheen_tint")
    if amount == 0.0 or metallic == 1.0:
        return {}
    part = amount * burley.sheen_albedo() * (1 - metallic if isinstance(metallic, float) else 1.0)
    colour = colours.reflectance([min(1.0, max(0.0, part * each)) for each in hue])
    return {"sheen": colour, "sheen_roughness": burley.SHEEN_ROUGHNESS}


def _base(
    base: Json,
    metallic: Json,
    flatness: float,
    facets: tuple[float, list[float]],
    roughness: Json,
    coat: float,
) -> Json:
    """The base that sends back as much even light, where it is all diffuse.

    `facets`: the index of the layer above it, and the hue of that layer's reflections.
    """
    if metallic != 0.0 or (isinstance(base, dict) and "texture" in base):
        return base
    index, hue = facets
    rough = roughness if isinstance(roughness, float) else 0.5
    white = burley.diffuse_albedo(rough, min(1.0, flatness)) / (1 - _COAT * coat * _COAT_REFLECTS)

    def under(index: float) -> tuple[float, float]:
        passing = burley.passing(rough, index)
        return white / passing, burley.lost_between_facets(rough, index) / passing

    if hue != _WHITE and isinstance(base, dict) and "rgb" in base:
        # Where less of a colour is reflected more of it comes to the base.
        made = [under(_of_reflectance(each * _at_normal(index))) for each in hue]
        return colours.reflectance(
            [
                min(1.0, max(0.0, gain * part - less))
                for (gain, less), part in zip(made, base["rgb"], strict=True)
            ]
        )
    gain, less = under(index)
    if isinstance(base, float):
        return min(1.0, max(0.0, gain * base - less))
    at = colours.knots(base)
    return colours.table(at, (gain * colours.values_of(base, at) - less).clip(0.0, 1.0))


def _at_normal(index: float) -> float:
    """The reflectance at normal incidence."""
    return float(((index - 1) / (index + 1)) ** 2)


def _of_reflectance(part: float) -> float:
    """The index that reflects so much at normal incidence."""
    return float(2 / (1 - min(part, 0.9) ** 0.5) - 1)


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
        eta = _of_reflectance(0.08 * max(specular, 1e-3))
    if not eta > 0:
        raise InputError.at(properties.place, f"an index of refraction is positive, found {eta:g}")
    return eta


def _need(context: Context, properties: Properties, name: str, value: float) -> None:
    if textures.number(context, properties, name, value) != value:
        context.findings.lost(properties.place, f'no support for a principled "{name}" other than {value:g}')
