"""Kernels as Mitsuba's materials."""

from collections.abc import Callable
from xml.etree.ElementTree import Element

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.mitsuba.write.context import Context
from nocturne_scene.formats.mitsuba.write.elements import matrix, parameter, plugin, reference, spectrum
from nocturne_scene.formats.writing.blends import Part, halves, parts_of
from nocturne_scene.formats.writing.compiled import Body, one_alpha
from nocturne_scene.formats.writing.tables import Table

# Materials that Mitsuba has for both sides of a surface at once.
_THROUGH = ("dielectric", "coated_dielectric", "thin_pane", "glazing", "null_kernel")


def material(context: Context, surface: scene_pb2.Surface, body: Body | None, place: str) -> Element:
    """A reference to the material of a surface; materials that are alike are written once."""
    back = surface.back_kernel if surface.HasField("back_kernel") else surface.kernel
    key = (surface.kernel, back, surface.interior if surface.HasField("interior") else -1)
    if key not in context.bsdfs:
        name = f"material{len(context.bsdfs)}"
        found = _Sides(context, body, place).whole(surface.kernel, back)
        found.set("id", name)
        context.root.append(found)
        context.bsdfs[key] = name
    return reference(context.bsdfs[key])


class _Sides:
    """Makes the materials of one surface."""

    def __init__(self, context: Context, body: Body | None, place: str) -> None:
        self._context = context
        self._message = context.compiled.message
        self._body = body
        self._place = f"{place}.kernel"

    def whole(self, front: int, back: int) -> Element:
        """Both sides."""
        if front == back:
            return self._both(front)
        if any(self._goes_through(each) for each in (front, back)):
            self._lost("two different sides that let light through can't be exported")
        both = plugin("bsdf", "twosided")
        both.extend([self._one(front), self._one(back)])
        return both

    def _both(self, index: int) -> Element:
        kernel = self._message.kernels[index]
        if kernel.WhichOneof("model") == "blend" and self._goes_through(index):
            return self._blend(kernel.blend, self._both)
        if self._goes_through(index):
            return self._one(index)
        both = plugin("bsdf", "twosided")
        both.append(self._one(index))
        return both

    def _goes_through(self, index: int) -> bool:
        kernel = self._message.kernels[index]
        if kernel.WhichOneof("model") == "blend":
            return any(self._goes_through(part.kernel) for part in kernel.blend.parts)
        return kernel.WhichOneof("model") in _THROUGH

    def _one(self, index: int) -> Element:
        """A material as it is from the front."""
        kernel = self._message.kernels[index]
        model = kernel.WhichOneof("model") or ""
        match model:
            case "lambertian":
                found = plugin("bsdf", "diffuse")
                found.append(self._colour("reflectance", kernel.lambertian.reflectance))
                return found
            case "conductor":
                return self._conductor(kernel.conductor)
            case "dielectric":
                return self._dielectric(kernel.dielectric)
            case "thin_pane":
                return self._pane(kernel.thin_pane)
            case "coated_diffuse":
                return self._plastic(kernel.coated_diffuse)
            case "blend":
                return self._blend(kernel.blend, self._one)
            case "null_kernel":
                return plugin("bsdf", "null")
            case "coated_conductor" | "coated_dielectric":
                self._lost("a coating is not supported by Mitsuba")
            case _:
                self._lost(f"the kernel {model} is not supported by Mitsuba")
        return plugin("bsdf", "diffuse")

    def _conductor(self, conductor: scene_pb2.Conductor) -> Element:
        found = self._faceted("conductor", conductor.roughness)
        found.append(spectrum("eta", self._table(conductor.n)))
        found.append(spectrum("k", self._table(conductor.k)))
        return found

    def _dielectric(self, dielectric: scene_pb2.Dielectric) -> Element:
        index = self._body.index if self._body is not None else None
        inside = 1.0 if index is None else self._constant(index)
        found = self._faceted("dielectric", dielectric.roughness)
        outside = self._body.outside if self._body is not None else None
        parameter(found, "int_ior", inside)
        parameter(found, "ext_ior", 1.0 if outside is None else self._constant(outside))
        return found

    def _pane(self, pane: scene_pb2.ThinPane) -> Element:
        if self._table(pane.transmittance).constant != 1.0:
            self._lost("a pane that absorbs is not supported by Mitsuba")
        return plugin("bsdf", "thindielectric", int_ior=self._constant(self._table(pane.index)), ext_ior=1.0)

    def _plastic(self, coated: scene_pb2.CoatedDiffuse) -> Element:
        found = self._faceted("plastic", coated.roughness)
        if found.get("type") == "roughplastic":
            self._lost("a rough coat is not supported by Mitsuba, whose own loses light between its facets")
        parameter(found, "nonlinear", True)
        parameter(found, "int_ior", self._constant(self._table(coated.index)))
        parameter(found, "ext_ior", 1.0)
        found.append(self._colour("diffuse_reflectance", coated.reflectance))
        return found

    def _blend(self, blend: scene_pb2.Blend, side: Callable[[int], Element]) -> Element:
        return self._tree(parts_of(blend), side)

    def _tree(self, parts: list[Part], side: Callable[[int], Element]) -> Element:
        """Parts whose factors came of blends of blends, as such again."""
        if len(parts) == 1:
            return side(parts[0][0])
        split = halves(parts)
        weight = split.weight
        rest, weighed = self._tree(split.rest, side), self._tree(split.weighed, side)
        for complement, (through, kept) in {False: (rest, weighed), True: (weighed, rest)}.items():
            if through.get("type") == "null":
                mask = plugin("bsdf", "mask")
                mask.extend([self._weight("opacity", weight, complement), kept])
                return mask
        found = plugin("bsdf", "blendbsdf")
        found.extend([self._weight("weight", weight, False), rest, weighed])
        return found

    def _weight(self, name: str, weight: scene_pb2.Scalar, complement: bool) -> Element:
        if weight.WhichOneof("source") == "constant":
            constant = 1 - weight.constant if complement else weight.constant
            return Element("float", {"name": name, "value": repr(constant)})
        values = self._context.compiled.numbers(weight.texture, complement=complement)
        return self._bitmap(name, weight.texture, values)

    def _faceted(self, kind: str, roughness: scene_pb2.Roughness) -> Element:
        """A material that there is smooth, and rough by another name."""
        alpha = one_alpha(roughness)
        if alpha is None:
            self._lost("a roughness of two directions or of a texture can't be exported; taken as smooth")
        if not alpha:
            return plugin("bsdf", kind)
        self._context.findings.note(
            self._place,
            "Mitsuba multiplies the shadows of both directions between facets, ours correlates them by "
            "height: 1 % at 75 degrees and alpha 0.2, more for rougher ones",
        )
        distribution = "beckmann" if roughness.beckmann else "ggx"
        return plugin("bsdf", f"rough{kind}", distribution=distribution, alpha=float(alpha))

    def _colour(self, name: str, colour: scene_pb2.Colour) -> Element:
        if not colour.HasField("texture"):
            return spectrum(name, self._table(colour.spectrum))
        return self._bitmap(name, colour.texture, self._context.compiled.colours(colour, self._place))

    def _bitmap(self, name: str, use: scene_pb2.TextureUse, pixels: np.ndarray) -> Element:
        texture = self._message.textures[use.texture]
        asset = self._context.picture(name, pixels)
        found = plugin("texture", "bitmap", name=name, filename=asset)
        parameter(found, "wrap_mode", "clamp" if texture.clamp else "repeat")
        # Its v goes down the picture.
        axes = [np.array([use.scale_u, 0, 0]), np.array([0, -use.scale_v, 0]), np.array([0.0, 0, 1])]
        found.append(matrix("to_uv", axes, np.array([use.offset_u, 1 - use.offset_v, 0])))
        if not texture.sharp:
            self._context.findings.note(
                self._place, "a texture is looked up at points, not as the mean over a footprint"
            )
        return found

    def _table(self, index: int) -> Table:
        return self._context.compiled.table(index)

    def _constant(self, table: Table) -> float:
        if table.constant is None:
            self._lost("an index of refraction that depends on wavelength is not supported by Mitsuba")
        return float(table.values[0])

    def _lost(self, message: str) -> None:
        self._context.findings.lost(self._place, message)
