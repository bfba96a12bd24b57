"""Spectra as written in a scene document."""

from collections.abc import Collection
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, Knot, SpectralValue, Wavelength
from nocturne_scene.document.node import ByKey, Node, problem_at, quoted_list
from nocturne_scene.spectra import lines as line_spectra
from nocturne_scene.spectra import published


def _known_illuminant(name: str) -> str:
    return _one_of(name, "illuminant", published.ILLUMINANTS)


def _known_patch(name: str) -> str:
    return _one_of(name, "patch", tuple(published.CHART_PATCHES))


def _one_of(name: str, noun: str, names: Collection[str]) -> str:
    if name not in names:
        shown = name[: bounds.NAME_LENGTH]
        raise problem_at("", f'no {noun} named "{shown}"; expected one of {quoted_list(names)}')
    return name


Illuminant = Annotated[
    str,
    Field(strict=True, json_schema_extra={"enum": list(published.ILLUMINANTS)}),
    AfterValidator(_known_illuminant),
]
ChartPatch = Annotated[
    str,
    Field(strict=True, json_schema_extra={"enum": list(published.CHART_PATCHES)}),
    AfterValidator(_known_patch),
]
_Part = Annotated[Finite, Field(ge=0, le=1)]
Luminance = Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)]
_LUMINANCE_HELP = (
    "Only for radiance: scales the spectrum so that it has this luminance, cd/m². "
    "Photometry by the CIE 1931 2° observer."
)


def check_increasing(wavelengths: list[float]) -> None:
    """Raise an error at the first knot of a table that is out of order."""
    for index, (before, after) in enumerate(pairwise(wavelengths), start=1):
        if after <= before:
            raise problem_at(
                f".table[{index}][0]", f"wavelengths must increase: {after:g} nm follows {before:g} nm"
            )


class ConstantSpectrum(Node):
    """The same value at every wavelength. A bare number means the same as `{"constant": number}`."""

    constant: SpectralValue = Field(description="Reflectance in [0, 1], or radiance in W m⁻² sr⁻¹ nm⁻¹.")
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class TableSpectrum(Node):
    """Measured or computed values, linear between neighbours.

    Compiled to the coarsest of the steps 100, 50, 20, 10, 5, 4, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02 and 0.01 nm
    on which every knot lies, so that nothing is lost. A table whose knots lie on none of them is sampled each
    0.1 nm from its first knot: the value is then exact at the samples, elsewhere wrong by at most 0.025 nm
    times the change of slope at a knot in between, and the end is rounded up to the next sample.
    """

    table: Annotated[list[Knot], Field(min_length=1, max_length=bounds.TABLE_KNOTS, fail_fast=True)] = Field(
        description="Pairs `[wavelength in nm, value]`, wavelengths increasing. Values are "
        "reflectance in [0, 1], or "
        "radiance in W m⁻² sr⁻¹ nm⁻¹."
    )
    outside: Literal["hold", "zero"] | None = Field(
        default=None,
        description="Beyond the first and last knot: `hold` the end value, or `zero`. Default: "
        "`hold` for reflectance, "
        "`zero` for radiance.",
    )
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)

    @model_validator(mode="after")
    def _wavelengths_increase(self) -> Self:
        check_increasing([knot[0] for knot in self.table])
        return self


class BlackbodySpectrum(Node):
    """Radiance of a black body, by Planck's law in vacuum, absolute unless `luminance` is given."""

    blackbody: Annotated[Finite, Field(gt=0, le=bounds.TEMPERATURE)] = Field(description="Temperature, K.")
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class IlluminantSpectrum(Node):
    """A CIE illuminant (CIE 015:2018).

    It has a shape and no size, so as radiance it needs `luminance`.
    """

    illuminant: Illuminant = Field(description="Which one.")
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class SolarSpectrum(Node):
    """Sunlight by ASTM G173-03, 280 to 4000 nm: as irradiance in W m⁻² nm⁻¹, times `factor`; zero beyond.

    A uniform sky's radiance is that over pi.
    """

    solar: Literal["extraterrestrial", "global", "direct"] = Field(
        description="`extraterrestrial`: above the air. After 1.5 air masses, `direct`: across the beam, and "
        "`global`: on a plane tilted by 37 degrees, sky and ground included."
    )
    factor: Annotated[Finite, Field(gt=0, le=bounds.RADIANCE)] = Field(
        default=1.0, description="Times all values."
    )
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class SpectralLine(Node):
    """One line. Nothing is infinitely thin, so it has a width."""

    nm: Wavelength = Field(description="Its middle, nm.")
    power: SpectralValue = Field(
        description="The line's radiance, W m⁻² sr⁻¹; with `luminance` only the lines' proportions count."
    )
    width: Annotated[Finite, Field(ge=line_spectra.MIN_WIDTH, le=line_spectra.MAX_WIDTH)] = Field(
        default=line_spectra.DEFAULT_WIDTH, description="Full width at half maximum, nm."
    )


class LineSpectrum(Node):
    """Light of a gas discharge or a laser: lines, each a triangle over wavelength.

    The triangle has its full width at half of its height, twice that at its foot; its area is the power.
    Lines may overlap. Those that lie outside of the scene's wavelengths are left out. However narrow a line
    is, it needs no more photons than other light does: see the sensor's `wavelengths`.
    """

    lines: Annotated[list[SpectralLine], Field(min_length=1, max_length=bounds.SPECTRAL_LINES)] = Field(
        description="The lines."
    )
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class RgbSpectrum(Node):
    """The smooth spectrum of a colour (Jakob and Hanika 2019), in linear light with the primaries of sRGB.

    As reflectance the values lie in [0, 1], and a white surface has (1, 1, 1) under D65. As radiance it needs
    `luminance`, and (1, 1, 1) is D65.
    """

    rgb: tuple[_Part, _Part, _Part] = Field(description="Red, green and blue, linear.")
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class ChartSpectrum(Node):
    """The reflectance of a patch of the 24-patch colour chart (the mean of 30 charts, BabelColor 2012)."""

    chart_patch: ChartPatch = Field(description="Which one.")


SPECTRUM_KEYS = {
    "constant": ConstantSpectrum,
    "table": TableSpectrum,
    "blackbody": BlackbodySpectrum,
    "illuminant": IlluminantSpectrum,
    "solar": SolarSpectrum,
    "lines": LineSpectrum,
    "rgb": RgbSpectrum,
    "chart_patch": ChartSpectrum,
}


def known_name(name: str, noun: str, collection: str, info: ValidationInfo) -> str:
    """Check that `name` is a key of `$.<collection>`, whose keys the validation context holds."""
    names: Collection[str] | None = (info.context or {}).get(collection)
    if names is not None and name not in names:
        expected = f"expected one of {quoted_list(names)}" if names else f"$.{collection} has none"
        raise problem_at("", f'no {noun} named "{name[: bounds.NAME_LENGTH]}"; {expected}')
    return name


def _known_spectrum(name: str, info: ValidationInfo) -> str:
    return known_name(name, "spectrum", "spectra", info)


Spectrum = (
    ConstantSpectrum
    | TableSpectrum
    | BlackbodySpectrum
    | IlluminantSpectrum
    | SolarSpectrum
    | LineSpectrum
    | RgbSpectrum
    | ChartSpectrum
)

InlineSpectrum = SpectralValue | Spectrum
SpectrumName = Annotated[str, Field(strict=True, title="name"), AfterValidator(_known_spectrum)]

# In $.spectra.
SpectrumDefinition = Annotated[InlineSpectrum, ByKey(SPECTRUM_KEYS)]
# Where a spectrum is used: also the name of one in $.spectra.
SpectrumReference = Annotated[SpectrumName | InlineSpectrum, ByKey(SPECTRUM_KEYS)]
