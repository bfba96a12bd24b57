"""Where figures go: results/latest.json, and the table in README.md that is made of it."""

import json
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from bench.machine import processor

Figures = dict[str, Any]
"""What a bench found, as JSON."""

_HERE = Path(__file__).parent
_LATEST = _HERE / "results" / "latest.json"
_README = _HERE / "README.md"
_BEGIN, _END = "<!-- latest figures: written by `make bench` -->\n", "<!-- end of latest figures -->\n"


@dataclass(frozen=True)
class Row:
    """A line of the table: the quantity, its figure, the aim (empty if there is none)."""

    what: str
    figure: str
    aim: str = ""


class Skipped(Exception):
    """Something is missing that is no part of ours, so there is nothing to measure; the message says what."""


class Bench(Protocol):
    """What each bench module has."""

    def run(self, quick: bool) -> Figures:
        """Measures; NocturneClientError where something that it needs is missing or fails, or Skipped."""

    def rows(self, figures: Figures) -> list[Row]:
        """The figures for people."""


def results_folder() -> Path:
    """Where figures and charts are kept."""
    return _LATEST.parent


def spread(values: Sequence[float]) -> Figures:
    """Median and extremes of the rounds."""
    return {
        "median": significant(statistics.median(values)),
        "low": significant(min(values)),
        "high": significant(max(values)),
    }


def spread_text(figures: Figures) -> str:
    """Median and extremes for people."""
    return f"{figures['median']:.3g} ({figures['low']:.3g} to {figures['high']:.3g})"


def significant(value: float) -> float:
    """Four digits: more is noise."""
    return float(f"{value:.4g}")


def kept() -> Figures:
    """The latest figures, by bench."""
    latest: Figures = json.loads(_LATEST.read_text()) if _LATEST.exists() else {}
    return latest


def keep(name: str, figures: Figures, benches: Mapping[str, Bench]) -> None:
    """Replaces this bench's figures in results/latest.json and in README.md; other benches' stay."""
    latest = kept()
    latest[name] = {"machine": processor(), **figures}
    _LATEST.parent.mkdir(exist_ok=True)
    _LATEST.write_text(json.dumps(latest, indent=1, sort_keys=True) + "\n")
    head, begin, rest = _README.read_text().partition(_BEGIN)
    _, end, tail = rest.partition(_END)
    if not (begin and end):
        raise RuntimeError(f"{_README} has lost the marks between which the table goes")
    _README.write_text(head + begin + _table(latest, benches) + end + tail)


def _table(latest: Mapping[str, Figures], benches: Mapping[str, Bench]) -> str:
    lines = ["| bench | what | figure | aim |", "| --- | --- | --- | --- |"]
    for name, bench in benches.items():
        if name in latest:
            lines += [
                f"| {name} | {row.what} | {row.figure} | {row.aim} |" for row in bench.rows(latest[name])
            ]
    loads = ", ".join(
        f"{name} {latest[name]['load_average'][0]:g} to {latest[name]['load_average'][1]:g}"
        for name in benches
        if name in latest
    )
    machines = sorted({figures["machine"] for figures in latest.values()})
    return (
        "\n".join(["", *lines, "", f"Measured on {'; '.join(machines)}. Load average: {loads}.", ""]) + "\n"
    )
