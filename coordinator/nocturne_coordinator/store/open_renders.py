"""Renders as coordinators read them, and taking them over."""

import json
from collections.abc import Iterator

from nocturne.v1 import job_pb2

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.records import FailedTile, OpenRender, RenderState, TileRow, Totals
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.store.database import Database, Row
from nocturne_coordinator.store.groups import WAITS
from nocturne_coordinator.store.layers import LAYERS_DUE
from nocturne_coordinator.store.leases import Leases

_COLUMNS = f"""id, state, scene_sha256, engine, schedule, photons, rays, invalid_samples, truncated_paths,
    cpu_seconds, audited, unaudited, refused, stop, priority, owner, ran_seconds, look_first,
    floating_point_profile, layers_sha256, {LAYERS_DUE} AS layers_due,
    EXISTS (SELECT 1 FROM failed_tile WHERE render_id = render.id) AS has_failed_tiles,
    coalesce((SELECT weight FROM token WHERE token.name = render.owner), 100) AS owner_weight,
    coalesce((SELECT fence FROM lease WHERE lease.render_id = render.id), 0) AS fence,
    coalesce((SELECT coordinator.number FROM lease JOIN coordinator ON coordinator.number = lease.coordinator
              WHERE lease.render_id = render.id
                  AND coordinator.until >= (julianday('now') - 2440587.5) * 86400.0), 0) AS holder"""  # noqa: S608 - our own condition

_INDEXED = "(state IN ('QUEUED', 'RUNNING') OR image_final = 0)"
"""True of all that are open; in the words of the index `render_open`, without which all renders are read."""


class OpenRenders:
    """The renders of a data folder that a coordinator works on, or could."""

    def __init__(self, database: Database, leases: Leases) -> None:
        self._database = database
        self._leases = leases

    def all(self) -> list[OpenRender]:
        """All that run, and of each owner those that are next: by priority, then oldest first."""
        rows = self._database.rows(
            f"""SELECT {_COLUMNS} FROM render WHERE id IN (
                    SELECT id FROM render WHERE state = 'RUNNING' AND {_INDEXED}
                    UNION SELECT id FROM lease JOIN render ON id = render_id
                        WHERE coordinator <> 0 AND state = 'QUEUED'
                    UNION SELECT id FROM (
                        SELECT id, row_number() OVER of_owner AS place FROM render
                        WHERE state = 'QUEUED' AND NOT ({WAITS})
                        WINDOW of_owner AS (PARTITION BY owner ORDER BY priority DESC, number)
                    ) AS placed WHERE place <= ?)
                ORDER BY priority DESC, number""",  # noqa: S608
            (limits.MAX_NEXT_OF_OWNER,),
        )
        return [_open_render(self._database, row) for row in rows]

    def ended_without_image(self) -> list[OpenRender]:
        """Those that ended, or pause, while their images do not show all that was committed, and layers are
        not waited for."""
        # The plus: sorting these few is less than reading all renders in the order of their numbers.
        rows = self._database.rows(
            f"""SELECT {_COLUMNS} FROM render
                WHERE image_final = 0 AND state NOT IN ('QUEUED', 'RUNNING') AND NOT ({LAYERS_DUE})
                ORDER BY +number"""  # noqa: S608
        )
        return [_open_render(self._database, row) for row in rows]

    def is_open(self, render_id: str) -> bool:
        """Whether some coordinator works on the render, or is to."""
        return (
            self._database.row(
                "SELECT 1 FROM render WHERE id = ? AND state IN ('QUEUED', 'RUNNING')", (render_id,)
            )
            is not None
        )

    def take(self, render_id: str) -> OpenRender | None:
        """The render as it is now, with a new fence: ours from here on. None if another one works on it."""
        with self._leases.owned():
            found = find_render(self._database, render_id)
            if found is None or found.holder not in (0, self._leases.number):
                return None
            self._leases.take(render_id)
            return find_render(self._database, render_id)

    def tiles(self, render_id: str) -> Iterator[TileRow]:
        """See tiles_of."""
        return tiles_of(self._database, render_id)


def find_render(database: Database, render_id: str) -> OpenRender | None:
    """A render as it is; None: there is none."""
    row = database.row(f"SELECT {_COLUMNS} FROM render WHERE id = ?", (render_id,))  # noqa: S608
    return None if row is None else _open_render(database, row)


def tiles_of(database: Database, render_id: str) -> Iterator[TileRow]:
    """The committed tiles, one after the other: all at once may be gigabytes. Last ones first: forward
    photons are counted after the last."""
    indices = database.rows(
        "SELECT tile_index FROM tile WHERE render_id = ? ORDER BY tile_index DESC", (render_id,)
    )
    for index in indices:
        row = database.row(
            """SELECT tile_index, samples, sums, invalid_samples, error_before, own, photons FROM tile
               WHERE render_id = ? AND tile_index = ?""",
            (render_id, index["tile_index"]),
        )
        if row is not None:
            yield TileRow(**dict(row))


def _open_render(database: Database, row: Row) -> OpenRender:
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
            truncated_paths=row["truncated_paths"],
            cpu_seconds=row["cpu_seconds"],
            audited=row["audited"],
            unaudited=row["unaudited"],
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
        layers_sha256=row["layers_sha256"],
        layers_due=bool(row["layers_due"]),
        failed_tiles=_failed_tiles(database, row["id"]) if row["has_failed_tiles"] else (),
    )


def _failed_tiles(database: Database, render_id: str) -> tuple[FailedTile, ...]:
    rows = database.rows("SELECT * FROM failed_tile WHERE render_id = ? ORDER BY tile_index", (render_id,))
    return tuple(
        FailedTile(
            row["tile_index"],
            row["first_sample"],
            row["end_sample"],
            row["reason"],
            tuple(json.loads(row["workers"])),
        )
        for row in rows
    )
