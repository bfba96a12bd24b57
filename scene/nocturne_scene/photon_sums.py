"""What forward photons add to a film of many tiles: their sums as workers send them, and the sums of both
directions together; as in worker/src/tile/photon_range.h."""

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.ranges import PHOTON_BUNDLE
from nocturne_scene.tile_sums import (
    PAIR_FIRST,
    PAIR_SECOND,
    PRODUCTS_SQUARES,
    XYZ_SUMS,
    TileSums,
    Values,
    block_sums,
    factors_of_tile,
    numbers_in,
    split,
    sums_per_pixel,
    tile_sums,
)

_XYZ = 3
_VALUE_BYTES, _PRODUCT_BYTES = 4, 2
"""Bytes of a float32 that are sent of a sum of values, and of a sum of products."""

_Factors = tuple[Values, Values]

_FACTORS = (PRODUCTS_SQUARES + PAIR_FIRST, PRODUCTS_SQUARES + PAIR_SECOND)
"""Of PRODUCTS, places in X, Y, Z."""


@dataclass(frozen=True, slots=True)
class PackedPhotons:
    """A photon range's sums as they were sent: unpacked, they are some ten times as large."""

    data: bytes
    width: int
    height: int
    further: int
    tiles: int

    def unpacked(self) -> TileSums:
        """ValueError where `data` is none of such a film."""
        return decode_photon_sums(self.data, self.width, self.height, self.further, self.tiles)


def decode_photon_sums(data: bytes, width: int, height: int, further: int, tiles: int) -> TileSums:
    """A photon range's sums of a film of so many tiles; ValueError where `data` is none."""
    numbers = np.zeros(numbers_in(width, height, further, tiles))
    sums = split(numbers, width, height, further, tiles)
    kinds = list(_kinds(sums, further))
    expected = sum(kind.size * size for kind, size in kinds)
    planes = np.frombuffer(_decompressed(data, expected), dtype=np.uint8)
    first = 0
    for kind, size in kinds:
        end = first + kind.size * size
        kind[...] = _from_planes(planes[first:end].reshape(size, kind.size)).reshape(kind.shape)
        first = end
    return sums


def _decompressed(data: bytes, expected: int) -> bytes:
    unpacking = zlib.decompressobj()
    try:
        found = unpacking.decompress(data, expected + 1)
    except zlib.error as error:
        raise ValueError(f"sums that can't be unpacked: {error}") from None
    if len(found) != expected or not unpacking.eof or unpacking.unused_data:
        raise ValueError(f"sums of {len(found)} bytes or more; expected {expected}")
    return found


def _kinds(sums: TileSums, further: int) -> Iterator[tuple[Values, int]]:
    """Views of one kind of number each, in the order in which they are sent, and the bytes of each."""
    for channel in range(sums_per_pixel(further)):
        is_value = channel < _XYZ or XYZ_SUMS <= channel < XYZ_SUMS + further
        yield sums.pixels[..., channel], _VALUE_BYTES if is_value else _PRODUCT_BYTES
    for products in (sums.block_products, sums.tile_products):
        for channel in range(products.shape[-1]):
            yield products[..., channel], _PRODUCT_BYTES


def _from_planes(planes: NDArray[np.uint8]) -> NDArray[np.float32]:
    """From the highest bytes of all numbers, then the next ones, and so on."""
    whole = np.zeros((planes.shape[1], _VALUE_BYTES), dtype=np.uint8)
    whole[:, : len(planes)] = planes.T
    return whole.view(">f4")[:, 0]


def with_photons(film: TileSums, samples: int, photons: TileSums, bundles: int, film_pixels: int) -> TileSums:
    """Sums of `samples` samples whose parts, adjoint and forward, know nothing of each other: means add up,
    and so do variances of means.

    Both of one tile, whose products are in `tile_products[0]`. `bundles` were traced for all pixels of the
    film. Samples and bundles are at least 1.
    """
    count = float(bundles * PHOTON_BUNDLE)
    both = _Independent(float(samples), count, samples * film_pixels / count)
    squares = XYZ_SUMS + (film.pixels.shape[-1] - XYZ_SUMS) // 2
    values, products = slice(_XYZ), slice(_XYZ, XYZ_SUMS)
    further, their_squares = slice(XYZ_SUMS, squares), slice(squares, None)
    ours, theirs, pixels = film.pixels, photons.pixels, film.pixels.copy()
    for part in (values, further):
        pixels[..., part] = both.sums(ours[..., part], theirs[..., part])
    pixels[..., products] = both.products_of_xyz(
        ours[..., values], ours[..., products], theirs[..., values], theirs[..., products]
    )
    pixels[..., their_squares] = both.products(
        ours[..., their_squares],
        (ours[..., further],) * 2,
        theirs[..., their_squares],
        (theirs[..., further],) * 2,
    )
    all_values = [*range(_XYZ), *range(XYZ_SUMS, squares)]
    blocks, photon_blocks = block_sums(ours[..., all_values]), block_sums(theirs[..., all_values])
    size = max(ours.shape[:2])
    return TileSums(
        pixels,
        both.products_of_xyz(blocks, film.block_products, photon_blocks, photons.block_products),
        both.products_of_all(
            tile_sums(blocks, size)[0],
            film.tile_products,
            tile_sums(photon_blocks, size)[0],
            photons.tile_products,
        ),
    )


class _Independent(NamedTuple):
    """What adds up numbers that know nothing of each other: those of samples of a film, and of photons whose
    sums count `scale` times. In the order of steps that C++ has, so that bits are equal."""

    samples: float
    photons: float
    scale: float

    def sums(self, film: Values, photons: Values) -> Values:
        return film + self.scale * photons

    def products(
        self, film: Values, film_factors: _Factors, photons: Values, photon_factors: _Factors
    ) -> Values:
        """Sums of products over samples, such that variances of means, or covariances, add up."""
        (film_a, film_b), (photon_a, photon_b) = film_factors, photon_factors
        whole = self.sums(film_a, photon_a) * self.sums(film_b, photon_b) / self.samples
        of_film = film - film_a * film_b / self.samples
        of_photons = photons - photon_a * photon_b / self.photons
        return whole + of_film + (self.samples - 1.0) / self.samples * (self.scale * self.scale) * of_photons

    def products_of_all(
        self, values: Values, products: Values, photon_values: Values, of_photons: Values
    ) -> Values:
        """A tile's products, with those of further responses."""
        one, other = factors_of_tile(values.shape[-1] - _XYZ)
        return self.products(
            products,
            (values[..., one], values[..., other]),
            of_photons,
            (photon_values[..., one], photon_values[..., other]),
        )

    def products_of_xyz(
        self, xyz: Values, products: Values, photon_xyz: Values, of_photons: Values
    ) -> Values:
        """The six PRODUCTS of X, Y, Z in the last axis."""
        one, other = _FACTORS
        return self.products(
            products,
            (xyz[..., one], xyz[..., other]),
            of_photons,
            (photon_xyz[..., one], photon_xyz[..., other]),
        )
