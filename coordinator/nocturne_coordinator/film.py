"""The image of a running render in memory: all tiles' sums, and how many samples each pixel has. Pure."""

import numpy as np

from .merge import Counts, RangeSums, Sums, TileState, Verdict
from .planned_render import PlannedRender


class Film:
    """Sums, of 32 bytes or more per pixel, and the merge state of every tile, which holds views into them."""

    def __init__(self, render: PlannedRender) -> None:
        self._render = render
        width, height = render.plan.width, render.plan.height
        self.sums: Sums = np.zeros((height, width, render.sums_per_pixel))
        self.counts: Counts = np.zeros((height, width), dtype=np.uint32)
        areas = [self._area(index) for index in range(render.grid.count)]
        self.tiles = [TileState(self.sums[area]) for area in areas]
        self._tile_counts = [self.counts[area] for area in areas]
        self._unfinished = render.grid.count

    def load(self, tile_index: int, samples: int, sums: bytes) -> None:
        """Puts back a tile as it was committed; ValueError if it doesn't fit the plan."""
        state = self.tiles[tile_index]
        state.sums[...] = np.frombuffer(sums, dtype="<f8").reshape(state.sums.shape)
        self._advance(tile_index, self._render.ranges.merged_at(samples))

    def offer(self, tile_index: int, offered: RangeSums) -> tuple[Verdict, list[RangeSums]]:
        """Merges a range when its turn has come; see TileState.offer."""
        verdict, released = self.tiles[tile_index].offer(offered)
        if released:
            self._advance(tile_index, self.tiles[tile_index].merged)
        return verdict, released

    @property
    def complete(self) -> bool:
        """Every planned range is merged."""
        return self._unfinished == 0

    def samples(self, tile_index: int) -> int:
        """Samples merged of a tile."""
        merged = self.tiles[tile_index].merged
        return self._render.ranges[merged - 1].end if merged else 0

    def tile_bytes(self, tile_index: int) -> bytes:
        """A tile's sums as they are committed: float64, little endian, row by row."""
        return self.tiles[tile_index].sums.astype("<f8", copy=False).tobytes()

    def _advance(self, tile_index: int, merged: int) -> None:
        self.tiles[tile_index].merged = merged
        self._tile_counts[tile_index].fill(self.samples(tile_index))
        if merged == len(self._render.ranges):
            self._unfinished -= 1

    def _area(self, tile_index: int) -> tuple[slice, slice]:
        tile = self._render.grid.tile(tile_index)
        return slice(tile.y, tile.y + tile.height), slice(tile.x, tile.x + tile.width)
