"""Surfaces, groups of them and instances of groups, as written in a scene document."""

from typing import Annotated, Any, Self

from pydantic import AfterValidator, Discriminator, Field, Tag, ValidationInfo, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import AssetReference, Text
from nocturne_scene.document.kernels import KernelReference
from nocturne_scene.document.luminaires import Luminaire
from nocturne_scene.document.medium_interfaces import Interior
from nocturne_scene.document.node import Node, problem_at
from nocturne_scene.document.placement import Moving
from nocturne_scene.document.shapes import ShapeDefinition
from nocturne_scene.document.spectra import known_name
from nocturne_scene.document.textures import BumpMap, NormalMap


class Surface(Moving):
    """A shape with its placement, its material and its emission.

    `scale` comes first, then `rotate`, then `translate`.
    """

    name: Text = Field(
        default="", description="For people, and for meters on its faces; not part of the compiled scene."
    )
    shape: ShapeDefinition = Field(description="The geometry.")
    kernel: KernelReference | None = Field(
        default=None,
        description="How the surface scatters light: a name from `$.kernels` or a kernel. Without one, and "
        "with an interior, it is the boundary of media, and not seen.",
    )
    interior: Interior | None = Field(default=None, description="Media that fill the enclosed space.")
    luminaire: Luminaire | None = Field(default=None, description="Present if the surface emits light.")
    normal_map: NormalMap | None = Field(default=None, description="Shading normals from a texture.")
    bump_map: BumpMap | None = Field(default=None, description="Shading normals from a texture of heights.")

    @model_validator(mode="after")
    def _is_something(self) -> Self:
        if self.kernel is None and self.interior is None:
            raise problem_at(
                ".kernel", "missing; expected a kernel, or an interior for the boundary of media"
            )
        return self


def _known_group(name: str, info: ValidationInfo) -> str:
    return known_name(name, "group", "groups", info)


class PlacementsFile(Node):
    """Placements in a PLY file, each of its vertices one.

    `x`, `y` and `z` are the shift in metres. Where they are there, `scale` is a factor for all lengths, more
    than 0, and `axis_x`, `axis_y`, `axis_z` and `degrees` are a rotation about an axis through the origin.
    `scale` comes first, then the rotation, then the shift. Other properties are ignored.
    """

    asset: AssetReference = Field(
        description="`sha256:` and 64 hexadecimal digits of an uploaded file; the command line also takes "
        "a path relative to the document."
    )


class Instance(Moving):
    """All surfaces of a group once more, without taking their memory again.

    With `placements`, once for each of them; the instance's own placement and its motion come after.

    Groups can hold instances of other groups. Of an instance and those around it only one may move; surfaces
    of a group may move as well.
    """

    name: Text = Field(default="", description="For people; not part of the compiled scene.")
    group: Annotated[str, Field(strict=True, title="name"), AfterValidator(_known_group)] = Field(
        description="A name from `$.groups`."
    )
    placements: PlacementsFile | None = Field(
        default=None, description="File with many placements of the group. Default: one placement."
    )


def _member_tag(value: Any) -> str:
    is_instance = "group" in value if isinstance(value, dict) else isinstance(value, Instance)
    return "<instance>" if is_instance else "<surface>"


Group = Annotated[
    list[
        Annotated[
            Annotated[Surface, Tag("<surface>")] | Annotated[Instance, Tag("<instance>")],
            Discriminator(_member_tag),
        ]
    ],
    Field(min_length=1, max_length=bounds.SURFACES),
]
