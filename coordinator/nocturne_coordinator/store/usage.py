"""Who uses what: processor time of all renders of each owner, and their part of the workers just now."""

from dataclasses import dataclass

from nocturne_coordinator.limits import DEFAULT_PRIORITY
from nocturne_coordinator.store.database import Database

_OWNERS = """
SELECT owner, sum(renders) AS renders, sum(open_renders) AS open_renders, sum(cpu_seconds) AS cpu_seconds,
    sum(stored_bytes) AS stored_bytes, sum(jobs) AS jobs, coalesce(max(weight), ?2) AS weight
FROM (
    SELECT owner, count(*) AS renders,
        count(*) FILTER (WHERE state IN ('QUEUED', 'RUNNING', 'PAUSED')) AS open_renders,
        sum(cpu_seconds) AS cpu_seconds, sum(stored_bytes) AS stored_bytes, 0 AS jobs,
        CAST(NULL AS INTEGER) AS weight
    FROM render GROUP BY owner
    UNION ALL SELECT owner, renders, 0, cpu_seconds, 0, 0, NULL FROM deleted_usage
    UNION ALL SELECT owner, 0, 0, 0.0, 0, count(*), NULL
        FROM at_work JOIN render ON render.id = render_id GROUP BY owner
    UNION ALL SELECT name, 0, 0, 0.0, 0, 0, weight FROM token WHERE revoked = 0
) AS each_kind
WHERE owner = coalesce(?1, owner)
GROUP BY owner HAVING sum(renders) > 0 ORDER BY sum(cpu_seconds) DESC, owner
"""


@dataclass(frozen=True, slots=True)
class OwnerUsage:
    """What one owner has used, deleted renders included, and uses now."""

    owner: str
    renders: int
    """All that there ever were."""
    open_renders: int
    cpu_seconds: float
    """Of workers, in merged ranges."""
    stored_bytes: int
    """Of renders that are there."""
    jobs: int
    """In the hands of workers."""
    weight: int


class UsageOfOwners:
    """The usage of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def read(self, owner: str | None) -> tuple[list[OwnerUsage], int]:
        """Of one owner or of all, most processor time first; and how many jobs all workers have in hand."""
        rows = self._database.rows(_OWNERS, (owner, DEFAULT_PRIORITY))
        jobs = self._database.row("SELECT count(*) AS jobs FROM at_work")
        return [OwnerUsage(**dict(row)) for row in rows], 0 if jobs is None else jobs["jobs"]
