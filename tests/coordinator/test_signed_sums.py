"""Sums of polarised light may be negative, and all others may not."""

import numpy as np
import pytest
from nocturne_coordinator.dispatch.planned_render import RejectedResult, check_sums
from nocturne_scene.tile_sums import PRODUCTS, TileSums, factors_of_tile

_SAMPLES, _EDGE = 16, 4
_SIGNED = [False, True]
"""A response, and one of polarised light."""


def _sums() -> TileSums:
    """Of samples by chance: X, Y, Z, both responses."""
    random = np.random.default_rng(3)
    values = random.random((_SAMPLES, _EDGE, _EDGE, 5))
    values[..., 4] -= 0.9
    x, y, z = (values[..., each] for each in range(3))
    further = values[..., 3:]
    each_pixel = [x, y, z, y * y, x * x, z * z, x * y, x * z, y * z]
    pixels = np.stack([each.sum(axis=0) for each in each_pixel], axis=-1)
    pixels = np.concatenate([pixels, further.sum(axis=0), (further**2).sum(axis=0)], axis=-1)
    together = values.sum(axis=(1, 2))
    first, second = factors_of_tile(2)
    products = (together[:, first] * together[:, second]).sum(axis=0)
    found = TileSums.zeros(_EDGE, _EDGE, 2)
    found.pixels[:] = pixels
    found.block_products[:] = products[:PRODUCTS]
    found.tile_products[:] = products
    return found


def test_polarised_light_may_be_negative() -> None:
    sums = _sums()
    assert (sums.pixels[..., 10] < 0.0).all()
    assert (sums.tile_products < 0.0).any()
    check_sums(sums, _SAMPLES, _SIGNED)
    with pytest.raises(RejectedResult, match="negative"):
        check_sums(sums, _SAMPLES)


@pytest.mark.parametrize("place", [9, 11, 12])
def test_responses_and_squares_may_not(place: int) -> None:
    sums = _sums()
    sums.pixels[0, 0, place] *= -1.0
    with pytest.raises(RejectedResult):
        check_sums(sums, _SAMPLES, _SIGNED)


@pytest.mark.parametrize("value", [np.nan, -1e200])
def test_polarised_light_is_of_this_world(value: float) -> None:
    sums = _sums()
    sums.pixels[0, 0, 10] = value
    with pytest.raises(RejectedResult):
        check_sums(sums, _SAMPLES, _SIGNED)
