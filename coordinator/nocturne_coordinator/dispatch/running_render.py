"""A render that the coordinator works on: its film, and what of it is not committed yet. No I/O.

One file, though long: each result changes film, totals and the next commit together.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import cast

from nocturne.v1 import job_pb2
from nocturne_scene.ranges import (
    FIRST_RANGE,
    PHOTON_BUNDLE,
    SampleRange,
    recut_schedule,
    sample_ends,
    samples_of,
)

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.film import MergedFilm
from nocturne_coordinator.dispatch.forecast import Forecast, Measured, forecast
from nocturne_coordinator.dispatch.forward_photons import photon_commit_seconds
from nocturne_coordinator.dispatch.job_cost import JOB_SECONDS, USUAL_COST, longest_range, max_cpu_seconds
from nocturne_coordinator.dispatch.merge import Offered, RangeSums
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.range_queue import RangeQueue, RangeState
from nocturne_coordinator.dispatch.records import (
    ErrorPoint,
    FailedTile,
    OpenRender,
    RenderCommit,
    RenderState,
    TileRow,
    TileRows,
)
from nocturne_coordinator.dispatch.trust import CONFIDENCE, RangeEnd, confirmed, error_warning_of, falls
from nocturne_coordinator.limits import MAX_LOOKED_AT_PIXELS, MAX_QUICK_PHOTONS

_RATE_SECONDS = 10.0
"""Over which photons per second are counted: many jobs, yet soon 0 when the workers are gone."""

_HISTORY_STEP = 1.01
"""A point of the error's history for every 1 % more photons: about 1400 for a render of a million samples."""


class RunningRender:
    """The film and totals of one render in memory."""

    def __init__(
        self,
        row: OpenRender,
        tiles: Iterable[TileRow] | None,
        now: float = 0.0,
        job_seconds: float = JOB_SECONDS,
    ) -> None:
        """Goes on where the committed tiles end, from `now` (any clock, seconds). `tiles`: None where
        `building` follows, then tiles come by `load`, then `loading`.

        ValueError if they do not fit the schedule.
        """
        self.row = row
        self.planned = PlannedRender(
            row.id,
            row.schedule,
            bytes.fromhex(row.scene_sha256),
            cast("job_pb2.Engine.ValueType", row.engine),
        )
        self.film = MergedFilm(self.planned, row.stop, in_steps=tiles is None)
        self.totals = row.totals
        self.floating_point_profile = row.floating_point_profile
        """How all its workers round; empty before the first result."""
        self.failed_tiles = {each.tile_index: each for each in row.failed_tiles}
        self.finds_errors = self.planned.pixels <= MAX_LOOKED_AT_PIXELS
        """Whether it finds its error itself; else `judged` gets it from a process."""
        self.estimate = ErrorEstimate()
        """Of the error, at the last preview."""
        self._before = self._now = RangeEnd()
        self._judged_photons = 0
        self.gets_quick_copies = True
        """Until one of them takes too long."""
        self.audits_open = 0
        self.next_preview = 0.0
        self.next_replan = 0.0
        self.next_figures = 0.0
        self.pictured_photons = 0
        self._dirty: set[int] = set()
        """Tiles to commit."""
        self._dirty_totals = False
        self._is_seen = row.totals.ranges > 0
        self._recent: deque[tuple[float, int]] = deque()
        self._last_rate = 0.0
        self._is_unreachable = False
        self._history_photons = 0.0
        self._contributors: dict[int, set[str]] = {}
        self._since = now
        self._invalid_samples = [0] * self.planned.queues
        if tiles is not None:
            self.load(tiles)
            for _ in self.loading():
                pass
        self._job_seconds = job_seconds
        self._longest: dict[bool, int] = {}
        """Samples to which ranges of tiles are to be cut, and bundles to which those of forward photons."""
        self.committing: Sequence[int] = ()
        """Queues of the last commit."""
        self._photon_entries: list[bytes] = []
        """Results whose forward photons are merged and not committed yet: that is a whole film."""
        # The first one sooner: somebody may be waiting to see that it is the right scene.
        self._next_photon_commit = now + photon_commit_seconds(self.planned.pixels) / 4

    def building(self) -> Iterator[None]:
        """Makes room for its film, in steps, between which others may have their turn."""
        return self.film.building()

    def load(self, tiles: Iterable[TileRow]) -> int:
        """Puts back committed tiles; `loading` must follow after the last. ValueError if they do not fit the
        schedule; gives how many there were."""
        count = 0
        for tile in tiles:
            own = tile.own or tile.sums
            self.film.load(tile.tile_index, tile.samples, own, tile.error_before, tile.photons)
            self._invalid_samples[tile.tile_index] = tile.invalid_samples
            count += 1
        return count

    def loading(self) -> Iterator[None]:
        """All that was committed is here, and is counted, in steps, between which others may have their
        turn."""
        yield from self.film.loading()
        for tile_index in self.failed_tiles:
            self.film.give_up(tile_index)
        self.totals.ranges = sum(queue.merged for queue in self.film.queues)
        self.totals.photons = self.film.traced_samples * self.planned.photons_per_sample

    @property
    def id(self) -> str:
        return self.planned.id

    def take_layers(self, row: OpenRender) -> None:
        """Takes over what its row says now of layers."""
        if self.row.layers_due != row.layers_due:
            self.row = replace(self.row, layers_due=row.layers_due, layers_sha256=row.layers_sha256)

    def can_replan(self, row: OpenRender) -> bool:
        """Whether all that is merged is of ranges that the row's schedule has, too."""
        now = self.planned.schedule
        if row.schedule == now:
            return True
        kept = self.planned.kept_in(row.schedule)
        if kept[0] >= len(now.range_ends) and kept[-1] >= len(now.photon_range_ends):
            # Nothing was taken away: no need to look at each of many tiles.
            return True
        return all(queue.merged <= most for queue, most in zip(self.film.queues, kept, strict=True))

    def replan(self, row: OpenRender) -> list[bytes]:
        """Goes on by the row's schedule and conditions, where it can; gives entries of results that waited
        and are of no use now."""
        kept = self.planned.kept_in(row.schedule)
        surplus = [
            queue.waiting.pop(index)
            for queue, most in zip(self.film.queues, kept, strict=True)
            for index in [each for each in queue.waiting if each >= most]
        ]
        self._ask_for(row)
        self.film.replan(self.planned, row.stop)
        for tile_index in self.failed_tiles:
            surplus += self.film.give_up(tile_index)
        for queue in self.film.queues:
            surplus += queue.close() if queue.closed else []
        return [each.entry for each in surplus]

    def replanning(self, row: OpenRender) -> Iterator[None]:
        """The same in steps, between which others may have their turn, of a render that is set aside: all
        that is merged is committed, and results that wait come again."""
        self._ask_for(row)
        for queue in self.film.queues:
            queue.waiting.clear()
        yield from self.film.replanning(self.planned, row.stop)
        for tile_index in self.failed_tiles:
            self.film.give_up(tile_index)

    def _ask_for(self, row: OpenRender) -> None:
        # Its time of running is counted here.
        self.row = replace(row, ran_seconds=self.row.ran_seconds)
        self.planned = replace(self.planned, schedule=row.schedule)
        self.failed_tiles = {each.tile_index: each for each in row.failed_tiles}
        self._longest.clear()
        self._is_unreachable = False
        self._dirty_totals = True

    def range_queues(self) -> list[RangeQueue]:
        """Of tiles, and of forward photons, when all that is merged is committed."""
        return list(self.each_range_queue())

    def each_range_queue(self) -> Iterator[RangeQueue]:
        """The same one by one: of a large film there are 65,536 tiles, and others wait meanwhile."""
        ranges, photon_index = len(self.planned.ranges), self.planned.photon_index
        for index, queue in enumerate(self.film.queues):
            if index == photon_index:
                ranges = len(self.planned.photon_ranges)
            states = bytearray(ranges)
            if queue.closed:
                closed = RangeState.FAILED if index in self.failed_tiles else RangeState.UNNEEDED
                states[:] = bytes([closed]) * ranges
            if queue.merged:
                states[: queue.merged] = bytes([RangeState.COMMITTED]) * queue.merged
            turns = self.planned.turns_of(index) if index == photon_index else None
            yield RangeQueue(states, self.film.horizon(index), queue.ahead, turns)

    def offer(self, tile_index: int, offered: RangeSums, now: float) -> Offered:
        """Merges a range when its turn has come; see Accumulator.offer."""
        outcome = self.film.offer(tile_index, offered)
        for merged in outcome.released:
            self.totals.ranges += 1
            self.totals.photons += merged.photons
            self.totals.rays += merged.rays
            self.totals.invalid_samples += merged.invalid_samples
            self.totals.truncated_paths += merged.truncated_paths
            self._invalid_samples[tile_index] += merged.invalid_samples
            self.totals.cpu_seconds += merged.cpu_seconds
            self._learn_cost(tile_index, merged.index, merged.cpu_seconds)
            self._recent.append((now, merged.photons))
            self._contributors.setdefault(tile_index, set()).add(merged.worker)
        if outcome.released and tile_index == self.planned.photon_index:
            self._photon_entries.extend(each.entry for each in (*outcome.released, *outcome.surplus))
        elif outcome.released:
            self._dirty.add(tile_index)
        return outcome

    @property
    def failed_on(self) -> set[str]:
        """The workers that failed at its tiles; with enrolment, machines."""
        return set().union(*(each.workers for each in self.failed_tiles.values()))

    def fail_tile(self, failed: FailedTile) -> list[RangeSums]:
        """The tile gets no more samples; gives ranges that waited and are of no use now."""
        self.failed_tiles[failed.tile_index] = failed
        self._dirty_totals = True
        return self.film.give_up(failed.tile_index)

    def count_audited(self) -> None:
        """A range was traced elsewhere again, and was the same."""
        self.totals.audited += 1
        self._dirty_totals = True

    def count_unaudited(self, ranges: int) -> None:
        """Ranges were to be audited, and no other machine traced them."""
        if ranges:
            self.totals.unaudited += ranges
            self._dirty_totals = True

    def count_refused(self) -> None:
        """A result came that could not be right."""
        self.totals.refused += 1
        self._dirty_totals = True

    # --- ending ---

    def ending(self, now: float, unix_time: float) -> tuple[RenderState, str] | None:
        """How the render ends, if it does so now: the state, and the reason in words."""
        found = self._condition_met(now, unix_time)
        if found is None or not self.failed_tiles:
            return found
        return RenderState.DEGRADED, f"{self._degraded()} {found[1]}".strip()

    def _condition_met(self, now: float, unix_time: float) -> tuple[RenderState, str] | None:
        stop = self.row.stop
        if self.film.complete:
            return RenderState.SUCCEEDED, self._complete()
        if stop.relative_error and confirmed(self._before, self._now, stop.relative_error):
            return RenderState.SUCCEEDED, f"{self._error_in_words()} {stop.relative_error:.3%} was asked for."
        if stop.until and unix_time >= stop.until:
            return RenderState.STOPPED_EARLY, f"Stopped at {stop.until_text or 'the time'}, as asked."
        if stop.wall_seconds and self.ran_seconds(now) >= stop.wall_seconds:
            return RenderState.STOPPED_EARLY, f"Stopped after {stop.wall_seconds:g} s of running, as asked."
        if stop.cpu_seconds and self.totals.cpu_seconds >= stop.cpu_seconds:
            used = f"{self.totals.cpu_seconds:.1f} of {stop.cpu_seconds:g} s"
            return RenderState.STOPPED_EARLY, f"Stopped at {used} of processor time, as asked."
        return None

    def _complete(self) -> str:
        self._judge()
        stop, last = self.row.stop, samples_of(self.planned.schedule)
        if self.estimate.mean <= 0.0:
            return f"No light was found: all pixels are black after {self.estimate.samples} samples."
        if stop.tile_samples:
            return "Has the samples that its manifest lists."
        if stop.relative_error:
            used = f"All {last} samples are used up. {self._error_in_words()}"
            return f"{used} {stop.relative_error:.3%} was asked for."
        if not stop.tile_relative_error:
            return ""
        tiles = self.planned.grid.count
        full = sum(self.film.samples_shown(index) == last for index in range(tiles))
        met = tiles - len(self.failed_tiles) - full
        have = f"{met} tiles have relative error {stop.tile_relative_error:.3%}"
        return f"{have}, {full} all {last} samples: they do not, or their error is not to be trusted."

    def _error_in_words(self) -> str:
        estimate, error_warning = self.estimate, self.error_warning
        if estimate.relative_error <= 0.0:
            return "The error is unknown."
        error = f"{estimate.relative_error:.3%}"
        if error_warning:
            return f"The relative error of {error} is not to be trusted: {error_warning}"
        interval = CONFIDENCE * estimate.mean_error
        return f"Relative error {error}, mean {estimate.mean:.4g} +- {interval:.2g} (95 %)."

    def _degraded(self) -> str:
        places = [f"{index} ({self._place(index)})" for index in sorted(self.failed_tiles)[:5]]
        more = f" and {len(self.failed_tiles) - 5} more" if len(self.failed_tiles) > 5 else ""
        reason = next(iter(self.failed_tiles.values())).reason
        where = "several workers" if len(self.failed_on) > 1 else "the only worker that was there"
        return f"Tiles {', '.join(places)}{more} failed on {where}: {reason}"

    def _place(self, tile_index: int) -> str:
        samples = self.film.samples(tile_index)
        if tile_index == self.planned.photon_index:
            return f"forward photons, {samples} bundles"
        tile = self.planned.grid.tile(tile_index)
        return f"x {tile.x}, y {tile.y}, {samples} samples"

    def ran_seconds(self, now: float) -> float:
        """Time running, pauses left out."""
        return self.row.ran_seconds + max(0.0, now - self._since)

    def forecast(self, now: float, unix_time: float, rate: float) -> Forecast:
        """When it will end, and its cost by then."""
        per_sample = self.planned.photons_per_sample
        measured = Measured(
            photons=self.totals.photons,
            photons_wanted=self.film.expected_samples * per_sample,
            mean_samples=self.film.mean_samples,
            estimate=self.estimate,
            range_ends=sample_ends(self.planned.schedule),
            photons_per_second=rate,
            cpu_seconds=self.totals.cpu_seconds,
            ran_seconds=self.ran_seconds(now),
        )
        found = forecast(measured, self.row.stop, unix_time, self._is_unreachable)
        self._is_unreachable = bool(found.target_unreachable)
        return found

    def cost(self, tile_index: int, range_index: int) -> float:
        """Processor seconds that a range takes, as far as is known; for sharing workers."""
        planned = self.planned.ranges_of(tile_index)[range_index]
        photons = self.planned.photons_in(tile_index, planned)
        known = self.totals.photons > 0 and self.totals.cpu_seconds > 0.0
        return photons * (self.totals.cpu_seconds / self.totals.photons if known else USUAL_COST)

    @property
    def is_small(self) -> bool:
        """Whether it is so small that copies of its jobs may go before those of others."""
        planned, schedule = self.planned, self.planned.schedule
        photons = planned.pixels * samples_of(schedule) if schedule.range_ends else 0
        bundles = schedule.photon_range_ends[-1] if schedule.photon_range_ends else 0
        return (photons + bundles * PHOTON_BUNDLE) * planned.photons_per_sample <= MAX_QUICK_PHOTONS

    def max_cpu_seconds(self, planned: SampleRange) -> float:
        """Processor seconds after which a job is stopped."""
        return max_cpu_seconds(planned.end - planned.first, self.totals.photons > 0, self._job_seconds)

    def stopped_too_long(self, tile_index: int, range_index: int, cpu_seconds: float) -> bool:
        """A job was stopped after so long; whether its range will be cut."""
        planned = self.planned.ranges_of(tile_index)[range_index]
        forward = tile_index == self.planned.photon_index
        if planned.first < self._completed(forward) or planned.end - planned.first <= FIRST_RANGE:
            return False
        self._learn_cost(tile_index, range_index, cpu_seconds, ahead=1)
        return self.recut() is not None

    def _completed(self, forward: bool) -> int:
        """Samples that some tile has, or bundles of forward photons: their ranges stay as they are."""
        samples = self.film.manifest()
        tiles = self.planned.photon_index
        return max(samples[tiles:] if forward else samples[:tiles])

    def _learn_cost(
        self, tile_index: int, range_index: int, cpu_seconds: float, ahead: int | None = None
    ) -> None:
        """A range took so long: those of its tile that may be published by now do so for each sample."""
        ranges = self.planned.ranges_of(tile_index)
        took = ranges[range_index]
        ahead = self.film.queues[tile_index].ahead + 1 if ahead is None else ahead
        last = min(range_index + ahead, len(ranges)) - 1
        following = ranges[last]
        samples = following.end - following.first
        predicted = cpu_seconds * samples / (took.end - took.first)
        if wanted := longest_range(predicted, samples, self._job_seconds):
            forward = tile_index == self.planned.photon_index
            self._longest[forward] = min(self._longest.get(forward, wanted), wanted)

    def recut(self) -> job_pb2.RangeSchedule | None:
        """The schedule with shorter ranges, where those that come next would take too long. A replay keeps
        its own."""
        if self.row.stop.tile_samples:
            return None
        for forward, longest in list(self._longest.items()):
            schedule = recut_schedule(
                self.planned.schedule, self._completed(forward), longest, forward_photons=forward
            )
            if schedule is not None:
                return schedule
            del self._longest[forward]
        return None

    def waiting_entries(self) -> list[bytes]:
        """Result entries of ranges that wait for earlier ones."""
        waiting = [early.entry for queue in self.film.queues for early in queue.waiting.values()]
        return [*waiting, *self._photon_entries]

    def commit_photons_next(self) -> None:
        """The next commit has forward photons, too: the render is let go after it."""
        self._next_photon_commit = 0.0

    # --- committing ---

    def changes(self, now: float, unix_time: float) -> RenderCommit | None:
        """The next commit, if there is anything to commit; call `committed` when that is done."""
        rate = self._rate(now)
        with_photons = self._photons_are_due(now, unix_time)
        changed = self._dirty or self._dirty_totals or with_photons
        if not changed and (rate > 0.0 or self._last_rate == 0.0):
            return None
        self._last_rate = rate
        self.committing = sorted(self._dirty)
        if with_photons:
            self.committing = range(self.planned.queues)
            self._next_photon_commit = now + photon_commit_seconds(self.planned.pixels)
        return RenderCommit(
            self.id,
            self.row.fence,
            TileRows(self.committing, self._whole_row if with_photons else self._row),
            # Open ones are forgotten with the coordinator.
            replace(self.totals, unaudited=self.totals.unaudited + self.audits_open),
            rate,
            ran_seconds=self.ran_seconds(now),
            tiles_done=self.film.tiles_done,
            forecast=self.forecast(now, unix_time, rate),
            contributors=self._contributors,
            photon_bundles=self.film.bundles_beside,
            failed_tiles=tuple(self.failed_tiles.values()),
            floating_point_profile=self.floating_point_profile,
        )

    def _photons_are_due(self, now: float, unix_time: float) -> bool:
        """Forward photons fall on all tiles: they are committed seldom, and before the render is let go."""
        is_due = now >= self._next_photon_commit or self._condition_met(now, unix_time) is not None
        return bool(self._photon_entries) and is_due

    def _row(self, index: int) -> TileRow:
        film, is_tile = self.film, index != self.planned.photon_index
        own = film.tile_bytes(index) if is_tile and index in self._dirty else b""
        sums = own if film.forward is None else b""
        row = TileRow(
            index, film.samples(index), sums, self._invalid_samples[index], film.error_before(index)
        )
        if film.forward is None or not is_tile:
            return row
        samples = film.samples_shown(index) or row.samples
        return replace(row, samples=samples, sums=film.shown_bytes(index), own=own)

    def _whole_row(self, index: int) -> TileRow:
        """A tile with the forward photons that fell on it; the number of these."""
        return replace(self._row(index), photons=self.film.photon_bytes(index))

    @property
    def is_unseen(self) -> bool:
        """Whether something is merged and nothing was ever committed."""
        return bool(self._dirty) and not self._is_seen

    def committed(self) -> list[bytes]:
        """Gives results that are of no more use, apart from those that are settled when they are merged."""
        self._is_seen = self._is_seen or bool(self._dirty)
        self._dirty.clear()
        self._contributors = {}
        self._dirty_totals = False
        if self.planned.photon_index not in self.committing:
            return []
        entries, self._photon_entries = self._photon_entries, []
        return entries

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
        self._judge()
        estimate = self.estimate
        point = ErrorPoint(
            unix_time=unix_time,
            photons=self.totals.photons,
            samples=self.film.mean_samples,
            relative_error=estimate.relative_error,
            top_percent_share=estimate.top_percent_share,
            effective_pixels=estimate.effective_pixels,
            mean=estimate.mean,
            mean_error=estimate.mean_error,
            zero_pixels=estimate.zero_pixels,
            error_warning=self.error_warning,
        )
        return point, self._is_for_history(point)

    def _is_for_history(self, point: ErrorPoint) -> bool:
        in_history = point.relative_error > 0.0 and point.photons >= self._history_photons
        if in_history:
            self._history_photons = point.photons * _HISTORY_STEP
        return in_history

    @property
    def error_warning(self) -> str:
        """Why the error is not to be trusted, a sentence; empty: it is, as far as is known."""
        if found := self.image_warning:
            return found
        known_twice = self._before.error and self._now.error
        if known_twice and not falls(self._before, self._now):
            return "It falls more slowly than errors do: brighter samples are still met for the first time."
        return ""

    @property
    def image_warning(self) -> str:
        """The same from the sums alone, whatever was known before: of equal images it is equal."""
        self._judge()
        return error_warning_of(self.estimate)

    def judged(self, point: ErrorPoint, estimate: ErrorEstimate) -> tuple[ErrorPoint, bool]:
        """The error was found elsewhere; gives the point to report, and whether it is for the history."""
        self._took(estimate)
        point = replace(point, error_warning=self.error_warning)
        return point, self._is_for_history(point)

    def _judge(self) -> None:
        """Estimates the error of the merged results."""
        if self._judged_photons != self.totals.photons and self.finds_errors:
            self._judged_photons = self.totals.photons
            self._took(self.film.estimate())

    def _took(self, estimate: ErrorEstimate) -> None:
        self.estimate = estimate
        now = RangeEnd.of(self.estimate)
        if now.samples > self._now.samples:
            self._before = self._now
        self._now = now
