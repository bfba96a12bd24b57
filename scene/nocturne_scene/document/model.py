"""The scene document as one schema. docs/reference/scene.md is made from its descriptions.

Lengths are metres, angles degrees, wavelengths nanometres, radiance W m-2 sr-1 nm-1. The parts are in
*_model.py.
"""

from collections.abc import Collection, Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.atmosphere import Atmosphere
from nocturne_scene.document.fields import Name, Text
from nocturne_scene.document.kernels import KernelDefinition
from nocturne_scene.document.luminaires import DistantDisc, EnvironmentDefinition, ImportantDirection
from nocturne_scene.document.media import Medium
from nocturne_scene.document.medium_interfaces import MediumNames
from nocturne_scene.document.node import NAMED, Node, problem_at
from nocturne_scene.document.problems import path
from nocturne_scene.document.ray_files import RayFile
from nocturne_scene.document.sensors import SensorDefinition
from nocturne_scene.document.spectra import SpectrumDefinition
from nocturne_scene.document.surfaces import Group, Instance, Surface
from nocturne_scene.document.textures import Texture
from nocturne_scene.document.tracing import Tracing
from nocturne_scene.spectra.wavelength_range import LONGEST, SHORTEST, VISIBLE, WavelengthRange

_WholeNm = Annotated[int, Field(strict=True, ge=int(SHORTEST), le=int(LONGEST))]


class Wavelengths(Node):
    """The wavelengths that a scene is about: photons have no others."""

    first: _WholeNm = Field(description="The shortest, nm.")
    last: _WholeNm = Field(description="The longest, nm.")

    @model_validator(mode="after")
    def _increase(self) -> Self:
        if self.last <= self.first:
            raise problem_at(".last", f"expected more than first, {self.first} nm")
        return self


class SceneDocument(Node):
    """A whole scene."""

    nocturne: Literal[1] = Field(description="Version of this format.")
    name: Text = Field(default="", description="For people; not part of the compiled scene.")
    source: Text = Field(default="", description="Where the scene's data come from.")
    note: Text = Field(default="", description="Anything worth knowing about the scene.")
    wavelengths: Wavelengths | None = Field(
        default=None,
        description="Default: 360 to 830 nm, what the CIE's observers see. Others, within 200 to 2500 nm, "
        "bring ultraviolet and near infrared ([how to](../how-to/wavelengths.md)). What a table, a formula "
        "or a colour is beyond its ends is said as a warning.",
    )
    spectra: Annotated[dict[Name, SpectrumDefinition], Field(max_length=bounds.NAMED_ENTRIES)] = Field(
        default={}, description="Spectra by name. Only those that are used are compiled."
    )
    textures: Annotated[dict[Name, Texture], Field(max_length=bounds.TEXTURES)] = Field(
        default={}, description="Textures by name. Only those that are used are compiled."
    )
    kernels: Annotated[dict[Name, KernelDefinition], Field(max_length=bounds.NAMED_ENTRIES)] = Field(
        default={}, description="Kernels by name. Only those that are used are compiled."
    )
    media: Annotated[dict[Name, Medium], Field(max_length=bounds.MEDIA)] = Field(
        default={}, description="Media by name: fog, smoke, milk. Only those that are used are compiled."
    )
    groups: Annotated[dict[Name, Group], Field(max_length=bounds.GROUPS)] = Field(
        default={}, description="Surfaces that only instances show, and instances of other groups, by name."
    )
    sensor: SensorDefinition = Field(description="The camera or meter.")
    surfaces: Annotated[list[Surface], Field(max_length=bounds.SURFACES)] = Field(
        default=[], description="What light can meet; at least one surface or instance."
    )
    instances: Annotated[list[Instance], Field(max_length=bounds.INSTANCES)] = Field(
        default=[], description="Groups, where they stand."
    )
    unbounded_media: MediumNames = Field(
        default=[], description="Names from `$.media` that fill all of space, except for dielectric bodies."
    )
    atmosphere: Atmosphere | None = Field(default=None, description="A planet with its air.")
    environment: EnvironmentDefinition | None = Field(
        default=None, description="Light from infinitely far away, from all directions."
    )
    distant: Annotated[list[DistantDisc], Field(max_length=bounds.DISTANT_DISCS)] = Field(
        default=[], description="Discs at infinity, such as the Sun."
    )
    ray_files: Annotated[list[RayFile], Field(max_length=bounds.RAY_FILES)] = Field(
        default=[], description="Lamps as the rays of files (IES TM-25), for meters."
    )
    important_directions: Annotated[list[ImportantDirection], Field(max_length=bounds.IMPORTANT_SHAPES)] = (
        Field(default=[], description="Shapes to aim photons at from anywhere in the scene.")
    )
    tracing: Tracing = Field(default=Tracing(), description="How photons are traced.")

    @property
    def wavelength_range(self) -> WavelengthRange:
        """The scene's wavelengths."""
        if self.wavelengths is None:
            return VISIBLE
        return WavelengthRange(float(self.wavelengths.first), float(self.wavelengths.last))

    @model_validator(mode="before")
    @classmethod
    def _no_lights_apart(cls, value: Any) -> Any:
        for key in ("lights", "lamps", "luminaires"):
            if isinstance(value, dict) and key in value:
                raise problem_at(
                    f".{key}",
                    "a lamp needs a size: expected a luminaire on an entry of $.surfaces, $.environment, or "
                    "$.distant",
                )
        return value


def context_for(document: dict[str, Any]) -> dict[str, Collection[str]]:
    """Return the names that references may use, for pydantic's validation context.

    The document is not validated yet.
    """
    collections = ((key, document.get(key)) for key in NAMED)
    return {key: found.keys() if isinstance(found, dict) else () for key, found in collections}


def all_surfaces(document: SceneDocument) -> Iterator[tuple[str, Surface]]:
    """Yield every surface of the document with its place, those of groups included."""
    for index, surface in enumerate(document.surfaces):
        yield path(("surfaces", index)), surface
    for name, group in document.groups.items():
        for index, member in enumerate(group):
            if isinstance(member, Surface):
                yield path(("groups", name, index)), member
