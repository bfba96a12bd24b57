"""The image of a running render in memory: all tiles' sums, and how many samples each pixel has. Pure."""

import math
from bisect import bisect_left

import numpy as np
from nocturne_scene.photon_sums import with_photons
from nocturne_scene.ranges import PHOTON_BUNDLE, ratio_of
from nocturne_scene.tile_sums import PRODUCTS, TileSums, decode

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate, Squares, estimate_error
from nocturne_coordinator.dispatch.film_sums import FilmSums
from nocturne_coordinator.dispatch.merge import Counts, Offered, RangeSums, Sums, TileState
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.dispatch.trust import RangeEnd, confirmed, samples_to_stop
from nocturne_coordinator.limits import photon_ranges_ahead


class MergedFilm:
    """Sums, and the merge state of every tile, which holds views into them.

    Where forward photons have separate ranges they are merged like those of a tile after the last, whose
    samples are bundles, and what is shown of a tile are the sums of both. It has no samples to show until it
    has some of both kinds: a part of the light alone would look like an image.
    """

    def __init__(self, render: PlannedRender, stop: StopConditions | None = None) -> None:
        """`stop` says which tiles end before the schedule does. ValueError if it does not fit the
        schedule."""
        height, width = render.schedule.height, render.schedule.width
        self._shown = self._own = FilmSums.zeros(render.grid, render.further)
        self._forward: FilmSums | None = None
        self.counts: Counts = np.zeros((height, width), dtype=np.uint32)
        self._tile_counts = [self.counts[self._own.area(index)] for index in range(render.grid.count)]
        self._pixels = [counts.size for counts in self._tile_counts]
        if render.photon_ranges is not None:
            self._own = FilmSums.zeros(render.grid, render.further)
            self._forward = FilmSums.zeros(render.grid, render.further)
            self._pixels.append(PHOTON_BUNDLE)
        self.tiles = [TileState(self._own.tile(index)) for index in range(render.grid.count)]
        if self._forward is not None:
            self.tiles.append(TileState(self._forward.whole, ahead=photon_ranges_ahead(render.pixels)))
        self._stale: set[int] = set()
        """Tiles of which other sums are shown than there are by now."""
        self._before = [RangeEnd()] * len(self.tiles)
        self._now = [RangeEnd()] * len(self.tiles)
        self._plan(render, stop or EVERYTHING)

    def _plan(self, render: PlannedRender, stop: StopConditions) -> None:
        self._render, self._stop = render, stop
        self._last = [len(render.ranges_of(index)) for index in range(len(self.tiles))]
        if self._stop.tile_samples:
            self._last = [
                render.ranges_of(index).merged_at(end) if end else 0
                for index, end in enumerate(self._stop.tile_samples)
            ]
        self._expected = [float(self._end(index, last)) for index, last in enumerate(self._last)]
        for tile, last in zip(self.tiles, self._last, strict=True):
            tile.closed = last == 0
        self._unfinished = sum(not tile.closed for tile in self.tiles)

    def replan(self, render: PlannedRender, stop: StopConditions) -> None:
        """Goes on by another schedule, which begins with the ranges that are merged or wait, and by other
        conditions."""
        self._plan(render, stop)
        for index, state in enumerate(self.tiles):
            if state.merged:
                self._resume(index, self.error_before(index))

    def load(
        self, tile_index: int, samples: int, sums: bytes, error_before: float = 0.0, photons: bytes = b""
    ) -> None:
        """Puts back a tile as it was committed; ValueError if it doesn't fit the schedule. `error_before`:
        see `error_before`. `photons`: sums of forward photons that fell on it; their number comes before the
        tiles."""
        state = self.tiles[tile_index]
        if tile_index < self._render.grid.count:
            if sums:
                state.sums.assign(self._decoded(tile_index, sums))
            if self._forward is not None and photons and self.bundles:
                self._forward.tile(tile_index).assign(self._decoded(tile_index, photons))
        state.merged = self._render.ranges_of(tile_index).merged_at(samples) if samples else 0
        self._resume(tile_index, error_before)

    def _resume(self, tile_index: int, error_before: float) -> None:
        """A tile goes on where it stands, or has enough."""
        state = self.tiles[tile_index]
        closed = state.closed
        self._now[tile_index] = RangeEnd(self._end(tile_index, state.merged - 1), error_before)
        state.closed = closed or self._enough(tile_index, state)
        self._advance(tile_index, not closed)

    def _decoded(self, tile_index: int, sums: bytes) -> TileSums:
        tile = self._render.grid.tile(tile_index)
        return decode(sums, tile.width, tile.height, self._render.further)

    def offer(self, tile_index: int, offered: RangeSums) -> Offered:
        """Merges a range when its turn has come; see TileState.offer."""
        state = self.tiles[tile_index]
        outcome = state.offer(offered, lambda state: self._enough(tile_index, state))
        if outcome.released:
            self._advance(tile_index, True)
        return outcome

    def give_up(self, tile_index: int) -> list[RangeSums]:
        """The tile gets no more samples, whatever was asked for; gives ranges that waited for one before
        them."""
        state = self.tiles[tile_index]
        if state.closed:
            return []
        surplus = state.close()
        self._advance(tile_index, True)
        return surplus

    @property
    def complete(self) -> bool:
        """No tile needs more samples."""
        return self._unfinished == 0

    @property
    def tiles_done(self) -> int:
        """Tiles that need no more samples."""
        return min(self._render.grid.count, len(self.tiles) - self._unfinished)

    @property
    def traced_samples(self) -> int:
        """Pixels times samples of all tiles, and forward photons of separate ranges."""
        return sum(pixels * self.samples(index) for index, pixels in enumerate(self._pixels))

    @property
    def mean_samples(self) -> float:
        """Of a pixel."""
        tiles = range(self._render.grid.count)
        return sum(self._pixels[index] * self.samples(index) for index in tiles) / self._render.pixels

    @property
    def expected_samples(self) -> float:
        """`traced_samples` when all tiles will be done, as far as is known now."""
        return float(np.dot(self._expected, self._pixels))

    def horizons(self) -> list[int]:
        """Of each tile."""
        return [self.horizon(index) for index in range(len(self.tiles))]

    def horizon(self, tile_index: int) -> int:
        """How many ranges the tile is expected to need in all; at least one more than it has."""
        state = self.tiles[tile_index]
        if not self._stop.tile_relative_error or self._is_forward(tile_index):
            return self._last[tile_index]
        reached = bisect_left(self._render.schedule.range_ends, self._expected[tile_index]) + 1
        known = state.merged > 0 and math.isfinite(self._expected[tile_index])
        return min(self._last[tile_index], max(state.merged + 1, reached if known else 0))

    def samples(self, tile_index: int) -> int:
        """Samples merged of a tile; of forward photons, bundles."""
        return self._end(tile_index, self.tiles[tile_index].merged)

    def manifest(self) -> list[int]:
        """Samples of each tile."""
        return [self.samples(index) for index in range(len(self.tiles))]

    def error_before(self, tile_index: int) -> float:
        """The trusted error of a tile at the range end before its last, which a stop by error goes by, too;
        0: unknown."""
        return self._before[tile_index].error

    @property
    def has_forward_ranges(self) -> bool:
        return self._forward is not None

    def tile_bytes(self, tile_index: int) -> bytes:
        """A tile's sums as they are committed; see TileSums.encode."""
        return self.tiles[tile_index].sums.encode()

    def photon_bytes(self, tile_index: int) -> bytes:
        """The same of forward photons that fell on a tile."""
        return self._forward.tile(tile_index).encode() if self._forward else b""

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
    def numbers_held(self) -> int:
        """Of pixels, in memory."""
        return self._shown.whole.pixels.size * (3 if self._forward else 1)

    @property
    def squares(self) -> Squares:
        """Sums for the correlation of neighbours' errors."""
        self._refresh()
        grid, whole = self._render.grid, self._shown.whole
        tiles = whole.tile_products.reshape(-1, grid.columns, PRODUCTS)
        return Squares(whole.block_products, tiles, grid.tile_size)

    def _is_forward(self, tile_index: int) -> bool:
        return tile_index == self._render.grid.count

    @property
    def bundles(self) -> int:
        """Merged bundles of forward photons in separate ranges."""
        return self.samples(self._render.photon_index) if self._forward else 0

    def _together(self, tile_index: int) -> TileSums | None:
        """A tile's sums of both kinds of photons; None: one of them has not come."""
        own, samples = self.tiles[tile_index].sums, self.samples(tile_index)
        if self._forward is None:
            return own
        if not (self.bundles and samples):
            return None
        photons = self._forward.tile(tile_index)
        return with_photons(own, samples, photons, self.bundles, self._render.pixels)

    def _refresh(self) -> None:
        for index in self._stale:
            if both := self._together(index):
                self._shown.tile(index).assign(both)
        self._stale.clear()

    def _end(self, tile_index: int, merged: int) -> int:
        return self._render.ranges_of(tile_index)[merged - 1].end if merged > 0 else 0

    def _enough(self, tile_index: int, state: TileState) -> bool:
        """Whether a tile needs no more: asked at the end of each range, answered from its own sums."""
        if state.merged >= self._last[tile_index]:
            return True
        asked = self._stop.tile_relative_error
        if not asked:
            return False
        if self._is_forward(tile_index):
            return self._tiles_have_enough()
        sums = self._together(tile_index)
        if sums is None:
            return False
        samples = self._end(tile_index, state.merged)
        counts = np.full(sums.pixels.shape[:2], samples, dtype=np.uint32)
        squares = Squares(sums.block_products, sums.tile_products[None], self._render.grid.tile_size)
        estimate = estimate_error(sums.pixels, counts, squares)
        before, now = self._now[tile_index], RangeEnd.of(estimate)
        self._before[tile_index], self._now[tile_index] = before, now
        expected = samples_to_stop(estimate, samples, asked, self._render.schedule.range_ends)
        last = float(self._end(tile_index, self._last[tile_index]))
        self._expected[tile_index] = min(last, expected)
        return confirmed(before, now, asked)

    def _tiles_have_enough(self) -> bool:
        """Whether no tile needs more forward photons than there are: all have ended, and none has more
        adjoint ones for each pixel."""
        tiles = range(self._render.grid.count)
        most = max(self.samples(index) for index in tiles)
        return all(self.tiles[index].closed for index in tiles) and (
            self.bundles * PHOTON_BUNDLE >= most * self._render.pixels * ratio_of(self._render.schedule)
        )

    def _advance(self, tile_index: int, was_open: bool) -> None:
        state = self.tiles[tile_index]
        tiles = range(self._render.grid.count) if self._is_forward(tile_index) else [tile_index]
        self._stale.update(tiles if self._forward else ())
        for index in tiles:
            known = self._forward is None or self.bundles
            self._tile_counts[index].fill(self.samples(index) if known else 0)
        if state.closed:
            self._expected[tile_index] = float(self.samples(tile_index))
            self._unfinished -= was_open
