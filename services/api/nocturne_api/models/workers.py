"""Workers, their machines and history, whether they get jobs, and the use by owners."""

from dataclasses import dataclass, field
from typing import Self

from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.store import usage
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer


class Worker(Answer):
    """One worker process, as it last reported itself."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.WORKER]})

    id: str
    engine: int = Field(description="Version of the tracing engine; renders take results of one only.")
    threads: int
    rays_per_second: float = Field(description="Over the last seconds, all threads together.")
    jobs_done: int
    started: float = Field(description="Unix time, seconds.")
    quarantine: str = Field(description="Why its results are refused; empty: they are taken.")
    floating_point_profile: str = Field(
        description="How it rounds; renders take results of one profile only."
    )
    incompatible: str = Field(
        description="Why it gets no jobs though it is not in quarantine; empty: it gets them."
    )

    drain: str = Field(
        description='"draining": it finishes the jobs in hand and gets no others; "drained": it has none any '
        "more, and can be stopped; empty: neither."
    )

    unaudited: str = Field(
        description="Why none of its results is audited, a sentence; empty: another machine is there."
    )

    @classmethod
    def of(
        cls, row: WorkerRow, quarantine: str, incompatible: str, drain: str = "", unaudited: str = ""
    ) -> Self:
        """The public side of a row of the data folder."""
        other = {"quarantine", "incompatible", "drain", "unaudited"}
        return cls(
            quarantine=quarantine,
            drain=drain,
            unaudited=unaudited,
            incompatible=incompatible,
            **{name: getattr(row, name) for name in cls.model_fields.keys() - other},
        )


class WorkerList(Answer):
    """The workers heard of in the last ten seconds."""

    workers: list[Worker]


class WorkOfWorker(Answer):
    """A render that a worker is tracing."""

    worker: str = Field(description="Its id.")
    render: str = Field(description="Id of the render.")
    name: str = Field(description="Of the render.")
    tiles: int = Field(description="How many of its tiles the worker has.")
    since: float = Field(description="Unix time at which it was first seen with the oldest of these.")


class WorkList(Answer):
    """Which renders the workers are tracing, as of the last two seconds."""

    work: list[WorkOfWorker]


class WorkerEvent(Answer):
    """What happened to a worker."""

    unix_time: float
    worker_id: str
    what: str = Field(description="joined, left, quarantined, draining or released.")
    reason: str


class RatePoint(Answer):
    """What all workers together did at one time."""

    unix_time: float
    threads: int
    rays_per_second: float


class WorkerHistory(Answer):
    """Worker events of late, and the rate of all workers."""

    events: list[WorkerEvent] = Field(description="The last 100, newest first.")
    rates: list[RatePoint] = Field(description="One for each minute of two days, oldest first.")


@dataclass(frozen=True, slots=True)
class Enrolment:
    """Fields as in the message of this name; gRPC only, as workers speak nothing else."""

    machine: str
    key: bytes = field(repr=False)
    redis_user: str
    redis_password: str = field(repr=False)


@dataclass(frozen=True)
class CoreHourPrice:
    """What an hour of a processor costs, as who runs the service says."""

    price: float = 0.0
    """0: nothing was said."""
    currency: str = ""

    def of(self, cpu_seconds: float) -> float:
        """Of so much processor time."""
        return self.price * cpu_seconds / 3600.0


class OwnerUsage(Answer):
    """One owner's renders, those that were deleted included."""

    owner: str = Field(description="Name of the token; empty without authentication.")
    weight: int = Field(description="Of the token, among others: 200 gets twice the work of 100.")
    renders: int = Field(description="All that there ever were.")
    open_renders: int = Field(description="Queued, running or paused.")
    share: float = Field(description="Part of the jobs in the hands of workers, now: 0 to 1.")
    cpu_seconds: float = Field(description="Processor seconds of workers, in results that counted.")
    cost: float = Field(description="Of these; 0 where no price is set.")
    stored_bytes: int = Field(description="What its renders that are there take of the disk, at most.")

    @classmethod
    def of(cls, row: usage.OwnerUsage, jobs: int, price: CoreHourPrice) -> Self:
        """The public side of a row; `jobs`: in the hands of all workers."""
        computed = {"share", "cost"}
        return cls(
            share=row.jobs / max(1, jobs),
            cost=price.of(row.cpu_seconds),
            **{name: getattr(row, name) for name in cls.model_fields.keys() - computed},
        )


class Usage(Answer):
    """Who uses what, of those that the caller may see."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.USAGE]})

    core_hour_price: float = Field(description="Of an hour of one processor; 0: none is set.")
    currency: str = Field(description="Of the price.")
    owners: list[OwnerUsage] = Field(description="Most processor time first.")
