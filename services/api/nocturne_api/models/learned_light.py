"""What a pilot learned of the light at a place."""

from typing import Annotated, Any, Self

from pydantic import Field

from nocturne_api.models.base import Answer

_Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class Cone(Answer):
    """Directions to which photons are sent alike."""

    axis: _Vector = Field(description="Unit vector, from the place to where light came from.")
    half_angle_degrees: float


class LearnedLight(Answer):
    """Where light comes from that mirrors and glass gather, at what a pixel shows."""

    normal: _Vector | None = Field(
        description="Of the surface, on the side that is seen; null: the pixel shows none."
    )
    direction: _Vector | None = Field(description="Unit vector of the ray that meets it there.")
    interfaces: int = Field(description="Mirrors and clear boundaries by which it is seen; 0: directly.")
    cones: list[Cone] = Field(
        description="Half of the photons that are sent towards lights from here go into one of these, each "
        "as likely; empty: nothing was learned nearby."
    )

    @classmethod
    def of(cls, found: dict[str, Any]) -> Self:
        """What `nocturne-trace --learned-at` wrote."""
        cones = [Cone(axis=each[:3], half_angle_degrees=each[3]) for each in found["cones"]]
        return cls(
            normal=found["normal"], direction=found["direction"], interfaces=found["interfaces"], cones=cones
        )
