"""The sums that a tile's result holds, and how they lie in memory; as in worker/src/tile/tile_sums.h."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
Counts = NDArray[np.uint32]
"""Samples of pixels."""

XYZ_SUMS = 9
"""Sums of a pixel without further responses: X, Y, Z, YY, XX, ZZ, XY, XZ, YZ. Then come a sum for each
further response and one of its square for each."""

PRODUCTS = 6
"""Sums over samples of products of sums over pixels: YY, XX, ZZ, XY, XZ, YZ."""

PRODUCTS_SQUARES, PRODUCTS_PAIRS = [1, 0, 2], [3, 4, 5]
"""Places in PRODUCTS of XX, YY, ZZ and of XY, XZ, YZ. Taking the first of Y, X, Z gives X, Y, Z, and back."""

PIXEL_SQUARES, PIXEL_PAIRS = [4, 3, 5], [6, 7, 8]
"""The same places among the sums of a pixel."""

PAIRS = ("XY", "XZ", "YZ")
"""In the order of their products."""

PAIR_FIRST, PAIR_SECOND = [0, 0, 1], [1, 2, 2]
"""Places in X, Y, Z of the two factors of each pair."""

BLOCK = 4
"""Edge of a block in pixels; blocks begin at a tile's upper left corner."""

_XYZ_SUMS_BEFORE = 4
"""Of images from before errors of X, Z and further responses were kept: X, Y, Z, YY."""


def sums_per_pixel(further: int) -> int:
    """With so many further responses."""
    return XYZ_SUMS + 2 * further


def blocks_in(pixels: int) -> int:
    """Along an edge of so many pixels."""
    return -(-pixels // BLOCK)


def no_coefficients() -> Values:
    """Of the tiles of most renders."""
    return np.zeros((0, 0, 0))


@dataclass(frozen=True, slots=True, eq=False)
class TileSums:
    """Sums over samples of a tile; views into one run of numbers, or separate arrays."""

    pixels: Values
    """Shape (height, width, sums_per_pixel)."""
    block_products: Values
    """Shape (blocks down, blocks across, PRODUCTS), of what each block's pixels together have."""
    tile_products: Values
    """Shape (1, products_of_tile): the same of the whole tile, then the products of each further response
    with X, Y, Z, those before it and itself; of a film, a row for each of its tiles."""
    coefficients: Values = field(default_factory=no_coefficients)
    """Shape (height, width, coefficients): of daylight; without errors. Of most renders none."""

    def encode(self) -> bytes:
        """Float64, little endian: pixels, blocks, tile, coefficients."""
        return b"".join(part.astype("<f8", copy=False).tobytes() for part in self._parts)

    @classmethod
    def zeros(cls, width: int, height: int, further: int = 0) -> Self:
        """Of a tile without samples."""
        return cls(
            np.zeros((height, width, sums_per_pixel(further))),
            np.zeros((blocks_in(height), blocks_in(width), PRODUCTS)),
            np.zeros((1, products_of_tile(further))),
        )

    def __iadd__(self, other: "TileSums") -> Self:
        """Sums of further samples, in place."""
        for own, added in zip(self._parts, other._parts, strict=True):
            np.add(own, added, out=own)
        return self

    def unpacked(self) -> Self:
        """These sums: some others wait packed."""
        return self

    def assign(self, other: "TileSums") -> None:
        """In place."""
        for own, assigned in zip(self._parts, other._parts, strict=True):
            own[...] = assigned

    @property
    def _parts(self) -> tuple[Values, Values, Values, Values]:
        return self.pixels, self.block_products, self.tile_products, self.coefficients


def products_of_tile(further: int) -> int:
    """Of what a tile's pixels together have, with so many further responses."""
    return PRODUCTS + further * (further + 7) // 2


def factors_of_tile(further: int) -> tuple[list[int], list[int]]:
    """Of each of a tile's products, the places of its factors in X, Y, Z and further responses."""
    last, values = len("XYZ"), len("XYZ") + further
    pairs = [(a, b) for a in range(last, values) for b in range(a + 1)]
    return (
        [*PRODUCTS_SQUARES, *PAIR_FIRST, *(a for a, _ in pairs)],
        [*PRODUCTS_SQUARES, *PAIR_SECOND, *(b for _, b in pairs)],
    )


def numbers_in(width: int, height: int, further: int, tiles: int = 1) -> int:
    """How many a tile has, or a film of so many tiles."""
    blocks = blocks_in(width) * blocks_in(height)
    return width * height * sums_per_pixel(further) + PRODUCTS * blocks + products_of_tile(further) * tiles


def decode(data: bytes, width: int, height: int, further: int) -> TileSums:
    """What `encode` gave; ValueError where it is no such tile's. What follows the tile are coefficients.

    Of a tile from before there were errors of all quantities, or products of responses, unknown values are
    NaN.
    """
    found = np.frombuffer(data, dtype="<f8")
    pixels, products = width * height, products_of_tile(further) - PRODUCTS
    if products and found.size == numbers_in(width, height, further) - products:
        found = np.append(found, np.full(products, np.nan))
    if found.size == pixels * (_XYZ_SUMS_BEFORE + further):
        found = _from_before(found.reshape(pixels, -1), width, height, further)
    more = found.size - numbers_in(width, height, further)
    if more < 0 or more % pixels:
        raise ValueError(f"{len(data)} bytes are no sums of {width} x {height} pixels")
    if not more:
        return split(found, width, height, further)
    return replace(
        split(found[:-more], width, height, further), coefficients=found[-more:].reshape(height, width, -1)
    )


def split(numbers: Values, width: int, height: int, further: int, tiles: int = 1) -> TileSums:
    """Views into as many numbers as a tile has, or a film of so many tiles."""
    per_pixel = sums_per_pixel(further)
    end, of_tiles = width * height * per_pixel, products_of_tile(further) * tiles
    return TileSums(
        numbers[:end].reshape(height, width, per_pixel),
        numbers[end:-of_tiles].reshape(blocks_in(height), blocks_in(width), PRODUCTS),
        numbers[-of_tiles:].reshape(tiles, -1),
    )


def _from_before(sums: Values, width: int, height: int, further: int) -> Values:
    numbers = np.full(numbers_in(width, height, further), np.nan)
    pixels = split(numbers, width, height, further).pixels.reshape(len(sums), -1)
    pixels[:, :_XYZ_SUMS_BEFORE] = sums[:, :_XYZ_SUMS_BEFORE]
    pixels[:, XYZ_SUMS : XYZ_SUMS + further] = sums[:, _XYZ_SUMS_BEFORE:]
    return numbers


def block_sums(values: Values) -> Values:
    """Over blocks of pixels, in the order in which C++ adds them; shape (blocks down, blocks across, ...)."""
    height, width, *more = values.shape
    down, across = blocks_in(height), blocks_in(width)
    if (height, width) != (down * BLOCK, across * BLOCK):
        values = np.pad(values, [(0, -height % BLOCK), (0, -width % BLOCK), *[(0, 0)] * len(more)])
    # By pixel of the block: a sum over the first axis is added up one after the other.
    blocks = values.reshape(down, BLOCK, across, BLOCK, *more).swapaxes(1, 2)
    pixels = np.moveaxis(blocks, (2, 3), (0, 1)).reshape(BLOCK**2, down, across, *more)
    total: Values = np.add.reduce(pixels)
    return total


def tile_sums(of_blocks: Values, tile_size: int) -> Values:
    """Over the blocks of each tile, row by row as C++ adds them; shape (tiles down, tiles across, ...)."""
    height, width, *more = of_blocks.shape
    down, across = min(blocks_in(tile_size), height), min(blocks_in(tile_size), width)
    padded = of_blocks
    if height % down or width % across:
        padded = np.pad(of_blocks, [(0, -height % down), (0, -width % across), *[(0, 0)] * len(more)])
    tiles = padded.reshape(padded.shape[0] // down, down, padded.shape[1] // across, across, *more)
    rows, columns = tiles.shape[0], tiles.shape[2]
    one_after_the_other = np.cumsum(tiles.swapaxes(1, 2).reshape(rows, columns, -1, *more), axis=2)
    total: Values = one_after_the_other[:, :, -1]
    return total
