"""Outdated pages: tables without rows, errors and fields that do not exist."""

import json
import re
from pathlib import Path

import pytest
from nocturne_api.errors import INTERNAL, TABLE

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "docs" / "reference"
PAGES = sorted([*ROOT.glob("docs/**/*.md"), *ROOT.glob("*.md"), *ROOT.glob("bench/*.md")])

_RULE = re.compile(r"^\|(?: *:?-+:? *\|)+$", re.MULTILINE)


def _empty_tables(text: str) -> list[str]:
    """Heads of tables that have no row."""
    lines = [*text.splitlines(), ""]
    return [
        lines[index - 1]
        for index, line in enumerate(lines)
        if _RULE.match(line) and not lines[index + 1].startswith("|")
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_no_table_is_empty(page: Path) -> None:
    assert _empty_tables(page.read_text(encoding="utf-8")) == []


def test_an_empty_table_would_be_found() -> None:
    assert _empty_tables("| a | b |\n| --- | --- |\n\ntext") == ["| a | b |"]
    assert _empty_tables("| a | b |\n| --- | --- |\n| 1 | 2 |\n") == []


def test_the_api_page_has_every_error() -> None:
    """And no other, with the statuses that they have."""
    page = (REFERENCE / "api.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([A-Z_]+) \| [^|]+ \| (\d+) \| ([A-Z_]+) \|$", page, re.MULTILINE)
    kinds = [*(kind for _, kind in TABLE), INTERNAL]
    assert set(rows) == {(kind.reason, str(kind.http_status), kind.grpc_status.name) for kind in kinds}


def test_fields_that_the_api_page_names_are_there() -> None:
    """In the description of REST, in gRPC's messages, or among the names of this repository."""
    page = (REFERENCE / "api.md").read_text(encoding="utf-8")
    page = re.sub(r"^```.*?^```", "", page, flags=re.MULTILINE | re.DOTALL)
    named = set(re.findall(r"`(?:progress\.)?([a-z]+(?:_[a-z]+)+)`", page))
    known = json.dumps(json.loads((REFERENCE / "openapi.json").read_text(encoding="utf-8")))
    # Metrics are named in parts, and checked where the dashboards are.
    named = {name for name in named if not name.startswith("nocturne_")}
    known += "".join(path.read_text(encoding="utf-8") for path in (ROOT / "proto").rglob("*.proto"))
    assert len(named) > 10
    assert [name for name in sorted(named) if not re.search(rf"\b{name}\b", known)] == []
