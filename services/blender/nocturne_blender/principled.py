"""Blender's Principled BSDF, and metals and glasses."""

from typing import Any

from .nodes import Reader

Json = Any

# Inputs that change nothing at these values.
_LEFT_OUT = {"Subsurface Weight": 0.0, "Sheen Weight": 0.0, "Anisotropic": 0.0}


def kernel(node: Any, reader: Reader) -> Json:
    """What a Principled BSDF scatters."""
    for name, nothing in _LEFT_OUT.items():
        if reader.number(node.inputs[name]) != nothing:
            reader.lost(f"no equal of {name!r}; left out")
    if reader.colour(node.inputs["Specular Tint"]) != [1.0, 1.0, 1.0]:
        reader.lost("no equal of 'Specular Tint'; taken as white")
    rough, index = reader.scalar(node.inputs["Roughness"]), _index(node, reader)
    found: Json = {
        "type": "principled",
        "base": reader.reflectance(node.inputs["Base Color"]),
        "metallic": reader.scalar(node.inputs["Metallic"]),
        "roughness": rough,
        "index": index,
    } | _coat(node, reader)
    through = reader.scalar(node.inputs["Transmission Weight"])
    if through != 0.0 and found["metallic"] != 1.0:
        if found["metallic"] != 0.0:
            reader.lost("no equal of glass that is partly metal; what is not let through is")
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


def _coat(node: Any, reader: Reader) -> Json:
    amount = reader.scalar(node.inputs["Coat Weight"])
    if amount == 0.0:
        return {}
    if reader.colour(node.inputs["Coat Tint"]) != [1.0, 1.0, 1.0]:
        reader.lost("no equal of 'Coat Tint'; taken as clear")
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
    reader.lost("no equal of the square of a texture of roughness; taken as it is")
    return {"roughness": rough}


def complement(weight: Json) -> Json:
    """1 - weight, of a number or a ScalarTexture."""
    if isinstance(weight, float):
        return 1 - weight
    return weight | {"gain": -weight.get("gain", 1.0), "bias": 1 - weight.get("bias", 0.0)}
