"""Sums of a whole film, and views of its tiles. Pure."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np
from nocturne_scene.ranges import TileGrid
from nocturne_scene.tile_sums import (
    BLOCK,
    PRODUCTS,
    TileSums,
    Values,
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
    def zeros(cls, grid: TileGrid, further: int, coefficients: int = 0) -> Self:
        """Of a film without samples."""
        pixels = np.zeros((grid.height, grid.width, sums_per_pixel(further)))
        blocks = np.zeros((blocks_in(grid.height), blocks_in(grid.width), PRODUCTS))
        products = np.zeros((grid.count, products_of_tile(further)))
        if not coefficients:
            return cls(grid, TileSums(pixels, blocks, products))
        of_daylight = np.zeros((grid.height, grid.width, coefficients))
        return cls(grid, TileSums(pixels, blocks, products, of_daylight))

    def tile(self, index: int) -> TileSums:
        """Views of a tile's."""
        tile = self.grid.tile(index)
        rows = slice(tile.y // BLOCK, blocks_in(tile.y + tile.height))
        columns = slice(tile.x // BLOCK, blocks_in(tile.x + tile.width))
        return TileSums(
            self.whole.pixels[self.area(index)],
            self.whole.block_products[rows, columns],
            self.whole.tile_products[index : index + 1],
            self._coefficients(self.area(index)),
        )

    def tiles(self) -> Iterator[tuple[TileSums, tuple[slice, slice]]]:
        """Views of all, and the pixels of each. Of a large film there are 65,536: no message is made of
        any."""
        size, pixels, blocks = self.grid.tile_size, self.whole.pixels, self.whole.block_products
        products = self.whole.tile_products

        def steps(edge: int) -> list[tuple[slice, slice]]:
            ends = [(first, min(first + size, edge)) for first in range(0, edge, size)]
            return [(slice(*each), slice(each[0] // BLOCK, blocks_in(each[1]))) for each in ends]

        columns = steps(self.grid.width)
        index = 0
        for y, block_rows in steps(self.grid.height):
            row, row_blocks = pixels[y], blocks[block_rows]
            for x, block_columns in columns:
                views = row[:, x], row_blocks[:, block_columns], products[index : index + 1]
                yield TileSums(*views, self._coefficients((y, x))), (y, x)
                index += 1

    def _coefficients(self, area: tuple[slice, slice]) -> Values:
        whole = self.whole.coefficients
        return whole[area] if whole.size else whole

    def area(self, index: int) -> tuple[slice, slice]:
        """A tile's pixels."""
        tile = self.grid.tile(index)
        return slice(tile.y, tile.y + tile.height), slice(tile.x, tile.x + tile.width)
