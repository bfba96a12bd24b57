"""Fields that several kinds of lights of a scene document have, and a check of two directions."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Field, StringConstraints

from nocturne_scene.document import bounds
from nocturne_scene.document.node import problem_at
from nocturne_scene.document.shapes import length, parallel
from nocturne_scene.responses import LIGHT_GROUP_PATTERN, REST, TAKEN_LAYERS


def _is_free_name(name: str) -> str:
    if name in TAKEN_LAYERS:
        means = "what lights without a group bring" if name == REST else "other channels of an image"
        raise problem_at("", f"{name!r} can't be a light group's name: it means {means}")
    return name


HiddenFrom = Annotated[
    Literal["camera", "camera_and_mirrors"] | None,
    Field(
        description="`camera`: it sees past the light and its surface, and mirrors show it; "
        "`camera_and_mirrors`: mirrors and clear glass don't show it either, as if it had no size. "
        "Everything else is lit all the same; meters see every light. Default: nobody."
    ),
]


LightGroup = Annotated[
    str,
    StringConstraints(strict=True, pattern=LIGHT_GROUP_PATTERN),
    AfterValidator(_is_free_name),
    Field(
        default="",
        description="Lights of one name have further channels of their light: `NAME.X`, `NAME.Y` "
        "and `NAME.Z`; `rest` is the light of those without a name, and `nocturne mix` dims "
        "them afterwards. Default: no name.",
    ),
]


def check_axes(
    first: tuple[float, float, float], second: tuple[float, float, float], first_at: str, second_at: str
) -> None:
    """Raise an error unless two directions span a plane."""
    for place, direction in ((first_at, first), (second_at, second)):
        if length(direction) < bounds.MIN_LENGTH:
            raise problem_at(place, f"{place.removeprefix('.')} has no length")
    if parallel(first, second):
        raise problem_at(
            second_at, f"{second_at.removeprefix('.')} is parallel to {first_at.removeprefix('.')}"
        )
