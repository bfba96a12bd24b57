"""`python -m tests.stability`: the whole matrix, as pages and stability.json."""

import argparse
import sys
import tempfile
from pathlib import Path

from nocturne_client.local.programs import CHECKOUT

from bench.machine import processor
from bench.report import kept
from bench.ways import WAYS
from tests.stability.case import Case
from tests.stability.cases import GROUPS
from tests.stability.measure import measure
from tests.stability.page import Matrix, as_json, from_json, page, summary_page
from tests.stability.verdict import Verdict

_SUMMARY = CHECKOUT / "docs" / "explanation" / "stability.md"
_PAGE = CHECKOUT / "tests" / "stability" / "README.md"
_MATRIX = CHECKOUT / "bench" / "results" / "stability.json"


def main() -> int:
    """Exit code 0 whatever the verdicts: the page says them."""
    parser = argparse.ArgumentParser(prog="python -m tests.stability", description=__doc__)
    parser.add_argument(
        "cases", nargs="*", metavar="CASE", help="only cases whose name has this; the others' verdicts stay"
    )
    parser.add_argument("--page", action="store_true", help="make the page of what was measured before")
    arguments = parser.parse_args()
    asked = arguments.cases
    if arguments.page:
        _write(from_json(_MATRIX.read_text()))
        return 0
    matrix: Matrix = from_json(_MATRIX.read_text()) if asked else {}
    with tempfile.TemporaryDirectory(prefix="nocturne-stability-") as folder:
        for case in (case for cases in GROUPS.values() for case in cases):
            if not asked or any(part in case.name for part in asked):
                matrix[case.name] = _row(case, Path(folder))
                sys.stderr.write(f"{case.name}: {_short(matrix[case.name])}\n")
    _write(matrix)
    _MATRIX.write_text(as_json(matrix, processor()))
    return 0


def _write(matrix: Matrix) -> None:
    _PAGE.write_text(page(matrix, kept().get("rare_light")))
    _SUMMARY.write_text(summary_page(matrix))


def _row(case: Case, folder: Path) -> dict[str, Verdict]:
    # The compiler, which all methods share, refuses such scenes.
    methods = WAYS if case.truth is not None else WAYS[:1]
    return {method.name: measure(case, method, folder / "scene") for method in methods}


def _short(row: dict[str, Verdict]) -> str:
    return ", ".join(
        f"{name} {verdict.word.value}" + ("" if verdict.off is None else f" {verdict.off:+.2g}")
        for name, verdict in row.items()
        if verdict.word.value != "-"
    )


if __name__ == "__main__":
    sys.exit(main())
