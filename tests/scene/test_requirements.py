"""Requirements of standards and by hand, and how sure they hold."""

import pytest
from nocturne_scene.errors import InputError
from nocturne_scene.photometry.requirements import Certainty, certainty, requirement, together


def test_the_row_of_an_office() -> None:
    """EN 12464-1:2021, 34.2."""
    found = requirement("EN 12464-1:34.2")
    assert (found.em, found.u0, found.ugr, found.ra, found.ez) == (500, 0.6, 19, 80, 150)
    assert requirement("en 12464-1:2021:34.2") == found
    assert "writing" in found.name


def test_limits_by_hand() -> None:
    found = requirement("Em=300, u0=0.4,UGR=22,DF=2")
    assert (found.em, found.u0, found.ugr, found.df, found.ra) == (300, 0.4, 22, 2, None)


@pytest.mark.parametrize("text", ["EN 12464-1:99.1", "Em", "Em=much", "lux=500", "Em=-3", "Em=nan"])
def test_what_is_not_understood_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="expected"):
        requirement(text)


def test_probabilities_of_a_normal_error() -> None:
    """1.645 errors: 95 % (tables of the normal distribution)."""
    assert certainty(501.645, 1.0, 500.0).holds == pytest.approx(0.95, abs=1e-4)
    assert certainty(498.355, 1.0, 500.0).verdict == "fails"
    assert certainty(500.0, 1.0, 500.0).verdict == "open"
    assert certainty(17.0, 1.0, 19.0, at_most=True).holds == pytest.approx(0.97725, abs=1e-4)


def test_an_unknown_error_decides_nothing() -> None:
    assert certainty(900.0, None, 500.0) == Certainty(0.0, 0.0)
    assert certainty(900.0, float("nan"), 500.0).verdict == "open"
    assert certainty(float("nan"), 1.0, 500.0).verdict == "open"


def test_of_several_limits_doubts_add_up() -> None:
    whole = together([Certainty(0.98, 0.02), Certainty(0.96, 0.04)])
    assert whole.holds == pytest.approx(0.94)
    assert whole.verdict == "open"
    assert together([Certainty(1.0, 0.0), Certainty(0.01, 0.99)]).verdict == "fails"


def test_rows_without_a_public_source_say_so() -> None:
    assert "not checked" in requirement("EN 12464-1:34.3").name
    assert "not checked" not in requirement("EN 12464-1:34.2").name
