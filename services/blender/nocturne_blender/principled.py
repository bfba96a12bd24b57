"""Blender's Principled BSDF, and metals and glasses."""

from typing import Any

from . import light
from .nodes import Reader

Json = Any

_WHITE = [1.0, 1.0, 1.0]


def kernel(node: Any, reader: Reader) -> Json:
    """What a Principled BSDF scatters."""
    if reader.number(node.inputs["Subsurface Weight"]) != 0.0:
        reader.lost("no support for 'Subsurface Weight'; light leaves where it came in")
    rough, index = reader.scalar(node.inputs["Roughness"]), _index(node, reader)
    found: Json = {
        "type": "principled",
        "base": reader.reflectance(node.inputs["Base Color"]),
        "metallic": reader.scalar(node.inputs["Metallic"]),
        "index": index,
    }
    found |= _facets(node, rough, reader) | _tint(node, index, found["metallic"], reader)
    found |= _coat(node, reader) | _sheen(node, reader)
    through = reader.scalar(node.inputs["Transmission Weight"])
    if through != 0.0 and found["metallic"] != 1.0:
        if found["metallic"] != 0.0:
            reader.lost("no support for glass that is partly metal; what is not let through is")
        clear = glass(index, rough, reader)
        found = (
            clear if through == 1.0 else {"type": "blend", "first": found, "second": clear, "weight": through}
        )
    opacity = reader.scalar(node.inputs["Alpha"])
    return found if opacity == 1.0 else {"type": "mask", "kernel": found, "opacity": opacity}


def _index(node: Any, reader: Reader) -> float:
    """The index whose reflectance at normal incidence is the IOR's times twice the Specular IOR Level."""
    index = max(1.0, reader.number(node.inputs["IOR"]))
    level = 2 * reader.number(node.inputs["Specular IOR Level"])
    if level == 1.0:
        return index
    root = min(0.99, max(0.0, level) * ((index - 1) / (index + 1)) ** 2) ** 0.5
    return float((1 + root) / (1 - root))


def _facets(node: Any, rough: Json, reader: Reader) -> Json:
    """Alpha, the square of roughness, is over an aspect along the tangent and times it across."""
    amount = min(1.0, max(0.0, reader.number(node.inputs["Anisotropic"])))
    if amount == 0.0:
        return {"roughness": rough}
    root = (1 - 0.9 * amount) ** 0.25

    def times(factor: float) -> Json:
        if isinstance(rough, float):
            return min(1.0, factor * rough)
        return (
            rough
            | {name: factor * rough[name] for name in ("gain", "bias") if name in rough}
            | ({} if "gain" in rough else {"gain": factor})
        )

    return {
        "roughness": times(1 / root),
        "roughness_across": times(root),
        "rotation": reader.number(node.inputs["Anisotropic Rotation"]) % 0.5,
    }


def _tint(node: Any, index: float, metallic: Json, reader: Reader) -> Json:
    """The reflectance at normal incidence, in colour."""
    tint = reader.colour(node.inputs["Specular Tint"])
    if tint == _WHITE:
        return {}
    if metallic != 0.0:
        reader.lost("no support for 'Specular Tint' of metal; its edges are white")
    own = ((index - 1) / (index + 1)) ** 2
    return {"specular_colour": light.reflectance([min(1.0, max(0.0, own * part)) for part in tint])}


def _sheen(node: Any, reader: Reader) -> Json:
    """Fuzz; Cycles has fibres of another distribution."""
    weight = min(1.0, max(0.0, reader.number(node.inputs["Sheen Weight"])))
    if weight == 0.0:
        return {}
    tint = [min(1.0, max(0.0, weight * part)) for part in reader.colour(node.inputs["Sheen Tint"])]
    return {
        "sheen": light.reflectance(tint),
        "sheen_roughness": reader.scalar(node.inputs["Sheen Roughness"]),
    }


def _coat(node: Any, reader: Reader) -> Json:
    amount = reader.scalar(node.inputs["Coat Weight"])
    if amount == 0.0:
        return {}
    if reader.colour(node.inputs["Coat Tint"]) != _WHITE:
        reader.lost("no support for 'Coat Tint'; taken as clear")
    return {
        "coat": amount,
        "coat_roughness": reader.scalar(node.inputs["Coat Roughness"]),
        "coat_index": min(4.0, max(1.0, reader.number(node.inputs["Coat IOR"]))),
    }


def metal(colour: Json, rough: Json) -> Json:
    """Metal of a colour at normal incidence."""
    return {"type": "principled", "base": colour, "metallic": 1.0, "roughness": rough}


def glass(index: float, rough: Json, reader: Reader) -> Json:
    """A clear body."""
    if index == 1.0:
        return {"type": "null"}
    return {"type": "dielectric", "index": index} | _alpha(rough, reader)


def _alpha(rough: Json, reader: Reader) -> Json:
    """Alpha of the microfacets is the square of Blender's roughness."""
    if isinstance(rough, float):
        return {"roughness": rough**2} if rough > 0 else {}
    reader.lost("no support for the square of a texture of roughness; taken as it is")
    return {"roughness": rough}


def complement(weight: Json) -> Json:
    """1 - weight, of a number or a ScalarTexture."""
    if isinstance(weight, float):
        return 1 - weight
    return weight | {"gain": -weight.get("gain", 1.0), "bias": 1 - weight.get("bias", 0.0)}
