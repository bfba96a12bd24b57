"""What only the coordinator does to the data folder; every write checks that the folder is still its own."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from nocturne.v1 import job_pb2

from .database import Database
from .ownership import Ownership
from .rows import ErrorPoint, RenderState, WorkerRow

_LARGEST = 2**63 - 1
_OPEN_COLUMNS = "id, state, scene_sha256, engine, plan, photons, rays, rejected, cpu_seconds"


@dataclass(frozen=True, slots=True)
class OpenRender:
    """What the coordinator needs to know of a render to work on it."""

    id: str
    state: RenderState
    plan: job_pb2.RenderPlan
    scene_sha256: str
    engine: int
    totals: "Totals"


@dataclass(slots=True)
class Totals:
    """What is counted of a render's merged ranges."""

    ranges: int = 0
    photons: int = 0
    rays: int = 0
    rejected: int = 0
    cpu_seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class TileRow:
    """A tile's merged samples, and their sums as float64, little endian."""

    tile_index: int
    samples: int
    sums: bytes


@dataclass(frozen=True, slots=True)
class RenderCommit:
    """A render's dirty tiles and its totals with them: absolute numbers, doing it twice changes nothing."""

    render_id: str
    tiles: list[TileRow]
    totals: Totals
    photons_per_second: float


class Ledger:
    """The coordinator's pen."""

    def __init__(self, database: Database, ownership: Ownership) -> None:
        self._database = database
        self._ownership = ownership

    # --- reading ---

    def open_renders(self) -> list[OpenRender]:
        """All that have not ended, oldest first."""
        rows = self._database.rows(
            f"SELECT {_OPEN_COLUMNS} FROM render WHERE state IN ('QUEUED', 'RUNNING') ORDER BY number"  # noqa: S608
        )
        return [_open_render(row) for row in rows]

    def ended_without_image(self) -> list[OpenRender]:
        """Those that ended while their images do not show all that was committed."""
        rows = self._database.rows(
            f"""SELECT {_OPEN_COLUMNS} FROM render
                WHERE image_final = 0 AND state NOT IN ('QUEUED', 'RUNNING') ORDER BY number"""  # noqa: S608
        )
        return [_open_render(row) for row in rows]

    def tiles(self, render_id: str) -> Iterator[TileRow]:
        """The committed tiles, one after the other: all at once may be gigabytes."""
        indices = self._database.rows(
            "SELECT tile_index FROM tile WHERE render_id = ? ORDER BY tile_index", (render_id,)
        )
        for index in indices:
            row = self._database.row(
                "SELECT tile_index, samples, sums FROM tile WHERE render_id = ? AND tile_index = ?",
                (render_id, index["tile_index"]),
            )
            if row is not None:
                yield TileRow(**dict(row))

    # --- writing ---

    def start(self, render_id: str, now: float) -> bool:
        """QUEUED becomes RUNNING; False if it is not queued any more."""
        with self._owned():
            changed = self._database.execute(
                """UPDATE render SET state = 'RUNNING', started = ?, sequence = sequence + 1
                   WHERE id = ? AND state = 'QUEUED'""",
                (now, render_id),
            )
        return changed == 1

    def commit(self, commits: list[RenderCommit]) -> None:
        """All of it in one transaction; a render that is not RUNNING any more keeps what it has."""
        with self._owned():
            for commit in commits:
                if self._write_totals(commit):
                    self._write_tiles(commit)

    def _write_totals(self, commit: RenderCommit) -> bool:
        totals = commit.totals
        changed = self._database.execute(
            """UPDATE render SET ranges_done = ?, photons = ?, rays = ?, rejected = ?, cpu_seconds = ?,
                   photons_per_second = ?, sequence = sequence + 1
               WHERE id = ? AND state = 'RUNNING'""",
            (
                totals.ranges,
                totals.photons,
                min(totals.rays, _LARGEST),
                totals.rejected,
                totals.cpu_seconds,
                commit.photons_per_second,
                commit.render_id,
            ),
        )
        return changed == 1

    def _write_tiles(self, commit: RenderCommit) -> None:
        self._database.execute_many(
            """INSERT INTO tile (render_id, tile_index, samples, sums) VALUES (?, ?, ?, ?)
               ON CONFLICT DO UPDATE SET samples = excluded.samples, sums = excluded.sums""",
            [(commit.render_id, tile.tile_index, tile.samples, tile.sums) for tile in commit.tiles],
        )

    def record_preview(self, render_id: str, point: ErrorPoint, in_history: bool) -> None:
        """A new preview is in its place; tells watchers, and keeps its error."""
        with self._owned():
            self._database.execute(
                "UPDATE render SET relative_error = ?, sequence = sequence + 1 WHERE id = ?",
                (point.relative_error, render_id),
            )
            if in_history:
                self._database.execute(
                    "INSERT INTO error_point VALUES (?, ?, ?, ?, ?)",
                    (render_id, point.unix_time, point.photons, point.samples, point.relative_error),
                )

    def end(self, render_id: str, state: RenderState, reason: str, now: float) -> None:
        """RUNNING or QUEUED becomes a final state; a SUCCEEDED render's images must be in their place."""
        with self._owned():
            self._database.execute(
                """UPDATE render
                   SET state = ?, reason = ?, ended = ?, image_final = ?, sequence = sequence + 1
                   WHERE id = ? AND state IN ('QUEUED', 'RUNNING')""",
                (state.value, reason, now, state is RenderState.SUCCEEDED, render_id),
            )

    def images_written(self, render_id: str) -> None:
        """An ended render's images show all that was committed."""
        with self._owned():
            self._database.execute(
                "UPDATE render SET image_final = 1, sequence = sequence + 1 WHERE id = ?", (render_id,)
            )

    def mirror_workers(self, workers: list[WorkerRow]) -> None:
        """Replaces the list of workers by who lives now."""
        with self._owned():
            self._database.execute("DELETE FROM worker")
            self._database.execute_many(
                "INSERT OR REPLACE INTO worker VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
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
                    )
                    for w in workers
                ],
            )

    @contextmanager
    def _owned(self) -> Iterator[None]:
        with self._database.transaction():
            self._ownership.check()
            yield


def _open_render(row: sqlite3.Row) -> OpenRender:
    return OpenRender(
        id=row["id"],
        state=RenderState(row["state"]),
        plan=job_pb2.RenderPlan.FromString(row["plan"]),
        scene_sha256=row["scene_sha256"],
        engine=row["engine"],
        totals=Totals(
            photons=row["photons"], rays=row["rays"], rejected=row["rejected"], cpu_seconds=row["cpu_seconds"]
        ),
    )
