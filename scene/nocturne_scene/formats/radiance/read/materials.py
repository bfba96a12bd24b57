"""Materials of Radiance as kernels, and their light."""

import math
from collections.abc import Callable, Sequence

from nocturne_scene.errors import InputError
from nocturne_scene.formats.radiance.read.primitives import Primitive
from nocturne_scene.formats.reading.colours import Json, reflectance
from nocturne_scene.formats.reading.findings import Findings

EFFICACY = 179.0
"""lm/W of all light (common.h: WHTEFFICACY)."""
_LUMINANCE = (0.265074126, 0.670114631, 0.064811243)
"""Of R, G and B (color.h: bright)."""
_GLASS_INDEX = 1.52


def luminance(rgb: Sequence[float]) -> float:
    """cd/m2 of a radiance in W/(sr m2)."""
    return EFFICACY * math.fsum(part * value for part, value in zip(_LUMINANCE, rgb, strict=True))


def light(rgb: Sequence[float]) -> Json:
    """A radiance as a document writes it, with the luminance that it has in Radiance; white is D65."""
    brightest = max(rgb)
    if not brightest > 0.0:
        return 0.0
    return {"rgb": [max(0.0, value) / brightest for value in rgb], "luminance": luminance(rgb)}


def kernel(material: Primitive, findings: Findings) -> Json:
    """Raises InputError for a material that is wrong, or of a kind that is not read."""
    made = _KINDS.get(material.kind)
    if made is None:
        known = ", ".join((*_KINDS, *EMITTING))
        raise InputError.at(material.place, f"material {material.kind} is not read; read are {known}")
    return made(material, findings)


EMITTING = ("light", "glow", "illum")
BLACK: Json = {"type": "lambertian", "reflectance": 0.0}


def emission(material: Primitive, findings: Findings) -> Json:
    """Of a material that emits."""
    count = 4 if material.kind == "glow" else 3
    rgb = material.need(count)[:3]
    if material.kind == "illum":
        findings.note(material.place, f"illum {material.name} emits as a light; what lies behind is not seen")
    return light(rgb)


def _colour(values: Sequence[float], material: Primitive) -> list[float]:
    if not all(0.0 <= value <= 1.0 for value in values):
        raise InputError.at(material.place, f"{material.kind} {material.name}: expected parts from 0 to 1")
    return [float(value) for value in values]


def _plastic(material: Primitive, findings: Findings) -> Json:
    """Light that is not reflected specularly is diffuse, times the colour."""
    red, green, blue, specular, rough = material.need(5)
    colour = _colour((red, green, blue, specular), material)[:3]
    if specular == 0.0:
        return {"type": "lambertian", "reflectance": reflectance(colour)}
    _note_rough(material, findings)
    return {
        "type": "principled",
        "base": reflectance(colour),
        "roughness": math.sqrt(min(rough, 1.0)),
        "specular_colour": specular,
    }


def _metal(material: Primitive, findings: Findings) -> Json:
    """What a metal reflects specularly has its colour."""
    red, green, blue, specular, rough = material.need(5)
    colour = _colour((red, green, blue, specular), material)[:3]
    _note_rough(material, findings)
    shiny = {
        "type": "principled",
        "base": reflectance(colour),
        "metallic": 1.0,
        "roughness": math.sqrt(min(rough, 1.0)),
    }
    if specular == 1.0:
        return shiny
    diffuse = {"type": "lambertian", "reflectance": reflectance(colour)}
    return {"type": "blend", "first": diffuse, "second": shiny, "weight": specular}


def _mirror(material: Primitive, findings: Findings) -> Json:
    colour = _colour(material.need(3), material)
    findings.note(material.place, f"mirror {material.name}: at grazing angles it is white here")
    return {"type": "principled", "base": reflectance(colour), "metallic": 1.0, "roughness": 0.0}


def _trans(material: Primitive, findings: Findings) -> Json:
    """Reflects diffusely, and lets light through diffusely and straight on."""
    red, green, blue, specular, rough, transmitted, straight = material.need(7)
    _colour((red, green, blue, specular, transmitted, straight), material)
    colour = [(1.0 - specular) * value for value in (red, green, blue)]
    if specular > 0.0:
        findings.note(material.place, f"trans {material.name}: its specular reflection is left out")
    if straight > 0.0 and rough > 0.0:
        findings.note(material.place, f"trans {material.name}: what passes straight on is not spread")
    clear = (
        transmitted
        * straight
        * math.fsum(part * value for part, value in zip(_LUMINANCE, colour, strict=True))
    )
    if clear > 0.0 and len(set(colour)) > 1:
        findings.note(material.place, f"trans {material.name}: what passes straight on has no colour here")
    left = 1.0 - clear
    if left <= 0.0:
        return {"type": "null"}
    diffuse = {
        "type": "diffuse_transmitter",
        "reflectance": reflectance([value * (1.0 - transmitted) / left for value in colour]),
        "transmittance": reflectance([value * transmitted * (1.0 - straight) / left for value in colour]),
    }
    return {"type": "mask", "kernel": diffuse, "opacity": left} if clear > 0.0 else diffuse


def _glass(material: Primitive, findings: Findings) -> Json:
    """Transmissivity is that of one crossing of the pane, without reflections."""
    del findings
    given = material.numbers
    index = given[3] if len(given) == 4 else _GLASS_INDEX
    colour = _colour((given if len(given) == 4 else material.need(3))[:3], material)
    return {"type": "thin_pane", "index": index, "transmittance": reflectance(colour)}


def _dielectric(material: Primitive, findings: Findings) -> Json:
    """Transmissivity is that of a unit of length."""
    red, green, blue, index, hartmann = material.need(5)
    colour = _colour((red, green, blue), material)
    if hartmann != 0.0:
        findings.note(material.place, f"dielectric {material.name}: its dispersion is left out")
    mean = math.fsum(part * value for part, value in zip(_LUMINANCE, colour, strict=True))
    if len(set(colour)) > 1:
        findings.note(material.place, f"dielectric {material.name}: it absorbs all colours alike here")
    found: dict[str, Json] = {"type": "dielectric", "index": index}
    return found if mean >= 1.0 else found | {"absorption": -math.log(max(mean, 1e-6))}


def _note_rough(material: Primitive, findings: Findings) -> None:
    findings.note(
        material.place,
        f"{material.kind} {material.name}: Ward's highlight becomes a microfacet one of the same slope",
    )


_KINDS: dict[str, Callable[[Primitive, Findings], Json]] = {
    "plastic": _plastic,
    "metal": _metal,
    "mirror": _mirror,
    "trans": _trans,
    "glass": _glass,
    "dielectric": _dielectric,
}
