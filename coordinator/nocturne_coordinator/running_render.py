"""A render that the coordinator works on: its film, and what of it is not committed yet. No I/O."""

import json
from collections import Counter, deque
from collections.abc import Iterable
from typing import cast

from nocturne.v1 import job_pb2

from .film import Film
from .images import Provenance, relative_error
from .merge import RangeSums, Verdict
from .planned_render import PlannedRender
from .schedule import JobKey
from .store.ledger import OpenRender, RenderCommit, TileRow
from .store.rows import ErrorPoint

_RATE_SECONDS = 10.0
"""Over which photons per second are counted: many jobs, yet soon 0 when the workers are gone."""

_HISTORY_STEP = 1.01
"""A point of the error's history for every 1 % more photons: about 1400 for a render of a million samples."""


class RunningRender:
    """The film and totals of one render in memory."""

    def __init__(self, row: OpenRender, tiles: Iterable[TileRow]) -> None:
        """Goes on where the committed tiles end; ValueError if they do not fit the plan."""
        self.planned = PlannedRender(
            row.id, row.plan, bytes.fromhex(row.scene_sha256), cast("job_pb2.Engine.ValueType", row.engine)
        )
        self.film = Film(self.planned)
        self.totals = row.totals
        self.failures: Counter[JobKey] = Counter()
        self.refusals: Counter[JobKey] = Counter()
        self.next_preview = 0.0
        self.next_image = 0.0
        self.pictured_photons = 0
        self._dirty: set[int] = set()
        self._recent: deque[tuple[float, int]] = deque()
        self._last_rate = 0.0
        self._history_photons = 0.0
        for tile in tiles:
            self.film.load(tile.tile_index, tile.samples, tile.sums)
        self.totals.ranges = sum(state.merged for state in self.film.tiles)

    @property
    def id(self) -> str:
        return self.planned.id

    @property
    def merged_ranges(self) -> list[int]:
        """Per tile."""
        return [state.merged for state in self.film.tiles]

    def offer(self, tile_index: int, offered: RangeSums, now: float) -> tuple[Verdict, list[RangeSums]]:
        """Merges a range when its turn has come; see TileState.offer."""
        verdict, released = self.film.offer(tile_index, offered)
        for merged in released:
            self.totals.ranges += 1
            self.totals.photons += merged.photons
            self.totals.rays += merged.rays
            self.totals.rejected += merged.rejected
            self.totals.cpu_seconds += merged.cpu_seconds
            self._recent.append((now, merged.photons))
            self._dirty.add(tile_index)
        return verdict, released

    def waiting_entries(self) -> list[bytes]:
        """Result entries of ranges that wait for earlier ones."""
        return [early.entry for state in self.film.tiles for early in state.waiting.values()]

    # --- committing ---

    def changes(self, now: float) -> RenderCommit | None:
        """What is to be committed, if anything; call `committed` when that is done."""
        rate = self._rate(now)
        if not self._dirty and (rate > 0.0 or self._last_rate == 0.0):
            return None
        self._last_rate = rate
        tiles = [
            TileRow(tile, self.film.samples(tile), self.film.tile_bytes(tile)) for tile in sorted(self._dirty)
        ]
        return RenderCommit(self.id, tiles, self.totals, rate)

    def committed(self) -> None:
        self._dirty.clear()

    def _rate(self, now: float) -> float:
        """Photons per second, over the last seconds."""
        while self._recent and self._recent[0][0] < now - _RATE_SECONDS:
            self._recent.popleft()
        if not self._recent:
            return 0.0
        span = max(now - self._recent[0][0], 1.0)
        return sum(photons for _, photons in self._recent) / span

    # --- looking ---

    def error_point(self, unix_time: float) -> tuple[ErrorPoint, bool]:
        """The error now, and whether enough was added since the last point for the history."""
        plan = self.planned.plan
        point = ErrorPoint(
            unix_time=unix_time,
            photons=self.totals.photons,
            samples=self.totals.photons / (plan.width * plan.height * self.planned.photons_per_sample),
            relative_error=relative_error(self.film.sums, self.film.counts),
        )
        in_history = point.relative_error > 0.0 and point.photons >= self._history_photons
        if in_history:
            self._history_photons = point.photons * _HISTORY_STEP
        return point, in_history

    def provenance(self) -> Provenance:
        return Provenance(self.planned.scene.hex(), plan_json(self.planned.plan), self.planned.engine)


def plan_json(plan: job_pb2.RenderPlan) -> str:
    """The plan in proto3 JSON, one line, in one spelling for ever: it is part of canonical files."""
    content: dict[str, int | list[int] | list[str]] = {
        "width": plan.width,
        "height": plan.height,
        "tileSize": plan.tile_size,
        "rangeEnds": list(plan.range_ends),
    }
    if plan.further_responses:
        content["furtherResponses"] = list(plan.further_responses)
    if plan.photons_per_sample:
        content["photonsPerSample"] = plan.photons_per_sample
    return json.dumps(content, separators=(",", ":"))
