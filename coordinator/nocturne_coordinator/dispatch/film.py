"""The image of a running render in memory: all tiles' sums, and how many samples each pixel has. Pure."""

import math
from bisect import bisect_left
from collections.abc import Iterator

import numpy as np
from nocturne_scene.ranges import PHOTON_BUNDLE, sample_ends
from nocturne_scene.tile_sums import TileSums, decode

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate, Squares, estimate_error
from nocturne_coordinator.dispatch.film_sums import FilmSums
from nocturne_coordinator.dispatch.forward_photons import ForwardPhotons
from nocturne_coordinator.dispatch.merge import Accumulator, Counts, Offered, RangeSums, Sums
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.dispatch.trust import RangeEnd, confirmed, samples_to_stop

QUEUES_AT_ONCE = 4096
"""That are looked at before others get their turn, where a render is taken up: 15 ms."""


class MergedFilm:
    """Sums, and an accumulator for each queue of ranges: those of tiles, which hold views into the sums, and
    after them that of forward photons, if there are any."""

    def __init__(
        self, render: PlannedRender, stop: StopConditions | None = None, in_steps: bool = False
    ) -> None:
        """`stop` says which tiles end before the schedule does. ValueError if it does not fit the
        schedule. `in_steps`: `building` follows."""
        grid, schedule = render.grid, render.schedule
        self._own = self._shown = FilmSums.zeros(grid, render.further, schedule.coefficients)
        self.counts: Counts = np.zeros((schedule.height, schedule.width), dtype=np.uint32)
        self._tile_counts: list[Counts] = []
        self._shown_samples = 0
        """Pixels times samples of all tiles, as they are shown."""
        self._pixels: list[int] = []
        self.queues: list[Accumulator] = []
        self.forward: ForwardPhotons | None = None
        if render.photon_ranges:
            self.forward = ForwardPhotons(render)
            self._shown = FilmSums.zeros(grid, render.further)
        self._stale: set[int] = set()
        """Tiles of which other sums are shown than there are by now."""
        self._before = [RangeEnd()] * render.queues
        self._now = [RangeEnd()] * render.queues
        self._render, self._stop = render, stop or EVERYTHING
        if not in_steps:
            for _ in self.building():
                pass

    def building(self) -> Iterator[None]:
        """Makes the queues, in steps, between which others may have their turn."""
        for index, (tile, area) in enumerate(self._own.tiles()):
            if index and index % QUEUES_AT_ONCE == 0:
                yield
            self._tile_counts.append(self.counts[area])
            self._pixels.append(self._tile_counts[-1].size)
            self.queues.append(Accumulator(tile))
        if self.forward is not None:
            self.queues.append(self.forward.merged)
            self._pixels.append(PHOTON_BUNDLE)
        self._pixels_of = np.array(self._pixels, dtype=np.float64)
        self._plan(self._render, self._stop)

    def _plan(self, render: PlannedRender, stop: StopConditions) -> None:
        self._render, self._stop = render, stop
        if self.forward is not None:
            self.forward.replan(render)
        count = render.grid.count
        self._last = [len(render.ranges)] * count + [len(render.photon_ranges)] * (len(self.queues) - count)
        if self._stop.tile_samples:
            self._last = [
                render.ranges_of(index).merged_at(end) if end else 0
                for index, end in enumerate(self._stop.tile_samples)
            ]
        of_photons = [render.photon_ranges.end_of(last) for last in self._last[count:]]
        of_tiles = [render.ranges.end_of(last) for last in self._last[:count]]
        self._expected = np.array(of_tiles + of_photons, dtype=np.float64)
        for queue, last in zip(self.queues, self._last, strict=True):
            queue.closed = last == 0
        self._unfinished = sum(not queue.closed for queue in self.queues)

    def replan(self, render: PlannedRender, stop: StopConditions) -> None:
        """Goes on by another schedule, which begins with the ranges that are merged or wait, and by other
        conditions."""
        for _ in self.replanning(render, stop):
            pass

    def replanning(self, render: PlannedRender, stop: StopConditions) -> Iterator[None]:
        """The same in steps, between which others may have their turn."""
        self._plan(render, stop)
        yield
        for index, queue in enumerate(self.queues):
            if index and index % QUEUES_AT_ONCE == 0:
                yield
            if queue.merged:
                self._note_end(index, self.error_before(index))
        yield from self.loading()

    def load(
        self, index: int, samples: int, sums: bytes, error_before: float = 0.0, photons: bytes = b""
    ) -> None:
        """Puts back a queue as it was committed; ValueError if it doesn't fit the schedule. `error_before`:
        see `error_before`. `photons`: sums of forward photons that fell on a tile; their number comes before
        the tiles."""
        queue, ranges = self.queues[index], self._render.ranges_of(index)
        if self.forward is not None and photons and self.forward.bundles:
            self.forward.tile(index).assign(self._decoded(index, photons))
        # Where there are none, samples and sums are those that forward photons make.
        if len(ranges):
            if sums:
                queue.sums.assign(self._decoded(index, sums))
            queue.merged = ranges.merged_at(samples) if samples else 0
        self._note_end(index, error_before)

    def _note_end(self, index: int, error_before: float) -> None:
        if self._ends_by_error(index):
            self._now[index] = RangeEnd(self._samples_at(self.queues[index].merged - 1), error_before)

    def loaded(self) -> None:
        """All that was committed is here."""
        for _ in self.loading():
            pass

    def loading(self) -> Iterator[None]:
        """The same in steps, between which others may have their turn."""
        for index, queue in enumerate(self.queues):
            if index and index % QUEUES_AT_ONCE == 0:
                yield
            closed = queue.closed
            queue.closed = closed or (queue.merged > 0 and self._enough(index, queue))
            self._advance(index, not closed)

    def _decoded(self, tile_index: int, sums: bytes) -> TileSums:
        tile = self._render.grid.tile(tile_index)
        return decode(sums, tile.width, tile.height, self._render.further)

    def offer(self, index: int, offered: RangeSums) -> Offered:
        """Merges a range when its turn has come; see Accumulator.offer."""
        outcome = self.queues[index].offer(offered, lambda queue: self._enough(index, queue))
        if outcome.released:
            self._advance(index, True)
        return outcome

    def give_up(self, index: int) -> list[RangeSums]:
        """The queue gets no more samples, whatever was asked for; gives ranges that waited for one before
        them."""
        queue = self.queues[index]
        if queue.closed:
            return []
        surplus = queue.close()
        self._advance(index, True)
        return surplus

    @property
    def complete(self) -> bool:
        """No tile needs more samples, and no more forward photons are needed."""
        return self._unfinished == 0

    @property
    def tiles_done(self) -> int:
        """Tiles that need no more samples."""
        if not self._render.ranges:
            return self._render.grid.count if self.complete else 0
        return min(self._render.grid.count, len(self.queues) - self._unfinished)

    @property
    def traced_samples(self) -> int:
        """Pixels times samples of all tiles, and forward photons."""
        return sum(pixels * self.samples(index) for index, pixels in enumerate(self._pixels))

    @property
    def mean_samples(self) -> float:
        """Of a pixel."""
        return self._shown_samples / self._render.pixels

    @property
    def expected_samples(self) -> float:
        """`traced_samples` when all tiles will be done, as far as is known now."""
        return float(self._expected @ self._pixels_of)

    def horizon(self, index: int) -> int:
        """How many ranges are expected to be needed in all; at least one more than there are."""
        queue = self.queues[index]
        if not self._ends_by_error(index):
            return self._last[index]
        reached = bisect_left(self._render.ranges_of(index).ends, self._expected[index]) + 1
        known = queue.merged > 0 and math.isfinite(self._expected[index])
        return min(self._last[index], max(queue.merged + 1, reached if known else 0))

    def samples(self, index: int) -> int:
        """Samples merged of a tile; of forward photons, bundles."""
        return self._render.ranges_of(index).end_of(self.queues[index].merged)

    def samples_shown(self, tile_index: int) -> int:
        """Of each pixel of a tile."""
        samples = self.samples(tile_index)
        return self.forward.samples_shown(samples) if self.forward else samples

    def manifest(self) -> list[int]:
        """Samples of each tile, and bundles of forward photons."""
        return [self.samples(index) for index in range(len(self.queues))]

    def error_before(self, index: int) -> float:
        """The trusted error at the range end before the last, which a stop by error goes by, too; 0:
        unknown."""
        return self._before[index].error

    def tile_bytes(self, tile_index: int) -> bytes:
        """A tile's sums as they are committed; see TileSums.encode."""
        return self.queues[tile_index].sums.encode()

    def photon_bytes(self, index: int) -> bytes:
        """The same of forward photons that fell on a tile; empty: it is none."""
        fell = self.forward.tile(index) if self.forward and index < self._render.photon_index else None
        return fell.encode() if fell else b""

    @property
    def bundles_beside(self) -> int:
        """Of forward photons that are no samples of pixels."""
        return self.forward.bundles if self.forward and self._render.ranges else 0

    def shown_bytes(self, tile_index: int) -> bytes:
        """The same of both together; empty: there is nothing to show yet."""
        both = self._together(tile_index)
        return both.encode() if both else b""

    def estimate(self) -> ErrorEstimate:
        """The image's mean and error, from its own sums."""
        return estimate_error(self.sums, self.counts, self.squares)

    @property
    def sums(self) -> Sums:
        """Of the image's pixels."""
        self._refresh()
        return self._shown.whole.pixels

    @property
    def squares(self) -> Squares:
        """Sums for the correlation of neighbours' errors."""
        self._refresh()
        grid, whole = self._render.grid, self._shown.whole
        tiles = whole.tile_products.reshape(-1, grid.columns, whole.tile_products.shape[-1])
        return Squares(whole.block_products, tiles, grid.tile_size)

    def _together(self, tile_index: int) -> TileSums | None:
        """A tile's sums of both kinds of photons; None: one of them has not come."""
        own = self.queues[tile_index].sums
        return self.forward.with_own(tile_index, own, self.samples(tile_index)) if self.forward else own

    def _refresh(self) -> None:
        for index in self._stale:
            if both := self._together(index):
                self._shown.tile(index).assign(both)
        self._stale.clear()

    def _samples_at(self, merged: int) -> int:
        """Of a pixel, when so many ranges were merged of a queue that ends by its error."""
        return sample_ends(self._render.schedule)[merged - 1] if merged > 0 else 0

    def _ends_by_error(self, index: int) -> bool:
        """Whether an error that was asked for of tiles ends the queue: forward photons alone fall where they
        do, and end by that of the film; together with adjoint ones, with all tiles."""
        is_tile = index != self._render.photon_index
        return bool(self._stop.tile_relative_error) and (is_tile or not self._render.ranges)

    def _enough(self, index: int, queue: Accumulator) -> bool:
        """Whether no more is needed: asked at the end of each range, answered from the sums."""
        if queue.merged >= self._last[index]:
            return True
        if not self._ends_by_error(index):
            return bool(self._stop.tile_relative_error) and self._tiles_have_enough()
        estimate = self._estimate_of(index)
        if estimate is None:
            return False
        asked, ends = self._stop.tile_relative_error, sample_ends(self._render.schedule)
        before, now = self._now[index], RangeEnd.of(estimate)
        self._before[index], self._now[index] = before, now
        samples = samples_to_stop(estimate, self._samples_at(queue.merged), asked, ends)
        # Of forward photons, bundles.
        ranges = min(self._last[index], bisect_left(ends, samples) + 1)
        self._expected[index] = float(self._render.ranges_of(index).end_of(ranges))
        return confirmed(before, now, asked)

    def _estimate_of(self, index: int) -> ErrorEstimate | None:
        """Of a tile, or by forward photons of the film; None: it has nothing to show yet."""
        if index == self._render.photon_index:
            self._show_photons()
            return self.estimate()
        sums, samples = self._together(index), self.samples_shown(index)
        if sums is None:
            return None
        counts = np.full(sums.pixels.shape[:2], samples, dtype=np.uint32)
        squares = Squares(sums.block_products, sums.tile_products[None], self._render.grid.tile_size)
        return estimate_error(sums.pixels, counts, squares)

    def _tiles_have_enough(self) -> bool:
        """Whether no tile needs more forward photons than there are: all have ended, and none has more
        adjoint ones for each pixel."""
        tiles = range(self._render.grid.count)
        most = max(self.samples(index) for index in tiles)
        return all(self.queues[index].closed for index in tiles) and bool(
            self.forward and self.forward.are_as_many_as(most)
        )

    def _show_photons(self) -> None:
        """Forward photons came: all tiles show others."""
        tiles = range(self._render.grid.count)
        self._stale.update(tiles)
        for index in tiles:
            self._count(index)

    def _count(self, tile_index: int) -> None:
        """Notes the samples that a tile shows now."""
        counts, samples = self._tile_counts[tile_index], self.samples_shown(tile_index)
        more = samples - int(counts[0, 0])
        if more:
            self._shown_samples += counts.size * more
            counts.fill(samples)

    def _advance(self, index: int, was_open: bool) -> None:
        if index == self._render.photon_index:
            self._show_photons()
        else:
            self._stale.update([index] if self.forward else ())
            self._count(index)
        if self.queues[index].closed:
            self._expected[index] = float(self.samples(index))
            self._unfinished -= was_open
