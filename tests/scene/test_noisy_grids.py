"""Grids of noisy readings: how far they are smoothed, and what the least true value is."""

import numpy as np
import pytest
from nocturne_scene.photometry.noisy_grids import calmed, least, least_is_at_least
from numpy.typing import NDArray

Values = NDArray[np.float64]
_DOWN, _ACROSS = np.mgrid[:8, :10].astype(float)
_FIELDS = {
    "even": np.full((8, 10), 500.0),
    "under lamps": 500.0 + 80.0 * np.cos(1.6 * _ACROSS) * np.cos(1.6 * _DOWN),
    "from a window": 100.0 + 3000.0 * np.exp(-_DOWN / 2.2),
    "darker at walls": 500.0
    * (1.0 - 0.4 * np.exp(-np.minimum(np.minimum(_ACROSS, 9 - _ACROSS), np.minimum(_DOWN, 7 - _DOWN)))),
}


def _readings(field: Values, part: float, times: int) -> Values:
    noise = np.random.default_rng(4).standard_normal((times, *field.shape))
    return field + part * field * noise


@pytest.mark.parametrize("name", _FIELDS)
def test_the_least_value_is_not_as_low_as_the_least_reading(name: str) -> None:
    """The least of 80 readings with errors of 2 % is low by up to 2.4 errors (an even field: the mean of the
    least of 80 normal numbers is -2.43); the estimate by less than two thirds of what the reading is. The
    interval of 95 % holds the truth, here in 40 of 40."""
    field, part = _FIELDS[name], 0.02
    found = [(each.min(), least(each, part * field)) for each in _readings(field, part, 40)]
    truth = field.min()
    raw = np.mean([low for low, _ in found]) - truth
    estimated = np.mean([each.value for _, each in found]) - truth
    assert abs(estimated) < 0.67 * abs(raw)
    held = sum(each.low <= truth <= each.high for _, each in found)
    # Fewer than 36 of 40 have a chance of 1.4 % at a true coverage of 95 % (binomial).
    assert held >= 36


def test_one_dark_place_stays() -> None:
    """A shadow of half the light, ten errors deep, is no noise."""
    field = np.full((8, 10), 500.0)
    field[5, 3] = 250.0
    found = [least(each, 0.05 * field).value for each in _readings(field, 0.05, 40)]
    # The mean of 40 readings has an error of 2.
    assert abs(np.mean(found) - 250.0) < 8.0


def test_values_are_smoothed_as_far_as_noise_goes() -> None:
    """Noise on an even field mostly goes; a field that is known without noise stays as it is."""
    even = np.full((8, 10), 500.0)
    (noisy,) = _readings(even, 0.1, 1)
    assert calmed(noisy, 0.1 * even).std() < 0.5 * noisy.std()
    lamps = _FIELDS["under lamps"]
    assert np.array_equal(calmed(lamps, np.zeros_like(lamps)), lamps)
    assert np.abs(calmed(lamps, 0.001 * lamps) - lamps).max() < 0.01 * 80.0


def test_planes_stay_whatever_the_noise() -> None:
    slope = 100.0 + 10.0 * _ACROSS + 5.0 * _DOWN
    assert calmed(slope, 0.3 * slope) == pytest.approx(slope)


def test_few_values_are_left_alone() -> None:
    row = np.array([[3.0, 1.0, 2.0]])
    assert np.array_equal(calmed(row, np.ones_like(row)), row)
    assert least(np.array([2.0]), np.array([0.0])).value == 2.0


def test_a_verdict_about_the_least_value_is_seldom_wrong() -> None:
    """At a limit just above or below the truth a wrong verdict with 95 % comes in 5 % of cases or fewer."""
    field, part = _FIELDS["even"], 0.03
    wrong_holds = wrong_fails = 0
    for each in _readings(field, part, 200):
        wrong_holds += least_is_at_least(each, part * field, 500.01)[0] >= 0.95
        wrong_fails += least_is_at_least(each, part * field, 499.99)[1] >= 0.95
    # More than 17 of 200 have a chance of 1.4 % at 5 % (binomial).
    assert wrong_holds <= 17
    assert wrong_fails <= 17


def test_without_noise_verdicts_are_certain() -> None:
    values, none = np.array([[2.0, 3.0]]), np.zeros((1, 2))
    assert least_is_at_least(values, none, 2.0) == (1.0, 0.0)
    assert least_is_at_least(values, none, 2.1) == (0.0, 1.0)
