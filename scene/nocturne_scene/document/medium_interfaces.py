"""Media inside of surfaces and around everything, as written in a scene document."""

from typing import Annotated

from pydantic import AfterValidator, Field, ValidationInfo

from nocturne_scene.document import bounds
from nocturne_scene.document.node import Node, problem_at
from nocturne_scene.document.spectra import known_name


def _known_medium(name: str, info: ValidationInfo) -> str:
    return known_name(name, "medium", "media", info)


def _each_once(names: list[str]) -> list[str]:
    for index, name in enumerate(names):
        if name in names[:index]:
            raise problem_at(f"[{index}]", f'"{name}" is named twice')
    return names


MediumName = Annotated[str, Field(strict=True, title="name"), AfterValidator(_known_medium)]
MediumNames = Annotated[list[MediumName], Field(max_length=bounds.MEDIA_IN_BODY), AfterValidator(_each_once)]


class Interior(Node):
    """What fills the body that a closed surface encloses, on the side that the normal points away from.

    With a dielectric kernel, the media fill that body. With any other kernel, or none, the body has the index
    of refraction of its surroundings: its boundary is not seen, unless the kernel is. Such bodies overlap
    each other freely, and their media add up; a dielectric body keeps out those of no higher priority.
    """

    media: Annotated[MediumNames, Field(min_length=1)] = Field(
        description="Names from `$.media`: all of them fill the body."
    )
    priority: Annotated[int, Field(strict=True, ge=-bounds.PRIORITY, le=bounds.PRIORITY)] | None = Field(
        default=None,
        description="Without a dielectric kernel, which has its own: media stay inside of dielectric bodies "
        "of a lower priority only. Default: 0.",
    )
