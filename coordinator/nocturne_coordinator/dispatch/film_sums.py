"""Sums of a whole film, and views of its tiles. Pure."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from nocturne_scene.ranges import TileGrid
from nocturne_scene.tile_sums import (
    BLOCK,
    PRODUCTS,
    TileSums,
    blocks_in,
    products_of_tile,
    sums_per_pixel,
)


@dataclass(frozen=True, slots=True)
class FilmSums:
    """72 bytes or more for each pixel and 48 for each block of pixels."""

    grid: TileGrid
    whole: TileSums
    """Products of tiles: a row for each."""

    @classmethod
    def zeros(cls, grid: TileGrid, further: int) -> Self:
        """Of a film without samples."""
        pixels = np.zeros((grid.height, grid.width, sums_per_pixel(further)))
        blocks = np.zeros((blocks_in(grid.height), blocks_in(grid.width), PRODUCTS))
        return cls(grid, TileSums(pixels, blocks, np.zeros((grid.count, products_of_tile(further)))))

    def tile(self, index: int) -> TileSums:
        """Views of a tile's."""
        tile = self.grid.tile(index)
        rows = slice(tile.y // BLOCK, blocks_in(tile.y + tile.height))
        columns = slice(tile.x // BLOCK, blocks_in(tile.x + tile.width))
        return TileSums(
            self.whole.pixels[self.area(index)],
            self.whole.block_products[rows, columns],
            self.whole.tile_products[index : index + 1],
        )

    def area(self, index: int) -> tuple[slice, slice]:
        """A tile's pixels."""
        tile = self.grid.tile(index)
        return slice(tile.y, tile.y + tile.height), slice(tile.x, tile.x + tile.width)
