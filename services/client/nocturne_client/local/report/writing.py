"""Reports as files, by the endings of their names."""

import json
from collections.abc import Callable
from pathlib import Path

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.report.contents import Report
from nocturne_client.local.report.drawing import Drawing, png, svg
from nocturne_client.local.report.html import html
from nocturne_client.outputs import written

_Writer = Callable[[Report], bytes]


def writer(path: Path) -> _Writer:
    """Raises NocturneClientError where the ending is another one."""
    found = _WRITERS.get(path.suffix.lower())
    if found is None:
        raise NocturneClientError(f"{path}: expected a name that ends in .pdf, .html, .json, .svg or .png")
    return found


def write(path: Path, report: Report) -> None:
    """Raises NocturneClientError."""
    made = writer(path)(report)
    try:
        with written(path) as file:
            file.write(made)
    except OSError as problem:
        raise NocturneClientError(f"{path}: {problem.strerror}") from problem


def _plan(report: Report) -> Drawing:
    for section in report.sections:
        if section.drawings:
            return section.drawings[0]
    raise NocturneClientError("there is no plan: no instrument of the image is a grid, and it is no film")


def _pdf(report: Report) -> bytes:
    # ReportLab takes a fifth of a second to load.
    from nocturne_client.local.report.pdf import pdf

    return pdf(report)


def plain(report: Report) -> str:
    """What it says, without drawings, as JSON: for programs that show it in their own way."""
    said = {
        "title": report.title,
        "facts": report.facts,
        "warnings": report.warnings,
        "requirement": report.requirement,
        "verdict": report.whole.verdict if report.whole is not None else "",
        "says": report.verdict,
        "checks": [
            {
                "what": each.what,
                "limit": each.limit,
                "found": each.found,
                "says": each.says,
                "verdict": each.verdict or "",
            }
            for each in report.checks
        ],
        "sections": [
            {
                "title": section.title,
                "tables": [
                    {"head": [*table.head], "rows": [[*row] for row in table.rows]}
                    for table in section.tables
                ],
                "notes": section.notes,
            }
            for section in report.sections
        ],
    }
    return json.dumps(said, indent=1, ensure_ascii=False) + "\n"


_WRITERS: dict[str, _Writer] = {
    ".json": lambda report: plain(report).encode(),
    ".pdf": _pdf,
    ".html": lambda report: html(report).encode(),
    ".svg": lambda report: svg(_plan(report)).encode(),
    ".png": lambda report: png(_plan(report)),
}
