"""Groups: renders of one owner that were submitted together, such as the frames of a film."""

from dataclasses import dataclass

from nocturne_scene.errors import NotFound

from nocturne_coordinator.store.database import Database

WAITS = """after_group <> '' AND (owner, after_group) IN (
    SELECT owner, in_group FROM render WHERE state IN ('QUEUED', 'RUNNING', 'PAUSED'))"""
"""Of a row of `render`: whether another group has to end first."""


@dataclass(frozen=True, slots=True)
class GroupRow:
    """All renders of a group together."""

    name: str
    renders: int
    ended: int
    failed: int
    """Of those that ended: FAILED, CANCELLED or DEGRADED."""
    ranges_done: int
    ranges_planned: int
    cpu_seconds: float
    predicted_end: float
    """Unix time at which the last that runs should end; 0: unknown."""


class Groups:
    """The groups of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def waits(self, render_id: str) -> bool:
        """Whether a queued render waits for the end of another group."""
        return (
            self._database.row(
                f"SELECT 1 FROM render WHERE id = ? AND state = 'QUEUED' AND {WAITS}",  # noqa: S608
                (render_id,),
            )
            is not None
        )

    def get(self, name: str, owner: str | None = None) -> GroupRow:
        """Of one owner, or of all; raises NotFound."""
        row = self._database.row(
            """SELECT count(*) AS renders,
                   count(*) FILTER (WHERE state NOT IN ('QUEUED', 'RUNNING', 'PAUSED')) AS ended,
                   count(*) FILTER (WHERE state IN ('FAILED', 'CANCELLED', 'DEGRADED')) AS failed,
                   coalesce(sum(CASE WHEN state IN ('QUEUED', 'RUNNING', 'PAUSED')
                                THEN ranges_done ELSE ranges_planned END), 0) AS ranges_done,
                   coalesce(sum(ranges_planned), 0) AS ranges_planned,
                   coalesce(sum(cpu_seconds), 0.0) AS cpu_seconds,
                   coalesce(max(CASE WHEN state = 'RUNNING' THEN predicted_end ELSE 0.0 END), 0.0)
                       AS predicted_end
               FROM render WHERE in_group = ?1 AND in_group <> '' AND owner = coalesce(?2, owner)""",
            (name, owner),
        )
        if row is None or not row["renders"]:
            raise NotFound(f"there is no group {name!r}")
        return GroupRow(name, **dict(row))
