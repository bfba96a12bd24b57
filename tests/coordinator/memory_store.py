"""The data folder in memory, as far as coordinators use it: its real database, by a virtual clock."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.records import FailedTile, OpenRender, RenderCommit, RenderState, TileRow
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.store.blob_use import Removals
from nocturne_coordinator.store.commits import Commits
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.leases import Leases
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.open_renders import OpenRenders, find_render
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.render_requests import RenderRequests
from nocturne_coordinator.store.renders import Renders
from nocturne_coordinator.store.sqlite import SqliteDatabase
from nocturne_coordinator.store.tiles import Tiles
from nocturne_coordinator.store.workers import Workers
from nocturne_scene.ranges import ranges_planned

from tests.coordinator.memory_queue import VirtualClock

SCENE = "5c" * 32

_UNIX_EPOCH = 2440587.5
"""As a Julian date."""


class MemoryDatabase(SqliteDatabase):
    """In memory; a test may make it full."""

    def __init__(self, clock: VirtualClock) -> None:
        self.is_full = False
        super().__init__(Path(":memory:"))
        # In place of SQLite's own: queries ask whose lease holds now.
        self._connection.create_function("julianday", 1, lambda _: _UNIX_EPOCH + clock.moment().unix / 86400)

    @contextmanager
    def transaction(self, durable: bool = True) -> Iterator[None]:
        if self.is_full:
            raise sqlite3.OperationalError("database or disk is full")
        with super().transaction(durable):
            yield


class Stored:
    """A render as the folder has it."""

    def __init__(self, store: "Store", render_id: str) -> None:
        self._store, self._id = store, render_id
        self._leases = cast(Leases, None)

    @property
    def row(self) -> OpenRender:
        row = find_render(self._store.database, self._id)
        assert row is not None
        return row

    @property
    def tiles(self) -> dict[int, TileRow]:
        rows = OpenRenders(self._store.database, self._leases).tiles(self._id)
        return {tile.tile_index: tile for tile in rows}

    @property
    def contributors(self) -> dict[int, set[str]]:
        found: dict[int, set[str]] = {}
        for row in self._store.database.rows("SELECT * FROM contribution WHERE render_id = ?", (self._id,)):
            found.setdefault(row["tile_index"], set()).add(row["worker_id"])
        return found

    @property
    def planned(self) -> PlannedRender:
        schedule = self._store.renders.schedule(self._id)
        return PlannedRender(self._id, schedule, bytes.fromhex(SCENE), job_pb2.ENGINE_CURRENT)

    @property
    def state(self) -> RenderState:
        return self._store.renders.get(self._id).state

    @property
    def reason(self) -> str:
        return self._store.renders.get(self._id).reason

    @property
    def ranges_done(self) -> int:
        return self._store.renders.get(self._id).ranges_done

    @property
    def ranges_planned(self) -> int:
        return self._store.renders.get(self._id).ranges_planned


class Store(DataFolder):
    """What all coordinators of a folder share."""

    def __init__(self, clock: VirtualClock) -> None:
        self.clock = clock
        self.database: MemoryDatabase = MemoryDatabase(clock)
        self.tiles = Tiles(self.database)
        self.renders = Renders(self.database, lambda _: None)
        self.requests = RenderRequests(self.database, self.renders, self.tiles)
        self.workers = Workers(self.database)
        self.removals = Removals(self.database)
        self.bundles: list[tuple[str, FailedTile]] = []
        self.images: dict[str, dict[int, tuple[int, bytes]]] = {}
        """Final ones, by render: of each tile its samples and sums."""

    @property
    def stored(self) -> dict[str, Stored]:
        rows = self.database.rows("SELECT id FROM render ORDER BY number")
        return {row["id"]: Stored(self, row["id"]) for row in rows}

    @property
    def bad_workers(self) -> list[str]:
        return list(self.workers.in_quarantine())

    def change(self, render_id: str, **values: Any) -> None:
        """A request of people, or a remainder of an older version, whatever the render's state."""
        if weight := values.pop("owner_weight", None):
            owner = values["owner"]
            self.database.execute(
                "INSERT OR REPLACE INTO token VALUES (?, ?, '[]', ?, 0.0, 0.0)", (owner, owner, weight)
            )
        for name, value in values.items():
            match value:
                case job_pb2.RangeSchedule():
                    self.change(render_id, ranges_planned=ranges_planned(value), samples=value.range_ends[-1])
                    value = value.SerializeToString(deterministic=True)
                case StopConditions():
                    value = value.to_json()
                case RenderState():
                    value = value.value
            self.database.execute(
                f"UPDATE render SET {name} = ?, sequence = sequence + 1 WHERE id = ?",  # noqa: S608
                (value, render_id),
            )

    def delete(self, render_id: str) -> None:
        self.database.execute("DELETE FROM at_work WHERE render_id = ?", (render_id,))
        self.database.execute("DELETE FROM render WHERE id = ?", (render_id,))


class MemoryOwnership(Ownership):
    """Without the files that are locked."""

    def __init__(self, store: Store, alone: bool) -> None:
        self._database, self.lease_seconds, self.shared = store.database, 10.0, True
        self._register(alone, store.clock.moment().unix)


class CheckedCommits(Commits):
    """Nothing that is committed goes back."""

    def _write_tiles(self, commit: RenderCommit) -> None:
        before = self._samples(commit.render_id)
        super()._write_tiles(commit)
        after = self._samples(commit.render_id)
        assert all(after[tile] >= samples for tile, samples in before.items())

    def _samples(self, render_id: str) -> dict[int, int]:
        rows = self._database.rows("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
        return {row["tile_index"]: row["samples"] for row in rows}


class MemoryLedger(Ledger):
    """The store as one coordinator writes it."""

    def __init__(self, store: Store, alone: bool) -> None:
        super().__init__(store.database, MemoryOwnership(store, alone))
        self.commits = CheckedCommits(store.database, self.leases)


class MemoryPreviews(Previews):
    """Keeps what would be written."""

    def __init__(self, store: Store, ledger: Ledger) -> None:
        super().__init__(store, ledger)
        self._store = store
        self.written = 0

    def write_preview(self, render: RunningRender, final: bool = False) -> None:
        with self._ledger.leases.holding(render.id, render.row.fence):
            self.written += 1

    def write_thumbnail(self, render: RunningRender) -> None:
        self.write_preview(render)

    def write_image(self, render: RunningRender) -> None:
        with self._ledger.leases.holding(render.id, render.row.fence):
            self._store.images[render.id] = {
                index: (render.film.samples(index), render.film.tile_bytes(index))
                for index in range(len(render.film.queues))
            }

    def write_bundle(self, render: RunningRender, failed: FailedTile) -> None:
        self._store.bundles.append((render.id, failed))
