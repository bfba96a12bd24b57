"""The atmosphere of a planet, as written in a scene document."""

from typing import Annotated

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, PositiveLength, Vector
from nocturne_scene.document.medium_interfaces import MediumName
from nocturne_scene.document.node import Node, problem_at
from nocturne_scene.document.shapes import length
from nocturne_scene.document.spectra import SpectrumReference


class AtmosphericAir(Node):
    """Clean air, whose density falls exponentially with altitude.

    The density at the ground follows from the pressure, so that the optical depth straight up is that of
    Bodhaine et al. 1999, 0.0971 at 550 nm and sea level, whatever the scale height.
    """

    pressure: Annotated[Finite, Field(gt=0, le=1e7)] = Field(
        default=101_325.0, description="Pressure on the ground, Pa."
    )
    scale_height: PositiveLength = Field(
        default=8449.5,
        description="Altitude over which the density falls to 1 / e, m. The default gives the ground the "
        "density of air at 15 degrees Celsius.",
    )


class AtmosphericOzone(Node):
    """Absorbs yellow and red: without it the evening sky is not blue.

    Its density rises from 10 km to 25 km and falls to 40 km; cross-sections at 233 K (Gorshelev et al.,
    Serdyuchenko et al. 2014).
    """

    dobson_units: Annotated[Finite, Field(gt=0, le=1e5)] = Field(
        default=300.0, description="The whole column, in Dobson units (0.01 mm of gas)."
    )


class AtmosphericAerosol(Node):
    """Haze, whose density falls exponentially with altitude."""

    medium: MediumName = Field(
        description="A name from `$.media`, whose `density` is not used: the optical depth says how much."
    )
    optical_depth: Annotated[Finite, Field(gt=0, le=1e3)] = Field(description="Straight up, at 550 nm.")
    scale_height: PositiveLength = Field(
        default=1200.0, description="Altitude over which the density falls to 1 / e, m."
    )


class Atmosphere(Node):
    """A planet with its air: a sphere of ground, and around it a shell of media without a visible boundary.

    The scene stands on it, or above it. Add the Sun to `$.distant`; the sky beyond is black unless there is
    an environment.
    """

    planet_radius: PositiveLength = Field(default=6_371_000.0, description="Radius of the planet, m.")
    thickness: PositiveLength = Field(default=100_000.0, description="Altitude where the air ends, m.")
    altitude: Annotated[Finite, Field(ge=-bounds.LENGTH, le=bounds.LENGTH)] = Field(
        default=0.0, description="Altitude of the scene's origin above the ground, m."
    )
    up: Vector = Field(default=(0.0, 1.0, 0.0), description="Away from the planet, of any length but 0.")
    ground_reflectance: SpectrumReference = Field(
        default=0.1, description="Of the ground, an ideal diffuse reflector."
    )
    air: AtmosphericAir | None = Field(default=AtmosphericAir(), description="`null`: none.")
    ozone: AtmosphericOzone | None = Field(default=None, description="Default: none.")
    aerosol: AtmosphericAerosol | None = Field(default=None, description="Default: none.")

    @model_validator(mode="after")
    def _is_somewhere(self) -> "Atmosphere":
        if length(self.up) < bounds.MIN_LENGTH:
            raise problem_at(".up", "the direction has no length")
        if self.planet_radius + self.altitude <= 0:
            raise problem_at(".altitude", "is deeper than the planet's centre")
        if self.air is None and self.ozone is None and self.aerosol is None:
            raise problem_at("", "has neither air nor ozone nor aerosol; leave the atmosphere out")
        return self
