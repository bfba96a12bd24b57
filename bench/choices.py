"""Ways to choose directions at equal time: figures 4 and 5 of the paper, as errors over CPU time.

What is hard in these scenes is rare and bright: single photons decide the squared error of a pixel. So films
are small, with many samples for each pixel, and the errors compared leave out the worst pixels.
"""

import json
import statistics
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nocturne_client.local.programs import CHECKOUT

from bench.chart import Line, write_chart
from bench.errors import trimmed_relmse, true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import Film, Ours
from bench.report import Figures, Row, results_folder, significant, spread, spread_text
from bench.scenes import Document, compile_film

WORST = 0.02
"""Part of the pixels that is left out."""

_THREADS = 2
_TRIAL_SEED, _REFERENCE_SEED = 500, 1000


@dataclass(frozen=True)
class _Figure:
    """A scene of the paper's figure, and ways to trace it by name; the first is compared with the others."""

    number: int
    scene: str
    ways: dict[str, dict[str, Any]]
    reference: str
    """The way whose long image is the truth."""


def _mixture(**weights: float) -> dict[str, Any]:
    return {"estimator": "mixture", "mixture": weights}


_PLATES = {"kernel": 0.4, "luminaires": 0.4, "environment": 0.2}
FIGURES = {
    "mixtures": _Figure(
        4,
        "mixtures",
        {
            "mixture": _mixture(**_PLATES),
            "split": {"estimator": "split", "split_vertices": 1, "mixture": _PLATES},
            "two photons": {"estimator": "two_photons"},
        },
        "two photons",
    ),
    "reflector": _Figure(
        5,
        "reflector",
        {
            "opening": _mixture(kernel=0.5, important=0.5),
            "lamp": _mixture(kernel=0.5, luminaires=0.5),
            "two photons": {"estimator": "two_photons"},
        },
        "opening",
    ),
}


@dataclass(frozen=True)
class _Size:
    film: Film
    budgets_cpu_s: tuple[float, ...]
    rounds: int
    trial_samples: int
    reference_cpu_s: float
    """Of each of four images."""


def run(quick: bool) -> Figures:
    """relMSE of Y against a long reference, in turns, for several budgets of CPU time; draws the charts."""
    size = (
        _Size(Film(12, 8), (0.1,), 1, 16, 0.5)
        if quick
        else _Size(Film(24, 16), (0.5, 1.0, 2.0), 5, 256, 12.0)
    )
    found: Figures = {"budgets_cpu_s": list(size.budgets_cpu_s)}
    for name, figure in FIGURES.items():
        found[name] = _measure(figure, size)
        if not quick:
            _draw(name, figure, found[name])
    return found


def rows(figures: Figures) -> list[Row]:
    """How many times the first way's error the others have, at each time."""
    table = []
    for name, figure in FIGURES.items():
        first, *others = figure.ways
        for other in others:
            ratios = [spread_text(each["error_over_first"][other]) for each in figures[name]]
            what = f"figure {figure.number}, {name}: relMSE, {other} / {first}"
            budgets = ", ".join(f"{each['budget_cpu_s']:g}" for each in figures[name])
            aim = "above 1" if (first, other) == ("opening", "lamp") else ""
            table.append(Row(f"{what}, at {budgets} CPU s", ", ".join(ratios), aim))
    return table


def _measure(figure: _Figure, size: _Size) -> list[Figures]:
    document: Document = json.loads((CHECKOUT / "scenes" / figure.scene / "scene.json").read_text())
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        ways = {}
        for number, (name, tracing) in enumerate(figure.ways.items()):
            changed = {**document, "tracing": tracing}
            compiled = compile_film(changed, Path(folder) / str(number), size.film.width, size.film.height, 1)
            ways[name] = Ours(compiled, size.film, _THREADS)
        return _compare(ways, figure, size)


def _compare(ways: dict[str, Ours], figure: _Figure, size: _Size) -> list[Figures]:
    rates = {
        name: way.frame(size.trial_samples, _TRIAL_SEED).cpu_s / size.trial_samples
        for name, way in ways.items()
    }
    samples = max(1, round(size.reference_cpu_s / rates[figure.reference]))
    long = [ways[figure.reference].frame(samples, _REFERENCE_SEED + number).y for number in range(4)]
    truth = Reference.of(long)
    found = []
    for budget in size.budgets_cpu_s:
        counts = {name: max(1, round(budget / rate)) for name, rate in rates.items()}
        errors: dict[str, list[float]] = {name: [] for name in ways}
        all_errors: dict[str, list[float]] = {name: [] for name in ways}
        costs: dict[str, list[float]] = {name: [] for name in ways}
        for seed in range(size.rounds):
            for name, way in ways.items():
                frame = way.frame(counts[name], seed)
                # At exactly this time: the error falls as 1 over time.
                share = frame.cpu_s / budget
                errors[name].append(share * trimmed_relmse(frame.y, truth.y, truth.error, WORST))
                all_errors[name].append(share * true_relmse(frame.y, truth.y, truth.error))
                costs[name].append(frame.cpu_s)
        first, *others = ways
        found.append(
            {
                "budget_cpu_s": budget,
                "samples": counts,
                "cpu_s": {name: significant(statistics.median(each)) for name, each in costs.items()},
                "relmse": {name: spread(each) for name, each in errors.items()},
                "relmse_of_all_pixels": {name: spread(each) for name, each in all_errors.items()},
                "error_over_first": {
                    other: spread([b / a for a, b in zip(errors[first], errors[other], strict=True)])
                    for other in others
                },
            }
        )
    return found


def _draw(name: str, figure: _Figure, found: list[Figures]) -> None:
    lines = [
        Line(way, [(each["budget_cpu_s"], each["relmse"][way]["median"]) for each in found])
        for way in figure.ways
    ]
    title = f"Figure {figure.number}, {name}: relMSE of 98 % of the pixels over CPU seconds"
    write_chart(results_folder() / f"choices-{name}.svg", title, "CPU s", "relMSE", lines)
