"""Thin films as written in a scene document: layers on surfaces, and panes of glazings."""

from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite
from nocturne_scene.document.indices import (
    CauchyIndex,
    ComplexIndex,
    IndexReference,
    RefractiveIndex,
    SellmeierIndex,
    TableIndex,
    known_material,
)
from nocturne_scene.document.node import ByKey, Node, problem_at
from nocturne_scene.document.spectra import SpectrumReference

# Of a dielectric, of a metal by name, or n and k.
FilmIndexReference = Annotated[
    Annotated[str, Field(strict=True, title="name"), AfterValidator(known_material)]
    | RefractiveIndex
    | SellmeierIndex
    | CauchyIndex
    | TableIndex
    | ComplexIndex,
    ByKey({"sellmeier": SellmeierIndex, "cauchy": CauchyIndex, "table": TableIndex, "n": ComplexIndex}),
]


class FilmLayer(Node):
    """One layer of a thin film: light that its faces reflect interferes."""

    index: FilmIndexReference = Field(
        description="Index of refraction of the layer: of something transparent, of a metal, or n and k; at "
        "most 100."
    )
    thickness_nm: Annotated[Finite, Field(gt=0, le=bounds.FILM_THICKNESS_NM)] = Field(
        description="Its thickness, nm."
    )


Layers = Annotated[list[FilmLayer], Field(max_length=bounds.FILM_LAYERS)]


class SheetPane(Node):
    """A sheet of glass, its faces bare or coated; reflections between them add up without interference."""

    index: IndexReference = Field(description="Index of refraction of the sheet.")
    transmittance: SpectrumReference = Field(
        default=1.0, description="Internal transmittance of one crossing at normal incidence, in [0, 1]."
    )
    front: Layers = Field(
        default=[], description="Layers on the face at the front, the outermost first. Default: none."
    )
    back: Layers = Field(
        default=[], description="Layers on the face at the back, the outermost first. Default: none."
    )


class FilmPane(Node):
    """A film alone, with nothing that carries it: soap."""

    film: Annotated[list[FilmLayer], Field(min_length=1, max_length=bounds.FILM_LAYERS)] = Field(
        description="Its layers, from the front to the back."
    )


class MeasuredPane(Node):
    """A pane by what was measured at normal incidence, as in the International Glazing Database and EN 410.

    A pane that reflects the same on both sides is taken for a bare sheet, whose index and internal
    transmittance follow at each wavelength. Others depend on the angle as fitted to clear glass, or to bronze
    glass where less than 0.645 goes through (Finlayson et al., WINDOW 4.0, 1993).
    """

    front_reflectance: SpectrumReference = Field(
        description="Of the side at the front, with what the other face reflects; in [0, 1]."
    )
    back_reflectance: SpectrumReference = Field(description="Of the side at the back.")
    transmittance: SpectrumReference = Field(
        description="Through the pane; with each reflectance at most 1 at every wavelength."
    )

    @model_validator(mode="after")
    def _absorbs_nothing_twice(self) -> Self:
        for name in ("front_reflectance", "back_reflectance"):
            reflected, through = getattr(self, name), self.transmittance
            numbers = isinstance(reflected, int | float) and isinstance(through, int | float)
            if numbers and reflected + through > 1:
                raise problem_at(
                    f".{name}", f"with the transmittance {reflected + through:g}; expected at most 1"
                )
        return self


Pane = Annotated[
    SheetPane | FilmPane | MeasuredPane,
    ByKey({"index": SheetPane, "film": FilmPane, "front_reflectance": MeasuredPane}),
]
