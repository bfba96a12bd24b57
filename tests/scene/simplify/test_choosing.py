"""Times and verdicts of models whose bias and noise are given."""

from math import inf

import pytest
from nocturne_scene.simplify.choosing import Model, budgets, can_join, promising, saving, verdict, worth_more
from nocturne_scene.simplify.simplification import Simplification
from nocturne_scene.simplify.statistics import UNBIASED, Bias, Interval

FULL = Model((), UNBIASED, 1.0, 1e-6)


def _part(name: str, *, exact: bool = False, kind: str = "") -> Simplification:
    return Simplification(name, lambda _: None, exact, kind)


def _model(
    name: str,
    local: tuple[float, float, float],
    mean: tuple[float, float, float] = (0, 0, 0),
    noise: float = 1.0,
    seconds: float = 1e-6,
    *,
    exact: bool = False,
    unsure: float = 1.0,
) -> Model:
    cost = Interval(seconds / FULL.seconds, seconds / FULL.seconds / unsure, seconds / FULL.seconds * unsure)
    return Model((_part(name, exact=exact),), Bias(Interval(*mean), Interval(*local)), noise, seconds, cost)


def test_the_full_model_has_all_of_the_target_for_noise() -> None:
    assert FULL.samples_for(0.02) == 2500
    assert FULL.seconds_for(0.02, 10_000) == pytest.approx(25.0)
    assert FULL.error_after(25.0, 10_000) == pytest.approx(0.02)


def test_bias_leaves_less_for_noise() -> None:
    """3-4-5: with 0.03 of bias at most, 0.04 of a target of 0.05 are left."""
    model = _model("fog", (0.01, 0.0, 0.03))
    assert model.samples_for(0.05) == 625
    assert model.samples_for(0.03) == inf
    assert model.error_after(1e12, 1) == pytest.approx(0.01)


def test_the_mean_counts_as_much_as_pixels_do() -> None:
    assert _model("fog", (0.0, 0.0, 0.01), mean=(-0.03, -0.06, 0.0)).samples_for(0.05) == inf


def test_theory_is_believed_more_than_chance() -> None:
    model = _model("roulette", (0.01, 0.0, 0.5), mean=(0.2, -0.1, 0.5), exact=True)
    assert model.samples_for(0.02) == 2500
    assert verdict(model, 0.02) == "same image"


@pytest.mark.parametrize(
    ("local", "mean", "expected"),
    [
        ((0.01, 0.005, 0.015), (0, -0.01, 0.01), "not needed"),
        ((0.05, 0.03, 0.06), (0, -0.01, 0.01), "needed"),
        ((0.01, 0.0, 0.03), (0, -0.01, 0.01), "undecided"),
        ((0.01, 0.0, 0.03), (-0.05, -0.06, -0.04), "needed"),
        ((0.01, 0.0, 0.015), (-0.01, -0.03, 0.01), "undecided"),
    ],
)
def test_the_ends_of_intervals_decide(
    local: tuple[float, float, float], mean: tuple[float, float, float], expected: str
) -> None:
    assert verdict(_model("fog", local, mean), 0.02) == expected


def test_promising_ones_meet_the_target_and_save_time() -> None:
    fast = _model("fast", (0, 0, 0.001), seconds=1e-7)
    faster_but_wrong = _model("wrong", (0.1, 0.09, 0.11), seconds=1e-8)
    same = _model("same", (0, 0, 0), seconds=0.97e-6)
    quiet = _model("quiet", (0, 0, 0), noise=0.5)
    assert promising([same, quiet, faster_but_wrong, fast], FULL, 0.02) == [fast, quiet]
    assert worth_more(fast, quiet, 0.02)
    assert saving(FULL, fast, 0.02) == pytest.approx(10, rel=0.01)
    # A gain that may be chance on a busy machine decides nothing.
    assert promising([_model("lucky", (0, 0, 0), seconds=0.8e-6, unsure=1.3)], FULL, 0.02) == []
    assert not worth_more(same, FULL, 0.02)


def test_one_of_a_kind() -> None:
    two, four = _part("2", kind="depth"), _part("4", kind="depth")
    assert not can_join((two,), four)
    assert can_join((two,), _part("fog"))
    assert can_join((_part("haze"),), _part("fog"))


def test_a_chart_goes_from_four_targets_of_noise_to_a_quarter() -> None:
    times = list(budgets([FULL], 0.02, 10_000, 5))
    errors = [FULL.error_after(time, 10_000) for time in times]
    assert errors == pytest.approx([0.08, 0.04, 0.02, 0.01, 0.005])
