"""What the core knows, shared by its parts. Pure."""

from dataclasses import dataclass, field

from nocturne_coordinator.dispatch.audit import NEW_SHARE, SHARE, Auditor
from nocturne_coordinator.dispatch.failure_policy import FailurePolicy
from nocturne_coordinator.dispatch.fleet import Fleet
from nocturne_coordinator.dispatch.instructions import Quarantine, ReleaseLease
from nocturne_coordinator.dispatch.job_cost import JOB_SECONDS
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import MIN_OVERDUE, JobKey, Scheduler

COMMIT_SECONDS = 0.9
"""Work lost with the coordinator, at most; a commit of a whole 512 x 512 film costs 15 ms."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What a coordinator is started with."""

    number: int = 1
    """Of this coordinator among those of the folder."""
    commit_seconds: float = COMMIT_SECONDS
    overdue_seconds: float = MIN_OVERDUE
    audit_share: float = SHARE
    audit_share_new: float = NEW_SHARE
    job_seconds: float = JOB_SECONDS
    enrolled: bool = False
    """Only machines that enrolled work, and nobody knows whether each is honest."""
    memory_bytes: int = 0
    """That the coordinator has with the processes that make pictures; 0: unknown, and enough."""


@dataclass(slots=True)
class State:
    """Everything between two events."""

    settings: Settings
    scheduler: Scheduler
    auditor: Auditor
    renders: dict[str, RunningRender] = field(default_factory=dict)
    failure_policy: FailurePolicy = field(default_factory=FailurePolicy)
    fleet: Fleet = field(default_factory=Fleet)
    to_acknowledge: dict[str, list[bytes]] = field(default_factory=dict)
    """Result entries to delete after the next commit, by render; under no render's name, of none."""
    failed: dict[str, str] = field(default_factory=dict)
    """Renders that are to end because too many of their tiles failed, and why."""
    lost: list[tuple[JobKey, str]] = field(default_factory=list)
    """Jobs with the workers that died having them. They are judged at the next tick: their results may be
    among those that are read before it."""
    waits_for_audits_since: dict[str, float] = field(default_factory=dict)
    """Since when renders wait for nothing else."""
    needs_audits_only: set[str] = field(default_factory=set)
    """Renders that end as soon as their audits, layers and pictures are done: they get no other jobs."""
    minority_since: dict[str, float] = field(default_factory=dict)
    """Renders that most workers can't help with, and since when."""
    folder_trouble: bool = False
    """The last commit failed: no new jobs until one works again, as merged results pile up in Redis."""
    owed: list[ReleaseLease | Quarantine] = field(default_factory=list)
    """Writes to the folder, besides those of sums, that must happen: each stays here until it has worked."""
    no_quick_copies: dict[str, float] = field(default_factory=dict)
    """Owners of whom a quick copy took too long, and until when they get none."""
    next_commit: float = 0.0

    @classmethod
    def of(cls, settings: Settings) -> "State":
        """At the start."""
        auditor = Auditor(settings.audit_share, settings.audit_share_new)
        return cls(settings, Scheduler(settings.overdue_seconds), auditor)
