"""What the API says of renders and workers: the fields of the public contract, for both doors."""

from typing import Self

from nocturne_coordinator.data_folder import RenderRow, RenderState, WorkerRow
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
    rejected: int = Field(
        description="Photons left out because their contribution was not finite or negative."
    )
    mean_samples: float = Field(description="Mean over pixels of samples merged.")
    relative_error: float = Field(
        description="Root mean square over pixels of Y's standard error relative to Y; 0: unknown."
    )
    photons_per_second: float
    cpu_seconds: float = Field(description="Processor seconds spent by workers.")


class RenderView(View):
    """One render."""

    id: str
    name: str
    state: RenderState = Field(description="QUEUED, RUNNING, SUCCEEDED, FAILED or CANCELLED.")
    reason: str = Field(description="Why it is in this state, in words; set for FAILED and CANCELLED.")
    width: int
    height: int
    samples: int = Field(description="Samples per pixel asked for.")
    scene_sha256: str = Field(description="SHA-256 of the compiled scene.")
    sequence: int = Field(description="Grows with every change that watchers should see.")
    created: float = Field(description="Unix time, seconds.")
    started: float = Field(description="Unix time, seconds; 0 before the start.")
    ended: float = Field(description="Unix time, seconds; 0 before the end.")
    progress: ProgressView

    @property
    def has_ended(self) -> bool:
        """Whether the render has reached a final state."""
        return self.state.ended

    @classmethod
    def of(cls, row: RenderRow) -> Self:
        """The public side of a row of the data folder."""
        same = {name: getattr(row, name) for name in cls.model_fields if name != "progress"}
        return cls(progress=ProgressView.model_validate(row), **same)


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

    @classmethod
    def of(cls, row: WorkerRow) -> Self:
        """The public side of a row of the data folder."""
        return cls.model_validate(row)


class WorkersView(View):
    """All workers heard of in the last ten seconds."""

    workers: list[WorkerView]


class ConvergencePoint(View):
    """The error estimate at one preview."""

    time_s: float = Field(description="Seconds since the start of the render.")
    photons: int
    samples: float = Field(description="Mean samples per pixel.")
    relative_error: float


class ConvergenceView(View):
    """The error estimate over time."""

    points: list[ConvergencePoint]


class AssetView(View):
    """A stored file."""

    sha256: str
    size_bytes: int


class DigestsView(View):
    """A list of SHA-256 digests."""

    sha256: list[str]
