"""What the core tells its shell to do. Pure: values, nothing else.

The shell carries an instruction out before the next event, and gives its answer back. A failure is an
answer, too: LeaseLost, StoreUnavailable and QueueError are raised where the core waits for it
(see `core.py`).
"""

from collections.abc import Generator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

from nocturne.v1 import job_pb2

from nocturne_coordinator.dispatch.records import (
    ErrorPoint,
    FailedTile,
    OpenRender,
    RenderCommit,
    RenderState,
)
from nocturne_coordinator.dispatch.scheduler import JobKey

DEBUG, INFO, WARNING, ERROR = 10, 20, 30, 40
"""Levels of Log; the numbers are those of Python's logging."""


class Instruction:
    """One thing for the shell to do."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Log(Instruction):
    """Write a line to the log."""

    level: int
    message: str


@dataclass(frozen=True, slots=True)
class AskTime(Instruction):
    """Answer: the moment, of an event that takes long."""


# --- queue ---


@dataclass(frozen=True, slots=True)
class Publish(Instruction):
    """Put jobs on the stream. Answer: their entries, in the same order."""

    keys: tuple[JobKey, ...]
    jobs: tuple[bytes, ...]
    quick: bool = False
    """On the stream of quick copies, whose entries begin with `QUICK`."""


@dataclass(frozen=True, slots=True)
class Withdraw(Instruction):
    """Take jobs off the stream, soon."""

    entries: tuple[bytes, ...]
    stop: bool = False
    """Nobody needs them any more: who works on one is to stop."""


@dataclass(frozen=True, slots=True)
class Acknowledge(Instruction):
    """Delete results, soon: their sums are committed, or are of no use."""

    entries: tuple[bytes, ...]


@dataclass(frozen=True, slots=True)
class RereadResults(Instruction):
    """Before anything else is published, give again what the streams have of a render that others worked on:
    JobsFound, then its results."""

    render_id: str


@dataclass(frozen=True, slots=True)
class PublishExclusions(Instruction):
    """Tell workers that they get no jobs, and why, as long as nothing else is said."""

    reasons: Mapping[str, str]


# --- store ---


@dataclass(frozen=True, slots=True)
class IsOpen(Instruction):
    """Answer: whether a render is one that some coordinator works on, or will; true if unknown."""

    render_id: str


@dataclass(frozen=True, slots=True)
class RefreshRenders(Instruction):
    """Send RendersSeen soon, though nothing may have changed."""


@dataclass(frozen=True, slots=True)
class TakeRender(Instruction):
    """Lease a render. Answer: it as it is now (OpenRender), or None where another coordinator has it."""

    render_id: str


@dataclass(frozen=True, slots=True)
class StartRender(Instruction):
    """QUEUED becomes RUNNING. Answer: whether it was still queued."""

    render_id: str
    fence: int


@dataclass(frozen=True, slots=True)
class ReadTiles(Instruction):
    """Answer: the committed tiles of a render (iterable of TileRow), to be read at once."""

    render_id: str


@dataclass(frozen=True, slots=True)
class Commit(Instruction):
    """Write merged results, in one transaction. Answer: CommitDone."""

    commits: tuple[RenderCommit, ...]
    fences: Mapping[str, int]
    """Of renders with results that would be acknowledged next: they must still be ours."""


@dataclass(frozen=True, slots=True)
class EndRender(Instruction):
    """Write a final state. Answer: whether the render had not changed meanwhile."""

    render: OpenRender
    state: RenderState
    reason: str


@dataclass(frozen=True, slots=True)
class RestartRender(Instruction):
    """Throw away all samples of a render, and its floating-point profile."""

    render_id: str
    fence: int


@dataclass(frozen=True, slots=True)
class Recut(Instruction):
    """Give a render that runs a schedule of the same samples in shorter ranges. Answer: whether that was
    done; it is not where somebody changed the render's requests."""

    render: OpenRender
    schedule: job_pb2.RangeSchedule


@dataclass(frozen=True, slots=True)
class ReleaseLease(Instruction):
    """Give the lease of a render back; if that fails, it runs out by itself."""

    render_id: str
    fence: int


@dataclass(frozen=True, slots=True)
class Quarantine(Instruction):
    """Note that no result of a worker is taken any more. Answer: ids of the renders whose tiles with its work
    are thrown away, none unless it `mismatched`."""

    worker: str
    reason: str
    mismatched: bool


# --- output ---


@dataclass(frozen=True, slots=True)
class WriteBundle(Instruction):
    """Keep what reproduces the failure of a tile."""

    render_id: str
    failed: FailedTile


@dataclass(frozen=True, slots=True)
class WritePreview(Instruction):
    """Replace a render's preview. Answer: the moment when that was done."""

    render_id: str
    final: bool = False


@dataclass(frozen=True, slots=True)
class WriteThumbnail(Instruction):
    """Replace the small picture. Answer: the moment when that was done."""

    render_id: str


@dataclass(frozen=True, slots=True)
class RecordError(Instruction):
    """Tell watchers of new pictures, with the error. Answer: the moment when that was done."""

    render_id: str
    fence: int
    point: ErrorPoint
    in_history: bool


@dataclass(frozen=True, slots=True)
class MakePictures(Instruction):
    """Make the last pictures of a render, all of whose results are committed; or others than the `final`
    ones, which take their places at once. Answer: PicturesMade, or None: to be asked again."""

    render_id: str
    final: bool = True


@dataclass(frozen=True, slots=True)
class WriteImage(Instruction):
    """Write the image of a render that ends; with it all pictures that are made already. Answer: the moment
    when that was done."""

    render_id: str


T = TypeVar("T")

Steps: TypeAlias = Generator[Instruction, Any, T]
"""Instructions one after the other, each with its answer; the outcome at the end. Between two events
none is ever left over, so all that the core knows is in its fields."""
