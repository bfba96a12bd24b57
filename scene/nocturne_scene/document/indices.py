"""Indices of refraction as written in a scene document."""

from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, Wavelength
from nocturne_scene.document.node import ByKey, Node, problem_at, quoted_list
from nocturne_scene.document.spectra import check_increasing
from nocturne_scene.spectra import indices

RefractiveIndex = Annotated[Finite, Field(ge=indices.SMALLEST, le=indices.LARGEST)]
_Extinction = Annotated[Finite, Field(ge=0, le=indices.LARGEST)]
_Coefficient = Annotated[Finite, Field(ge=-1e6, le=1e6)]
_Triple = tuple[_Coefficient, _Coefficient, _Coefficient]


class SellmeierCoefficients(Node):
    """Coefficients as glass makers print them, for wavelengths in micrometres."""

    b: _Triple = Field(description="B1, B2, B3.")
    c: _Triple = Field(description="C1, C2, C3, µm².")


class SellmeierIndex(Node):
    """n² = 1 + sum of B l² / (l² - C), l in µm: the dispersion formula of most glass catalogues."""

    sellmeier: SellmeierCoefficients = Field(description="The coefficients.")


class CauchyIndex(Node):
    """n = A + B / l² + C / l⁴, l in µm."""

    cauchy: Annotated[list[_Coefficient], Field(min_length=1, max_length=3)] = Field(
        description="A, B (µm²), C (µm⁴); one to three of them."
    )


class TableIndex(Node):
    """Measured indices, linear between neighbours; beyond the table the end value holds."""

    table: Annotated[
        list[tuple[Wavelength, RefractiveIndex]],
        Field(min_length=1, max_length=bounds.TABLE_KNOTS, fail_fast=True),
    ] = Field(description="Pairs `[wavelength in nm, index]`, wavelengths increasing.")

    @model_validator(mode="after")
    def _wavelengths_increase(self) -> Self:
        check_increasing([knot[0] for knot in self.table])
        return self


class TableExtinction(Node):
    """Measured extinction coefficients k, linear between neighbours; beyond the table the end value holds."""

    table: Annotated[
        list[tuple[Wavelength, _Extinction]],
        Field(min_length=1, max_length=bounds.TABLE_KNOTS, fail_fast=True),
    ] = Field(description="Pairs `[wavelength in nm, k]`, wavelengths increasing.")

    @model_validator(mode="after")
    def _wavelengths_increase(self) -> Self:
        check_increasing([knot[0] for knot in self.table])
        return self


def _known_dielectric(name: str) -> str:
    if name in indices.dielectrics():
        return name
    metal = "that is a metal; " if name in indices.metals() else ""
    expected = f"{metal}expected one of {quoted_list(indices.dielectrics())}"
    raise problem_at("", f'no index of refraction named "{name[: bounds.NAME_LENGTH]}"; {expected}')


def _known_metal(name: str) -> str:
    if name in indices.metals():
        return name
    raise problem_at(
        "",
        f'no metal named "{name[: bounds.NAME_LENGTH]}"; expected one of {quoted_list(indices.metals())}, or '
        f'an object such as {{"n": 0.2, "k": 3.4}}',
    )


def known_material(name: str) -> str:
    """Check the name of something transparent or of a metal."""
    names = (*indices.dielectrics(), *indices.metals())
    if name in names:
        return name
    raise problem_at(
        "",
        f'no index of refraction named "{name[: bounds.NAME_LENGTH]}"; expected one of {quoted_list(names)}, '
        f'or an object such as {{"n": 1.38, "k": 0}}',
    )


_NAME = Field(strict=True, title="name")
# An index of refraction without an imaginary part.
IndexReference = Annotated[
    Annotated[str, _NAME, AfterValidator(_known_dielectric)]
    | RefractiveIndex
    | SellmeierIndex
    | CauchyIndex
    | TableIndex,
    ByKey({"sellmeier": SellmeierIndex, "cauchy": CauchyIndex, "table": TableIndex}),
]
ExtinctionReference = Annotated[_Extinction | TableExtinction, ByKey({"table": TableExtinction})]


class ComplexIndex(Node):
    """The index of refraction n + i k of a metal."""

    n: IndexReference = Field(description="Real part.")
    k: ExtinctionReference = Field(description="Imaginary part, the extinction coefficient; not negative.")


# An index of refraction with an imaginary part.
ComplexIndexReference = Annotated[
    Annotated[str, _NAME, AfterValidator(_known_metal)] | ComplexIndex,
    ByKey({"n": ComplexIndex, "k": ComplexIndex}),
]
