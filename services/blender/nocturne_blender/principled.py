"""Blender's Principled BSDF, and metals and glasses."""

from typing import Any

from .nodes import Reader

Json = Any

# nm at which a metal's colour is taken as its red, green and blue.
_PRIMARIES = ((450.0, 2), (550.0, 1), (610.0, 0))
# What reflects all has no index.
_MOST = 0.999
# Inputs that change nothing at these values.
_LEFT_OUT = {"Subsurface Weight": 0.0, "Sheen Weight": 0.0, "Coat Weight": 0.0, "Anisotropic": 0.0}


def kernel(node: Any, reader: Reader) -> Json:
    """What a Principled BSDF scatters."""
    for name, nothing in _LEFT_OUT.items():
        if reader.number(node.inputs[name]) != nothing:
            reader.lost(f"no equal of {name!r}; left out")
    base, rough = node.inputs["Base Color"], reader.scalar(node.inputs["Roughness"])
    index = max(1.0, reader.number(node.inputs["IOR"]))
    found = _plastic(base, rough, index, reader)
    through = reader.scalar(node.inputs["Transmission Weight"])
    if through != 0.0:
        found = _mixed(found, glass(index, rough, reader), through)
    metallic = reader.scalar(node.inputs["Metallic"])
    if metallic != 0.0:
        found = _mixed(found, metal(reader.reflectance(base), rough, reader), metallic)
    opacity = reader.scalar(node.inputs["Alpha"])
    return found if opacity == 1.0 else {"type": "mask", "kernel": found, "opacity": opacity}


def _plastic(base: Any, rough: Json, index: float, reader: Reader) -> Json:
    reflectance = reader.reflectance(base)
    if index == 1.0:
        return {"type": "lambertian", "reflectance": reflectance}
    return {"type": "coated_diffuse", "index": index, "reflectance": reflectance} | _alpha(rough, reader)


def metal(colour: Json, rough: Json, reader: Reader) -> Json:
    """A conductor that reflects a colour at normal incidence: k^2 / (4 + k^2) where n is 1."""
    if isinstance(colour, dict) and "texture" in colour:
        reader.lost("no equal of a metal with a texture; taken as grey")
        colour = 0.5
    rgb = colour["rgb"] if isinstance(colour, dict) else [colour] * 3
    table = [
        [at, 2 * (min(_MOST, rgb[part]) / (1 - min(_MOST, rgb[part]))) ** 0.5] for at, part in _PRIMARIES
    ]
    k: Json = table[0][1] if isinstance(colour, float) else {"table": table}
    return {"type": "conductor", "index": {"n": 1.0, "k": k}} | _alpha(rough, reader)


def glass(index: float, rough: Json, reader: Reader) -> Json:
    """A clear body."""
    if index == 1.0:
        return {"type": "null"}
    return {"type": "dielectric", "index": index} | _alpha(rough, reader)


def _alpha(rough: Json, reader: Reader) -> Json:
    """Alpha of the microfacets is the square of Blender's roughness."""
    if isinstance(rough, float):
        return {"roughness": rough**2} if rough > 0 else {}
    reader.lost("no equal of the square of a texture of roughness; taken as it is")
    return {"roughness": rough}


def complement(weight: Json) -> Json:
    """1 - weight, of a number or a ScalarTexture."""
    if isinstance(weight, float):
        return 1 - weight
    return weight | {"gain": -weight.get("gain", 1.0), "bias": 1 - weight.get("bias", 0.0)}


def _mixed(first: Json, second: Json, weight: Json) -> Json:
    return second if weight == 1.0 else {"type": "blend", "first": first, "second": second, "weight": weight}
