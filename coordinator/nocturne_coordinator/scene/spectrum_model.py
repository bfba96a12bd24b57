"""Spectra as written in a scene document."""

from collections.abc import Collection
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, Tag, ValidationInfo, model_validator

from nocturne_coordinator.scene import bounds
from nocturne_coordinator.scene.fields import Finite, Knot, SpectralValue
from nocturne_coordinator.scene.node import Node, chosen_by_key, problem_at, quoted_list

Luminance = Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)]
_LUMINANCE_HELP = (
    "Only for radiance: scales the spectrum so that it has this luminance, cd/m². "
    "Photometry by the CIE 1931 2° observer."
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
        for index, (before, after) in enumerate(pairwise(self.table), start=1):
            if after[0] <= before[0]:
                raise problem_at(
                    f".table[{index}][0]",
                    f"wavelengths must increase: {after[0]:g} nm follows {before[0]:g} nm",
                )
        return self


class BlackbodySpectrum(Node):
    """Radiance of a black body, by Planck's law in vacuum, absolute unless `luminance` is given."""

    blackbody: Annotated[Finite, Field(gt=0, le=bounds.TEMPERATURE)] = Field(description="Temperature, K.")
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


class IlluminantSpectrum(Node):
    """A CIE standard illuminant (CIE 015:2018).

    It has a shape and no size, so as radiance it needs `luminance`.
    """

    illuminant: Literal["A", "D50", "D65", "E"] = Field(description="Which one.")
    luminance: Luminance | None = Field(default=None, description=_LUMINANCE_HELP)


_BY_KEY = {
    "constant": "<constant>",
    "table": "<table>",
    "blackbody": "<blackbody>",
    "illuminant": "<illuminant>",
}


def _number(value: Any) -> str | None:
    """Tag of a bare number. True and false are numbers to Python, but not to JSON."""
    return "<number>" if isinstance(value, int | float) and not isinstance(value, bool) else None


def _number_or_name(value: Any) -> str | None:
    return "<name>" if isinstance(value, str) else _number(value)


def known_name(name: str, noun: str, collection: str, info: ValidationInfo) -> str:
    """Check that `name` is a key of `$.<collection>`, whose keys the validation context holds."""
    names: Collection[str] | None = (info.context or {}).get(collection)
    if names is not None and name not in names:
        expected = f"expected one of {quoted_list(names)}" if names else f"$.{collection} has none"
        raise problem_at("", f'no {noun} named "{name[: bounds.NAME_LENGTH]}"; {expected}')
    return name


def _known_spectrum(name: str, info: ValidationInfo) -> str:
    return known_name(name, "spectrum", "spectra", info)


Spectrum = ConstantSpectrum | TableSpectrum | BlackbodySpectrum | IlluminantSpectrum

_Inline = (
    Annotated[SpectralValue, Tag("<number>")]
    | Annotated[ConstantSpectrum, Tag("<constant>")]
    | Annotated[TableSpectrum, Tag("<table>")]
    | Annotated[BlackbodySpectrum, Tag("<blackbody>")]
    | Annotated[IlluminantSpectrum, Tag("<illuminant>")]
)
_SpectrumName = Annotated[
    str, Field(strict=True, title="name"), AfterValidator(_known_spectrum), Tag("<name>")
]

_definition_check, _definition_choice = chosen_by_key(_BY_KEY, _number, "a number")
_reference_check, _reference_choice = chosen_by_key(_BY_KEY, _number_or_name, "a name, a number")

# In $.spectra.
SpectrumDefinition = Annotated[_Inline, _definition_choice, _definition_check]
# Where a spectrum is used: also the name of one in $.spectra.
SpectrumReference = Annotated[_SpectrumName | _Inline, _reference_choice, _reference_check]
