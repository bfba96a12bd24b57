"""Kernels: names resolved, sides told apart, blends and masks flattened to one sum."""

from dataclasses import dataclass

from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.kernel_leaves import Leaves, Side, null_kernel
from nocturne_scene.compile.textures import Textures
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.kernels import Blend, Dielectric, Glazing, Kernel, Mask, TwoSided
from nocturne_scene.document.problems import path


@dataclass(frozen=True)
class CompiledKernel:
    """What a surface needs to know of its kernel."""

    front: int
    back: int | None = None
    interior: scene_pb2.Interior | None = None
    needs_coordinates: bool = False


@dataclass(frozen=True)
class _Part:
    """One kernel of a flattened sum, with the factors of its weight."""

    kernel: scene_pb2.Kernel
    factors: tuple[scene_pb2.Blend.Factor, ...]
    interior: scene_pb2.Interior | None
    needs_coordinates: bool


class Kernels:
    """Compiles kernels; each named one once."""

    def __init__(self, workspace: Workspace, textures: Textures) -> None:
        self._workspace = workspace
        self._textures = textures
        self._leaves = Leaves(workspace, textures)
        self._named: dict[str, CompiledKernel | None] = {}

    def compile(self, reference: str | Kernel, place: str) -> CompiledKernel | None:
        """Return the kernel; None if it can't be compiled, which is noted."""
        if not isinstance(reference, str):
            return self._compile(reference, place)
        self._workspace.use("kernels", reference)
        if reference not in self._named:
            kernel = self._workspace.document.kernels[reference]
            self._named[reference] = self._compile(kernel, path(("kernels", reference)))
        return self._named[reference]

    def scatters(self) -> bool:
        """Whether any compiled kernel sends light on."""
        return any(not self._is_black(kernel) for kernel in self._workspace.kernels.messages)

    def _is_black(self, kernel: scene_pb2.Kernel) -> bool:
        if kernel.WhichOneof("model") != "lambertian":
            return False
        return spectra.is_black(self._workspace.spectra.messages[kernel.lambertian.reflectance.spectrum])

    def _compile(self, kernel: Kernel, place: str) -> CompiledKernel | None:
        with self._workspace.problems_at(place):
            front = self._side(kernel, "front", place)
            back = self._side(kernel, "back", place) if self._has_sides(kernel) else front
            if front is None or back is None:
                return None
            if self._through(front.front) != self._through(back.front):
                raise Unusable(
                    "lets other light through from its front than from its back, which no surface does; give "
                    "both sides the same transmittance, or put two_sided into the mask or blend"
                )
            return CompiledKernel(
                front.front,
                None if back.front == front.front else back.front,
                front.interior,
                front.needs_coordinates or back.needs_coordinates,
            )
        return None

    def _has_sides(self, kernel: str | Kernel) -> bool:
        match self._resolved(kernel):
            case TwoSided() | Glazing():
                return True
            case Dielectric() as body:
                return bool(body.coating)
            case Blend() as blend:
                return self._has_sides(blend.first) or self._has_sides(blend.second)
            case Mask() as mask:
                return self._has_sides(mask.kernel)
        return False

    def _through(self, index: int) -> list[tuple[str, bytes, list[bytes]]]:
        """What a compiled kernel does to light that goes through the surface."""
        kernel = self._workspace.kernels.messages[index]
        parts = kernel.blend.parts or [scene_pb2.Blend.Part(kernel=index)]
        found = []
        for part in parts:
            leaf = self._workspace.kernels.messages[part.kernel]
            model = leaf.WhichOneof("model")
            match model:
                case "diffuse_transmitter" if not self._is_zero(leaf.diffuse_transmitter.transmittance):
                    through = leaf.diffuse_transmitter.transmittance.SerializeToString(deterministic=True)
                case "thin_pane" | "null_kernel":
                    through = leaf.SerializeToString(deterministic=True)
                case "glazing":
                    panes = scene_pb2.Glazing(panes=leaf.glazing.panes)
                    through = panes.SerializeToString(deterministic=True)
                case _:
                    continue
            factors = sorted(each.SerializeToString(deterministic=True) for each in part.factors)
            found.append((model, through, factors))
        return sorted(found)

    def _is_zero(self, colour: scene_pb2.Colour) -> bool:
        return spectra.is_black(self._workspace.spectra.messages[colour.spectrum])

    def _resolved(self, kernel: str | Kernel) -> Kernel:
        if isinstance(kernel, str):
            self._workspace.use("kernels", kernel)
            return self._workspace.document.kernels[kernel]
        return kernel

    def _side(self, kernel: Kernel, side: Side, place: str) -> CompiledKernel | None:
        problems = len(self._workspace.problems)
        parts = self._parts(kernel, side, place)
        if len(self._workspace.problems) > problems:
            return None
        if len(parts) > bounds.BLEND_PARTS:
            raise Unusable(
                f"blends {len(parts)} kernels once all blends and masks in it are taken together; "
                f"at most {bounds.BLEND_PARTS}"
            )
        interiors = [part.interior for part in parts if part.interior is not None]
        if any(interior != interiors[0] for interior in interiors):
            raise Unusable(
                "blends dielectrics of different bodies; the surface encloses one body, so they must agree "
                "in index, outside, absorption and priority"
            )
        return CompiledKernel(
            self._sum(parts),
            interior=interiors[0] if interiors else None,
            needs_coordinates=any(part.needs_coordinates for part in parts),
        )

    def _sum(self, parts: list[_Part]) -> int:
        pool = self._workspace.kernels
        if len(parts) == 1 and not parts[0].factors:
            return pool.index_of(parts[0].kernel)
        if any(part.kernel.HasField("fluorescent") for part in parts):
            raise Unusable("a fluorescent surface can be no part of a blend or a mask")
        if any(part.kernel.HasField("polarising_filter") for part in parts):
            raise Unusable("a polariser or a retarder can be no part of a blend or a mask")
        blend = scene_pb2.Blend(
            parts=[
                scene_pb2.Blend.Part(kernel=pool.index_of(part.kernel), factors=part.factors)
                for part in parts
            ]
        )
        return pool.index_of(scene_pb2.Kernel(blend=blend))

    def _parts(self, reference: str | Kernel, side: Side, place: str) -> list[_Part]:
        if isinstance(reference, str):
            place = path(("kernels", reference))
        kernel = self._resolved(reference)
        match kernel:
            case TwoSided():
                chosen = kernel.front if side == "front" else kernel.back
                return self._parts(chosen, side, f"{place}.{side}")
            case Blend():
                with self._workspace.problems_at(f"{place}.weight"):
                    return self._weighted(kernel, side, place)
                return []
            case Mask():
                with self._workspace.problems_at(f"{place}.opacity"):
                    return self._masked(kernel, side, place)
                return []
        textured = self._textures.uses
        with self._workspace.problems_at(place):
            leaf = self._leaves.compile(kernel, side)
            needs = self._textures.uses > textured or _is_anisotropic(leaf.kernel)
            return [_Part(leaf.kernel, (), leaf.interior, needs)]
        return []

    def _weighted(self, blend: Blend, side: Side, place: str) -> list[_Part]:
        uses = self._textures.uses
        weight = self._textures.scalar(blend.weight)
        varies = self._textures.uses > uses
        parts = []
        if not _is_constant(weight, 1.0):
            first = self._parts(blend.first, side, f"{place}.first")
            parts += [_times(part, weight, True, varies) for part in first]
        if not _is_constant(weight, 0.0):
            second = self._parts(blend.second, side, f"{place}.second")
            parts += [_times(part, weight, False, varies) for part in second]
        return parts

    def _masked(self, mask: Mask, side: Side, place: str) -> list[_Part]:
        uses = self._textures.uses
        opacity = self._textures.scalar(mask.opacity)
        varies = self._textures.uses > uses
        parts = []
        if not _is_constant(opacity, 0.0):
            inner = self._parts(mask.kernel, side, f"{place}.kernel")
            parts += [_times(part, opacity, False, varies) for part in inner]
        if not _is_constant(opacity, 1.0):
            parts.append(_times(_Part(null_kernel(), (), None, False), opacity, True, varies))
        return parts


def _is_constant(scalar: scene_pb2.Scalar, value: float) -> bool:
    return scalar.WhichOneof("source") == "constant" and scalar.constant == value


def _times(part: _Part, weight: scene_pb2.Scalar, complement: bool, varies: bool) -> _Part:
    if _is_constant(weight, 0.0 if complement else 1.0):
        return part
    factor = scene_pb2.Blend.Factor(weight=weight, complement=complement)
    return _Part(part.kernel, (*part.factors, factor), part.interior, part.needs_coordinates or varies)


def _is_anisotropic(kernel: scene_pb2.Kernel) -> bool:
    """Whether the kernel looks different along u and v."""
    model = getattr(kernel, kernel.WhichOneof("model") or "null_kernel")
    if isinstance(model, scene_pb2.CoatedConductor):
        model = model.conductor
    elif isinstance(model, scene_pb2.CoatedDielectric):
        model = model.dielectric
    roughness = getattr(model, "roughness", None)
    if isinstance(roughness, scene_pb2.Roughness):
        return roughness.alpha_u != roughness.alpha_v
    return kernel.principled.HasField("brush")
