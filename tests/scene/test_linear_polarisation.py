"""Degree and angle of linear polarisation from Stokes vectors with noise."""

import math

import numpy as np
import pytest
from nocturne_scene.photometry.polarisation import LinearPolarisation, polarisation_of
from nocturne_scene.uncertainty import RegionReading
from numpy.typing import NDArray

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


def test_dark_or_untold() -> None:
    assert _read(np.zeros(3), np.eye(3)) is None
