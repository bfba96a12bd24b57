"""The data folder in memory, as far as coordinators use it."""

import copy
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.planned_render import PlannedRender
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
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.errors import LeaseLost, OwnershipLost
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger

from tests.coordinator.memory_queue import VirtualClock

SCENE = "5c" * 32


@dataclass
class Stored:
    """A render as the data folder has it."""

    row: OpenRender
    tiles: dict[int, TileRow] = field(default_factory=dict)
    contributors: dict[int, set[str]] = field(default_factory=dict)
    coordinator: int = 0
    reason: str = ""
    final_image: dict[int, tuple[int, bytes]] | None = None
    errors: list[ErrorPoint] = field(default_factory=list)

    @property
    def planned(self) -> PlannedRender:
        return PlannedRender(self.row.id, self.row.schedule, bytes.fromhex(SCENE), job_pb2.ENGINE_CURRENT)

    @property
    def ranges_done(self) -> int:
        return sum(self.planned.ranges.merged_at(tile.samples) for tile in self.tiles.values())

    @property
    def ranges_planned(self) -> int:
        return self.planned.grid.count * len(self.planned.ranges)


class Store(DataFolder):
    """What all coordinators of a folder share."""

    def __init__(self, clock: VirtualClock) -> None:
        self.clock = clock
        self.stored: dict[str, Stored] = {}
        self.bad_workers: dict[str, str] = {}
        self.until: dict[int, float] = {}
        self.changes = 0
        self.is_full = False
        self.owner_epoch = 1
        self.bundles: list[tuple[str, FailedTile]] = []

    def change_counter(self) -> int:
        return self.changes

    def change(self, render_id: str, **values: object) -> None:
        stored = self.stored[render_id]
        stored.row = replace(stored.row, **values)  # type: ignore[arg-type]
        self.changes += 1


class MemoryLedger(Ledger):
    """The store as one coordinator writes it; every commit is compared with the sequential merge."""

    def __init__(self, store: Store, number: int) -> None:
        self._store, self._number = store, number
        self._epoch = store.owner_epoch
        # One class stands in for all parts of the ledger.
        parts: Any = self
        self.leases = self.renders = self.commits = self.workers = parts
        self._store.until[number] = store.clock.moment().unix + 10.0

    @property
    def number(self) -> int:
        return self._number

    @property
    def lease_seconds(self) -> float:
        return 10.0

    @contextmanager
    def _owned(self) -> Iterator[None]:
        if self._store.owner_epoch != self._epoch:
            raise OwnershipLost("another coordinator has taken over the data folder")
        if self._store.is_full:
            raise sqlite3.OperationalError("database or disk is full")
        yield
        self._store.changes += 1

    def _holder(self, stored: Stored) -> int:
        alive = self._store.until.get(stored.coordinator, 0.0) >= self._store.clock.moment().unix
        return stored.coordinator if alive else 0

    def _row(self, stored: Stored) -> OpenRender:
        return replace(stored.row, holder=self._holder(stored), totals=copy.copy(stored.row.totals))

    def all(self) -> list[OpenRender]:
        states = (RenderState.QUEUED, RenderState.RUNNING)
        return [self._row(each) for each in self._store.stored.values() if each.row.state in states]

    def quarantined(self) -> dict[str, str]:
        return dict(self._store.bad_workers)

    def drained(self) -> dict[str, str]:
        return {}

    def tiles(self, render_id: str) -> Iterator[TileRow]:
        return iter(list(self._store.stored[render_id].tiles.values()))

    def is_open(self, render_id: str) -> bool:
        return any(row.id == render_id for row in self.all())

    def renew(self, now: float) -> int:
        with self._owned():
            self._store.until[self._number] = now + 10.0
            self._store.until = {each: until for each, until in self._store.until.items() if until >= now}
        return len(self._store.until)

    def resign(self) -> None:
        self._store.until.pop(self._number, None)

    def take(self, render_id: str) -> OpenRender | None:
        with self._owned():
            stored = self._store.stored[render_id]
            if self._holder(stored) not in (0, self._number):
                return None
            stored.coordinator = self._number
            stored.row = replace(stored.row, fence=stored.row.fence + 1)
            return self._row(stored)

    def let_go(self, render_id: str, fence: int) -> None:
        with self._owned():
            if self._holds(render_id, fence):
                self._store.stored[render_id].coordinator = 0

    def _holds(self, render_id: str, fence: int) -> bool:
        stored = self._store.stored.get(render_id)
        return stored is not None and (stored.coordinator, stored.row.fence) == (self._number, fence)

    def lost(self, fences: Mapping[str, int]) -> list[str]:
        return [render_id for render_id, fence in fences.items() if not self._holds(render_id, fence)]

    @contextmanager
    def holding(self, render_id: str, fence: int) -> Iterator[None]:
        with self._owned():
            if not self._holds(render_id, fence):
                raise LeaseLost(render_id)
            yield

    def start(self, render_id: str, fence: int, now: float) -> bool:
        with self.holding(render_id, fence):
            if self._store.stored[render_id].row.state is not RenderState.QUEUED:
                return False
            self._store.change(render_id, state=RenderState.RUNNING)
            return True

    def commit(self, commits: list[RenderCommit]) -> list[str]:
        lost = []
        with self._owned():
            for commit in commits:
                if not self._holds(commit.render_id, commit.fence):
                    lost.append(commit.render_id)
                elif not self._store.stored[commit.render_id].row.state.ended:
                    self._keep(commit)
        return lost

    def _keep(self, commit: RenderCommit) -> None:
        stored = self._store.stored[commit.render_id]
        for tile in commit.tiles:
            before = stored.tiles.get(tile.tile_index)
            assert before is None or before.samples <= tile.samples, "what is committed goes back"
            stored.tiles[tile.tile_index] = tile
        for index, workers in commit.contributors.items():
            stored.contributors.setdefault(index, set()).update(workers)
        self._store.change(
            commit.render_id,
            totals=copy.copy(commit.totals),
            failed_tiles=tuple(commit.failed_tiles),
            floating_point_profile=commit.floating_point_profile,
            ran_seconds=commit.ran_seconds,
        )

    def quarantine(self, worker_id: str, reason: str, now: float, lied: bool = False) -> list[str]:
        found = []
        with self._owned():
            self._store.bad_workers.setdefault(worker_id, reason)
            for stored in self._store.stored.values():
                spoilt = [index for index, workers in stored.contributors.items() if worker_id in workers]
                if not (spoilt and lied):
                    continue
                if stored.row.state.has_image:
                    manifest = [0] * stored.planned.grid.count
                    for index, tile in stored.tiles.items():
                        manifest[index] = tile.samples
                    stop = StopConditions(tile_samples=tuple(manifest))
                    stored.row = replace(stored.row, state=RenderState.QUEUED, stop=stop)
                    stored.final_image = None
                for index in spoilt:
                    stored.tiles.pop(index, None)
                    del stored.contributors[index]
                stored.row = replace(stored.row, fence=stored.row.fence + 1)
                found.append(stored.row.id)
        return found

    def start_anew(self, render_id: str, fence: int) -> None:
        with self.holding(render_id, fence):
            stored = self._store.stored[render_id]
            stored.tiles, stored.contributors = {}, {}
            totals = Totals(cpu_seconds=stored.row.totals.cpu_seconds)
            self._store.change(
                render_id, floating_point_profile="", totals=totals, failed_tiles=(), fence=fence + 1
            )

    def recut(self, render_id: str, fence: int, schedule: job_pb2.RangeSchedule) -> None:
        with self.holding(render_id, fence):
            self._store.change(render_id, schedule=schedule)

    def write_meters(self, values: Mapping[str, float]) -> None:
        assert all(np.isfinite(value) for value in values.values())

    def record_preview(self, render_id: str, fence: int, point: ErrorPoint, in_history: bool) -> None:
        with self.holding(render_id, fence):
            if in_history:
                self._store.stored[render_id].errors.append(point)

    def end(self, render: OpenRender, state: RenderState, reason: str, now: float) -> bool:
        with self.holding(render.id, render.fence):
            stored = self._store.stored[render.id]
            if stored.row.state.ended or not stored.row.asks_the_same(render):
                return False
            if stored.row.state is RenderState.PAUSED:
                return False
            stored.reason = reason
            self._store.change(render.id, state=state)
            return True

    def mirror(self, workers: list[WorkerRow], at_work: list[tuple[str, int, str]], now: float) -> None:
        with self._owned():
            pass


class MemoryPreviews(Previews):
    """Looks at what would be written."""

    def __init__(self, store: Store, ledger: MemoryLedger) -> None:
        self._store, self._memory = store, ledger
        self.written = 0

    def write_preview(self, render: RunningRender, final: bool = False) -> None:
        with self._memory.holding(render.id, render.row.fence):
            self.written += 1

    def write_thumbnail(self, render: RunningRender) -> None:
        self.write_preview(render)

    def write_image(self, render: RunningRender) -> None:
        with self._memory.holding(render.id, render.row.fence):
            image = {
                index: (render.film.samples(index), render.film.tile_bytes(index))
                for index in range(len(render.film.tiles))
            }
            self._store.stored[render.id].final_image = image

    def write_bundle(self, render: RunningRender, failed: FailedTile) -> None:
        self._store.bundles.append((render.id, failed))

    def finish_ended(self, unix_time: float) -> None:
        pass
