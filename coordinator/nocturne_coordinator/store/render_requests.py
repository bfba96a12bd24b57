"""Requests of people for an existing render: each is a change of its row, which coordinators see.

Asking twice is asking once.
"""

import json
import time
from collections.abc import Sequence

from nocturne_scene.ranges import extended_schedule, ranges_planned

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.errors import WrongState
from nocturne_coordinator.store.blob_use import BlobUse
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.quotas import NO_QUOTA, Quota, check_quota
from nocturne_coordinator.store.renders import Renders, check_priority
from nocturne_coordinator.store.rows import NewRender, RenderRow
from nocturne_coordinator.store.tags import checked_tags
from nocturne_coordinator.store.tiles import Tiles


class RenderRequests:
    """Cancel, pause, resume, extend and so on, for the renders of a data folder."""

    def __init__(self, database: Database, renders: Renders, tiles: Tiles) -> None:
        self._database = database
        self._blob_use = BlobUse(database)
        self._renders = renders
        self._tiles = tiles

    def cancel(self, render_id: str) -> RenderRow:
        """Cancels the render if it has not ended; sums committed so far stay, later ones are refused.

        Works without a coordinator; one that runs stops the work and writes the final image within a second.
        Raises NotFound.
        """
        self._database.execute(
            """UPDATE render SET state = 'CANCELLED', reason = 'Cancelled by request.', ended = ?,
                   photons_per_second = 0, target_unreachable = '', sequence = sequence + 1
               WHERE id = ? AND state IN ('QUEUED', 'RUNNING', 'PAUSED')""",
            (time.time(), render_id),
        )
        return self._renders.get(render_id)

    def pause(self, render_id: str) -> RenderRow:
        """No more work on a queued or running render until it is resumed; merged results are kept.

        Pausing twice is pausing once. Raises NotFound, and WrongState for a render that has ended.
        """
        self._change_state(render_id, "PAUSED", "Paused by request.", ("QUEUED", "RUNNING"))
        return self._now_in(render_id, (RenderState.PAUSED,), "paused")

    def resume(self, render_id: str) -> RenderRow:
        """Goes on with a paused render; with a degraded one, by tracing its failed tiles again.

        Resuming twice is resuming once. Raises NotFound, and WrongState for a render in another state.
        """
        with self._database.transaction():
            self._database.execute(
                """DELETE FROM failed_tile WHERE render_id IN
                   (SELECT id FROM render WHERE id = ? AND state = 'DEGRADED')""",
                (render_id,),
            )
            self._change_state(render_id, "QUEUED", "", ("PAUSED", "DEGRADED"))
        return self._now_in(render_id, (RenderState.QUEUED, RenderState.RUNNING), "resumed")

    def set_priority(self, render_id: str, priority: int) -> RenderRow:
        """The render's weight among its owner's. Raises NotFound, and InputError for a wrong priority."""
        check_priority(priority)
        self._database.execute(
            "UPDATE render SET priority = ?, sequence = sequence + 1 WHERE id = ? AND priority <> ?",
            (priority, render_id, priority),
        )
        return self._renders.get(render_id)

    def set_tags(self, render_id: str, tags: Sequence[str]) -> RenderRow:
        """Other tags instead of those that it had. Raises NotFound, InputError."""
        text = json.dumps(checked_tags(tags), ensure_ascii=False)
        self._database.execute(
            "UPDATE render SET tags = ?, sequence = sequence + 1 WHERE id = ? AND tags <> ?",
            (text, render_id, text),
        )
        return self._renders.get(render_id)

    def look_first(self, render_id: str, region: Region | None) -> RenderRow:
        """Which part of the film gets its samples first; None: all alike. Raises NotFound, InputError."""
        render = self._renders.get(render_id)
        if region is not None:
            region.check(render.width, render.height)
        text = region.to_json() if region else ""
        self._database.execute(
            "UPDATE render SET look_first = ?, sequence = sequence + 1 WHERE id = ? AND look_first <> ?",
            (text, render_id, text),
        )
        return self._renders.get(render_id)

    def extend(
        self, render_id: str, samples: int, stop: StopConditions, quota: Quota = NO_QUOTA
    ) -> RenderRow:
        """More samples, or other conditions, for a render in any state but FAILED; nothing is traced again.

        `samples` is what each pixel is to have in all, at least as many as before; the conditions replace
        those before. Repeating it changes nothing. Raises NotFound, InputError, WrongState and QuotaUsedUp.
        """
        with self._database.transaction():
            render = self._renders.get(render_id)
            if render.state is RenderState.FAILED:
                raise WrongState(f"{render_id} has failed, and can't be extended: {render.reason}")
            schedule = extended_schedule(self._renders.schedule(render_id), samples)
            if (samples, stop.request()) == (render.samples, render.stop.request()):
                return render
            goes_on = render.state in (RenderState.RUNNING, RenderState.PAUSED)
            self._database.execute("DELETE FROM failed_tile WHERE render_id = ?", (render_id,))
            self._database.execute(
                """UPDATE render SET samples = ?, schedule = ?, stop = ?, ranges_planned = ?, state = ?,
                    reason = '', ended = 0, image_final = 0, target_unreachable = '',
                    unreachable_reported = 0, sequence = sequence + 1 WHERE id = ?""",
                (
                    samples,
                    schedule.SerializeToString(deterministic=True),
                    stop.to_json(),
                    ranges_planned(schedule),
                    render.state.value if goes_on else "QUEUED",
                    render_id,
                ),
            )
            check_quota(self._database, render.owner, quota)
        return self._renders.get(render_id)

    def replay(self, render_id: str, request_id: str, owner: str = "", quota: Quota = NO_QUOTA) -> RenderRow:
        """A render of the same scene and schedule, with the samples that each tile has now, by workers of the
        same floating-point profile: it gives the same bits.

        Raises NotFound, WrongState where there are no samples, Conflict and QuotaUsedUp.
        """
        original = self._renders.get(render_id)
        manifest = self._tiles.manifest(render_id)
        if not any(manifest):
            raise WrongState(f"{render_id} has no samples yet")
        return self._renders.create(
            NewRender(
                request_id=request_id,
                name=f"{original.name[: limits.MAX_NAME - 10]} (replay)",
                scene_sha256=original.scene_sha256,
                scene_document=self._renders.scene_document(render_id),
                width=original.width,
                height=original.height,
                samples=original.samples,
                schedule=self._renders.schedule(render_id),
                stop=StopConditions(tile_samples=manifest),
                owner=owner,
                floating_point_profile=original.floating_point_profile,
                warnings=original.warnings,
                way=original.way,
                sensor=original.sensor,
                layers=original.layers,
                layers_sha256=original.layers_sha256,
                tags=original.tags,
                further_files=self._blob_use.of(render_id),
            ),
            quota,
        )

    def _change_state(self, render_id: str, to: str, reason: str, of: tuple[str, ...]) -> None:
        """Ends what predicts, as nothing runs in any state that people ask for."""
        marks = ", ".join("?" * len(of))
        self._database.execute(
            f"""UPDATE render SET state = ?, reason = ?, ended = 0, image_final = 0, photons_per_second = 0,
                    predicted_end = 0, target_unreachable = '', sequence = sequence + 1
                WHERE id = ? AND state IN ({marks})""",  # noqa: S608
            (to, reason, render_id, *of),
        )

    def _now_in(self, render_id: str, states: tuple[RenderState, ...], what: str) -> RenderRow:
        render = self._renders.get(render_id)
        if render.state not in states:
            raise WrongState(f"{render_id} is {render.state} and can't be {what}")
        return render
