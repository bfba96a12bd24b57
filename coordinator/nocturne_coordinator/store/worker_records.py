"""What coordinators write of workers: who is there, who does what, and whose work is not trusted."""

from nocturne.v1 import job_pb2
from nocturne_scene.ranges import manifest_of

from nocturne_coordinator.dispatch.records import RenderState, WorkerRow
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.events import note_worker
from nocturne_coordinator.store.leases import Leases

_RATE_STEP_SECONDS = 60.0
_RATES_KEPT_SECONDS = 2 * 86400.0
"""Two nights of what all workers did, minute by minute: 2880 rows."""


class WorkerRecords:
    """A coordinator's writes about the workers of a data folder."""

    def __init__(self, database: Database, leases: Leases) -> None:
        self._database = database
        self._leases = leases

    def quarantined(self) -> dict[str, str]:
        """Workers whose results are not taken, and why."""
        rows = self._database.rows("SELECT worker_id, reason FROM quarantine")
        return {row["worker_id"]: row["reason"] for row in rows}

    def drained(self) -> dict[str, str]:
        """Workers that finish the jobs they hold and get no more, and why."""
        rows = self._database.rows("SELECT worker_id, who FROM drain")
        by = {row["worker_id"]: f", by {row['who']}" if row["who"] else "" for row in rows}
        return {worker: f"It is drained{who}." for worker, who in by.items()}

    def quarantine(self, worker_id: str, reason: str, now: float, mismatched: bool = False) -> list[str]:
        """Takes no more results of a worker, until somebody releases it.

        Of one whose results `mismatched` all tiles with its work are thrown away; gives their renders. A
        render that had ended is worked on again, until each tile has the samples that it had. Whoever has one
        of them in memory has lost it.
        """
        with self._leases.owned(durable=True):
            if self._database.execute(
                "INSERT INTO quarantine VALUES (?, ?, ?) ON CONFLICT DO NOTHING", (worker_id, reason, now)
            ):
                note_worker(self._database, now, worker_id, "quarantined", reason)
            return self._distrust(worker_id) if mismatched else []

    def _distrust(self, worker_id: str) -> list[str]:
        rows = self._database.rows(
            """SELECT DISTINCT render_id, state FROM contribution JOIN render ON render.id = render_id
               WHERE worker_id = ?""",
            (worker_id,),
        )
        for row in rows:
            if RenderState(row["state"]).ended:
                self._reopen(row["render_id"], worker_id)
            self._database.execute(
                """DELETE FROM tile WHERE render_id = ? AND tile_index IN
                   (SELECT tile_index FROM contribution WHERE render_id = ? AND worker_id = ?)""",
                (row["render_id"], row["render_id"], worker_id),
            )
            # A tile's row has the forward photons that fell on it: without it none are whole.
            self._database.execute(
                """DELETE FROM tile WHERE render_id = ?1
                   AND tile_index = (SELECT tiles FROM render WHERE id = ?1)""",
                (row["render_id"],),
            )
            self._database.execute(
                """DELETE FROM contribution WHERE render_id = ? AND tile_index NOT IN
                   (SELECT tile_index FROM tile WHERE render_id = ?)""",
                (row["render_id"], row["render_id"]),
            )
            self._database.execute(
                "UPDATE render SET image_final = 0, sequence = sequence + 1 WHERE id = ?",
                (row["render_id"],),
            )
            self._database.execute(
                "UPDATE lease SET fence = fence + 1 WHERE render_id = ?", (row["render_id"],)
            )
        return [row["render_id"] for row in rows]

    def _reopen(self, render_id: str, worker_id: str) -> None:
        tiles = self._database.rows("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
        schedule = self._database.row("SELECT schedule FROM render WHERE id = ?", (render_id,))
        assert schedule is not None  # noqa: S101 - it has tiles
        samples = manifest_of(job_pb2.RangeSchedule.FromString(schedule["schedule"]), map(tuple, tiles))
        self._database.execute(
            """UPDATE render SET state = 'QUEUED', reason = ?, ended = 0, image_final = 0, stop = ?
               WHERE id = ? AND state NOT IN ('FAILED', 'CANCELLED')""",
            (
                f"Work of {worker_id}, found faulty later, is done again.",
                StopConditions(tile_samples=tuple(samples)).to_json(),
                render_id,
            ),
        )

    def _mirror_work(self, at_work: list[tuple[str, int, str]], now: float) -> None:
        """A tile that is still at work keeps the time at which it was first seen."""
        own = self._leases.number
        self._database.execute(
            "DELETE FROM at_work WHERE coordinator NOT IN (SELECT number FROM coordinator)"
        )
        known = self._database.rows(
            "SELECT render_id, tile_index, worker_id FROM at_work WHERE coordinator = ?", (own,)
        )
        over = {tuple(row) for row in known}.difference(at_work)
        self._database.execute_many(
            """DELETE FROM at_work
               WHERE coordinator = ? AND render_id = ? AND tile_index = ? AND worker_id = ?""",
            [(own, *each) for each in over],
        )
        self._database.execute_many(
            # A worker may still have a job of a render that was deleted.
            """INSERT INTO at_work SELECT ?1, ?2, ?3, ?4, ?5
               WHERE EXISTS (SELECT 1 FROM render WHERE id = ?2) ON CONFLICT DO NOTHING""",
            [(own, *each, now) for each in at_work],
        )

    def mirror(self, workers: list[WorkerRow], at_work: list[tuple[str, int, str]], now: float) -> None:
        """Replaces the list of live workers, and of the tiles of our renders that each is tracing.

        Records worker events (seen first, gone), and about once a minute what all workers together did.
        """
        with self._leases.owned():
            before = {row["id"] for row in self._database.rows("SELECT id FROM worker")}
            alive = {worker.id for worker in workers}
            for worker in sorted(alive - before):
                note_worker(self._database, now, worker, "joined", "")
            for worker in sorted(before - alive):
                note_worker(self._database, now, worker, "left", "")
            self._keep_rate(workers, now)
            self._mirror_work(at_work, now)
            self._database.execute("DELETE FROM worker")
            self._database.execute_many(
                "INSERT INTO worker VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                [
                    (
                        w.id,
                        w.engine,
                        w.threads,
                        w.photons,
                        w.rays,
                        w.photons_per_second,
                        w.jobs_done,
                        w.started,
                        w.seen,
                        w.floating_point_profile,
                    )
                    for w in workers
                ],
            )

    def _keep_rate(self, workers: list[WorkerRow], now: float) -> None:
        last = self._database.row("SELECT max(unix_time) AS time FROM rate_point")
        if last is not None and last["time"] is not None and now - last["time"] < _RATE_STEP_SECONDS:
            return
        rate = sum(worker.rays_per_second for worker in workers)
        threads = sum(worker.threads for worker in workers)
        self._database.execute(
            """INSERT INTO rate_point VALUES (?, ?, ?) ON CONFLICT (unix_time)
               DO UPDATE SET threads = excluded.threads, rays_per_second = excluded.rays_per_second""",
            (now, threads, rate),
        )
        self._database.execute("DELETE FROM rate_point WHERE unix_time < ?", (now - _RATES_KEPT_SECONDS,))
