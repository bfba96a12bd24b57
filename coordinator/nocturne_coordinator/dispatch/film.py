"""The image of a running render in memory: all tiles' sums, and how many samples each pixel has. Pure."""

import math
from bisect import bisect_left

import numpy as np
from nocturne_scene.tile_sums import BLOCK, PRODUCTS, TileSums, blocks_in, decode, sums_per_pixel

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate, Squares, estimate_error
from nocturne_coordinator.dispatch.merge import Counts, Offered, RangeSums, Sums, TileState
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.dispatch.trust import RangeEnd, confirmed, samples_to_stop


class Film:
    """Sums, of 72 bytes or more per pixel and 48 per block of pixels, and the merge state of every tile,
    which holds views into them."""

    def __init__(self, render: PlannedRender, stop: StopConditions | None = None) -> None:
        """`stop` says which tiles end before the schedule does. ValueError if it does not fit the
        schedule."""
        self._render = render
        self._stop = stop or EVERYTHING
        width, height = render.schedule.width, render.schedule.height
        self.sums: Sums = np.zeros((height, width, sums_per_pixel(render.further)))
        self.block_products: Sums = np.zeros((blocks_in(height), blocks_in(width), PRODUCTS))
        self.tile_products: Sums = np.zeros((render.grid.count, PRODUCTS))
        self.counts: Counts = np.zeros((height, width), dtype=np.uint32)
        self.tiles = [TileState(self._views(index)) for index in range(render.grid.count)]
        self._tile_counts = [self.counts[self._area(index)] for index in range(render.grid.count)]
        self._pixels = [counts.size for counts in self._tile_counts]
        self._last = [len(render.ranges)] * len(self.tiles)
        if self._stop.tile_samples:
            self._last = [render.ranges.merged_at(end) if end else 0 for end in self._stop.tile_samples]
        self._before = [RangeEnd()] * len(self.tiles)
        self._now = [RangeEnd()] * len(self.tiles)
        self._expected = [float(self._end(last)) for last in self._last]
        for tile, last in zip(self.tiles, self._last, strict=True):
            tile.closed = last == 0
        self._unfinished = sum(not tile.closed for tile in self.tiles)

    def load(self, tile_index: int, samples: int, sums: bytes, error_before: float = 0.0) -> None:
        """Puts back a tile as it was committed; ValueError if it doesn't fit the schedule. `error_before`:
        see `error_before`."""
        state = self.tiles[tile_index]
        height, width, _ = state.sums.pixels.shape
        state.sums.assign(decode(sums, width, height, self._render.further))
        state.merged = self._render.ranges.merged_at(samples)
        closed = state.closed
        self._now[tile_index] = RangeEnd(self._end(state.merged - 1), error_before)
        state.closed = closed or self._enough(tile_index, state)
        self._advance(tile_index, not closed)

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
        return len(self.tiles) - self._unfinished

    @property
    def expected_samples(self) -> float:
        """Pixels times samples when all tiles will be done, as far as can be told now."""
        return float(np.dot(self._expected, self._pixels))

    def horizon(self, tile_index: int) -> int:
        """How many ranges the tile is expected to need in all; at least one more than it has."""
        state = self.tiles[tile_index]
        if not self._stop.tile_relative_error:
            return self._last[tile_index]
        reached = bisect_left(self._render.schedule.range_ends, self._expected[tile_index]) + 1
        known = state.merged > 0 and math.isfinite(self._expected[tile_index])
        return min(self._last[tile_index], max(state.merged + 1, reached if known else 0))

    def samples(self, tile_index: int) -> int:
        """Samples merged of a tile."""
        return self._end(self.tiles[tile_index].merged)

    def manifest(self) -> list[int]:
        """Samples of each tile."""
        return [self.samples(index) for index in range(len(self.tiles))]

    def error_before(self, tile_index: int) -> float:
        """The trusted error of a tile at the range end before its last, which a stop by error goes by, too;
        0: unknown."""
        return self._before[tile_index].error

    def tile_bytes(self, tile_index: int) -> bytes:
        """A tile's sums as they are committed; see TileSums.encode."""
        return self.tiles[tile_index].sums.encode()

    def estimate(self) -> ErrorEstimate:
        """The image's mean and error, from its own sums."""
        return estimate_error(self.sums, self.counts, self.squares)

    @property
    def squares(self) -> Squares:
        """What tells how errors of neighbours go together."""
        grid = self._render.grid
        tiles = self.tile_products.reshape(-1, grid.columns, PRODUCTS)
        return Squares(self.block_products, tiles, grid.tile_size)

    def _end(self, merged: int) -> int:
        return self._render.ranges[merged - 1].end if merged > 0 else 0

    def _enough(self, tile_index: int, state: TileState) -> bool:
        """Whether a tile needs no more: asked at the end of each range, answered from its own sums."""
        if state.merged >= self._last[tile_index]:
            return True
        asked = self._stop.tile_relative_error
        if not asked:
            return False
        samples = self._end(state.merged)
        sums = state.sums
        counts = np.full(sums.pixels.shape[:2], samples, dtype=np.uint32)
        squares = Squares(sums.block_products, sums.tile_products[None], self._render.grid.tile_size)
        estimate = estimate_error(sums.pixels, counts, squares)
        before, now = self._now[tile_index], RangeEnd.of(estimate)
        self._before[tile_index], self._now[tile_index] = before, now
        expected = samples_to_stop(estimate, samples, asked, self._render.schedule.range_ends)
        self._expected[tile_index] = min(float(self._end(self._last[tile_index])), expected)
        return confirmed(before, now, asked)

    def _advance(self, tile_index: int, was_open: bool) -> None:
        state = self.tiles[tile_index]
        samples = self._end(state.merged)
        self._tile_counts[tile_index].fill(samples)
        if state.closed:
            self._expected[tile_index] = float(samples)
            self._unfinished -= was_open

    def _views(self, tile_index: int) -> TileSums:
        tile = self._render.grid.tile(tile_index)
        rows = slice(tile.y // BLOCK, blocks_in(tile.y + tile.height))
        columns = slice(tile.x // BLOCK, blocks_in(tile.x + tile.width))
        return TileSums(
            self.sums[self._area(tile_index)],
            self.block_products[rows, columns],
            self.tile_products[tile_index : tile_index + 1],
        )

    def _area(self, tile_index: int) -> tuple[slice, slice]:
        tile = self._render.grid.tile(tile_index)
        return slice(tile.y, tile.y + tile.height), slice(tile.x, tile.x + tile.width)
