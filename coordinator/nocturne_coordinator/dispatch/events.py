"""Events that the core is given, with the times at which they happened. Pure: values, nothing else."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.records import ErrorPoint, OpenRender, WorkerRow


class Moment(NamedTuple):
    """A time by both clocks, in seconds."""

    now: float
    """By a clock that never jumps; its zero is anywhere."""
    unix: float


class Event:
    """One thing that happened."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Tick(Event):
    """Time has passed: results that are due are committed, and renders whose end has come are ended."""

    at: Moment


@dataclass(frozen=True, slots=True)
class ResultCame(Event):
    """An entry of the results stream."""

    at: Moment
    entry: bytes
    data: bytes
    draw: float
    """At random in [0, 1), not to be foreseen: whether the job is audited."""
    refusal: str = ""
    """Why it does not count, whatever it says: no machine that had the job has signed it."""


@dataclass(frozen=True, slots=True)
class RedisEmptied(Event):
    """Nothing is on the streams that was there before."""

    at: Moment


@dataclass(frozen=True, slots=True)
class JobsFound(Event):
    """All that is on the stream of jobs: entries, and serialised jobs."""

    at: Moment
    jobs: tuple[tuple[bytes, bytes], ...]


@dataclass(frozen=True, slots=True)
class StreamIsReady(Event):
    """All results that came are read, and jobs can be published now."""

    at: Moment


@dataclass(frozen=True, slots=True)
class WorkersSeen(Event):
    """What workers say of themselves, and who has which job."""

    at: Moment
    workers: tuple[WorkerRow, ...]
    left_ms: Mapping[str, int]
    """By worker, how long its status holds without another."""
    holders: tuple[Holder, ...]
    jobs_waiting: int
    """On the stream, of all coordinators."""


@dataclass(frozen=True, slots=True)
class RendersSeen(Event):
    """The folder as it is: its open renders by priority, then oldest first."""

    at: Moment
    renders: tuple[OpenRender, ...]
    quarantined: Mapping[str, str]
    """Workers, and why."""
    coordinators: int
    """That work on the folder."""
    drained: Mapping[str, str] = field(default_factory=dict)
    """Workers that finish the jobs they hold and get no more, and why."""


@dataclass(frozen=True, slots=True)
class RenderLost(Event):
    """Another coordinator has a render, or its sums were changed."""

    at: Moment
    render_id: str


@dataclass(frozen=True, slots=True)
class Stopping(Event):
    """The process is to end in order."""

    at: Moment


@dataclass(frozen=True, slots=True)
class MadeApart:
    """What a process found that made the pictures of a large film."""

    point: ErrorPoint
    estimate: ErrorEstimate
    cpu_seconds: float


@dataclass(frozen=True, slots=True)
class PicturesMade:
    """Answer to MakePictures."""

    at: Moment
    apart: MadeApart | None = None
    """None: of a small film, whose pictures are made when they are written."""


@dataclass(frozen=True, slots=True)
class CommitDone:
    """Answer to Commit."""

    at: Moment
    lost: tuple[str, ...]
    """Renders that are another coordinator's now, of which nothing was written."""
