"""The torture cases that must stay right, and the judge itself. All cases: `make stability`."""

from pathlib import Path

import numpy as np
import pytest
from nocturne_client.local.programs import CHECKOUT

from bench.report import kept
from bench.ways import WAYS
from tests.stability.case import Case
from tests.stability.cases import GROUPS
from tests.stability.measure import measure
from tests.stability.page import from_json, page, summary_page
from tests.stability.verdict import Verdict, Word, judge

_ALL = {case.name: case for cases in GROUPS.values() for case in cases}
_DEFAULT = WAYS[0]

KEPT = (
    "furnace at 1000 m",
    "furnace of 1e-06 m",
    "furnace of 1e+09 m",
    "furnace at 1e+07 m",
    "dark box at 10000 m",
    "dark box at 1e+06 m",
    "absorbing plate 100000 times as wide as thick",
    "nested instances, scales 1e-6 to 1e6",
    "triangles without an area",
    "metal, alpha 1e-06",
    "glass of index 1.5 at 89.9 degrees",
    "plate of index 1.0001",
    "ten plates of 1e-06 m",
    "camera in the middle of a glass ball",
    "lamp of radius 1e-05 at 1 m",
    "sun of 0.01 degrees",
    "sodium lines, 0.01 nm wide",
    "media that overlap by half",
    "a white cube turns once",
)
"""Quick ones, right by the default method."""

REFUSED = [case for case in _ALL.values() if case.truth is None]


@pytest.mark.system
@pytest.mark.parametrize("name", KEPT)
def test_stays_right(name: str, tmp_path: Path) -> None:
    """False alarms: 0.01 for 600 such tests."""
    verdict = measure(_ALL[name], _DEFAULT, tmp_path)
    assert verdict.word is Word.RIGHT, verdict


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_is_refused(case: Case, tmp_path: Path) -> None:
    verdict = measure(case, _DEFAULT, tmp_path)
    assert verdict.word is Word.REFUSED
    assert "$." in verdict.said


def test_there_are_enough_cases() -> None:
    assert len(_ALL) >= 40
    assert len(_ALL) == sum(map(len, GROUPS.values())), "names are not unique"


def _pixels(mean: float, deviation: float) -> np.typing.NDArray[np.float64]:
    """64 values with exactly these statistics."""
    signs = np.array([-1.0, 1.0] * 32)
    return np.asarray(mean + deviation * np.sqrt(63 / 64) * signs)


def test_judge() -> None:
    """Deviations in standard errors, of 64 pixels: an eighth of the pixels' deviation."""
    errors = np.full(64, 0.08)
    assert judge(_pixels(1.00, 0.08), errors, 1.0, 0.0)[0] is Word.RIGHT
    assert judge(_pixels(1.03, 0.08), errors, 1.0, 0.0)[0] is Word.RIGHT
    assert judge(_pixels(1.06, 0.08), errors, 1.0, 0.0)[0] is Word.BIASED
    assert judge(_pixels(1.06, 0.08), errors, 1.0, 0.06)[0] is Word.RIGHT
    assert judge(_pixels(1.00, 0.40), errors * 5, 1.0, 0.0)[0] is Word.NOISY
    assert judge(_pixels(1.00, 0.40), errors, 1.0, 0.0)[0] is Word.UNEVEN
    assert judge(np.zeros(64), errors, 1.0, 0.0)[0] is Word.NOTHING
    one = np.zeros(64)
    one[5] = 64.0
    assert judge(one, one, 1.0, 0.0)[0] is Word.NOISY
    assert judge(np.zeros(64), errors, 0.0, 0.0)[0] is Word.RIGHT
    assert judge(one, errors, 0.0, 0.0)[0] is Word.BIASED


def test_kept_matrix_has_all_cases_and_its_page() -> None:
    """Both pages are those that `make stability` makes of the kept matrix."""
    matrix = from_json((CHECKOUT / "bench" / "results" / "stability.json").read_text())
    assert list(matrix) == list(_ALL)
    made = page(matrix, kept().get("rare_light"))
    assert (CHECKOUT / "tests" / "stability" / "README.md").read_text() == made
    assert (CHECKOUT / "docs" / "explanation" / "stability.md").read_text() == summary_page(matrix)


def test_the_default_is_never_off_without_a_warning() -> None:
    matrix = from_json((CHECKOUT / "bench" / "results" / "stability.json").read_text())
    off = {name: row[_DEFAULT.name] for name, row in matrix.items() if row[_DEFAULT.name].word is Word.BIASED}
    assert off, "the page has had such cells since it was first made"
    assert [name for name, verdict in off.items() if not verdict.warned] == []


def test_one_that_could_not_see_a_fault_is_no_way_out() -> None:
    case = _ALL["furnace at 100000 m"]
    row = {"two photons": Verdict(Word.BIASED, -3e-3, 2e-4), "path": Verdict(Word.RIGHT, -3e-3, 1e-3)}
    assert "No method is known to be right." in page({case.name: row})


def test_page_says_what_to_use_instead() -> None:
    case = _ALL["sun of 0.01 degrees"]
    row = {"two photons": Verdict(Word.RIGHT, 0.0, 1e-3), "kernel only": Verdict(Word.NOTHING, -1.0, 0.0)}
    text = page({case.name: row})
    assert "| sun of 0.01 degrees | right ± 0.1 % | **found nothing** |" in text
    assert "Instead of kernel only: two photons." in text
    assert case.remedy in text
