"""Renders and their groups: state and progress."""

from typing import Self

from nocturne_coordinator.dispatch import region, stopping
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.store.groups import GroupRow
from nocturne_coordinator.store.rows import RenderRow
from nocturne_scene.compile.ways import GUIDED
from nocturne_scene.quantities import quantity_named
from nocturne_scene.render_warnings import WarningKind
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer


class Progress(Answer):
    """The merged and committed work of a render."""

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
    top_percent_share: float = Field(
        description="Part of the square of relative_error that the worst 1 % of the pixels have; 0: unknown."
    )
    effective_pixels: float = Field(
        description="Effective sample size (Kish) of the pixels that carry the error, (sum v)^2 / sum v^2 of "
        "their relative variances; 0: unknown."
    )
    mean: float = Field(description="Mean of Y over pixels, in the render's unit; 0: unknown.")
    mean_error: float = Field(
        description="Standard error of the mean; its 95 % interval is 1.96 of it to each side."
    )
    zero_pixels: int = Field(
        description="Pixels in which no sample found any light: nothing is known of them but that it is rare."
    )
    error_warning: str = Field(
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
    unaudited: int = Field(
        description="Ranges that were chosen to be traced again, and that no other machine has traced by now."
    )
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
        description="At most so much (two standard errors above what a pilot found), relative to the "
        "light seen there."
    )


class RenderWarning(Answer):
    """A warning to readers of a render, in addition to its error."""

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
        description='What Y measures: "luminance", "illuminance" or "luminous intensity", or what the sensor '
        'measures instead, such as "irradiance"; empty: not kept, in renders of older programs.'
    )
    unit: str = Field(description='Unit of Y, such as "cd/m2", "lx", "cd" or "W m-2".')
    response_unit: str = Field(
        description='Unit of further responses, for one without a unit: "W m-2 sr-1", "W m-2" or "W sr-1".'
    )
    first_nm: float = Field(
        description="The shortest of the scene's wavelengths, nm: 360 unless it says another."
    )
    last_nm: float = Field(description="The longest of them, nm: 830 unless it says another.")
    warnings: list[RenderWarning] = Field(
        description="What of the scene can hardly be meant, with its place, and what the image may not show."
    )
    way: str = Field(
        description="How it is traced and why, in words: what a pilot chose. Empty: the scene left nothing "
        "open, or the render is too small for a pilot."
    )
    sensor: str = Field(
        description='Type of the scene\'s sensor, such as "panorama", of which glare can be rated; '
        '"daylight" for meters that measure daylight coefficients.'
    )
    guided: bool = Field(
        description="Whether photons from the sensor are sent to where light was learned to come from."
    )
    layers: list[str] = Field(
        description="Layers that its EXR has in addition to the image: those asked for, and emission of "
        "a panorama."
    )
    group: str = Field(description="Name of its group; empty: none.")
    after: str = Field(description="The group that has to end before it begins; empty: none.")
    tags: list[str] = Field(description="Words to sort renders by.")
    target_unreachable: str = Field(
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
        converted |= {"guided", "warnings", "first_nm", "last_nm"}
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
            first_nm=row.wavelengths.first,
            last_nm=row.wavelengths.last,
            **{name: getattr(row, name) for name in cls.model_fields.keys() - converted},
        )


class RenderPage(Answer):
    """One page of renders, newest first."""

    renders: list[Render]
    next_page_token: str = Field(description="Empty on the last page.")


class Baselines(Answer):
    """Renders of the same scene and film by other engines."""

    renders: list[Render] = Field(description="The newest of each engine, newest engine first.")


class Explanation(Answer):
    """What a render waits for."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.EXPLANATION]})

    sentence: str


class TileInProgress(Answer):
    """A tile that is being traced."""

    tile: int = Field(description="Its index, row by row over the film.")
    worker: str = Field(description="Id of the worker that traces it.")


class TilesInProgress(Answer):
    """Tiles of a render that are being traced, as of the last two seconds."""

    tiles: list[TileInProgress]


class ConvergencePoint(Answer):
    """The error estimate at one preview."""

    time_s: float = Field(description="Seconds since the start of the render.")
    samples: float = Field(description="Mean samples per pixel.")
    relative_error: float = Field(description="As in Progress.")
    top_percent_share: float = Field(description="As in Progress.")
    effective_pixels: float = Field(description="As in Progress.")


class Convergence(Answer):
    """The error estimate over time, oldest first."""

    points: list[ConvergencePoint]


class NewGroup(Answer):
    """What one request made."""

    name: str = Field(description="Of the group; empty where there is one render that nobody gave a group.")
    renders: list[Render] = Field(
        description="In the order of variations, the last one fastest, then frames."
    )


class Group(Answer):
    """All renders of a group together."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.GROUP]})

    name: str
    renders: int = Field(description="How many there are.")
    ended: int = Field(description="Of these, those in a final state.")
    failed: int = Field(description="Of those that ended: failed, cancelled or degraded.")
    fraction: float = Field(
        description="Of the work of all: sample ranges merged, where a render that has ended counts as whole."
    )
    cpu_seconds: float = Field(description="Processor seconds of workers so far.")
    predicted_end: float = Field(
        description="Unix time at which the last of those that run should end; 0: unknown."
    )

    @classmethod
    def of(cls, row: GroupRow) -> Self:
        """The public side of a row."""
        return cls(
            name=row.name,
            renders=row.renders,
            ended=row.ended,
            failed=row.failed,
            fraction=row.ranges_done / max(1, row.ranges_planned),
            cpu_seconds=row.cpu_seconds,
            predicted_end=row.predicted_end,
        )


class TilesEvent(Answer):
    """Which tiles of a render have new samples: the data of an event `tiles`."""

    render: str = Field(description="Its id.")
    revision: int = Field(description="The render's sequence.")
    tiles: list[tuple[int, int]] = Field(description="First and last indices of runs of tiles.")
