"""What a coordinator writes of a render that it holds: sums, errors, states. LeaseLost where it does not."""

import json

from nocturne.v1 import job_pb2
from nocturne_scene.ranges import ranges_planned

from nocturne_coordinator.dispatch.records import ErrorPoint, OpenRender, RenderCommit, RenderState
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.leases import Leases

_LARGEST = 2**63 - 1


class Commits:
    """A coordinator's writes to the renders of a data folder."""

    def __init__(self, database: Database, leases: Leases) -> None:
        self._database = database
        self._leases = leases

    def start(self, render_id: str, fence: int, now: float) -> bool:
        """QUEUED becomes RUNNING; False if it is not queued any more. LeaseLost if it is another's."""
        with self._leases.holding(render_id, fence):
            changed = self._database.execute(
                """UPDATE render SET state = 'RUNNING', started = iif(started > 0, started, ?), reason = '',
                       image_final = 0, sequence = sequence + 1
                   WHERE id = ? AND state = 'QUEUED'""",
                (now, render_id),
            )
        return changed == 1

    def commit(self, commits: list[RenderCommit]) -> list[str]:
        """All of it in one transaction; a render that has ended meanwhile keeps its state.

        Gives the renders that are another coordinator's now, of which nothing is written.
        """
        lost = []
        with self._leases.owned():
            for commit in commits:
                if not self._leases.holds(commit.render_id, commit.fence):
                    lost.append(commit.render_id)
                elif self._write_totals(commit):
                    self._write_tiles(commit)
                    self._write_failed_tiles(commit)
        return lost

    def _write_totals(self, commit: RenderCommit) -> bool:
        totals = commit.totals
        changed = self._database.execute(
            """UPDATE render SET ranges_done = ?, photons = ?, rays = ?, invalid_samples = ?,
                   truncated_paths = ?, photon_bundles = ?, cpu_seconds = ?,
                   audited = ?, unaudited = ?, refused = ?,
                   photons_per_second = iif(state = 'RUNNING', ?, 0), ran_seconds = ?, tiles_done = ?,
                   tiles_failed = ?, predicted_end = ?, predicted_cpu_seconds = ?,
                   target_unreachable = iif(state = 'RUNNING', ?, ''), floating_point_profile = ?,
                   sequence = sequence + 1
               WHERE id = ? AND state IN ('QUEUED', 'RUNNING', 'PAUSED')""",
            (
                totals.ranges,
                totals.photons,
                min(totals.rays, _LARGEST),
                totals.invalid_samples,
                min(totals.truncated_paths, _LARGEST),
                commit.photon_bundles,
                totals.cpu_seconds,
                totals.audited,
                totals.unaudited,
                totals.refused,
                commit.photons_per_second,
                commit.ran_seconds,
                commit.tiles_done,
                len(tuple(commit.failed_tiles)),
                commit.forecast.end,
                commit.forecast.cpu_seconds,
                commit.forecast.target_unreachable,
                commit.floating_point_profile,
                commit.render_id,
            ),
        )
        return changed == 1

    def _write_tiles(self, commit: RenderCommit) -> None:
        self._database.execute_many(
            """INSERT INTO tile (render_id, tile_index, samples, sums, invalid_samples, error_before, own,
                   photons, revision)
               VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, (SELECT sequence FROM render WHERE id = ?1))
               ON CONFLICT (render_id, tile_index)
               DO UPDATE SET samples = excluded.samples, sums = excluded.sums,
                   invalid_samples = excluded.invalid_samples, error_before = excluded.error_before,
                   own = iif(length(excluded.own) > 0, excluded.own, tile.own),
                   photons = iif(length(excluded.photons) > 0, excluded.photons, tile.photons),
                   revision = excluded.revision""",
            (
                (
                    commit.render_id,
                    tile.tile_index,
                    tile.samples,
                    tile.sums,
                    tile.invalid_samples,
                    tile.error_before,
                    tile.own,
                    tile.photons,
                )
                for tile in commit.tiles
            ),
        )
        self._database.execute_many(
            "INSERT INTO contribution VALUES (?, ?, ?) ON CONFLICT DO NOTHING",
            [
                (commit.render_id, tile, worker)
                for tile, workers in commit.contributors.items()
                for worker in workers
            ],
        )

    def _write_failed_tiles(self, commit: RenderCommit) -> None:
        self._database.execute_many(
            """INSERT INTO failed_tile VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (render_id, tile_index)
               DO UPDATE SET first_sample = excluded.first_sample, end_sample = excluded.end_sample,
                   reason = excluded.reason, workers = excluded.workers""",
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

    def record_preview(self, render_id: str, fence: int, point: ErrorPoint, in_history: bool) -> None:
        """A new preview is in its place; tells watchers, keeps its error. LeaseLost if it is another's."""
        with self._leases.holding(render_id, fence):
            self._database.execute(
                """UPDATE render SET relative_error = ?, top_percent_share = ?, effective_pixels = ?,
                       mean = ?, mean_error = ?, zero_pixels = ?, error_warning = ?, sequence = sequence + 1
                   WHERE id = ?""",
                (
                    point.relative_error,
                    point.top_percent_share,
                    point.effective_pixels,
                    point.mean,
                    point.mean_error,
                    point.zero_pixels,
                    point.error_warning,
                    render_id,
                ),
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
                        point.top_percent_share,
                        point.effective_pixels,
                    ),
                )

    def end(self, render: OpenRender, state: RenderState, reason: str, now: float) -> bool:
        """RUNNING or QUEUED becomes a final state; False if it was paused, cancelled or extended meanwhile.

        The images of one that `has_image` must be in their place. LeaseLost if the render is another's.
        """
        with self._leases.holding(render.id, render.fence, durable=True):
            changed = self._database.execute(
                """UPDATE render
                   SET state = ?, reason = ?, ended = ?, image_final = ?, photons_per_second = 0,
                       predicted_end = 0, predicted_cpu_seconds = cpu_seconds, target_unreachable = '',
                       sequence = sequence + 1
                   WHERE id = ? AND state IN ('QUEUED', 'RUNNING') AND schedule = ? AND stop = ?""",
                (
                    state.value,
                    reason,
                    now,
                    int(state.has_image),
                    render.id,
                    render.schedule.SerializeToString(deterministic=True),
                    render.stop.to_json(),
                ),
            )
        return changed == 1

    def recut(self, render: OpenRender, schedule: job_pb2.RangeSchedule) -> bool:
        """A render that runs has a schedule of the same samples in shorter ranges; False if it does not run
        any more, or was extended meanwhile. LeaseLost if it is another's."""
        with self._leases.holding(render.id, render.fence):
            changed = self._database.execute(
                """UPDATE render SET schedule = ?, ranges_planned = ?, sequence = sequence + 1
                   WHERE id = ? AND state = 'RUNNING' AND schedule = ?""",
                (
                    schedule.SerializeToString(deterministic=True),
                    ranges_planned(schedule),
                    render.id,
                    render.schedule.SerializeToString(deterministic=True),
                ),
            )
        return changed == 1

    def images_written(self, render_id: str, fence: int) -> None:
        """An ended render's images show all that was committed. LeaseLost if it is another's."""
        with self._leases.holding(render_id, fence, durable=True):
            self._database.execute(
                "UPDATE render SET image_final = 1, sequence = sequence + 1 WHERE id = ?", (render_id,)
            )

    def start_anew(self, render_id: str, fence: int) -> None:
        """Throws away all samples of a render that runs, and its floating-point profile. LeaseLost if it is
        another's.

        Its cost so far stays counted. Whoever has it in memory has lost it.
        """
        with self._leases.holding(render_id, fence):
            for table in ("tile", "contribution", "failed_tile", "error_point"):
                self._database.execute(f"DELETE FROM {table} WHERE render_id = ?", (render_id,))  # noqa: S608
            self._database.execute(
                """UPDATE render SET floating_point_profile = '', ranges_done = 0, photons = 0, rays = 0,
                       invalid_samples = 0, truncated_paths = 0, photon_bundles = 0, tiles_done = 0,
                       tiles_failed = 0,
                       relative_error = 0, mean = 0, mean_error = 0, zero_pixels = 0, error_warning = '',
                       sequence = sequence + 1
                   WHERE id = ?""",
                (render_id,),
            )
            self._database.execute("UPDATE lease SET fence = fence + 1 WHERE render_id = ?", (render_id,))
