"""Kernels as written in a scene document: how surfaces scatter light."""

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import AssetReference, Finite, Vector
from nocturne_scene.document.films import Layers, Pane
from nocturne_scene.document.fluorescence import Fluorescence
from nocturne_scene.document.indices import ComplexIndexReference, IndexReference
from nocturne_scene.document.node import ByType, Node, problem_at
from nocturne_scene.document.shapes import length
from nocturne_scene.document.spectra import SpectrumReference, known_name
from nocturne_scene.document.textures import ColourReference, ScalarReference

_REFLECTANCE = "Fraction of the light that is reflected, in [0, 1] at every wavelength."


class Lambertian(Node):
    """An ideal diffuse reflector, on both sides of the surface: it looks equally bright from everywhere."""

    type: Literal["lambertian"]
    reflectance: ColourReference = Field(description=_REFLECTANCE)
    fluorescence: Annotated[list[Fluorescence], Field(max_length=bounds.FLUOROPHORES)] = Field(
        default=[],
        description="What else it does with light: absorbs it and sends it on at other wavelengths. Of each "
        "wavelength's photons at most all are reflected or absorbed so. Light within the scene's "
        "`wavelengths` excites; photons start at the sensor alone. Default: nothing.",
    )


class DiffuseTransmitter(Node):
    """Paper, leaf or cloth: diffuse on both sides, to the side that light comes from and to the other."""

    type: Literal["diffuse_transmitter"]
    reflectance: ColourReference = Field(description=_REFLECTANCE)
    transmittance: ColourReference = Field(
        description="Fraction that goes through; with the reflectance at most 1 at every wavelength."
    )


class RoughKernel(Node):
    """Fields of kernels with microfacets; 0 is polished."""

    roughness: ScalarReference | None = Field(
        default=None, description="Alpha of the microfacets, in [0, 1]; 0 is polished. Default: 0."
    )
    roughness_u: ScalarReference | None = Field(
        default=None, description="Alpha along the surface's u, instead of `roughness`."
    )
    roughness_v: ScalarReference | None = Field(default=None, description="Alpha along v.")
    distribution: Literal["ggx", "beckmann"] = Field(
        default="ggx",
        description="Of the microfacets' normals: `ggx` has the long tails of most real surfaces, `beckmann` "
        "normally distributed slopes, alpha being sqrt 2 times their standard deviation.",
    )

    @model_validator(mode="after")
    def _one_or_two(self) -> Self:
        one, two = self.roughness is not None, (self.roughness_u is not None, self.roughness_v is not None)
        if one and any(two):
            raise problem_at(".roughness", "give either roughness, or roughness_u and roughness_v")
        if any(two) and not all(two):
            missing = ".roughness_v" if two[0] else ".roughness_u"
            raise problem_at(missing, "missing; roughness_u and roughness_v go together")
        return self

    def alphas(self) -> "tuple[tuple[str, ScalarReference], tuple[str, ScalarReference]]":
        """Field and value of the roughness along u and along v."""
        if self.roughness_u is not None and self.roughness_v is not None:
            return ("roughness_u", self.roughness_u), ("roughness_v", self.roughness_v)
        alpha = 0.0 if self.roughness is None else self.roughness
        return ("roughness", alpha), ("roughness", alpha)


class Conductor(RoughKernel):
    """A metal, polished or rough (microfacets)."""

    type: Literal["conductor"]
    index: ComplexIndexReference = Field(description="Index of refraction n + i k, against vacuum.")
    coating: Layers = Field(default=[], description="Thin layers on it, the outermost first. Default: none.")


class Dielectric(RoughKernel):
    """The boundary of a transparent body, polished or rough (microfacets): glass, water, diamond.

    What the surface encloses, on the side that the normal points away from, is the body. Bodies may overlap:
    where they do, the one with the higher `priority` is there, so a drink reaches a little into its glass.
    """

    type: Literal["dielectric"]
    index: IndexReference = Field(description="Index of refraction of the body.")
    absorption: SpectrumReference | None = Field(
        default=None, description="Absorption coefficient inside, 1/m: a constant or a table. Default: none."
    )
    priority: Annotated[int, Field(strict=True, ge=-bounds.PRIORITY, le=bounds.PRIORITY)] = Field(
        default=0, description="Which of overlapping bodies counts: the one with the highest number."
    )
    outside: IndexReference | None = Field(
        default=None,
        description="Index of refraction on the side that the normal points to, whatever is there. The "
        "surface is a boundary between two indices then and bounds no body: it may be open, as water in a "
        "glass is, and has neither `absorption` nor `priority`. Mitsuba's and pbrt's boundaries are such. "
        "Default: the index of what the body is in.",
    )
    coating: Layers = Field(
        default=[],
        description="Thin layers between the body and its surroundings, the outermost first. Default: none.",
    )

    @model_validator(mode="after")
    def _no_body_between_two_indices(self) -> Self:
        if self.outside is None:
            return self
        if self.absorption is not None:
            raise problem_at(".absorption", "a boundary with an index outside bounds no body; leave this out")
        if self.priority != 0:
            raise problem_at(".priority", "a boundary with an index outside bounds no body; leave this out")
        return self


class ThinPane(Node):
    """A thin plane sheet of glass as one surface: all inner reflections, without the offset of the light."""

    type: Literal["thin_pane"]
    index: IndexReference = Field(description="Index of refraction of the sheet.")
    transmittance: SpectrumReference = Field(
        default=1.0, description="Internal transmittance of one crossing at normal incidence, in [0, 1]."
    )


class Glazing(Node):
    """Panes one behind the other with gaps between them, as one surface without thickness: a window.

    Light goes straight on or is mirrored, with all reflections between the panes and in them, without the
    offset of the light. The front is the side that the surface's normal points to.
    """

    type: Literal["glazing"]
    panes: Annotated[list[Pane], Field(min_length=1, max_length=bounds.PANES)] = Field(
        description="From the front to the back."
    )


class CoatedDiffuse(RoughKernel):
    """A dielectric layer over an ideal diffuse base, on both sides of the surface: plastic, tiles."""

    type: Literal["coated_diffuse"]
    index: IndexReference = Field(description="Index of refraction of the layer.")
    reflectance: ColourReference = Field(description="Of the base alone, in [0, 1].")


class Phong(Node):
    """A cosine lobe around the mirror direction, (n + 2) / 2π cosⁿ, times the reflectance."""

    type: Literal["phong"]
    reflectance: ColourReference = Field(description=_REFLECTANCE)
    exponent: Annotated[Finite, Field(ge=0, le=bounds.PHONG_EXPONENT)] = Field(description="n.")


class Principled(Node):
    """The principled surface of exchange formats: metal, a dielectric over a diffuse base, or between both.

    Its parts: GGX microfacets whose alpha is the square of a roughness; metal by Schlick's reflectance;
    a base that gets what the dielectric lets through; a clear coat over both; fuzz over all. Formulas:
    worker/src/kernels/principled.h.
    """

    type: Literal["principled"]
    base: ColourReference = Field(
        description="Diffuse reflectance, and what metal reflects at normal incidence; in [0, 1]."
    )
    metallic: ScalarReference = Field(default=0.0, description="How much of it is metal, in [0, 1].")
    roughness: ScalarReference = Field(
        default=0.5, description="Square root of the microfacets' alpha, in [0, 1]; 0 is polished."
    )
    index: IndexReference = Field(default=1.5, description="Index of refraction over the base.")
    coat: ScalarReference = Field(default=0.0, description="How much of the clear coat is there, in [0, 1].")
    coat_roughness: ScalarReference = Field(default=0.0, description="The coat's, as `roughness`.")
    coat_index: Annotated[Finite, Field(ge=1, le=4)] = Field(
        default=1.5, description="Index of refraction of the coat."
    )
    specular: ScalarReference = Field(
        default=1.0, description="A factor of what the dielectric reflects, in [0, 1]."
    )
    specular_colour: ColourReference | None = Field(
        default=None,
        description="What the dielectric reflects at normal incidence, in [0, 1], before `specular`; at "
        "grazing angles it is white nevertheless. Default: the reflectance of its index.",
    )
    roughness_across: ScalarReference | None = Field(
        default=None,
        description="Of brushed facets, across the brush; `roughness` is then along it. Default: the same.",
    )
    rotation: ScalarReference = Field(
        default=0.0, description="From the surface's u to the brush, counterclockwise, in whole turns."
    )
    sheen: ColourReference | None = Field(
        default=None, description="What fuzz over all reflects, in [0, 1]. Default: there is none."
    )
    sheen_roughness: ScalarReference = Field(default=0.5, description="The fuzz's, as `roughness`.")


class Measured(Node):
    """A measured, isotropic reflection: a MERL file, or a spectral table in the half-angle frame.

    The table's layout: docs/how-to/measured-brdf.md.
    """

    type: Literal["measured"]
    asset: AssetReference = Field(
        description="The file: a path relative to the document, or `sha256:` and its digest."
    )
    format: Literal["merl", "table"] = Field(description="Which of the two.")


class Blend(Node):
    """Two kernels, each for a part of the light."""

    type: Literal["blend"]
    first: "KernelReference" = Field(description="A name from `$.kernels` or a kernel.")
    second: "KernelReference" = Field(description="The same.")
    weight: ScalarReference = Field(description="Part of `second`, in [0, 1]; `first` has the rest.")


class Mask(Node):
    """A kernel that is only partly there: the rest of the light goes straight through."""

    type: Literal["mask"]
    kernel: "KernelReference" = Field(description="A name from `$.kernels` or a kernel.")
    opacity: ScalarReference = Field(description="Part that is there, in [0, 1].")


class TwoSided(Node):
    """A kernel for each side of the surface. Neither can be a dielectric: a boundary has both sides.

    Both let the same light through, or none: no surface lets light through in one direction only.
    """

    type: Literal["two_sided"]
    front: "KernelReference" = Field(description="For light on the side that the normal points to.")
    back: "KernelReference" = Field(description="For light on the other side.")


class Polariser(Node):
    """A thin sheet that lets light through that is polarised along its axis, and no other.

    The axis is a direction in the scene, also of surfaces in groups; what counts is its part across the ray.
    """

    type: Literal["polariser"]
    axis: Vector = Field(description="Of the electric field that goes through.")
    transmittance: SpectrumReference = Field(
        default=1.0, description="Of light that is polarised along the axis, in [0, 1]."
    )
    leakage: SpectrumReference = Field(
        default=0.0, description="Transmittance of light that is polarised across it, in [0, 1]."
    )

    @model_validator(mode="after")
    def _has_axis(self) -> Self:
        _check_axis(self.axis)
        return self


class Retarder(Node):
    """A clear thin sheet in which light that is polarised across its fast axis falls behind: a wave plate.

    The axis is a direction in the scene, also of surfaces in groups; what counts is its part across the ray.
    """

    type: Literal["retarder"]
    axis: Vector = Field(description="The fast one.")
    retardance_nm: Annotated[Finite, Field(ge=0, le=bounds.RETARDANCE_NM)] | None = Field(
        default=None,
        description="By how much it falls behind, nm: a quarter of the wavelength makes circular light.",
    )
    retardance_degrees: Annotated[Finite, Field(ge=0, le=360)] | None = Field(
        default=None, description="The same as a phase, at all wavelengths, instead of `retardance_nm`."
    )

    @model_validator(mode="after")
    def _has_axis(self) -> Self:
        if (self.retardance_nm is None) == (self.retardance_degrees is None):
            raise problem_at("", "expected either retardance_nm or retardance_degrees")
        _check_axis(self.axis)
        return self


def _check_axis(axis: tuple[float, float, float]) -> None:
    if length(axis) < bounds.MIN_LENGTH:
        raise problem_at(".axis", "axis has no length")


class NullKernel(Node):
    """Nothing: light goes straight through. For shapes that only emit."""

    type: Literal["null"]


def _known_kernel(name: str, info: ValidationInfo) -> str:
    return known_name(name, "kernel", "kernels", info)


Kernel = (
    Lambertian
    | DiffuseTransmitter
    | Conductor
    | Dielectric
    | ThinPane
    | Glazing
    | CoatedDiffuse
    | Phong
    | Principled
    | Measured
    | Polariser
    | Retarder
    | Blend
    | Mask
    | TwoSided
    | NullKernel
)
# In $.kernels.
KernelDefinition = Annotated[Kernel, ByType()]
# Where a kernel is used: also the name of one in $.kernels.
KernelReference = Annotated[
    Annotated[str, Field(strict=True, title="name"), AfterValidator(_known_kernel)] | Kernel, ByType()
]

Blend.model_rebuild()
Mask.model_rebuild()
TwoSided.model_rebuild()


def inner_kernels(kernel: Kernel) -> list[tuple[str, str | Kernel]]:
    """Return the kernels that a kernel holds or names, by field."""
    match kernel:
        case Blend():
            return [("first", kernel.first), ("second", kernel.second)]
        case Mask():
            return [("kernel", kernel.kernel)]
        case TwoSided():
            return [("front", kernel.front), ("back", kernel.back)]
    return []
