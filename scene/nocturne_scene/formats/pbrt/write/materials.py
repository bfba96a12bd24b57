"""Kernels as pbrt's materials, which like ours scatter on both sides."""

from dataclasses import dataclass

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.pbrt.write.context import Context
from nocturne_scene.formats.pbrt.write.directives import (
    directive,
    quoted,
    real,
    reflectance,
    spectrum,
    switch,
    text,
    texture,
    whole,
)
from nocturne_scene.formats.writing.blends import Part, halves, parts_of
from nocturne_scene.formats.writing.compiled import Body
from nocturne_scene.formats.writing.tables import Array, Table

# Reflections between a coat and its base that are followed: the rest is below rounding.
_MAX_BOUNCES = 1000


@dataclass(frozen=True)
class Material:
    """What a shape is made of."""

    line: str
    """The directive that chooses it."""
    opacity: str = ""
    """A parameter of the shape, or none."""

    @property
    def is_interface(self) -> bool:
        """Whether light notices only the enclosed space."""
        return self.line == _INTERFACE


_INTERFACE = directive("Material", quoted("interface"))


def material(context: Context, surface: scene_pb2.Surface, body: Body | None, place: str) -> Material:
    """The material of a surface; those that are alike are written once."""
    if surface.HasField("back_kernel") and surface.back_kernel != surface.kernel:
        context.findings.lost(f"{place}.kernel", "two different sides are not supported by pbrt")
    maker = _Maker(context, surface.interior if surface.HasField("interior") else -1, body, f"{place}.kernel")
    return maker.whole(surface.kernel)


class _Maker:
    """Makes the material of one surface."""

    def __init__(self, context: Context, interior: int, body: Body | None, place: str) -> None:
        self._context = context
        self._kernels = context.compiled.message.kernels
        self._interior = interior
        self._body = body
        self._place = place

    def whole(self, index: int) -> Material:
        """A kernel, its outermost mask as an opacity."""
        kernel = self._kernels[index]
        if self._passes(index):
            return Material(_INTERFACE)
        if kernel.WhichOneof("model") == "blend" and len(kernel.blend.parts) > 1:
            split = halves(parts_of(kernel.blend))
            for opaque, clear, complement in (
                (split.weighed, split.rest, False),
                (split.rest, split.weighed, True),
            ):
                if len(clear) == 1 and self._passes(clear[0][0]):
                    opacity = self._scalar("alpha", split.weight, complement)
                    return Material(_chosen(self._tree(opaque)), opacity)
        return Material(_chosen(self._named(index)))

    def _passes(self, index: int) -> bool:
        return self._kernels[index].WhichOneof("model") == "null_kernel"

    def _named(self, index: int) -> str:
        key = (index, self._interior)
        if key not in self._context.materials:
            kernel = self._kernels[index]
            if kernel.WhichOneof("model") == "blend":
                self._context.materials[key] = self._tree(parts_of(kernel.blend))
            else:
                self._context.materials[key] = self._make(*self._parameters(kernel))
        return self._context.materials[key]

    def _make(self, kind: str, *parameters: str) -> str:
        name = f"material{sum(line.startswith('MakeNamedMaterial') for line in self._context.world)}"
        line = directive("MakeNamedMaterial", quoted(name), text("type", kind), *parameters)
        self._context.world.append(line)
        return name

    def _tree(self, parts: list[Part]) -> str:
        if len(parts) == 1:
            return self._named(parts[0][0])
        split = halves(parts)
        names = " ".join(quoted(self._tree(half)) for half in (split.rest, split.weighed))
        return self._make(
            "mix", f'"string materials" [ {names} ]', self._scalar("amount", split.weight, False)
        )

    def _parameters(self, kernel: scene_pb2.Kernel) -> list[str]:
        """The kind of a material, and its parameters."""
        match kernel.WhichOneof("model"):
            case "lambertian":
                return ["diffuse", self._colour("reflectance", kernel.lambertian.reflectance)]
            case "diffuse_transmitter":
                both = kernel.diffuse_transmitter
                return [
                    "diffusetransmission",
                    self._colour("reflectance", both.reflectance),
                    self._colour("transmittance", both.transmittance),
                ]
            case "conductor":
                metal = kernel.conductor
                n, k = (spectrum(name, self._table(at)) for name, at in (("eta", metal.n), ("k", metal.k)))
                return ["conductor", n, k, *self._roughness(metal.roughness)]
            case "dielectric":
                return ["dielectric", self._ratio(), *self._roughness(kernel.dielectric.roughness)]
            case "thin_pane":
                if self._table(kernel.thin_pane.transmittance).constant != 1.0:
                    self._lost("a pane that absorbs is not supported by pbrt")
                return ["thindielectric", _index(self._table(kernel.thin_pane.index))]
            case "coated_diffuse":
                return self._coated(kernel.coated_diffuse)
            case "null_kernel":
                self._lost("a null kernel inside of a blend other than a mask is not supported by pbrt")
            case "coated_conductor" | "coated_dielectric":
                self._lost("a coating is not supported by pbrt")
            case model:
                self._lost(f"the kernel {model} is not supported by pbrt")
        return ["diffuse"]

    def _ratio(self) -> str:
        """Of the index inside to that outside, which is all that pbrt's boundaries know."""
        inside = self._body.index if self._body is not None else None
        outside = self._body.outside if self._body is not None else None
        found = Table(np.ones(1)) if inside is None else inside
        if outside is None:
            return _index(found)
        if found.constant is None or outside.constant is None:
            self._lost("a boundary between two indices that depend on wavelength is not supported by pbrt")
            return _index(found)
        return real("eta", found.constant / outside.constant)

    def _coated(self, coated: scene_pb2.CoatedDiffuse) -> list[str]:
        self._context.findings.note(
            self._place,
            "light between coat and base walks at random in pbrt, and is summed in closed form here",
        )
        return [
            "coateddiffuse",
            _index(self._table(coated.index)),
            self._colour("reflectance", coated.reflectance),
            whole("maxdepth", _MAX_BOUNCES),
            # Its own default is not smooth.
            *(self._roughness(coated.roughness) or [real("roughness", 0.0)]),
        ]

    def _roughness(self, roughness: scene_pb2.Roughness) -> list[str]:
        """Parameters of a rough surface; none of a smooth one."""
        both = (roughness.alpha_u, roughness.alpha_v)
        if all(each.WhichOneof("source") != "texture" and each.constant == 0.0 for each in both):
            return []
        if roughness.beckmann:
            self._lost("facets by Beckmann are not supported by pbrt")
        named = zip(("uroughness", "vroughness"), both, strict=True)
        return [*(self._scalar(name, each, False) for name, each in named), switch("remaproughness", False)]

    def _scalar(self, name: str, scalar: scene_pb2.Scalar, complement: bool) -> str:
        if scalar.WhichOneof("source") != "texture":
            return real(name, 1 - scalar.constant if complement else scalar.constant)
        values = self._context.compiled.numbers(scalar.texture, complement=complement)
        return texture(name, self._picture("float", scalar.texture, values))

    def _colour(self, name: str, colour: scene_pb2.Colour) -> str:
        if not colour.HasField("texture"):
            return reflectance(name, self._table(colour.spectrum))
        pixels = self._context.compiled.colours(colour, self._place)
        rgb = np.repeat(pixels, 3, axis=2) if pixels.shape[2] == 1 else pixels
        return texture(name, self._picture("spectrum", colour.texture, rgb))

    def _picture(self, kind: str, use: scene_pb2.TextureUse, pixels: Array) -> str:
        found = self._context.compiled.message.textures[use.texture]
        asset = self._context.writer.picture(kind, np.asarray(pixels))
        name = f"texture{len(self._context.textures)}"
        self._context.textures.append(name)
        if not found.sharp:
            self._context.findings.note(
                self._place, "a texture is looked up at points in pbrt, not as the mean over a footprint"
            )
        line = directive(
            "Texture",
            quoted(name),
            quoted(kind),
            quoted("imagemap"),
            text("filename", asset),
            text("encoding", "linear"),
            text("filter", "point" if found.sharp else "bilinear"),
            text("wrap", "clamp" if found.clamp else "repeat"),
            real("uscale", use.scale_u),
            real("vscale", use.scale_v),
            real("udelta", use.offset_u),
            real("vdelta", use.offset_v),
        )
        self._context.world.append(line)
        return name

    def _table(self, index: int) -> Table:
        return self._context.compiled.table(index)

    def _lost(self, message: str) -> None:
        self._context.findings.lost(self._place, message)


def _chosen(name: str) -> str:
    return directive("NamedMaterial", quoted(name))


def _index(table: Table) -> str:
    """An index of refraction, which may depend on wavelength."""
    return spectrum("eta", table) if table.constant is None else real("eta", table.constant)
