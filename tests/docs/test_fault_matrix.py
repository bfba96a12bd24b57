"""tests/faults/README.md has every row of the fault matrix, with the tests of it in tests/faults."""

import ast
import re
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]

_ROW = re.compile(r"^\| ([A-Z]\d+) \| (.+?) \| (x?) ?\| (.+?) \| (.+?) \|$", re.MULTILINE)
_IDS = re.compile(r"((?:[A-Z]\d+(?:, )?)+): ")
_FILE = re.compile(r"`(test_\w+\.py)`")


class Row(NamedTuple):
    """Of the table in tests/faults/README.md."""

    name: str
    fault: str
    in_make_test: str
    tests: str
    result: str


def _rows() -> list[Row]:
    page = (ROOT / "tests" / "faults" / "README.md").read_text(encoding="utf-8")
    return [Row(*match) for match in _ROW.findall(page)]


def _tested() -> dict[str, dict[str, bool]]:
    """By row that a docstring in tests/faults names: the files, and whether `make test` runs such a test."""
    found: dict[str, dict[str, bool]] = defaultdict(dict)
    for path in sorted((ROOT / "tests" / "faults").glob("test_*.py")):
        module = ast.parse(path.read_text(encoding="utf-8"))
        all_soak = any(
            isinstance(each, ast.Assign) and ast.unparse(each) == "pytestmark = pytest.mark.soak"
            for each in module.body
        )
        for test in module.body:
            if not isinstance(test, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            if not test.name.startswith("test_"):
                continue
            named = _IDS.match(ast.get_docstring(test) or "")
            soak = all_soak or any(ast.unparse(each) == "pytest.mark.soak" for each in test.decorator_list)
            for name in named[1].split(", ") if named else ():
                found[name][path.name] = found[name].get(path.name, False) or not soak
    return found


def test_every_row_has_its_tests_and_a_result() -> None:
    rows = _rows()
    # 10 of workers, 6 of lies, 3 of transport, 4 of Redis, 8 of coordinators, 4 of all, 14 found by attacks.
    assert len({row.name for row in rows}) == len(rows) == 49
    tested = _tested()
    assert {row.name: set(_FILE.findall(row.tests)) for row in rows} == {
        name: set(files) for name, files in tested.items()
    }
    assert all(row.result.strip() for row in rows)


def test_all_rows_but_the_random_night_are_in_make_test() -> None:
    tested = _tested()
    assert [row.name for row in _rows() if not row.in_make_test] == ["S3"]
    assert [row.name for row in _rows() if row.in_make_test and not any(tested[row.name].values())] == []
