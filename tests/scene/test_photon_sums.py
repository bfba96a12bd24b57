"""Sums of forward photons as workers send them, and the sums of both directions together."""

import zlib
from dataclasses import astuple

import numpy as np
import pytest
from nocturne_scene.photon_sums import decode_photon_sums, with_photons
from nocturne_scene.pixel_errors import covariance_of_means, variance_of_mean
from nocturne_scene.ranges import PHOTON_BUNDLE
from nocturne_scene.tile_sums import TileSums, factors_of_tile, products_of_tile, sums_per_pixel

from tests.sums import sums_of


def _planes(numbers: np.ndarray, size: int) -> bytes:
    whole = numbers.astype(">f4").reshape(-1, 1).view(np.uint8)
    return b"".join(whole[:, byte].tobytes() for byte in range(size))


def _encoded(pixels: np.ndarray, products: list[np.ndarray], further: int) -> bytes:
    """As workers pack them."""
    values = {0, 1, 2, *range(9, 9 + further)}
    kinds = [_planes(pixels[..., c], 4 if c in values else 2) for c in range(pixels.shape[-1])]
    kinds += [_planes(each[..., c], 2) for each in products for c in range(each.shape[-1])]
    return zlib.compress(b"".join(kinds))


@pytest.fixture
def sums() -> tuple[np.ndarray, list[np.ndarray]]:
    """Of 8 x 5 pixels, a further response, and two tiles: small whole numbers, exact in all that is sent."""
    rng = np.random.default_rng(1)
    shapes = [(5, 8, sums_per_pixel(1)), (2, 2, 6), (2, products_of_tile(1))]
    pixels, *products = (rng.integers(0, 128, shape).astype(np.float64) for shape in shapes)
    return pixels, products


def test_what_was_packed_is_unpacked(sums: tuple[np.ndarray, list[np.ndarray]]) -> None:
    pixels, products = sums
    found = decode_photon_sums(_encoded(pixels, products, 1), 8, 5, 1, 2)
    *parts, coefficients = astuple(found)
    for part, expected in zip(parts, [pixels, *products], strict=True):
        np.testing.assert_array_equal(part, expected)
    assert coefficients.size == 0


@pytest.mark.parametrize("spoil", [lambda data: data[:-1], lambda data: data + b"x", lambda data: data[:1]])
def test_other_bytes_are_refused(sums: tuple[np.ndarray, list[np.ndarray]], spoil: object) -> None:
    assert callable(spoil)
    data = spoil(_encoded(*sums, 1))
    with pytest.raises(ValueError, match="sums"):
        decode_photon_sums(data, 8, 5, 1, 2)


def test_bytes_of_another_film_are_refused_before_they_fill_the_memory() -> None:
    with pytest.raises(ValueError, match="expected 120"):
        decode_photon_sums(zlib.compress(bytes(2**24)), 4, 1, 0, 1)


def test_means_and_variances_add_up() -> None:
    rng = np.random.default_rng(2)
    samples, bundles, film_pixels = 16, 3, 4096
    film, photons = TileSums.zeros(8, 8, 1), TileSums.zeros(8, 8, 1)
    for sums, scale in ((film, 1.0), (photons, 1e-3)):
        for part in (sums.pixels, sums.block_products, sums.tile_products):
            part[...] = scale * rng.uniform(1.0, 2.0, part.shape)
    film.pixels[..., 3:9] *= 4.0
    both = with_photons(film, samples, photons, bundles, film_pixels)
    count = bundles * PHOTON_BUNDLE
    n = np.full((8, 8), samples)
    for value, square in ((0, 4), (1, 3), (2, 5), (9, 10)):
        mean = both.pixels[..., value] / samples
        expected = film.pixels[..., value] / samples + photons.pixels[..., value] * film_pixels / count
        np.testing.assert_allclose(mean, expected, rtol=1e-14)
        found = variance_of_mean(both.pixels[..., value], both.pixels[..., square], n)
        of_film = variance_of_mean(film.pixels[..., value], film.pixels[..., square], n)
        theirs = photons.pixels[..., square] - photons.pixels[..., value] ** 2 / count
        np.testing.assert_allclose(found, of_film + theirs * (film_pixels / count) ** 2, rtol=1e-9)


def test_products_of_responses_add_up() -> None:
    """Covariances of a tile's means of X, Y, Z and two responses, from whole samples of both directions."""
    rng = np.random.default_rng(3)
    samples, bundles, film_pixels = 64, 1, 64
    film = sums_of(rng.uniform(1.0, 2.0, (samples, 8, 8, 5)))
    photons = sums_of(rng.uniform(0.0, 1.0, (PHOTON_BUNDLE, 8, 8, 5)))
    both = with_photons(film, samples, photons, bundles, film_pixels)
    scale = film_pixels / PHOTON_BUNDLE
    values = [0, 1, 2, 9, 10]
    one, other = factors_of_tile(2)

    def covariances(sums: TileSums, count: int) -> np.ndarray:
        of_tile = sums.pixels[..., values].sum(axis=(0, 1))
        n = np.full(len(one), count)
        return covariance_of_means(sums.tile_products[0], of_tile[one], of_tile[other], n)

    expected = covariances(film, samples)
    expected = expected + covariances(photons, PHOTON_BUNDLE) * (scale * PHOTON_BUNDLE) ** 2
    np.testing.assert_allclose(covariances(both, samples), expected, rtol=1e-3, atol=1e-3 * expected.max())
