"""Shaders of volumes as media."""

from typing import Any

from . import light
from .nodes import Reader

Json = Any


def medium_of(node: Any, reader: Reader) -> Json | None:
    """A Medium that is the same everywhere; None where it is clear.

    Cycles scatters density times the colour and absorbs density times one minus the colour, per metre.
    """
    kind = node.bl_idname
    if kind not in ("ShaderNodeVolumeScatter", "ShaderNodeVolumeAbsorption", "ShaderNodeVolumePrincipled"):
        reader.lost(f"no support for the volume {node.bl_label}; left out")
        return None
    density = reader.number(node.inputs["Density"])
    colour = [min(1.0, max(0.0, part)) for part in reader.colour(node.inputs["Color"])]
    if density <= 0:
        return None
    rest = [1 - part for part in colour]
    if kind == "ShaderNodeVolumeAbsorption":
        return {"absorption": light.reflectance(rest), "density": density}
    found: Json = {"scattering": light.reflectance(colour), "density": density}
    if kind == "ShaderNodeVolumePrincipled":
        found["absorption"] = light.reflectance(rest)
        if any(reader.number(node.inputs[name]) > 0 for name in ("Emission Strength", "Blackbody Intensity")):
            reader.lost("no support for a volume that glows; it is dark")
    elif getattr(node, "phase", "HENYEY_GREENSTEIN") != "HENYEY_GREENSTEIN":
        reader.lost(f"no support for the phase {node.phase}; taken as Henyey-Greenstein's")
    g = reader.number(node.inputs["Anisotropy"])
    if g != 0.0:
        found["phase"] = {"type": "henyey_greenstein", "g": max(-0.99, min(0.99, g))}
    return found
