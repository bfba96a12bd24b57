"""The judge on readings with a known truth."""

import numpy as np
import pytest

from tests.crossings.judging import agree, differences, held, holm, leans
from tests.crossings.methods import Readings

_SEEDS, _REGIONS, _NAMES = 8, 5, ("X", "Y", "Z")


def _readings(
    random: np.random.Generator, mean: float, error: float, stated: float | None = None
) -> Readings:
    shape = (_SEEDS, _REGIONS, len(_NAMES))
    errors = np.full(shape, error if stated is None else stated)
    factors = np.full(shape[:2], 1.96)
    return Readings(_NAMES, random.normal(mean, error, shape), errors, factors, 0.0)


def test_false_alarms_are_as_rare_as_they_are_said_to_be() -> None:
    """Of 400 pairs that agree 1 % are expected; 4 in 400 +- 2, so that 12 come once in 3000."""
    random = np.random.default_rng(1)
    found = [agree({"a": _readings(random, 1, 0.1), "b": _readings(random, 1, 0.1)}) for _ in range(400)]
    assert sum(each < 0.01 for each in found) < 12


def test_a_bias_of_five_percent_is_found() -> None:
    random = np.random.default_rng(2)
    (found,) = differences({"a": _readings(random, 1.0, 0.01), "b": _readings(random, 1.05, 0.01)})
    assert found.surely < 1e-4
    assert found.ratio == pytest.approx(1.05, abs=0.02)


@pytest.mark.parametrize(("bias", "least", "most"), [(0.0, -3.3, 3.3), (-0.02, -12.0, -4.0)])
def test_a_bias_too_small_for_a_scene_adds_up_over_many(bias: float, least: float, most: float) -> None:
    """Of 400 scenes in which two means of 8 images have a standard error of 0.05 together: 0.4 of it is a
    lean of -8 over all. False alarms: 0.001, and 0.0001 that it is missed."""
    random = np.random.default_rng(4)
    found = [
        leans({"a": _readings(random, 1.0, 0.1), "b": _readings(random, 1.0 + bias, 0.1)})["b"]
        for _ in range(400)
    ]
    assert least < sum(found) / 20.0 < most


def test_what_stated_errors_explain_is_no_fault() -> None:
    """A method that misses rare light scatters little; its stated error allows for the light that it may have
    missed."""
    random = np.random.default_rng(3)
    (found,) = differences({"a": _readings(random, 1.0, 0.01, 0.5), "b": _readings(random, 1.1, 0.01)})
    assert found.probability < 1e-4
    assert found.surely > 0.1


def test_a_quarter_in_which_nothing_was_met_is_as_uncertain_as_the_image() -> None:
    """A lamp's dim corner: one method met it by no seed, another finds a hundredth of the image there.
    A fifth of it would be missed in the image, too."""
    for missing, least, most in ((0.01, 0.5, 1.0), (0.2, 0.0, 1e-4)):
        random = np.random.default_rng(6)
        one, other = _readings(random, 1.0, 0.02), _readings(random, 1.0, 0.001)
        one.means[:, 4], one.errors[:, 4] = 0.0, 0.0
        other.means[:, 4], other.errors[:, 4] = missing, 0.001
        (found,) = differences({"a": one, "b": other})
        assert least <= found.surely <= most


def test_black_is_black() -> None:
    random = np.random.default_rng(4)
    (found,) = differences({"a": _readings(random, 0.0, 0.0), "b": _readings(random, 0.0, 0.0)})
    assert found.surely == 1.0
    (found,) = differences({"a": _readings(random, 0.0, 0.0), "b": _readings(random, 1.0, 0.01)})
    assert found.surely < 1e-9


def test_coverage_of_right_and_of_small_errors() -> None:
    """Of 24 images of five regions each, by two methods."""
    random = np.random.default_rng(5)
    found = [held({"a": _readings(random, 1.0, 0.1), "b": _readings(random, 1.0, 0.1)}) for _ in range(50)]
    assert 0.94 < sum(inside for inside, _ in found) / sum(count for _, count in found) < 0.97
    small = {"a": _readings(random, 1.0, 0.1, 0.03), "b": _readings(random, 1.0, 0.1)}
    inside, count = held(small)
    assert inside / count < 0.85


def test_holm() -> None:
    assert holm([0.001, 0.004, 0.5], 0.01) == [True, True, False]
    assert holm([0.006, 0.5, 0.4], 0.01) == [False, False, False]
