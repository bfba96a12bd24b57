"""Fluorescence as written in a scene document: light that is absorbed and sent on at other wavelengths."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, SpectralValue, Wavelength
from nocturne_scene.document.node import ByKey, Node, problem_at
from nocturne_scene.document.spectra import SpectrumReference

_Wavelengths = Annotated[
    list[Wavelength], Field(min_length=2, max_length=bounds.RERADIATION_KNOTS, fail_fast=True)
]


class Fluorophore(Node):
    """A dye or phosphor: emits a part of the light that it absorbs, at other wavelengths.

    Each absorbed photon gives `quantum_yield` photons, whose wavelengths are distributed by `emission`
    whatever the absorbed one's was.
    """

    absorption: SpectrumReference = Field(
        description="Part of the light that it absorbs, in [0, 1]: a number or a table, zero beyond it "
        "unless it says otherwise."
    )
    emission: SpectrumReference = Field(
        description="Emitted power over wavelength, a table, zero beyond it. Only its shape counts."
    )
    quantum_yield: Annotated[Finite, Field(gt=0, le=1)] = Field(
        default=1.0, description="Emitted photons for each absorbed one, in (0, 1]."
    )


class Dye(Node):
    """A dye or phosphor in a medium: emits a part of the light that it absorbs, at other wavelengths, evenly
    into all directions.

    Each absorbed photon gives `quantum_yield` photons, whose wavelengths are distributed by `emission`
    whatever the absorbed one's was.
    """

    absorption: SpectrumReference = Field(
        description="Its absorption coefficient, 1/m where the medium's density is 1: a number or a table, "
        "zero beyond it unless it says otherwise. It adds to that of the medium."
    )
    emission: SpectrumReference = Field(
        description="Emitted power over wavelength, a table, zero beyond it. Only its shape counts."
    )
    quantum_yield: Annotated[Finite, Field(gt=0, le=1)] = Field(
        default=1.0, description="Emitted photons for each absorbed one, in (0, 1]."
    )


class Reradiation(Node):
    """A measured re-radiation matrix (Donaldson matrix) off its diagonal: what `reflectance` has is no part
    of it.

    Linear between emitted wavelengths; between exciting ones the value over the wavelength is linear, which
    is the number of photons. Zero beyond.
    """

    excitation_nm: _Wavelengths = Field(description="Exciting wavelengths, increasing, nm.")
    emission_nm: _Wavelengths = Field(description="Emitted wavelengths, increasing, nm.")
    values: list[Annotated[list[SpectralValue], Field(fail_fast=True)]] = Field(
        description="For each exciting wavelength, for each emitted one: power emitted per nm over the power "
        "that falls on the surface, 1/nm. A matrix measured in bands is divided by the width of the emitted "
        "bands."
    )

    @model_validator(mode="after")
    def _fits(self) -> Self:
        for name in ("excitation_nm", "emission_nm"):
            knots = getattr(self, name)
            for index in range(1, len(knots)):
                if knots[index] <= knots[index - 1]:
                    raise problem_at(f".{name}[{index}]", "wavelengths must increase")
        if len(self.values) != len(self.excitation_nm):
            raise problem_at(
                ".values", f"has {len(self.values)} rows for {len(self.excitation_nm)} exciting wavelengths"
            )
        for index, row in enumerate(self.values):
            if len(row) != len(self.emission_nm):
                raise problem_at(
                    f".values[{index}]",
                    f"has {len(row)} values for {len(self.emission_nm)} emitted wavelengths",
                )
        return self


Fluorescence = Annotated[
    Fluorophore | Reradiation, ByKey({"absorption": Fluorophore, "excitation_nm": Reradiation})
]
