"""What is read from and written to the data folder, as values."""

from dataclasses import dataclass
from enum import StrEnum

from nocturne.v1 import job_pb2


class RenderState(StrEnum):
    """Where a render stands; the last three are final."""

    QUEUED = "QUEUED"
    RUNNING = "RUNNING"
    SUCCEEDED = "SUCCEEDED"
    FAILED = "FAILED"
    CANCELLED = "CANCELLED"

    @property
    def ended(self) -> bool:
        return self not in (RenderState.QUEUED, RenderState.RUNNING)


@dataclass(frozen=True, slots=True)
class NewRender:
    """A render to be created; the scene is compiled already and its blobs are in the folder."""

    request_id: str
    name: str
    scene_sha256: str
    scene_document: str
    """JSON, as submitted."""
    width: int
    height: int
    samples: int
    plan: job_pb2.RenderPlan


@dataclass(frozen=True, slots=True)
class RenderRow:
    """A render as the public service shows it; fields as in the messages Render and Progress."""

    id: str
    name: str
    state: RenderState
    reason: str
    width: int
    height: int
    samples: int
    photons_per_sample: int
    scene_sha256: str
    sequence: int
    created: float
    started: float
    ended: float
    ranges_done: int
    ranges_planned: int
    photons: int
    rays: int
    rejected: int
    relative_error: float
    photons_per_second: float
    cpu_seconds: float
    image_final: bool
    """An ended render's files hold all its committed samples (a cancelled one's follow within a second)."""

    @property
    def mean_samples(self) -> float:
        """Mean over pixels of samples merged."""
        return self.photons / (self.width * self.height * self.photons_per_sample)


@dataclass(frozen=True, slots=True)
class WorkerRow:
    """A worker as it last described itself; `seen` and `started` in unix seconds."""

    id: str
    engine: int
    threads: int
    photons: int
    rays: int
    photons_per_second: float
    jobs_done: int
    started: float
    seen: float


@dataclass(frozen=True, slots=True)
class ErrorPoint:
    """The error of a render at one moment; samples is the mean over pixels."""

    unix_time: float
    photons: int
    samples: float
    relative_error: float
