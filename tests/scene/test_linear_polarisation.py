"""Degree and angle of linear polarisation from Stokes vectors with noise."""

import math

import numpy as np
import pytest
from nocturne_scene.photometry.polarisation import LinearPolarisation, polarisation_of
from nocturne_scene.uncertainty import RegionReading, moments_of, read_region
from numpy.typing import NDArray

from tests.sums import sums_of

_NAMES = ["X", "Y", "Z", "S1.Y", "S2.Y"]


def _read(stokes: NDArray[np.float64], covariance: NDArray[np.float64]) -> LinearPolarisation | None:
    mean, error = np.zeros(5), np.zeros(5)
    mean[[1, 3, 4]], error[[1, 3, 4]] = stokes, np.sqrt(np.diagonal(covariance))
    correlations = np.eye(5)
    both = np.sqrt(np.outer(np.diagonal(covariance), np.diagonal(covariance)))
    correlations[np.ix_([1, 3, 4], [1, 3, 4])] = covariance / both
    nothing = (math.nan, math.nan)
    reading = RegionReading(
        tuple(mean), tuple(error), nothing, nothing, 1.0, 1.96, 1, 0, 9, (9, 9), correlations
    )
    return polarisation_of(reading, _NAMES)


def test_without_noise() -> None:
    found = _read(np.array([2.0, 0.6, -0.8]), 1e-18 * np.eye(3))
    assert found is not None
    assert found.degree == pytest.approx(0.5)
    assert found.degree_interval == pytest.approx((0.5, 0.5), abs=1e-7)
    assert found.angle_degrees == pytest.approx(math.degrees(math.atan2(-0.8, 0.6)) / 2 + 180)
    assert found.angle_error < 1e-6


@pytest.mark.parametrize("degree", [0.0, 0.02, 0.1, 0.4])
def test_intervals_hold_and_the_mean_is_not_too_large(degree: float) -> None:
    """Of unpolarised light sqrt(S1² + S2²) would read 1.25 errors."""
    random = np.random.default_rng(1)
    covariance = np.diag([1e-4, 4e-4, 4e-4])
    covariance[0, 1] = covariance[1, 0] = 0.3 * 2e-4
    truth = np.array([1.0, degree * math.cos(1.0), degree * math.sin(1.0)])
    drawn = random.multivariate_normal(truth, covariance, 300)
    found = [each for each in (_read(stokes, covariance) for stokes in drawn) if each is not None]
    held = np.mean([each.degree_interval[0] <= degree <= each.degree_interval[1] for each in found])
    assert held > 0.92
    too_large = np.mean([each.degree for each in found]) - degree
    naive = np.mean(np.hypot(drawn[:, 1], drawn[:, 2]) / drawn[:, 0]) - degree
    assert abs(too_large) < (0.004 if degree >= 0.1 else 0.85 * naive)


def _told(reading: RegionReading | None, names: list[str]) -> LinearPolarisation:
    assert reading is not None
    found = polarisation_of(reading, names)
    assert found is not None
    return found


_SEEN = ["X", "Y", "Z", "S1.Y", "S2.Y", "S3.Y", "polariser0.Y", "polariser22.Y", "polariser45.Y"]


def _pixels(random: np.random.Generator, samples: int, edge: int) -> NDArray[np.float64]:
    """Samples of a tile: on its left, light that varies and is polarised by 0.3 in every sample; on its
    right, light that varies as much, with S1 that knows nothing of it."""
    light = random.gamma(4.0, 0.25, (samples, edge, edge))
    one = 0.3 * light
    one[:, :, edge // 2 :] = 0.3 + 0.15 * (random.random((samples, edge, edge // 2)) - 0.5)
    two = 0.4 * light
    twice = np.radians([0.0, 45.0, 90.0])
    behind = [0.5 * (light + np.cos(each) * one + np.sin(each) * two) for each in twice]
    return np.stack([light, light, light, one, two, 0.0 * light, *behind], axis=-1)


def test_pixels_know_how_their_own_stokes_parameters_go_together() -> None:
    """Light that is polarised alike in every sample is known without error, and its neighbours do not change
    that; where S1 and S0 know nothing of each other the interval holds."""
    samples, edge, runs = 256, 8, 60
    random = np.random.default_rng(4)
    names, held, chosen = [*_SEEN], [], np.zeros((edge, edge), dtype=bool)
    truth = float(np.hypot(0.3, 0.4))
    for _ in range(runs):
        sums = sums_of(_pixels(random, samples, edge))
        image = moments_of(
            sums.pixels,
            np.full((edge, edge), samples, dtype=np.uint32),
            sums.block_products,
            sums.tile_products[None],
            edge,
            names[3:],
        )
        for column in (1, 6):
            chosen[:] = False
            chosen[3, column] = True
            found = _told(read_region(image, chosen), names)
            low, high = found.degree_interval
            if column == 1:
                assert high - low < 1e-5
                assert found.degree == pytest.approx(0.5, rel=1e-6)
                assert found.angle_error < 1e-3
            else:
                held.append(low <= truth <= high)
                assert high - low < 0.06
    assert np.mean(held) >= 0.88


def test_noise_of_unpolarised_light_is_not_taken_for_rare_light() -> None:
    """Of samples that all are lit, S1 of either sign has the error by its samples alone."""
    samples, edge = 256, 8
    values = np.zeros((samples, edge, edge, len(_SEEN)))
    values[..., :3] = 1.0
    values[..., 3] = np.random.default_rng(5).choice([-0.5, 0.5], (samples, edge, edge))
    values[..., 6] = 0.5 * (1.0 + values[..., 3])
    values[..., 7] = 0.5 * (1.0 + np.sqrt(0.5) * values[..., 3])
    values[..., 8] = 0.5
    sums = sums_of(values)
    counts = np.full((edge, edge), samples, dtype=np.uint32)
    image = moments_of(sums.pixels, counts, sums.block_products, sums.tile_products[None], edge, _SEEN[3:])
    error = np.sqrt(image.variance + image.one_more)[..., 3]
    assert float(error.mean()) == pytest.approx(0.5 / np.sqrt(samples), rel=0.02)


def test_dark_or_untold() -> None:
    assert _read(np.zeros(3), np.eye(3)) is None
