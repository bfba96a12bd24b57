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

    def release(self, worker_id: str) -> None:
        """Takes a worker's results again; raises NotFound where it is not in quarantine."""
        with self._database.transaction():
            if not self._database.execute("DELETE FROM quarantine WHERE worker_id = ?", (worker_id,)):
                raise NotFound(f"no worker {worker_id!r} is in quarantine")
            note_worker(self._database, time.time(), worker_id, "released", "")

    def history(self, events: int) -> tuple[list[WorkerEvent], list[RatePoint]]:
        """The last of what happened to workers, newest first; and what all of them did, oldest first."""
        happened = self._database.rows(
            "SELECT unix_time, worker_id, what, reason FROM worker_event ORDER BY number DESC LIMIT ?",
            (events,),
        )
        rates = self._database.rows("SELECT * FROM rate_point ORDER BY unix_time")
        return [WorkerEvent(**dict(row)) for row in happened], [RatePoint(**dict(row)) for row in rates]
