"""Groups of renders."""

from typing import Self

from nocturne_coordinator.store.groups import GroupRow
from pydantic import ConfigDict, Field

from nocturne_api.models import examples
from nocturne_api.models.base import Answer


class Group(Answer):
    """All renders of a group together."""

    model_config = ConfigDict(json_schema_extra={"examples": [examples.GROUP]})

    name: str
    renders: int = Field(description="How many there are.")
    ended: int = Field(description="Of these, those in a final state.")
    failed: int = Field(description="Of those that ended: failed, cancelled or degraded.")
    fraction: float = Field(
        description="Of the work of all: sample ranges merged, where what has ended counts as whole."
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
