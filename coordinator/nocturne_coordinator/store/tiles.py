"""The committed tiles of renders, as those who watch them read them."""

from nocturne.v1 import job_pb2
from nocturne_scene.errors import NotFound
from nocturne_scene.ranges import manifest_of

from nocturne_coordinator.store.database import Database, Row
from nocturne_coordinator.store.rows import TileChange


class Tiles:
    """The tiles of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def changed(self, render_id: str, since: tuple[int, int], limit: int) -> list[TileChange]:
        """Tiles whose (revision, index) is above `since`, in that order, at most `limit`.

        Asking again with the last one's gives the rest: a tile that changes meanwhile comes once more, later.
        """
        rows = self._database.rows(
            """SELECT tile_index, revision, samples, invalid_samples FROM tile
               WHERE render_id = ? AND (revision, tile_index) > (?, ?) AND length(sums) > 0
               ORDER BY revision, tile_index LIMIT ?""",
            (render_id, *since, limit),
        )
        return [TileChange(**dict(row)) for row in rows]

    def sums(self, render_id: str, since: tuple[int, int], limit: int) -> list[tuple[TileChange, bytes]]:
        """The same tiles with their sums; see nocturne_scene.tile_sums."""
        rows = self._database.rows(
            """SELECT tile_index, revision, samples, invalid_samples, sums FROM tile
               WHERE render_id = ? AND (revision, tile_index) > (?, ?) AND length(sums) > 0
               ORDER BY revision, tile_index LIMIT ?""",
            (render_id, *since, limit),
        )
        return [_with_sums(row) for row in rows]

    def between(self, render_id: str, first: int, end: int) -> list[tuple[TileChange, bytes]]:
        """Tiles with indices in [first, end) that have samples, with their sums."""
        rows = self._database.rows(
            """SELECT tile_index, revision, samples, invalid_samples, sums FROM tile
               WHERE render_id = ? AND tile_index >= ? AND tile_index < ? AND length(sums) > 0
               ORDER BY tile_index""",
            (render_id, first, end),
        )
        return [_with_sums(row) for row in rows]

    def manifest(self, render_id: str) -> tuple[int, ...]:
        """Committed samples of each tile, row by row, and bundles of forward photons if there are any; raises
        NotFound."""
        render = self._database.row("SELECT schedule FROM render WHERE id = ?", (render_id,))
        if render is None:
            raise NotFound(f"there is no render {render_id!r}")
        rows = self._database.rows("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
        schedule = job_pb2.RangeSchedule.FromString(render["schedule"])
        return tuple(manifest_of(schedule, map(tuple, rows)))

    def at_work(self, render_id: str) -> list[tuple[int, str]]:
        """Tiles of a render that are being traced, and by whom; forward photons of all of them are none."""
        rows = self._database.rows(
            """SELECT tile_index, worker_id FROM at_work JOIN render ON render.id = render_id
               WHERE render_id = ? AND tile_index != render.tiles ORDER BY tile_index""",
            (render_id,),
        )
        return [(row["tile_index"], row["worker_id"]) for row in rows]

    def work_of_workers(self, owner: str | None) -> list[tuple[str, str, str, int, float]]:
        """For each worker and render that it traces: worker, render, name, tiles, and since when it has the
        oldest of these. Of one owner's renders only, or of all."""
        rows = self._database.rows(
            """SELECT worker_id, render.id, render.name, count(*), min(since)
               FROM at_work JOIN render ON render.id = at_work.render_id
               WHERE render.owner = coalesce(?1, render.owner)
               GROUP BY worker_id, render.id, render.name ORDER BY worker_id, min(since)""",
            (owner,),
        )
        return [(row[0], row[1], row[2], row[3], row[4]) for row in rows]


def _with_sums(row: Row) -> tuple[TileChange, bytes]:
    change = TileChange(row["tile_index"], row["revision"], row["samples"], row["invalid_samples"])
    return change, row["sums"]
