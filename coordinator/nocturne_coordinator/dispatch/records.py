"""Values: renders and workers as the core is given them, and the records that it gives to be kept. Pure.

The store reads and writes them; `store.rows` has those that the coordinator's decisions do not need.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.forecast import UNKNOWN, Forecast
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.limits import DEFAULT_PRIORITY

UNKNOWN_PROFILE = "unknown"
"""Floating-point profile of workers that don't tell theirs."""


class RenderState(StrEnum):
    """Where a render stands; from SUCCEEDED on it has ended, though it may be extended."""

    QUEUED = "QUEUED"
    RUNNING = "RUNNING"
    PAUSED = "PAUSED"
    SUCCEEDED = "SUCCEEDED"
    STOPPED_EARLY = "STOPPED_EARLY"
    """By a time: the image lists the samples that each tile has."""
    DEGRADED = "DEGRADED"
    """Complete but for tiles that failed."""
    FAILED = "FAILED"
    CANCELLED = "CANCELLED"

    @property
    def ended(self) -> bool:
        return self not in (RenderState.QUEUED, RenderState.RUNNING, RenderState.PAUSED)

    @property
    def has_image(self) -> bool:
        """Ended with an image that holds all that was asked for, or could be had."""
        return self in (RenderState.SUCCEEDED, RenderState.STOPPED_EARLY, RenderState.DEGRADED)


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
    floating_point_profile: str = UNKNOWN_PROFILE

    @property
    def rays_per_second(self) -> float:
        """Its rate in rays, by the rays that its photons took so far."""
        return self.photons_per_second * self.rays / self.photons if self.photons else 0.0


@dataclass(frozen=True, slots=True)
class ErrorPoint:
    """The error of a render at one moment; samples is the mean over pixels."""

    unix_time: float
    photons: int
    samples: float
    relative_error: float
    top_percent_share: float = 0.0
    effective_pixels: float = 0.0
    mean: float = 0.0
    mean_error: float = 0.0
    zero_pixels: int = 0
    """See error_estimate.ErrorEstimate."""
    error_warning: str = ""
    """Why the error is not to be trusted; see trust."""


@dataclass(frozen=True, slots=True)
class OpenRender:
    """What the coordinator needs to know of a render to work on it."""

    id: str
    state: RenderState
    schedule: job_pb2.RangeSchedule
    scene_sha256: str
    engine: int
    totals: "Totals"
    stop: StopConditions = EVERYTHING
    priority: int = DEFAULT_PRIORITY
    owner: str = ""
    owner_weight: int = DEFAULT_PRIORITY
    ran_seconds: float = 0.0
    failed_tiles: tuple["FailedTile", ...] = ()
    holder: int = 0
    """Number of the coordinator that works on it; 0: none that gives signs of life."""
    fence: int = 0
    """Grows with every holder; who does not know the newest may not write."""
    look_first: Region | None = None
    floating_point_profile: str = ""
    """How all its workers round; empty before the first result."""
    layers_sha256: str = ""
    """Of the blob that holds the layers of its image; empty: it has none."""
    layers_due: bool = False
    """They are being made; its end waits for them."""

    def asks_the_same(self, other: "OpenRender") -> bool:
        """Whether schedule and conditions are those of another state of this render."""
        return (self.schedule, self.stop) == (other.schedule, other.stop)


@dataclass(frozen=True, slots=True)
class FailedTile:
    """A range that failed on several workers; its tile gets no more samples."""

    tile_index: int
    first_sample: int
    end_sample: int
    reason: str
    workers: tuple[str, ...]


@dataclass(slots=True)
class Totals:
    """Counts over a render's merged ranges."""

    ranges: int = 0
    photons: int = 0
    rays: int = 0
    invalid_samples: int = 0
    cpu_seconds: float = 0.0
    audited: int = 0
    unaudited: int = 0
    refused: int = 0
    truncated_paths: int = 0


@dataclass(frozen=True, slots=True)
class TileRow:
    """A tile's merged samples, and their sums as float64, little endian."""

    tile_index: int
    samples: int
    sums: bytes
    invalid_samples: int = 0
    """Photons left out of them."""
    error_before: float = 0.0
    """See MergedFilm.error_before."""
    own: bytes = b""
    """Where forward photons have separate ranges, `sums` are those of both together, and these those of
    the tile's own samples; empty: as they were committed before."""
    photons: bytes = b""
    """And these those of forward photons that fell on it, likewise."""


@dataclass(frozen=True, slots=True)
class TileRows:
    """Rows that are made when they are asked for, one after the other: those of a commit may be 100 MB."""

    tiles: Sequence[int]
    row_of: Callable[[int], TileRow]
    """Good until the next event."""

    def __iter__(self) -> Iterator[TileRow]:
        return map(self.row_of, self.tiles)

    def __len__(self) -> int:
        return len(self.tiles)


@dataclass(frozen=True, slots=True)
class RenderCommit:
    """A render's dirty tiles and its totals with them: absolute numbers, doing it twice changes nothing."""

    render_id: str
    fence: int
    tiles: TileRows | list[TileRow]
    totals: Totals
    photons_per_second: float
    ran_seconds: float = 0.0
    tiles_done: int = 0
    forecast: Forecast = UNKNOWN
    contributors: Mapping[int, Iterable[str]] = field(default_factory=dict)
    """By tile, the workers whose work is new in its sums."""
    photon_bundles: int = 0
    """Forward photons in separate ranges, which are among all photons, but no samples of pixels."""
    failed_tiles: Iterable[FailedTile] = ()
    """All of the render's."""
    floating_point_profile: str = ""
