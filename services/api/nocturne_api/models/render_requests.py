"""What callers ask of renders: the bodies of requests."""

from typing import Annotated, Any

from pydantic import ConfigDict, Field

from nocturne_api.limits import GROUP_RENDERS
from nocturne_api.models import examples
from nocturne_api.models.base import RequestBody, SchemaOf
from nocturne_api.models.scenes import Scene

TAGS = "Words to sort renders by: at most 20, of at most 100 printable characters without a comma."
REQUEST_ID = "Chosen by the caller, 1 to 128 printable characters: the same id gives the same render again."


class StopRequest(RequestBody):
    """When a render should end besides at its last sample, whichever comes first; 0 or empty: not asked for.

    The schema of `stop` in requests. The coordinator's rules check the values (`stop_conditions`).
    """

    relative_error: float = Field(default=0.0, description="Of the image, as in Progress, at most 1.")
    tile_relative_error: float = Field(default=0.0, description="Of each tile, at most 1.")
    wall_seconds: float = Field(default=0.0, description="Seconds of running, without pauses.")
    cpu_seconds: float = Field(default=0.0, description="Processor seconds of workers.")
    until: str = Field(
        default="",
        description='A time with its zone: "07:00 Europe/Berlin", "07:00+01:00", "2026-11-22T07:00:00Z".',
    )


Stop = Annotated[dict[str, Any], SchemaOf(StopRequest)]


class CreateRenderRequest(RequestBody):
    """A scene to render."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.CREATE_RENDER]})

    request_id: str = Field(description=REQUEST_ID)
    name: str = Field(default="", description="At most 200 printable characters.")
    scene: Scene
    width: int = Field(description="Pixels.")
    height: int = Field(description="Pixels.")
    samples: int = Field(description="Samples per pixel, at most.")
    stop: Stop = Field(default_factory=dict)
    priority: int = Field(default=0, description="1 to 1000; 0 means 100.")
    layers: list[str] = Field(
        default_factory=list,
        description="Channels of the EXR about the surfaces in the image: albedo, normal, depth, position, "
        "object, material, emission. Panoramas of scenes with luminaires have the last one always.",
    )
    group: str = Field(
        default="",
        description="Renders with the same are one group, such as the frames of a film; at most 200 "
        "printable characters.",
    )
    after: str = Field(
        default="", description="A group that has to end before this render begins. One without renders has."
    )
    tags: list[str] = Field(default_factory=list, description=TAGS)


class Variation(RequestBody):
    """A place of the scene, and the values that it has in turn."""

    place: str = Field(description="Such as `tracing.seed`.")
    values: list[Any] = Field(min_length=1, description="Any JSON; whole sensors are views of the scene.")


class FrameRange(RequestBody):
    """Numbers of frames, both included."""

    first: int = Field(ge=0, le=999_999_999)
    last: int = Field(ge=0, le=999_999_999)


class CreateGroupRequest(CreateRenderRequest):
    """One scene as many renders: one for each frame of every combination of its variations.

    All are made, or none. Each is compiled, traced and stopped by itself, and named by the name given and its
    values and frame. Where there is more than one and no group is named, the group gets the name and six
    letters that follow from the request id.
    """

    model_config = ConfigDict(json_schema_extra={"examples": [examples.CREATE_GROUP]})

    changes: dict[str, Any] = Field(
        default_factory=dict,
        description="Values by their places in the scene, in all renders. In frames a text such as `-1..1` "
        "stands for numbers evenly from the first frame to the last.",
    )
    varied: list[Variation] = Field(default_factory=list, description="All combinations are made.")
    frames: FrameRange | None = Field(
        default=None, description=f"Frames and variations make at most {GROUP_RENDERS:,} renders."
    )


class RenderActionRequest(RequestBody):
    """Doing it twice is doing it once; the request id is kept for the log only."""

    request_id: str = ""


class ExtendRenderRequest(RenderActionRequest):
    """More samples, or other conditions: all others stay as they are."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"samples": 4096}]})

    samples: int = Field(default=0, description="In all, at least as many as before; 0 means as many.")
    stop: Stop = Field(
        default_factory=dict, description="Those named here change; all others stay as they are."
    )
    drop: list[str] = Field(
        default_factory=list, description="Names of conditions that are dropped, such as `relative_error`."
    )


class SetPriorityRequest(RenderActionRequest):
    """The render's weight among those of its owner."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"priority": 200}]})

    priority: int = Field(description="1 to 1000; 200 gets twice the work of 100.")


class SetTagsRequest(RenderActionRequest):
    """Tags instead of those that the render has."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"tags": ["lobby", "for review"]}]})

    tags: list[str] = Field(description=TAGS)


class LookFirstRequest(RenderActionRequest):
    """A part of the film, in pixels from its upper left corner; width and height 0: all parts are alike."""

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"x": 64, "y": 32, "width": 128, "height": 128}]}
    )

    x: int = 0
    y: int = 0
    width: int = 0
    height: int = 0


class ReplayRenderRequest(RequestBody):
    """A new render with the samples per tile that this one has now."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"request_id": "night-1-again"}]})

    request_id: str = Field(description=REQUEST_ID)
