"""Who uses what, and what it costs."""

from dataclasses import dataclass
from typing import Self

from nocturne_coordinator.store import usage
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer


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
