"""The scene document as one schema. Its descriptions are the reference: docs/scene.md is made from them.

Lengths are metres, angles degrees, wavelengths nanometres, radiance W m-2 sr-1 nm-1.
"""

from collections.abc import Collection
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, Tag, ValidationInfo, model_validator

from nocturne_coordinator.scene import bounds
from nocturne_coordinator.scene.fields import Finite, Name, NotNegative, PositiveLength, Switch, Text, Vector
from nocturne_coordinator.scene.node import Node, chosen_by_type, problem_at
from nocturne_coordinator.scene.shape_model import Rotation, ShapeDefinition, length, parallel
from nocturne_coordinator.scene.spectrum_model import SpectrumDefinition, SpectrumReference, known_name


class Lambertian(Node):
    """An ideal diffuse reflector, on both sides of the surface: it looks equally bright from everywhere."""

    type: Literal["lambertian"]
    reflectance: SpectrumReference = Field(
        description="Fraction of the light that is reflected, in [0, 1] at every wavelength."
    )


def _known_kernel(name: str, info: ValidationInfo) -> str:
    return known_name(name, "kernel", "kernels", info)


_definition_check, _ = chosen_by_type({"lambertian": "<lambertian>"})
_reference_check, _reference_choice = chosen_by_type({"lambertian": "<lambertian>"}, or_name=True)

# In $.kernels.
KernelDefinition = Annotated[Lambertian, _definition_check]
# Where a kernel is used: also the name of one in $.kernels.
KernelReference = Annotated[
    Annotated[str, Field(strict=True, title="name"), AfterValidator(_known_kernel), Tag("<name>")]
    | Annotated[Lambertian, Tag("<lambertian>")],
    _reference_choice,
    _reference_check,
]


class Luminaire(Node):
    """What makes a surface emit light, the same radiance in all directions of the emitting side."""

    radiance: SpectrumReference = Field(description="Spectral radiance, W m⁻² sr⁻¹ nm⁻¹.")
    two_sided: Switch = Field(
        default=False,
        description="Emit from both sides; otherwise only from the side that the normal points to.",
    )


class Surface(Node):
    """A shape, where it stands, what it is made of and whether it emits.

    `scale` comes first, then `rotate`, then `translate`.
    """

    name: Text = Field(default="", description="For people; not part of the compiled scene.")
    shape: ShapeDefinition = Field(description="The geometry.")
    scale: PositiveLength = Field(
        default=1.0, description="Factor for all lengths, more than 0; 0.001 for a file in millimetres."
    )
    rotate: Rotation | None = Field(default=None, description="Rotation about the origin.")
    translate: Vector = Field(default=(0.0, 0.0, 0.0), description="Shift, m.")
    kernel: KernelReference = Field(
        description="How the surface scatters light: a name from `$.kernels` or a kernel."
    )
    luminaire: Luminaire | None = Field(default=None, description="Present if the surface emits light.")


class _Sensor(Node):
    position: Vector = Field(description="Where the sensor is, m.")
    look_at: Vector = Field(description="A point in the middle of the image.")
    up: Vector = Field(
        default=(0.0, 1.0, 0.0), description="A direction that is upwards in the image; not along the view."
    )
    vertical_field_of_view_degrees: Annotated[Finite, Field(gt=0, lt=180)] = Field(
        description="Full angle between the image's top and bottom edges. The horizontal one "
        "follows from the image's shape."
    )
    wavelengths: Literal["response", "uniform"] = Field(
        default="response",
        description="How a photon's wavelength is drawn: in proportion to X + Y + Z of the "
        "observer, or uniformly from 360 to 830 "
        "nm. Both give the same image; `response` with less noise.",
    )

    @model_validator(mode="after")
    def _has_frame(self) -> Self:
        view = tuple(np.subtract(self.look_at, self.position))
        if length(view) < bounds.SMALLEST_LENGTH:
            raise problem_at(
                ".look_at", "look_at is the same point as position, so there is no direction of view"
            )
        if length(self.up) < bounds.SMALLEST_LENGTH:
            raise problem_at(".up", "up has no length")
        if parallel(view, self.up):
            raise problem_at(".up", "up is parallel to the direction of view")
        return self


class Pinhole(_Sensor):
    """A camera whose opening is a point: everything is sharp."""

    type: Literal["pinhole"]


class ThinLens(_Sensor):
    """A camera with a round, ideal lens: sharp at one distance only."""

    type: Literal["thin_lens"]
    lens_radius: PositiveLength = Field(description="Radius of the lens, m.")
    focus_distance: PositiveLength = Field(
        description="Distance of the sharp plane, m, along the direction of view."
    )


_sensor_check, _sensor_choice = chosen_by_type({"pinhole": "<pinhole>", "thin_lens": "<thin lens>"})
SensorDefinition = Annotated[
    Annotated[Pinhole, Tag("<pinhole>")] | Annotated[ThinLens, Tag("<thin lens>")],
    _sensor_choice,
    _sensor_check,
]


class Mixture(Node):
    """Weights of the three ways to choose a direction; scaled so that they sum to 1.

    The weights change the noise and not the image, as long as `kernel` or `uniform` is more than 0: with
    `luminaires` alone, light that other surfaces scatter is lost. A way with weight 0 is never used.
    """

    kernel: NotNegative = Field(default=0.65, le=1e6, description="In proportion to the kernel.")
    luminaires: NotNegative = Field(default=0.35, le=1e6, description="Towards the luminaires.")
    uniform: NotNegative = Field(
        default=0.0, le=1e6, description="Uniformly over the directions that the surface scatters to."
    )

    @model_validator(mode="after")
    def _some_weight(self) -> Self:
        if not self.kernel + self.luminaires + self.uniform > 0:
            raise problem_at("", "all weights are zero; at least one must be more than 0")
        return self


class Tracing(Node):
    """How photons are traced. None of it changes what the image converges to, except `maximum_depth`."""

    h: Annotated[Finite, Field(gt=0, le=1e6)] = Field(
        default=1.0,
        description="Scales the probability min(1, H h) that a photon survives at a surface of albedo H.",
    )
    roulette: Literal["weight", "albedo"] = Field(
        default="weight",
        description="Survival by H h times the weight that the photon carries, or by H h alone (the paper).",
    )
    maximum_depth: Annotated[int, Field(strict=True, ge=1, le=bounds.DEPTH)] = Field(
        default=1000, description="Interactions after which a photon is absorbed."
    )
    mixture: Mixture = Field(default=Mixture(), description="How directions are chosen.")
    sequence: Literal["sobol", "independent"] = Field(
        default="sobol",
        description="Random numbers: Owen-scrambled Sobol points for each pixel, or independent ones.",
    )
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**64)] = Field(
        default=0, description="Chooses the random numbers of the whole image."
    )


class SceneDocument(Node):
    """A whole scene."""

    nocturne: Literal[1] = Field(description="Version of this format.")
    name: Text = Field(default="", description="For people; not part of the compiled scene.")
    source: Text = Field(default="", description="Where the scene's data come from.")
    note: Text = Field(default="", description="Anything worth knowing about the scene.")
    spectra: Annotated[dict[Name, SpectrumDefinition], Field(max_length=bounds.NAMED_ENTRIES)] = Field(
        default={}, description="Spectra by name. Only those that are used are compiled."
    )
    kernels: Annotated[dict[Name, KernelDefinition], Field(max_length=bounds.NAMED_ENTRIES)] = Field(
        default={}, description="Kernels by name. Only those that are used are compiled."
    )
    sensor: SensorDefinition = Field(description="The camera.")
    surfaces: Annotated[list[Surface], Field(min_length=1, max_length=bounds.SURFACES)] = Field(
        description="Everything that light can meet; at least one, and at least one of them with a luminaire."
    )
    tracing: Tracing = Field(default=Tracing(), description="How photons are traced.")


def context_for(document: dict[str, Any]) -> dict[str, Collection[str]]:
    """Return the names that references may use, for pydantic's validation context.

    The document is not validated yet.
    """
    collections = ((key, document.get(key)) for key in ("spectra", "kernels"))
    return {key: found.keys() if isinstance(found, dict) else () for key, found in collections}
