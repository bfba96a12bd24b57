"""Where things stand and how they move, as written in a scene document."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Degrees, Finite, PositiveLength, Vector
from nocturne_scene.document.node import ByKey, Node, problem_at
from nocturne_scene.document.shapes import length


class Rotation(Node):
    """A rotation about an axis through the origin, counter-clockwise seen against the axis (right-handed)."""

    axis: Vector = Field(description="Direction of the axis, of any length but 0.")
    degrees: Degrees = Field(description="Angle, degrees.")

    @model_validator(mode="after")
    def _has_axis(self) -> Self:
        if length(self.axis) < bounds.MIN_LENGTH:
            raise problem_at(".axis", "the axis has no length")
        return self


class Turn(Rotation):
    """A rotation about any axis while the shutter is open, at most one full turn."""

    degrees: Annotated[Finite, Field(ge=-360, le=360)] = Field(description="Angle, degrees.")
    about: Vector = Field(default=(0.0, 0.0, 0.0), description="A point on the axis, m.")


class Placement(Node):
    """Where a thing stands. `scale` comes first, then `rotate`, then `translate`."""

    scale: PositiveLength = Field(
        default=1.0, description="Factor for all lengths, more than 0; 0.001 for a file in millimetres."
    )
    rotate: Rotation | None = Field(default=None, description="Rotation about the origin.")
    translate: Vector = Field(default=(0.0, 0.0, 0.0), description="Shift, m.")


class RigidMotion(Node):
    """How a thing moves while the shutter is open, at constant speed: first `rotate`, then `translate`.

    A rotation becomes straight pieces, none of which is farther from its arc than 1/3000 of the distance to
    the axis.
    """

    rotate: Turn | None = Field(default=None, description="Rotation over the whole shutter interval.")
    translate: Vector = Field(
        default=(0.0, 0.0, 0.0), description="Shift over the whole shutter interval, m."
    )


class KeyedMotion(Node):
    """Placements at equally spaced times, from when the shutter opens to when it closes.

    Each comes after the thing's own placement; in between, points move in straight lines.
    """

    placements: Annotated[list[Placement], Field(min_length=2, max_length=bounds.TIME_STEPS)] = Field(
        description="At least two."
    )


Motion = Annotated[
    RigidMotion | KeyedMotion,
    ByKey({"placements": KeyedMotion, "rotate": RigidMotion, "translate": RigidMotion}),
]


class Moving(Placement):
    """Fields of everything that stands somewhere and may move."""

    motion: Motion | None = Field(
        default=None, description="Movement while the shutter is open; comes after the placement."
    )
