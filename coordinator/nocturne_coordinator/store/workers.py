"""Workers as the coordinators last described them, and what happened to them."""

import time
from dataclasses import fields

from nocturne_scene.errors import NotFound

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.profiles import incompatible
from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.events import note_worker
from nocturne_coordinator.store.rows import RatePoint, WorkerEvent

_LAST_JOBS_SECONDS = 10.0
"""Until notified, a worker that is drained may take another job, which is listed as its own some seconds
later. A worker's status holds as long."""

_COLUMNS = ", ".join(field.name for field in fields(WorkerRow))


class Workers:
    """The workers of a data folder, for those who look at them."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def alive(self) -> list[WorkerRow]:
        """Workers heard of in the last ten seconds, by name."""
        rows = self._database.rows(
            f"SELECT {_COLUMNS} FROM worker WHERE seen > ? ORDER BY id",  # noqa: S608
            (time.time() - limits.WORKER_SECONDS,),
        )
        return [WorkerRow(**dict(row)) for row in rows]

    def incompatible(self) -> dict[str, str]:
        """Workers that get no jobs though they are not in quarantine, and why."""
        renders = self._database.rows(
            "SELECT DISTINCT floating_point_profile FROM render WHERE state IN ('QUEUED', 'RUNNING')"
        )
        classes = [row["floating_point_profile"] for row in renders]
        return incompatible(self.alive(), self.in_quarantine(), classes)

    def in_quarantine(self) -> dict[str, str]:
        """Workers whose results are not taken, and why."""
        rows = self._database.rows("SELECT worker_id, reason FROM quarantine ORDER BY since")
        return {row["worker_id"]: row["reason"] for row in rows}

    def drain(self, worker_id: str, who: str) -> None:
        """Gives a worker no more jobs; the job it holds counts. Again changes nothing.

        Raises NotFound for a worker that was not heard of lately.
        """
        with self._database.transaction():
            if all(worker.id != worker_id for worker in self.alive()):
                raise NotFound(f"no worker {worker_id!r} was heard of in the last ten seconds")
            now = time.time()
            if self._database.execute(
                "INSERT INTO drain VALUES (?, ?, ?) ON CONFLICT DO NOTHING", (worker_id, who, now)
            ):
                note_worker(self._database, now, worker_id, "draining", f"by {who}" if who else "")

    def drained(self) -> dict[str, bool]:
        """Workers that get no more jobs, and whether they have finished all that they had."""
        rows = self._database.rows(
            """SELECT worker_id, since < ? AND NOT EXISTS
                   (SELECT 1 FROM at_work WHERE at_work.worker_id = drain.worker_id) AS done FROM drain""",
            (time.time() - _LAST_JOBS_SECONDS,),
        )
        return {row["worker_id"]: bool(row["done"]) for row in rows}

    def release(self, worker_id: str) -> None:
        """Gives a worker jobs and takes its results again; raises NotFound where it is neither in quarantine
        nor drained."""
        with self._database.transaction():
            freed = [
                self._database.execute(f"DELETE FROM {table} WHERE worker_id = ?", (worker_id,))  # noqa: S608
                for table in ("quarantine", "drain")
            ]
            if not any(freed):
                raise NotFound(f"no worker {worker_id!r} is in quarantine or drained")
            note_worker(self._database, time.time(), worker_id, "released", "")

    def history(self, events: int) -> tuple[list[WorkerEvent], list[RatePoint]]:
        """The last of what happened to workers, newest first; and what all of them did, oldest first."""
        happened = self._database.rows(
            "SELECT unix_time, worker_id, what, reason FROM worker_event ORDER BY number DESC LIMIT ?",
            (events,),
        )
        rates = self._database.rows("SELECT * FROM rate_point ORDER BY unix_time")
        return [WorkerEvent(**dict(row)) for row in happened], [RatePoint(**dict(row)) for row in rates]
