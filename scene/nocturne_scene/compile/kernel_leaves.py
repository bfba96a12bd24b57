"""Kernels that hold no other kernels, as messages."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile import spectra
from nocturne_scene.compile.films import compile_glazing, compile_layers
from nocturne_scene.compile.fluorescence import compile_fluorescent
from nocturne_scene.compile.indices import AnyIndex, compile_complex, compile_index
from nocturne_scene.compile.measured import compile_measured
from nocturne_scene.compile.polarisation import compile_filter
from nocturne_scene.compile.textures import Textures
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document.kernels import (
    CoatedDiffuse,
    Conductor,
    Dielectric,
    DiffuseTransmitter,
    Glazing,
    Kernel,
    Lambertian,
    Measured,
    NullKernel,
    Phong,
    Polariser,
    Principled,
    Retarder,
    RoughKernel,
    ThinPane,
)
from nocturne_scene.spectra import indices

# Spectra are float32: the numbers 0.7 and 0.3 add up to a little more than 1.
_ROUNDING = 1e-6


# As worker/src/kernels/dielectric.h has it: indices closer than this are equal to rough boundaries.
_NO_CONTRAST = 2e-5

Side = Literal["front", "back"]


@dataclass(frozen=True)
class Leaf:
    """A kernel, and the interior that its surface then has."""

    kernel: scene_pb2.Kernel
    interior: scene_pb2.Interior | None = None


def null_kernel() -> scene_pb2.Kernel:
    """Return the kernel that lets everything through."""
    return scene_pb2.Kernel(null_kernel=scene_pb2.NullKernel())


class Leaves:
    """Compiles single kernels."""

    def __init__(self, workspace: Workspace, textures: Textures) -> None:
        self._workspace = workspace
        self._textures = textures

    def compile(self, kernel: Kernel, side: Side) -> Leaf:
        """Return the message of a kernel that holds no other, for light on this side; raises Unusable and its
        kin."""
        colour = self._textures.reflectance
        match kernel:
            case Lambertian() if kernel.fluorescence:
                return Leaf(scene_pb2.Kernel(fluorescent=compile_fluorescent(self._workspace, kernel)))
            case Lambertian():
                lambertian = scene_pb2.Lambertian(reflectance=colour(kernel.reflectance, ".reflectance"))
                return Leaf(scene_pb2.Kernel(lambertian=lambertian))
            case DiffuseTransmitter():
                return Leaf(scene_pb2.Kernel(diffuse_transmitter=self._transmitter(kernel)))
            case Conductor():
                return Leaf(self._metal(kernel))
            case Dielectric():
                return Leaf(self._boundary(kernel, side), self._interior(kernel))
            case ThinPane():
                pane = scene_pb2.ThinPane(
                    index=self._index(kernel.index),
                    transmittance=self._workspace.reflectance(kernel.transmittance),
                )
                return Leaf(scene_pb2.Kernel(thin_pane=pane))
            case Glazing():
                glazing = compile_glazing(self._workspace, kernel, from_back=side == "back")
                return Leaf(scene_pb2.Kernel(glazing=glazing))
            case CoatedDiffuse():
                coated = scene_pb2.CoatedDiffuse(
                    index=self._index(kernel.index),
                    roughness=self._roughness(kernel),
                    reflectance=colour(kernel.reflectance, ".reflectance"),
                )
                return Leaf(scene_pb2.Kernel(coated_diffuse=coated))
            case Phong():
                reflectance = colour(kernel.reflectance, ".reflectance")
                phong = scene_pb2.Phong(reflectance=reflectance, exponent=kernel.exponent)
                return Leaf(scene_pb2.Kernel(phong=phong))
            case Principled():
                return Leaf(scene_pb2.Kernel(principled=self._principled(kernel)))
            case Measured():
                measured = scene_pb2.Measured(blob=compile_measured(self._workspace, kernel))
                return Leaf(scene_pb2.Kernel(measured=measured))
            case Polariser() | Retarder():
                return Leaf(compile_filter(self._workspace, kernel))
            case NullKernel():
                return Leaf(null_kernel())
        raise TypeError(f"{type(kernel).__name__} is no single kernel")

    def _transmitter(self, kernel: DiffuseTransmitter) -> scene_pb2.DiffuseTransmitter:
        message = scene_pb2.DiffuseTransmitter(
            reflectance=self._textures.reflectance(kernel.reflectance, ".reflectance"),
            transmittance=self._textures.reflectance(kernel.transmittance, ".transmittance"),
        )
        pool, grid = self._workspace.spectra.messages, self._workspace.wavelengths.grid()
        total = np.zeros(len(grid))
        for colour in (message.reflectance, message.transmittance):
            total += spectra.evaluate(pool[colour.spectrum], grid)
        if np.any(total > 1 + _ROUNDING):
            worst = int(np.argmax(total))
            raise Unusable(
                f"reflectance and transmittance add up to {total[worst]:.6g} at {grid[worst]:g} nm; "
                "expected at most 1",
                ".transmittance",
            )
        return message

    def _principled(self, kernel: Principled) -> scene_pb2.Principled:
        scalar = self._textures.scalar
        message = scene_pb2.Principled(
            base=self._textures.reflectance(kernel.base, ".base"),
            metallic=scalar(kernel.metallic, ".metallic"),
            roughness=scalar(kernel.roughness, ".roughness"),
            index=self._index(kernel.index),
            coat=scalar(kernel.coat, ".coat"),
            coat_roughness=scalar(kernel.coat_roughness, ".coat_roughness"),
            coat_index=kernel.coat_index,
        )
        # The default is left out: it would cost time at every point.
        if kernel.specular != 1.0 or kernel.specular_colour is not None:
            message.reflectance.amount.CopyFrom(scalar(kernel.specular, ".specular"))
        if kernel.specular_colour is not None:
            colour = self._textures.reflectance(kernel.specular_colour, ".specular_colour")
            message.reflectance.normal.CopyFrom(colour)
        if kernel.roughness_across is not None and kernel.roughness_across != kernel.roughness:
            message.brush.roughness.CopyFrom(scalar(kernel.roughness_across, ".roughness_across"))
            message.brush.rotation.CopyFrom(scalar(kernel.rotation, ".rotation"))
        if kernel.sheen is not None:
            message.sheen.colour.CopyFrom(self._textures.reflectance(kernel.sheen, ".sheen"))
            message.sheen.roughness.CopyFrom(scalar(kernel.sheen_roughness, ".sheen_roughness"))
        return message

    def _metal(self, kernel: Conductor) -> scene_pb2.Kernel:
        conductor = self._conductor(kernel)
        if not kernel.coating:
            return scene_pb2.Kernel(conductor=conductor)
        layers = compile_layers(self._workspace, kernel.coating, ".coating")
        return scene_pb2.Kernel(
            coated_conductor=scene_pb2.CoatedConductor(conductor=conductor, layers=layers)
        )

    def _boundary(self, kernel: Dielectric, side: Side) -> scene_pb2.Kernel:
        dielectric = scene_pb2.Dielectric(roughness=self._roughness(kernel))
        if not kernel.coating:
            return scene_pb2.Kernel(dielectric=dielectric)
        layers = compile_layers(self._workspace, kernel.coating, ".coating")
        if side == "back":
            layers.reverse()
        polished = scene_pb2.Scalar(constant=0.0)
        alphas = (dielectric.roughness.alpha_u, dielectric.roughness.alpha_v)
        body = self._workspace.spectra.messages[self._index(kernel.index)]
        if alphas != (polished, polished) and all(abs(n - 1) < _NO_CONTRAST for n in body.values):
            raise Unusable(
                "the body has the index of the air around it, where facets refract nothing; expected another "
                "index, or roughness 0 below a coating",
                ".index",
            )
        return scene_pb2.Kernel(
            coated_dielectric=scene_pb2.CoatedDielectric(dielectric=dielectric, layers=layers)
        )

    def _conductor(self, kernel: Conductor) -> scene_pb2.Conductor:
        try:
            n, k = compile_complex(self._workspace, kernel.index)
        except Unusable as error:
            raise Unusable(str(error), f".index{error.suffix}") from None
        return scene_pb2.Conductor(n=n, k=k, roughness=self._roughness(kernel))

    def _interior(self, kernel: Dielectric) -> scene_pb2.Interior:
        message = scene_pb2.Interior(index=self._index(kernel.index), priority=kernel.priority)
        if kernel.outside is not None:
            message.outside = self._index(kernel.outside, ".outside")
        if kernel.absorption is not None:
            found = self._workspace.spectrum(kernel.absorption)
            absorption = spectra.reflectance(found, self._workspace.spectral)
            if not spectra.is_black(absorption):
                message.absorption = self._workspace.spectra.index_of(absorption)
        return message

    def _index(self, index: AnyIndex, place: str = ".index") -> int:
        try:
            return compile_index(self._workspace, index)
        except indices.BadIndexError as error:
            raise Unusable(str(error), place) from None

    def _roughness(self, kernel: RoughKernel) -> scene_pb2.Roughness:
        (name_u, alpha_u), (name_v, alpha_v) = kernel.alphas()
        return scene_pb2.Roughness(
            alpha_u=self._textures.scalar(alpha_u, f".{name_u}"),
            alpha_v=self._textures.scalar(alpha_v, f".{name_v}"),
            beckmann=kernel.distribution == "beckmann",
        )
