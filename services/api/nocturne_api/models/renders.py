"""Renders: their state and progress, and what a caller asks of them.

One file, though long: the fields of one message, each with the sentence that the API's description has.
"""

from typing import Annotated, Any, Self

from nocturne_coordinator.dispatch import region, stopping
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.store.rows import RenderRow
from nocturne_scene.compile.ways import GUIDED
from nocturne_scene.quantities import quantity_named
from nocturne_scene.render_warnings import WarningKind
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer, RequestBody, SchemaOf

TAGS = "Words to sort renders by: at most 20, of at most 100 printable characters without a comma."
REQUEST_ID = "Chosen by the caller, 1 to 128 printable characters: the same id gives the same render again."


class Progress(Answer):
    """What has been merged and committed of a render."""

    ranges_done: int = Field(description="Sample ranges merged.")
    ranges_planned: int = Field(description="Sample ranges of the whole render.")
    samples_merged: int = Field(description="Samples merged, of all pixels together.")
    rays: int = Field(description="Rays cast for them.")
    invalid_samples: int = Field(
        description="Contributions left out because they were NaN, infinite or negative."
    )
    truncated_paths: int = Field(
        description="Photons ended by the tracer's limit of interactions; light that they would have brought "
        "is missing."
    )
    mean_samples: float = Field(description="Mean over pixels of the samples merged.")
    relative_error: float = Field(
        description="Root mean square over pixels of Y's standard error relative to Y, "
        "sqrt(mean(var / (Y^2 + 0.01 M^2))) with M the image's mean Y; 0: unknown."
    )
    worst_share: float = Field(
        description="Part of the square of relative_error that the worst 1 % of the pixels have; 0: unknown."
    )
    effective_sample_size_of_pixels: float = Field(
        description="Effective sample size (Kish) of the pixels that carry the error, (sum v)^2 / sum v^2 of "
        "their relative variances; 0: unknown."
    )
    mean: float = Field(description="Mean of Y over pixels, in the render's unit; 0: unknown.")
    mean_error: float = Field(
        description="Standard error of the mean; its 95 % interval is 1.96 of it to each side."
    )
    unseen_pixels: int = Field(
        description="Pixels in which no sample found any light: nothing is known of them but that it is rare."
    )
    doubt: str = Field(
        description="Why relative_error is not to be trusted, a sentence; empty: it is, as far as one image "
        "can tell."
    )
    samples_per_second: float = Field(description="Rate of the last minutes; 0 when nothing comes back.")
    rays_per_second: float = Field(description="The same in rays.")
    cpu_seconds: float = Field(description="Processor seconds spent by workers.")
    tiles_done: int = Field(description="Tiles that need no more samples.")
    tiles: int = Field(description="Tiles of the film.")
    tiles_failed: int = Field(description="Tiles that were given up after failing on several workers.")
    audited: int = Field(description="Ranges that another worker traced again with the same result.")
    refused: int = Field(description="Results that were refused because they could not be right.")
    predicted_end: float = Field(
        description="Unix time at which the render should end, from its rate and error so far; 0: unknown."
    )
    predicted_cpu_seconds: float = Field(
        description="Processor seconds that it should have cost by then; 0: unknown."
    )

    @classmethod
    def of(cls, row: RenderRow) -> Self:
        """The public side of a row of the data folder."""
        computed = {"samples_merged", "samples_per_second", "rays_per_second"}
        same = {name: getattr(row, name) for name in cls.model_fields.keys() - computed}
        return cls(
            samples_merged=row.photons // row.photons_per_sample,
            samples_per_second=row.photons_per_second / row.photons_per_sample,
            rays_per_second=row.photons_per_second * row.rays / row.photons if row.photons else 0.0,
            **same,
        )


class StopConditions(Answer):
    """When a render ends besides at its last sample: at the first that is met. 0 or empty: not asked for."""

    relative_error: float = Field(description="Of the image, as in Progress.")
    tile_relative_error: float = Field(
        description="Of each tile, from its own pixels; a tile that has it gets no more samples."
    )
    wall_seconds: float = Field(description="Seconds of running, without pauses.")
    cpu_seconds: float = Field(description="Processor seconds of workers.")
    until: str = Field(description="A time with its zone, as it was given.")
    until_time: float = Field(description="The same as Unix time.")

    @classmethod
    def of(cls, stop: stopping.StopConditions) -> Self:
        """The public side of stop conditions."""
        return cls(
            relative_error=stop.relative_error,
            tile_relative_error=stop.tile_relative_error,
            wall_seconds=stop.wall_seconds,
            cpu_seconds=stop.cpu_seconds,
            until=stop.until_text,
            until_time=stop.until,
        )


class Region(Answer):
    """Pixels [x, x + width) times [y, y + height), from the upper left corner."""

    x: int
    y: int
    width: int
    height: int


class UnmetPart(Answer):
    """Pixels [x, x + width) times [y, y + height), from the upper left corner, in which light may be missing
    that no error shows."""

    x: int
    y: int
    width: int
    height: int
    part: float = Field(
        description="At most so much (two standard errors above what a pilot found), in parts of what is "
        "seen there."
    )


class RenderWarning(Answer):
    """What whoever reads a render should know beside its error."""

    kind: WarningKind = Field(
        description="scene: the document says what can hardly be meant. layers: they could not be made. "
        "missing_light: so much of the image's mean may be missing. missing_in_parts: light may be missing "
        "in parts of the image. fault: of the program."
    )
    sentence: str
    parts: list[UnmetPart] = Field(
        description="Of missing_in_parts: all pixels in which light may be missing."
    )


class Render(Answer):
    """One render."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.RENDER]})

    id: str
    name: str
    state: RenderState
    reason: str = Field(description="Why it is in this state, in words; may be empty.")
    width: int = Field(description="Pixels.")
    height: int = Field(description="Pixels.")
    samples: int = Field(description="Samples per pixel asked for, at most.")
    scene_sha256: str = Field(description="SHA-256 of the compiled scene, hexadecimal.")
    engine: int = Field(description="Version of the tracing engine that its samples are by.")
    floating_point_profile: str = Field(
        description="How its workers round, which all do alike; empty before the first result."
    )
    quantity: str = Field(
        description='What Y measures: "luminance", "illuminance" or "luminous intensity"; empty: not '
        "kept, in renders of older programs."
    )
    unit: str = Field(description='Unit of Y: "cd/m2", "lx" or "cd".')
    response_unit: str = Field(
        description='Unit of further responses, for one without a unit: "W m-2 sr-1", "W m-2" or "W sr-1".'
    )
    warnings: list[RenderWarning] = Field(
        description="What of the scene can hardly be meant, with its place, and what the image may not show."
    )
    way: str = Field(
        description="How it is traced and why, in words: what a pilot chose. Empty: the scene left nothing "
        "open, or the render is too small for a pilot."
    )
    sensor: str = Field(
        description='Type of the scene\'s sensor, such as "panorama", of which glare can be rated.'
    )
    guided: bool = Field(
        description="Whether photons from the sensor are sent to where light was learned to come from."
    )
    layers: list[str] = Field(
        description="Layers that its EXR has beside the image: those asked for, and emission of a panorama."
    )
    group: str = Field(description="What it was submitted with; empty: alone.")
    after: str = Field(description="The group that has to end before it begins; empty: none.")
    tags: list[str] = Field(description="Words to sort renders by.")
    out_of_reach: str = Field(
        description="Why the error asked for will not be reached before a time ends the render, a sentence, "
        "by its rate so far; empty: it will, or nobody knows."
    )
    sequence: int = Field(description="Grows with every change that watchers should see.")
    created: float = Field(description="Unix time, seconds.")
    started: float = Field(description="Unix time, seconds; 0 before the start.")
    ended: float = Field(description="Unix time, seconds; 0 before the end.")
    stop: StopConditions
    priority: int = Field(description="1 to 1000: the render's weight among those of its owner.")
    owner: str = Field(description="Name of the token that asked for it; empty without authentication.")
    look_first: Region | None = Field(
        description="The part of the film that gets its samples first; null: all parts are alike."
    )
    progress: Progress

    @property
    def has_ended(self) -> bool:
        """Whether the render has reached a final state."""
        return self.state.ended

    @classmethod
    def of(cls, row: RenderRow) -> Self:
        """The public side of a row of the data folder."""
        converted = {"progress", "stop", "look_first", "unit", "response_unit", "group", "after"}
        converted |= {"guided", "warnings"}
        quantity = quantity_named(row.quantity)
        first = region.Region.from_json(row.look_first) if row.look_first else None
        return cls(
            progress=Progress.of(row),
            stop=StopConditions.of(row.stop),
            look_first=Region.model_validate(first) if first else None,
            group=row.in_group,
            after=row.after_group,
            guided=GUIDED in row.way,
            warnings=[RenderWarning.model_validate(each.to_json()) for each in row.warnings],
            unit=quantity.unit,
            response_unit=quantity.response_unit,
            **{name: getattr(row, name) for name in cls.model_fields.keys() - converted},
        )


class RenderPage(Answer):
    """One page of renders, newest first."""

    renders: list[Render]
    next_page_token: str = Field(description="Empty on the last page.")


class Baselines(Answer):
    """Renders of the same scene and film by other engines."""

    renders: list[Render] = Field(description="The newest of each engine, newest engine first.")


class ReadValue(Answer):
    """A mean and its error."""

    name: str = Field(description="X, Y, Z, or a further response of the sensor.")
    mean: float
    standard_error: float | None = Field(description="Of the mean; null where it is not known.")


class Reading(Answer):
    """Means over the pixels of a region that have samples."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.READING]})

    region: Region
    quantity: str = Field(description="What Y measures; empty where it is not known.")
    unit: str = Field(description="Of X, Y and Z.")
    response_unit: str = Field(description="Of a further response without a unit of its own.")
    values: list[ReadValue] = Field(description="X, Y, Z, then the sensor's further responses by name.")
    u_prime: float | None = Field(description="CIE 1976 u' of the mean; null in the dark.")
    v_prime: float | None = Field(description="CIE 1976 v' of the mean; null in the dark.")
    u_prime_error: float | None = Field(description="Standard error; null where it is not known.")
    v_prime_error: float | None = Field(description="Standard error; null where it is not known.")
    correlation: float = Field(
        description="How many times the variance of Y is that of pixels that know nothing of each other; at "
        "least 1."
    )
    coverage_factor: float | None = Field(
        description="Standard errors to each side of a 95 % interval: Student's t, 2.13 for a block with 16 "
        "samples, 1.96 where errors are well known; null where they are not known."
    )
    pixels: int
    unseen_pixels: int = Field(description="In which no sample found light.")
    samples: int = Field(description="Of all pixels together.")
    fewest_samples: int = Field(description="Of any pixel.")
    most_samples: int = Field(description="Of any pixel.")
    invalid_samples: int = Field(description="Of the tiles that the region touches.")


class Explanation(Answer):
    """What a render waits for."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.EXPLANATION]})

    sentence: str


class TileInProgress(Answer):
    """A tile that is being traced."""

    tile: int = Field(description="Its index, row by row over the film.")
    worker: str = Field(description="Id of the worker that traces it.")


class TilesInProgress(Answer):
    """What is being traced of a render, as of the last two seconds."""

    tiles: list[TileInProgress]


class ConvergencePoint(Answer):
    """The error estimate at one preview."""

    time_s: float = Field(description="Seconds since the start of the render.")
    samples: float = Field(description="Mean samples per pixel.")
    relative_error: float = Field(description="As in Progress.")
    worst_share: float = Field(description="As in Progress.")
    effective_sample_size_of_pixels: float = Field(description="As in Progress.")


class Convergence(Answer):
    """The error estimate over time, oldest first."""

    points: list[ConvergencePoint]


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


class SceneDocument(RequestBody):
    """A scene, by the JSON Schema at /scene.schema.json (docs/reference/scene.md); assets by `sha256:...`.

    The schema of `scene` in requests. The scene language's own rules check it, with all problems at once.
    """

    model_config = ConfigDict(extra="allow", json_schema_extra={"examples": [examples.SCENE]})


Stop = Annotated[dict[str, Any], SchemaOf(StopRequest)]
Scene = Annotated[dict[str, Any], SchemaOf(SceneDocument)]


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
        description="What the EXR is to tell of the surfaces in the image: albedo, normal, depth, position, "
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


class RenderActionRequest(RequestBody):
    """Doing it twice is doing it once; the request id is kept for the log only."""

    request_id: str = ""


class ExtendRenderRequest(RenderActionRequest):
    """More samples, or other conditions: what is not named stays as it is."""

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
