"""What only coordinators do to the data folder; every write checks that folder and render are theirs."""

import json
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from nocturne.v1 import job_pb2
from nocturne_scene.ranges import TileGrid

from nocturne_coordinator.dispatch.records import (
    ErrorPoint,
    FailedTile,
    OpenRender,
    RenderCommit,
    RenderState,
    TileRow,
    Totals,
    WorkerRow,
)
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.errors import LeaseLost
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.events import note_worker
from nocturne_coordinator.store.ownership import Ownership

_LARGEST = 2**63 - 1
_OPEN_COLUMNS = """id, state, scene_sha256, engine, schedule, photons, rays, invalid_samples, cpu_seconds,
audited,
    refused, stop, priority, owner, ran_seconds, look_first, floating_point_profile,
    coalesce((SELECT weight FROM token WHERE token.name = render.owner), 100) AS owner_weight,
    coalesce((SELECT fence FROM lease WHERE lease.render_id = render.id), 0) AS fence,
    coalesce((SELECT coordinator.number FROM lease JOIN coordinator ON coordinator.number = lease.coordinator
              WHERE lease.render_id = render.id
                  AND coordinator.until >= (julianday('now') - 2440587.5) * 86400.0), 0) AS holder"""


_RATE_STEP_SECONDS = 60.0
_RATES_KEPT_SECONDS = 2 * 86400.0
"""Two nights of what all workers did, minute by minute: 2880 rows."""


class Ledger:
    """The coordinator's pen."""

    def __init__(self, database: Database, ownership: Ownership) -> None:
        self._database = database
        self._ownership = ownership

    # --- reading ---

    def open_renders(self) -> list[OpenRender]:
        """All that are to be worked on: by priority, then oldest first."""
        rows = self._database.rows(
            f"""SELECT {_OPEN_COLUMNS} FROM render WHERE state IN ('QUEUED', 'RUNNING')
                ORDER BY priority DESC, number"""  # noqa: S608
        )
        return [self._open_render(row) for row in rows]

    def ended_without_image(self) -> list[OpenRender]:
        """Those that ended, or pause, while their images do not show all that was committed."""
        rows = self._database.rows(
            f"""SELECT {_OPEN_COLUMNS} FROM render
                WHERE image_final = 0 AND state NOT IN ('QUEUED', 'RUNNING') ORDER BY number"""  # noqa: S608
        )
        return [self._open_render(row) for row in rows]

    def quarantined(self) -> dict[str, str]:
        """Workers whose results are not taken, and why."""
        rows = self._database.rows("SELECT worker_id, reason FROM quarantine")
        return {row["worker_id"]: row["reason"] for row in rows}

    def tiles(self, render_id: str) -> Iterator[TileRow]:
        """The committed tiles, one after the other: all at once may be gigabytes."""
        indices = self._database.rows(
            "SELECT tile_index FROM tile WHERE render_id = ? ORDER BY tile_index", (render_id,)
        )
        for index in indices:
            row = self._database.row(
                """SELECT tile_index, samples, sums, invalid_samples FROM tile
                   WHERE render_id = ? AND tile_index = ?""",
                (render_id, index["tile_index"]),
            )
            if row is not None:
                yield TileRow(**dict(row))

    def is_open(self, render_id: str) -> bool:
        """Whether some coordinator works on the render, or is to."""
        return (
            self._database.row(
                "SELECT 1 FROM render WHERE id = ? AND state IN ('QUEUED', 'RUNNING')", (render_id,)
            )
            is not None
        )

    # --- leases ---

    @property
    def number(self) -> int:
        """Of this coordinator."""
        return self._ownership.number

    @property
    def lease_seconds(self) -> float:
        """How long nobody takes our renders away without a sign of life."""
        return self._ownership.lease_seconds

    def renew(self, now: float) -> int:
        """A sign of life, `now` in unix seconds; gives the number of coordinators at work."""
        with self._owned():
            self._database.execute(
                "INSERT OR REPLACE INTO coordinator VALUES (?, ?)", (self.number, now + self.lease_seconds)
            )
            self._database.execute("DELETE FROM coordinator WHERE until < ?", (now,))
            self._database.execute(
                "DELETE FROM meter WHERE coordinator NOT IN (SELECT number FROM coordinator)"
            )
            row = self._database.row("SELECT count(*) AS count FROM coordinator")
        return int(row["count"]) if row is not None else 0

    def resign(self) -> None:
        """Nobody needs to wait for our leases to end."""
        with self._owned():
            self._database.execute("DELETE FROM coordinator WHERE number = ?", (self.number,))

    def take(self, render_id: str) -> OpenRender | None:
        """The render as it is now, with a new fence: ours from here on. None if another one works on it."""
        with self._owned():
            row = self._database.row(f"SELECT {_OPEN_COLUMNS} FROM render WHERE id = ?", (render_id,))  # noqa: S608
            if row is None or row["holder"] not in (0, self.number):
                return None
            self._database.execute(
                """INSERT INTO lease VALUES (?, ?, 1)
                   ON CONFLICT DO UPDATE SET coordinator = excluded.coordinator, fence = fence + 1""",
                (render_id, self.number),
            )
            row = self._database.row(f"SELECT {_OPEN_COLUMNS} FROM render WHERE id = ?", (render_id,))  # noqa: S608
            assert row is not None  # noqa: S101 - it was there in the same transaction
            return self._open_render(row)

    def let_go(self, render_id: str, fence: int) -> None:
        """Whoever wants may take the render."""
        with self._owned():
            self._database.execute(
                "UPDATE lease SET coordinator = 0 WHERE render_id = ? AND coordinator = ? AND fence = ?",
                (render_id, self.number, fence),
            )

    @contextmanager
    def holding(self, render_id: str, fence: int) -> Iterator[None]:
        """A transaction in which the render is ours and stays so; LeaseLost if it is not."""
        with self._owned():
            if not self._holds(render_id, fence):
                raise LeaseLost(render_id)
            yield

    def lost(self, fences: Mapping[str, int]) -> list[str]:
        """Of renders and the fences that they had, those that are another coordinator's now."""
        return [render_id for render_id, fence in fences.items() if not self._holds(render_id, fence)]

    def _holds(self, render_id: str, fence: int) -> bool:
        row = self._database.row(
            "SELECT 1 FROM lease WHERE render_id = ? AND coordinator = ? AND fence = ?",
            (render_id, self.number, fence),
        )
        return row is not None

    # --- writing ---

    def start(self, render_id: str, fence: int, now: float) -> bool:
        """QUEUED becomes RUNNING; False if it is not queued any more. LeaseLost if it is another's."""
        with self.holding(render_id, fence):
            changed = self._database.execute(
                """UPDATE render SET state = 'RUNNING', started = iif(started > 0, started, ?), reason = '',
                       image_final = 0, sequence = sequence + 1
                   WHERE id = ? AND state = 'QUEUED'""",
                (now, render_id),
            )
        return changed == 1

    def commit(self, commits: list[RenderCommit]) -> list[str]:
        """All of it in one transaction; a render that has ended meanwhile keeps what it has.

        Gives the renders that are another coordinator's now, of which nothing is written.
        """
        lost = []
        with self._owned():
            for commit in commits:
                if not self._holds(commit.render_id, commit.fence):
                    lost.append(commit.render_id)
                elif self._write_totals(commit):
                    self._write_tiles(commit)
                    self._write_failed_tiles(commit)
        return lost

    def _write_totals(self, commit: RenderCommit) -> bool:
        totals = commit.totals
        changed = self._database.execute(
            """UPDATE render SET ranges_done = ?, photons = ?, rays = ?, invalid_samples = ?, cpu_seconds = ?,
                   audited = ?, refused = ?, photons_per_second = iif(state = 'RUNNING', ?, 0), ran_seconds =
                   ?, tiles_done = ?, tiles_failed = ?, predicted_end = ?, predicted_cpu_seconds = ?,
                   floating_point_profile = ?, sequence = sequence + 1
               WHERE id = ? AND state IN ('QUEUED', 'RUNNING', 'PAUSED')""",
            (
                totals.ranges,
                totals.photons,
                min(totals.rays, _LARGEST),
                totals.invalid_samples,
                totals.cpu_seconds,
                totals.audited,
                totals.refused,
                commit.photons_per_second,
                commit.ran_seconds,
                commit.tiles_done,
                len(tuple(commit.failed_tiles)),
                commit.forecast.end,
                commit.forecast.cpu_seconds,
                commit.floating_point_profile,
                commit.render_id,
            ),
        )
        return changed == 1

    def _write_tiles(self, commit: RenderCommit) -> None:
        self._database.execute_many(
            """INSERT INTO tile (render_id, tile_index, samples, sums, invalid_samples, revision)
               VALUES (?1, ?2, ?3, ?4, ?5, (SELECT sequence FROM render WHERE id = ?1))
               ON CONFLICT DO UPDATE SET samples = excluded.samples, sums = excluded.sums,
                   invalid_samples = excluded.invalid_samples, revision = excluded.revision""",
            [
                (commit.render_id, tile.tile_index, tile.samples, tile.sums, tile.invalid_samples)
                for tile in commit.tiles
            ],
        )
        self._database.execute_many(
            "INSERT OR IGNORE INTO contribution VALUES (?, ?, ?)",
            [
                (commit.render_id, tile, worker)
                for tile, workers in commit.contributors.items()
                for worker in workers
            ],
        )

    def _write_failed_tiles(self, commit: RenderCommit) -> None:
        self._database.execute_many(
            "INSERT OR REPLACE INTO failed_tile VALUES (?, ?, ?, ?, ?, ?)",
            [
                (
                    commit.render_id,
                    each.tile_index,
                    each.first_sample,
                    each.end_sample,
                    each.reason,
                    json.dumps(each.workers),
                )
                for each in commit.failed_tiles
            ],
        )

    def quarantine(self, worker_id: str, reason: str, now: float) -> None:
        """Takes no more results of a worker, until somebody releases it."""
        with self._owned():
            if self._database.execute(
                "INSERT OR IGNORE INTO quarantine VALUES (?, ?, ?)", (worker_id, reason, now)
            ):
                self._note(now, worker_id, "quarantined", reason)

    def distrust(self, worker_id: str) -> list[str]:
        """Throws away all tiles with work of a worker; gives their renders.

        A render that had ended is worked on again, until each tile has the samples that it had. Whoever has
        one of them in memory has lost it.
        """
        with self._owned():
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

    def start_anew(self, render_id: str, fence: int) -> None:
        """Throws away all samples of a render that runs, and its floating-point profile. LeaseLost if it is
        another's.

        What it has cost stays counted. Whoever has it in memory has lost it.
        """
        with self.holding(render_id, fence):
            for table in ("tile", "contribution", "failed_tile", "error_point"):
                self._database.execute(f"DELETE FROM {table} WHERE render_id = ?", (render_id,))  # noqa: S608
            self._database.execute(
                """UPDATE render SET floating_point_profile = '', ranges_done = 0, photons = 0, rays = 0,
                invalid_samples = 0,
                       tiles_done = 0, tiles_failed = 0, relative_error = 0, sequence = sequence + 1
                   WHERE id = ?""",
                (render_id,),
            )
            self._database.execute("UPDATE lease SET fence = fence + 1 WHERE render_id = ?", (render_id,))

    def _reopen(self, render_id: str, worker_id: str) -> None:
        tiles = self._database.rows("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
        schedule = self._database.row("SELECT schedule FROM render WHERE id = ?", (render_id,))
        assert schedule is not None  # noqa: S101 - it has tiles
        samples = [0] * TileGrid.of(job_pb2.RangeSchedule.FromString(schedule["schedule"])).count
        for tile in tiles:
            samples[tile["tile_index"]] = tile["samples"]
        self._database.execute(
            """UPDATE render SET state = 'QUEUED', reason = ?, ended = 0, image_final = 0, stop = ?
               WHERE id = ? AND state NOT IN ('FAILED', 'CANCELLED')""",
            (
                f"Work of {worker_id}, found faulty later, is done again.",
                StopConditions(tile_samples=tuple(samples)).to_json(),
                render_id,
            ),
        )

    def write_meters(self, values: Mapping[str, float]) -> None:
        """What this coordinator counts, by name."""
        with self._owned():
            self._database.execute_many(
                "INSERT OR REPLACE INTO meter VALUES (?, ?, ?)",
                [(self.number, name, value) for name, value in values.items()],
            )

    def record_preview(self, render_id: str, fence: int, point: ErrorPoint, in_history: bool) -> None:
        """A new preview is in its place; tells watchers, keeps its error. LeaseLost if it is another's."""
        with self.holding(render_id, fence):
            self._database.execute(
                """UPDATE render SET relative_error = ?, worst_share = ?, effective_pixels = ?,
                       sequence = sequence + 1 WHERE id = ?""",
                (point.relative_error, point.worst_share, point.effective_pixels, render_id),
            )
            if in_history:
                self._database.execute(
                    "INSERT INTO error_point VALUES (?, ?, ?, ?, ?, ?, ?)",
                    (
                        render_id,
                        point.unix_time,
                        point.photons,
                        point.samples,
                        point.relative_error,
                        point.worst_share,
                        point.effective_pixels,
                    ),
                )

    def end(self, render: OpenRender, state: RenderState, reason: str, now: float) -> bool:
        """RUNNING or QUEUED becomes a final state; False if it was paused, cancelled or extended meanwhile.

        The images of one that `has_image` must be in their place. LeaseLost if the render is another's.
        """
        with self.holding(render.id, render.fence):
            changed = self._database.execute(
                """UPDATE render
                   SET state = ?, reason = ?, ended = ?, image_final = ?, photons_per_second = 0,
                       predicted_end = 0, predicted_cpu_seconds = cpu_seconds, sequence = sequence + 1
                   WHERE id = ? AND state IN ('QUEUED', 'RUNNING') AND schedule = ? AND stop = ?""",
                (
                    state.value,
                    reason,
                    now,
                    state.has_image,
                    render.id,
                    render.schedule.SerializeToString(deterministic=True),
                    render.stop.to_json(),
                ),
            )
        return changed == 1

    def images_written(self, render_id: str, fence: int) -> None:
        """An ended render's images show all that was committed. LeaseLost if it is another's."""
        with self.holding(render_id, fence):
            self._database.execute(
                "UPDATE render SET image_final = 1, sequence = sequence + 1 WHERE id = ?", (render_id,)
            )

    def mirror_workers(
        self, workers: list[WorkerRow], at_work: list[tuple[str, int, str]], now: float
    ) -> None:
        """Replaces the list of workers by who lives now, and who has which tile of our renders in hand.

        Keeps who came and went, and about once a minute what all of them together did.
        """
        with self._owned():
            before = {row["id"] for row in self._database.rows("SELECT id FROM worker")}
            alive = {worker.id for worker in workers}
            for worker in sorted(alive - before):
                self._note(now, worker, "joined", "")
            for worker in sorted(before - alive):
                self._note(now, worker, "left", "")
            self._keep_rate(workers, now)
            self._database.execute(
                """DELETE FROM at_work
                   WHERE coordinator = ? OR coordinator NOT IN (SELECT number FROM coordinator)""",
                (self.number,),
            )
            self._database.execute_many(
                # A worker may still have a job of a render that was deleted.
                """INSERT OR IGNORE INTO at_work SELECT ?1, ?2, ?3, ?4
                   WHERE EXISTS (SELECT 1 FROM render WHERE id = ?2)""",
                [(self.number, *each) for each in at_work],
            )
            self._database.execute("DELETE FROM worker")
            self._database.execute_many(
                "INSERT OR REPLACE INTO worker VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
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

    def _note(self, now: float, worker_id: str, what: str, reason: str) -> None:
        note_worker(self._database, now, worker_id, what, reason)

    def _keep_rate(self, workers: list[WorkerRow], now: float) -> None:
        last = self._database.row("SELECT max(unix_time) AS time FROM rate_point")
        if last is not None and last["time"] is not None and now - last["time"] < _RATE_STEP_SECONDS:
            return
        rate = sum(worker.photons_per_second for worker in workers)
        threads = sum(worker.threads for worker in workers)
        self._database.execute("INSERT OR REPLACE INTO rate_point VALUES (?, ?, ?)", (now, threads, rate))
        self._database.execute("DELETE FROM rate_point WHERE unix_time < ?", (now - _RATES_KEPT_SECONDS,))

    @contextmanager
    def _owned(self) -> Iterator[None]:
        with self._database.transaction():
            self._ownership.check()
            yield

    def _open_render(self, row: sqlite3.Row) -> OpenRender:
        failed = self._database.rows(
            "SELECT * FROM failed_tile WHERE render_id = ? ORDER BY tile_index", (row["id"],)
        )
        return OpenRender(
            id=row["id"],
            state=RenderState(row["state"]),
            schedule=job_pb2.RangeSchedule.FromString(row["schedule"]),
            scene_sha256=row["scene_sha256"],
            engine=row["engine"],
            totals=Totals(
                photons=row["photons"],
                rays=row["rays"],
                invalid_samples=row["invalid_samples"],
                cpu_seconds=row["cpu_seconds"],
                audited=row["audited"],
                refused=row["refused"],
            ),
            stop=StopConditions.from_json(row["stop"]),
            priority=row["priority"],
            owner=row["owner"],
            owner_weight=row["owner_weight"],
            ran_seconds=row["ran_seconds"],
            holder=row["holder"],
            fence=row["fence"],
            look_first=Region.from_json(row["look_first"]) if row["look_first"] else None,
            floating_point_profile=row["floating_point_profile"],
            failed_tiles=tuple(
                FailedTile(
                    each["tile_index"],
                    each["first_sample"],
                    each["end_sample"],
                    each["reason"],
                    tuple(json.loads(each["workers"])),
                )
                for each in failed
            ),
        )
