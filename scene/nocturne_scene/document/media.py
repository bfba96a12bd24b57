"""Media as written in a scene document: what fills space and is hit by chance."""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import (
    AssetReference,
    Coordinate,
    Finite,
    Fraction,
    NotNegative,
    PositiveLength,
    Switch,
    Text,
    Vector,
    Wavelength,
)
from nocturne_scene.document.fluorescence import Dye
from nocturne_scene.document.indices import IndexReference
from nocturne_scene.document.node import ByKey, ByType, Node, one_of_names, problem_at
from nocturne_scene.document.placement import Placement
from nocturne_scene.document.shapes import length
from nocturne_scene.document.spectra import SpectrumReference
from nocturne_scene.media import presets as media_presets

_Density = Annotated[NotNegative, Field(le=bounds.MEDIUM_DENSITY)]
_MeanCosine = Annotated[Finite, Field(gt=-1, lt=1)]
_Shape = Annotated[Finite, Field(gt=0, le=bounds.DROPLET_SHAPE)]


class Droplets(Node):
    """Clear spheres of many sizes: n(r) in proportion to r^alpha exp(-(alpha / gamma) (r / mode)^gamma).

    The modified gamma distribution (D. Deirmendjian, "Electromagnetic scattering on spherical
    polydispersions", 1969). How they scatter is computed by Mie's theory when the scene is compiled: for 21
    wavelengths, linear in between.
    """

    mode_radius: Annotated[Finite, Field(ge=1e-9, le=1e-3)] = Field(
        description="The most frequent radius, m."
    )
    alpha: _Shape = Field(description="Exponent of the small droplets.")
    gamma: _Shape = Field(default=1.0, description="Exponent of the large droplets' decline.")
    number: Annotated[Finite, Field(gt=0, le=bounds.DROPLETS)] = Field(
        default=1e8,
        description="Droplets in a cubic metre where the density is 1. Without effect on a phase function.",
    )
    index: IndexReference = Field(default="water", description="Index of refraction.")


class IsotropicPhase(Node):
    """The same in all directions."""

    type: Literal["isotropic"]


class HenyeyGreensteinPhase(Node):
    """L. G. Henyey and J. L. Greenstein, Astrophysical Journal 93, 1941."""

    type: Literal["henyey_greenstein"]
    g: _MeanCosine = Field(description="Mean cosine of the scattering angle; positive is forwards.")


class DoubleHenyeyGreensteinPhase(Node):
    """Two Henyey-Greenstein functions, each for a part of the light."""

    type: Literal["double_henyey_greenstein"]
    first: _MeanCosine = Field(description="Mean cosine of the first.")
    second: _MeanCosine = Field(description="Mean cosine of the second.")
    weight: Fraction = Field(description="Part of the first; the second has the rest.")


class RayleighPhase(Node):
    """Molecules, and whatever is far smaller than the wavelength; unpolarised light."""

    type: Literal["rayleigh"]
    depolarisation: SpectrumReference = Field(
        default=0.0, description="Depolarisation ratio for natural light, in [0, 1)."
    )


_Elements = list[Annotated[list[Annotated[Finite, Field(ge=-1, le=1)]], Field(fail_fast=True)]]


class ScatteringMatrix(Node):
    """What a phase function does to polarised light: elements of the scattering matrix of particles that are
    turned at random, each over the phase function, with lists as `values` has.

    As C. F. Bohren and D. R. Huffman define them ("Absorption and scattering of light by small particles",
    1983, section 3.3): for molecules S12 is negative at 90 degrees. Codes with the other handedness have the
    other sign of S34. Only scenes with Stokes vectors or filters read it.
    """

    s12: _Elements = Field(description="S12 / S11, in [-1, 1].")
    s33: _Elements = Field(description="S33 / S11, in [-1, 1].")
    s34: _Elements = Field(description="S34 / S11, in [-1, 1].")
    s22: _Elements | None = Field(
        default=None, description="S22 / S11, in [-1, 1]. Default: 1, as of spheres."
    )
    s44: _Elements | None = Field(
        default=None, description="S44 / S11, in [-1, 1]. Default: `s33`, as of spheres."
    )


class TabulatedPhase(Node):
    """Measured or computed values, linear between cosines and between wavelengths; of any scale."""

    type: Literal["tabulated"]
    cosines: Annotated[list[Finite], Field(min_length=2, max_length=bounds.PHASE_COSINES, fail_fast=True)] = (
        Field(description="Cosines of the scattering angle, increasing from -1 (back) to 1 (on).")
    )
    wavelengths: Annotated[list[Wavelength], Field(min_length=1, max_length=bounds.TABLE_KNOTS)] = Field(
        default=[550.0], description="Increasing; the first and last hold beyond. One: the same for all."
    )
    values: list[Annotated[list[NotNegative], Field(fail_fast=True)]] = Field(
        description="A list for each wavelength, with a value for each cosine; not all zero."
    )
    matrix: ScatteringMatrix | None = Field(
        default=None, description="For polarised light. Default: scattered light is unpolarised."
    )

    @model_validator(mode="after")
    def _is_table(self) -> Self:
        if self.cosines[0] != -1 or self.cosines[-1] != 1:
            raise problem_at(".cosines", "expected cosines from -1 to 1, both included")
        for name in ("cosines", "wavelengths"):
            for index, (before, after) in enumerate(pairwise(getattr(self, name)), start=1):
                if after <= before:
                    raise problem_at(f".{name}[{index}]", f"must increase: {after:g} follows {before:g}")
        if len(self.values) != len(self.wavelengths):
            raise problem_at(
                ".values", f"has {len(self.values)} lists for {len(self.wavelengths)} wavelengths"
            )
        for index, row in enumerate(self.values):
            if len(row) != len(self.cosines):
                raise problem_at(
                    f".values[{index}]", f"has {len(row)} values for {len(self.cosines)} cosines"
                )
            if not any(row):
                raise problem_at(f".values[{index}]", "all values are zero")
        if self.matrix is not None:
            _check_matrix(self.matrix, len(self.wavelengths), len(self.cosines))
        return self


_DIGITS = 1e-3
"""By which printed elements may break these relations."""


def _check_matrix(matrix: ScatteringMatrix, rows: int, columns: int) -> None:
    """Raise a problem unless it has the table's shape, and leaves no light more than wholly polarised.

    J. W. Hovenier and C. V. M. van der Mee, "Basic relationships for matrices describing scattering by small
    particles", in Light Scattering by Nonspherical Particles, 2000, equations 53 to 55.
    """
    for name in ("s12", "s33", "s34", "s22", "s44"):
        lists = getattr(matrix, name)
        if lists is not None and [len(each) for each in lists] != rows * [columns]:
            raise problem_at(
                f".matrix.{name}", f"expected {rows} lists, as `values` has, of {columns} values each"
            )
    for row in range(rows):
        for column in range(columns):
            s12, s33, s34 = (lists[row][column] for lists in (matrix.s12, matrix.s33, matrix.s34))
            s22 = 1.0 if matrix.s22 is None else matrix.s22[row][column]
            s44 = s33 if matrix.s44 is None else matrix.s44[row][column]
            excess = max(
                (s33 + s44) ** 2 + 4 * s34**2 - (1 + s22) ** 2 + 4 * s12**2,
                abs(s33 - s44) - (1 - s22),
                abs(s22 - s12) - (1 - s12),
                abs(s22 + s12) - (1 + s12),
            )
            if excess > _DIGITS:
                raise problem_at(
                    f".matrix.s12[{row}][{column}]",
                    "with the other elements there, light would leave more than wholly polarised",
                )


class MiePhase(Node):
    """That of droplets, for coefficients of your own."""

    type: Literal["mie"]
    droplets: Droplets = Field(description="The droplets.")


Phase = (
    IsotropicPhase
    | HenyeyGreensteinPhase
    | DoubleHenyeyGreensteinPhase
    | RayleighPhase
    | TabulatedPhase
    | MiePhase
)
PhaseDefinition = Annotated[Phase, ByType()]


class AbovePlane(Node):
    """Altitude is the distance from a plane."""

    point: Vector = Field(default=(0.0, 0.0, 0.0), description="A point of the plane.")
    up: Vector = Field(default=(0.0, 1.0, 0.0), description="Its normal, of any length but 0.")

    @model_validator(mode="after")
    def _has_direction(self) -> Self:
        if length(self.up) < bounds.MIN_LENGTH:
            raise problem_at(".up", "the direction has no length")
        return self


class AboveSphere(Node):
    """Altitude is the distance from a sphere."""

    centre: Vector = Field(description="Centre.")
    radius: PositiveLength = Field(description="Radius, m.")


_Above = Annotated[
    AbovePlane | AboveSphere,
    ByKey({"radius": AboveSphere, "centre": AboveSphere, "up": AbovePlane, "point": AbovePlane}),
]
_ABOVE = Field(default=AbovePlane(), description="What altitude is measured from. Default: the plane y = 0.")


class ExponentialDensity(Node):
    """`at_ground` times exp(-altitude / scale height), also below the ground."""

    scale_height: PositiveLength = Field(description="Altitude over which the density falls to 1 / e, m.")
    at_ground: _Density = Field(default=1.0, description="Density at altitude 0.")
    above: _Above = _ABOVE


class LayeredDensity(Node):
    """A density that depends on altitude, linear between those given; nothing beyond."""

    layers: Annotated[
        list[tuple[Coordinate, _Density]],
        Field(min_length=2, max_length=bounds.TABLE_KNOTS, fail_fast=True),
    ] = Field(description="Pairs `[altitude in m, density]`, altitudes increasing.")
    above: _Above = _ABOVE

    @model_validator(mode="after")
    def _increase(self) -> Self:
        for index, (before, after) in enumerate(pairwise(self.layers), start=1):
            if after[0] <= before[0]:
                raise problem_at(
                    f".layers[{index}][0]",
                    f"altitudes must increase: {after[0]:g} m follows {before[0]:g} m",
                )
        return self


class Grid(Placement):
    """A grid of an OpenVDB file, with 32-bit floats; where it is sparse it stays sparse.

    The file's own transform places voxels; then come `scale`, `rotate` and `translate`. It stands in the
    scene, also where the surface that bounds it is in a group.
    """

    asset: AssetReference = Field(
        description="The .vdb file: a path relative to the document, or `sha256:` and its digest."
    )
    grid: Annotated[Text, Field(min_length=1, max_length=bounds.NAME_LENGTH)] = Field(
        description="Name of the grid in the file."
    )
    factor: Annotated[NotNegative, Field(le=bounds.MEDIUM_DENSITY)] = Field(
        default=1.0, description="Factor of the values."
    )
    nearest: Switch = Field(
        default=False, description="`true`: constant over a voxel. `false`: linear between voxel centres."
    )


DensityDefinition = Annotated[
    _Density | ExponentialDensity | LayeredDensity | Grid,
    ByKey({"scale_height": ExponentialDensity, "layers": LayeredDensity, "asset": Grid}),
]


_Preset = Annotated[
    str,
    Field(strict=True, json_schema_extra={"enum": list(media_presets.names())}),
    one_of_names("medium", media_presets.names()),
]


class Medium(Node):
    """What fills space and is hit by chance: fog, smoke, air, milk.

    Its effect on light comes from one of three: `absorption`, `scattering` and `fluorescence`, a `preset`, or
    `droplets`.
    Coefficients are per metre where the density is 1; spectra of any kind but those of light.
    """

    preset: _Preset | None = Field(default=None, description="A published medium, with its phase function.")
    droplets: Droplets | None = Field(default=None, description="Fog or haze by Mie's theory.")
    absorption: SpectrumReference | None = Field(
        default=None, description="Absorption coefficient, 1/m. Default: none."
    )
    scattering: SpectrumReference | None = Field(
        default=None, description="Scattering coefficient, 1/m. Default: none."
    )
    phase: PhaseDefinition | None = Field(
        default=None, description="How directions change, for `scattering`. Default: isotropic."
    )
    density: DensityDefinition = Field(
        default=1.0, description="Factor of the coefficients: a number, by altitude, or a grid."
    )
    fluorescence: Annotated[list[Dye], Field(max_length=bounds.FLUOROPHORES)] = Field(
        default=[], description="Dyes in it, in addition to `absorption` and `scattering`."
    )
    temperature: Grid | None = Field(
        default=None, description="Kelvin. The medium glows as a black body wherever it absorbs."
    )
    emission_scale: Annotated[NotNegative, Field(le=bounds.MEDIUM_DENSITY)] | None = Field(
        default=None, description="Factor of the glow, with `temperature`. Default: 1."
    )

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        own = self.absorption is not None or self.scattering is not None or bool(self.fluorescence)
        given = [own, self.preset is not None, self.droplets is not None]
        if sum(given) != 1:
            raise problem_at(
                "",
                'expected either "preset", or "droplets", or some of "absorption", "scattering" and '
                '"fluorescence"',
            )
        if self.phase is not None and self.scattering is None:
            whose = "has no scattering" if own else "has a phase function of its own"
            raise problem_at(".phase", f"the medium {whose}; leave it out")
        if self.fluorescence and self.temperature is not None:
            raise problem_at(".temperature", "a medium that fluoresces can't glow; expected two media")
        if self.emission_scale is not None and self.temperature is None:
            raise problem_at(".emission_scale", "needs a temperature")
        return self

    def grid_density(self) -> Grid | None:
        """The grid of its density, if it has one."""
        return self.density if isinstance(self.density, Grid) else None
