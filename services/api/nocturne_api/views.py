"""What the API says of renders and workers: the fields of the public contract, for both doors."""

from dataclasses import asdict
from typing import Self

from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.store.data_folder import RenderRow, RenderState, WorkerRow
from nocturne_coordinator.store.webhooks import Webhook
from pydantic import BaseModel, ConfigDict, Field


class View(BaseModel):
    """An immutable answer."""

    model_config = ConfigDict(frozen=True, from_attributes=True)


class ProgressView(View):
    """What has been merged and committed."""

    ranges_done: int = Field(description="Sample ranges merged, of all planned.")
    ranges_planned: int
    photons: int
    rays: int
    invalid_samples: int = Field(
        description="Photons left out because their contribution was not finite or negative."
    )
    mean_samples: float = Field(description="Mean over pixels of samples merged.")
    relative_error: float = Field(
        description="Root mean square over pixels of Y's standard error relative to Y; 0: unknown."
    )
    worst_share: float = Field(
        description="Part of the relative error's square that the worst 1 % of the pixels have; 0: unknown."
    )
    effective_pixels: float = Field(
        description="How many pixels carry the error, (sum v)^2 / sum v^2 of their variances; 0: unknown."
    )
    photons_per_second: float
    cpu_seconds: float = Field(description="Processor seconds spent by workers.")
    tiles_done: int = Field(description="Tiles that need no more samples.")
    tiles: int
    tiles_failed: int = Field(description="Tiles left as they are, after failing on several workers.")
    audited: int = Field(description="Ranges that were traced again elsewhere, and were the same.")
    refused: int = Field(description="Results that could not be right.")
    predicted_end: float = Field(description="Unix time at which it should end; 0: unknown.")
    predicted_cpu_seconds: float = Field(description="What it should have cost by then; 0: unknown.")


class StopView(View):
    """When a render ends besides at its last sample; 0 or empty: not asked for."""

    relative_error: float
    tile_relative_error: float
    wall_seconds: float
    cpu_seconds: float
    until: str = Field(description="As it was given.")
    until_time: float = Field(description="Unix time, seconds.")

    @classmethod
    def of(cls, stop: StopConditions) -> Self:
        """The public side of stop conditions."""
        return cls(
            relative_error=stop.relative_error,
            tile_relative_error=stop.tile_relative_error,
            wall_seconds=stop.wall_seconds,
            cpu_seconds=stop.cpu_seconds,
            until=stop.until_text,
            until_time=stop.until,
        )


class RegionView(View):
    """Pixels [x, x + width) times [y, y + height)."""

    x: int
    y: int
    width: int
    height: int


class RenderView(View):
    """One render."""

    id: str
    name: str
    state: RenderState = Field(description="QUEUED, RUNNING, PAUSED, or how it ended.")
    reason: str = Field(description="Why it is in this state, in words; may be empty.")
    width: int
    height: int
    samples: int = Field(description="Samples per pixel asked for, at most.")
    scene_sha256: str = Field(description="SHA-256 of the compiled scene.")
    floating_point_profile: str = Field(
        description="A name for how its workers round, which all do alike; empty before the first result."
    )
    sequence: int = Field(description="Grows with every change that watchers should see.")
    created: float = Field(description="Unix time, seconds.")
    started: float = Field(description="Unix time, seconds; 0 before the start.")
    ended: float = Field(description="Unix time, seconds; 0 before the end.")
    stop: StopView
    priority: int = Field(description="1 to 1000; an owner's renders share by it what the owner gets.")
    owner: str = Field(description="Name of the token that asked for it; empty without authentication.")
    look_first: RegionView | None = Field(description="The part of the film that gets its samples first.")
    progress: ProgressView

    @property
    def has_ended(self) -> bool:
        """Whether the render has reached a final state."""
        return self.state.ended

    @classmethod
    def of(cls, row: RenderRow) -> Self:
        """The public side of a row of the data folder."""
        same = {name: getattr(row, name) for name in cls.model_fields if name not in _CONVERTED}
        region = Region.from_json(row.look_first) if row.look_first else None
        return cls(
            progress=ProgressView.model_validate(row),
            stop=StopView.of(row.stop),
            look_first=RegionView.model_validate(region) if region else None,
            **same,
        )


_CONVERTED = ("progress", "stop", "look_first")


class PageView(View):
    """One page of renders, newest first."""

    renders: list[RenderView]
    next_page_token: str = Field(description="Empty on the last page.")


class WorkerView(View):
    """One worker process, as it last reported itself."""

    id: str
    engine: int
    threads: int
    photons_per_second: float
    jobs_done: int
    started: float = Field(description="Unix time, seconds.")
    quarantine: str = Field(description="Why its results are not taken; empty: they are.")
    floating_point_profile: str = Field(
        description="A name for how it rounds: a render takes results of one class."
    )
    incompatible: str = Field(
        description="Why it gets no jobs though it is not in quarantine; empty: it gets them."
    )

    @classmethod
    def of(cls, row: WorkerRow, quarantine: str, incompatible: str) -> Self:
        """The public side of a row of the data folder."""
        same = cls.model_fields.keys() - {"quarantine", "incompatible"}
        return cls(
            quarantine=quarantine,
            incompatible=incompatible,
            **{each: getattr(row, each) for each in sorted(same)},
        )


class WorkersView(View):
    """All workers heard of in the last ten seconds."""

    workers: list[WorkerView]


class WorkerEventView(View):
    """What happened to a worker."""

    unix_time: float
    worker_id: str
    what: str = Field(description="joined, left, quarantined or released.")
    reason: str


class RatePointView(View):
    """What all workers together did at one time."""

    unix_time: float
    threads: int
    photons_per_second: float


class WorkerHistoryView(View):
    """The last 100 events, newest first; and a rate for each minute of two days, oldest first."""

    events: list[WorkerEventView]
    rates: list[RatePointView]


class TileAtWork(View):
    """A tile that is being traced."""

    tile: int
    worker: str


class AtWorkView(View):
    """What is being traced of a render, as of the last two seconds."""

    tiles: list[TileAtWork]


class ConvergencePoint(View):
    """The error estimate at one preview."""

    time_s: float = Field(description="Seconds since the start of the render.")
    photons: int
    samples: float = Field(description="Mean samples per pixel.")
    relative_error: float
    worst_share: float = Field(description="As in progress.")
    effective_pixels: float = Field(description="As in progress.")


class ConvergenceView(View):
    """The error estimate over time."""

    points: list[ConvergencePoint]


class ExplanationView(View):
    """What a render waits for."""

    sentence: str


class WebhookView(View):
    """An address that is told how its owner's renders end."""

    id: str
    owner: str
    url: str
    created: float = Field(description="Unix time, seconds.")
    last_outcome: str = Field(description="How the last message went; empty before the first.")

    @classmethod
    def of(cls, webhook: Webhook) -> Self:
        """The public side of a row of the data folder."""
        return cls(**asdict(webhook))


class NewWebhookView(WebhookView):
    """With what can't be had again."""

    secret: str = Field(description="What messages are signed with, by standardwebhooks.com.")


class WebhooksView(View):
    """Oldest first."""

    webhooks: list[WebhookView]


class AssetView(View):
    """A stored file."""

    sha256: str
    size_bytes: int


class DigestsView(View):
    """A list of SHA-256 digests."""

    sha256: list[str]
