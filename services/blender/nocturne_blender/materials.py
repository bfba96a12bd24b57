"""Materials as kernels, luminaires and media."""

from dataclasses import dataclass, replace
from typing import Any

from . import light, principled
from .findings import Findings
from .images import Images
from .media import medium_of
from .nodes import Reader, output, source

Json = Any

_BLACK: Json = {"type": "lambertian", "reflectance": 0.0}
_CLEAR: Json = {"type": "null"}
# Of a surface without a material, as Cycles has it.
_PLAIN: Json = {"type": "lambertian", "reflectance": 0.8}
_MAX_DEPTH = 16


@dataclass(frozen=True)
class Shader:
    """A shader node's scattering and emission."""

    kernel: Json = None
    radiance: Json = 0.0


class Materials:
    """The fields of surfaces, by material."""

    def __init__(self, document: Json, images: Images, findings: Findings) -> None:
        self._document, self._images, self._findings = document, images, findings
        self._made: dict[str, Json] = {}

    def fields(self, material: Any) -> Json:
        """Kernel, luminaire, interior and maps of a surface."""
        if material is None:
            return {"kernel": _PLAIN}
        if material.name_full not in self._made:
            self._made[material.name_full] = self._fields(material)
        return self._made[material.name_full]

    def _fields(self, material: Any) -> Json:
        reader = Reader(material.name, self._images, self._findings)
        if material.node_tree is None:
            return {
                "kernel": {"type": "lambertian", "reflectance": light.reflectance(material.diffuse_color[:3])}
            }
        end = output(material.node_tree, "ShaderNodeOutputMaterial")
        if end is None:
            return {"kernel": _BLACK}
        if source(end.inputs["Displacement"]) is not None:
            reader.lost("no support for displacement; left out")
        surface, volume = source(end.inputs["Surface"]), source(end.inputs["Volume"])
        shader = Shader() if surface is None else self._shader(surface, reader, 0)
        kernel = shader.kernel or (_BLACK if shader.radiance != 0.0 else None)
        fields: Json = {} if kernel is None else {"kernel": self._named(material, kernel)}
        if shader.radiance != 0.0:
            fields["luminaire"] = {"radiance": shader.radiance, "two_sided": True}
        if volume is not None and (found := medium_of(volume, reader)) is not None:
            name = _free_name(self._document["media"], material.name)
            self._document["media"][name] = found
            fields["interior"] = {"media": [name]}
        if not fields:
            return {"kernel": _CLEAR if volume is not None else _BLACK}
        return fields | ({} if surface is None else _relief(surface, reader))

    def _named(self, material: Any, kernel: Json) -> str:
        name = _free_name(self._document["kernels"], material.name)
        self._document["kernels"][name] = kernel
        return name

    def _shader(self, node: Any, reader: Reader, depth: int) -> Shader:
        if depth > _MAX_DEPTH:
            reader.lost("shaders are mixed too deeply")
            return Shader(_BLACK)
        if node.bl_idname == "ShaderNodeMixShader":
            return self._mixed(node, reader, depth)
        if node.bl_idname == "ShaderNodeAddShader":
            first, second = (self._input(socket, reader, depth) for socket in node.inputs)
            if first.kernel and second.kernel:
                reader.lost("no support for a sum of two shaders that scatter; the first one is taken")
            radiance = first.radiance if first.radiance != 0.0 else second.radiance
            return Shader(first.kernel or second.kernel, radiance)
        make = _SHADERS.get(node.bl_idname)
        if make is None:
            reader.lost(f"no support for the shader {node.bl_label}; it is black")
            return Shader(_BLACK)
        return make(node, reader)

    def _input(self, socket: Any, reader: Reader, depth: int) -> Shader:
        node = source(socket)
        return Shader() if node is None else self._shader(node, reader, depth + 1)

    def _mixed(self, node: Any, reader: Reader, depth: int) -> Shader:
        weight = reader.scalar(node.inputs[0])
        first, second = (self._input(socket, reader, depth) for socket in node.inputs[1:])
        if weight in (0.0, 1.0):
            return second if weight == 1.0 else first
        radiance = 0.0
        for shader, part in ((first, 1 - weight), (second, weight)) if isinstance(weight, float) else ():
            if shader.radiance != 0.0:
                if radiance != 0.0:
                    reader.lost("no support for two shaders that both emit; the second one is taken")
                radiance = _scaled(shader.radiance, part)
        if not isinstance(weight, float) and (first.radiance != 0.0 or second.radiance != 0.0):
            reader.lost("no support for light mixed by a texture; left out")
        return Shader(_blend(first.kernel or _BLACK, second.kernel or _BLACK, weight), radiance)


def _blend(first: Json, second: Json, weight: Json) -> Json:
    if first == _CLEAR:
        return {"type": "mask", "kernel": second, "opacity": weight}
    if second == _CLEAR:
        return {"type": "mask", "kernel": first, "opacity": principled.complement(weight)}
    return {"type": "blend", "first": first, "second": second, "weight": weight}


def _scaled(radiance: Json, factor: float) -> Json:
    if "texture" in radiance:
        return radiance | {"spectrum": _scaled(radiance["spectrum"], factor)}
    return radiance | {"luminance": radiance["luminance"] * factor}


def _diffuse(node: Any, reader: Reader) -> Shader:
    if reader.scalar(node.inputs["Roughness"]) != 0.0:
        reader.lost("no support for rough diffuse reflection (Oren-Nayar); taken as Lambertian")
    return Shader({"type": "lambertian", "reflectance": reader.reflectance(node.inputs["Color"])})


def _translucent(node: Any, reader: Reader) -> Shader:
    through = reader.reflectance(node.inputs["Color"])
    return Shader({"type": "diffuse_transmitter", "reflectance": 0.0, "transmittance": through})


def _glossy(node: Any, reader: Reader) -> Shader:
    if abs(reader.number(node.inputs["Anisotropy"])) > 0:
        reader.lost("no support for brushed metal along a mesh's tangents; taken as even")
    colour, rough = reader.reflectance(node.inputs["Color"]), reader.scalar(node.inputs["Roughness"])
    return Shader(principled.metal(colour, rough))


def _glass(node: Any, reader: Reader) -> Shader:
    if reader.colour(node.inputs["Color"]) != [1.0, 1.0, 1.0]:
        reader.lost(
            "no support for glass coloured at its surface; taken as clear (use a volume's absorption)"
        )
    rough = reader.scalar(node.inputs["Roughness"])
    return Shader(principled.glass(max(1.0, reader.number(node.inputs["IOR"])), rough, reader))


def _transparent(node: Any, reader: Reader) -> Shader:
    colour = reader.colour(node.inputs["Color"])
    if colour == [1.0, 1.0, 1.0]:
        return Shader(_CLEAR)
    # Light that goes straight on in a colour: a sheet with the index of its surroundings.
    return Shader({"type": "thin_pane", "index": 1.0, "transmittance": light.reflectance(colour)})


def _emission(node: Any, reader: Reader) -> Shader:
    return Shader(None, emitted(reader, node.inputs["Color"], reader.number(node.inputs["Strength"])))


def emitted(reader: Reader, colour: Any, strength: float) -> Json:
    """Radiance of a colour socket times a strength in W m-2 sr-1."""
    use = reader.texture(colour) if strength > 0 else None
    if use is not None:
        return light.textured_radiance(use, strength)
    return light.radiance([strength * part for part in reader.colour(colour)])


def _principled(node: Any, reader: Reader) -> Shader:
    shader = Shader(principled.kernel(node, reader))
    strength = reader.number(node.inputs["Emission Strength"])
    if strength > 0:
        shader = replace(shader, radiance=emitted(reader, node.inputs["Emission Color"], strength))
    return shader


_SHADERS = {
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfTranslucent": _translucent,
    "ShaderNodeBsdfAnisotropic": _glossy,
    "ShaderNodeBsdfGlossy": _glossy,
    "ShaderNodeBsdfGlass": _glass,
    "ShaderNodeBsdfTransparent": _transparent,
    "ShaderNodeEmission": _emission,
    "ShaderNodeBsdfPrincipled": _principled,
}


def _relief(node: Any, reader: Reader) -> Json:
    """A normal or bump map at the shader's normal."""
    socket = node.inputs.get("Normal")
    found = None if socket is None else source(socket)
    if found is None:
        return {}
    if found.bl_idname == "ShaderNodeNormalMap":
        use = reader.texture(found.inputs["Color"])
        if use is not None:
            if reader.number(found.inputs["Strength"]) != 1.0:
                reader.lost("no support for a normal map's strength")
            return {"normal_map": use | {"texture": use["texture"] | {"encoding": "linear"}}}
    if found.bl_idname == "ShaderNodeBump":
        use = reader.texture(found.inputs["Height"])
        height = reader.number(found.inputs["Distance"]) * reader.number(found.inputs["Strength"])
        if use is not None:
            return {"bump_map": use | {"height": -height if found.invert else height}}
    reader.lost("no support for what turns its normals; left out")
    return {}


def _free_name(taken: Json, wanted: str) -> str:
    """A name that a document takes, and that is not in use."""
    plain = "".join(each if each.isascii() and (each.isalnum() or each in "_. -") else "_" for each in wanted)
    base = ("" if plain[:1].isalnum() else "_") + plain[:150]
    name, number = base, 2
    while name in taken:
        name, number = f"{base} {number}", number + 1
    return name
