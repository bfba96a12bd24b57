"""Methods of choosing directions at equal time: figures 4 and 5 of the paper, as errors over CPU time.

The difficult light in these scenes is rare and bright: single photons decide the squared error of a pixel. So
films are small, with many samples for each pixel, and the compared errors leave out the worst pixels.
"""

import json
import math
import statistics
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nocturne_client.local.chart import Line, write_chart
from nocturne_client.local.programs import CHECKOUT

from bench.errors import trimmed_relmse, true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import FilmSize, Ours
from bench.report import Figures, Row, results_folder, significant, spread
from bench.scenes import Document, compile_film

WORST = 0.02
"""Part of the pixels that is left out."""

_THREADS = 2
_TRIAL_SEED, _REFERENCE_SEED = 500, 1000


@dataclass(frozen=True)
class _Figure:
    """A scene of the paper's figure, and methods by name; the first is compared with the others."""

    number: int
    scene: str
    ways: dict[str, dict[str, Any]]
    reference: dict[str, Any]
    """How the truth is traced."""
    kernels: dict[str, Any] = field(default_factory=dict)
    """Other ones than the scene's."""


def _mixture(**weights: float) -> dict[str, Any]:
    return {"estimator": "mixture", "mixture": weights}


_ALONE = {"estimator": "two_photons", "direction": "adjoint", "sharing": 1}
_SHARED = {**_ALONE, "sharing": 16}
_PLATES = {"kernel": 0.4, "luminaires": 0.4, "environment": 0.2}
_AIMS = {
    "opening": _mixture(kernel=0.5, important=0.5),
    "lamp": _mixture(kernel=0.5, luminaires=0.5),
    "opening and lamp": _mixture(kernel=0.5, important=0.25, luminaires=0.25),
    "two photons": _ALONE,
    "two photons, shared": _SHARED,
}
# In the reflector, hundreds of times less error than by any of those.
_BOTH = {"direction": "both"}
FIGURES = {
    "mixtures": _Figure(
        4,
        "mixtures",
        {
            "mixture": _mixture(**_PLATES),
            "split": {"estimator": "split", "split_vertices": 1, "mixture": _PLATES},
            "two photons": _ALONE,
            "two photons, shared": _SHARED,
        },
        _ALONE,
    ),
    "reflector": _Figure(5, "reflector", _AIMS, _BOTH),
    "polished reflector": _Figure(
        5, "reflector", _AIMS, _BOTH, {"aluminium": {"type": "conductor", "index": "Al"}}
    ),
}


@dataclass(frozen=True)
class _Size:
    film: FilmSize
    budgets_cpu_s: tuple[float, ...]
    rounds: int
    trial_samples: int
    reference_cpu_s: float
    """Of each of four images."""


def run(quick: bool) -> Figures:
    """relMSE of Y against a long reference, in turns, for several budgets of CPU time; draws the charts."""
    size = (
        _Size(FilmSize(12, 8), (0.1,), 1, 16, 0.5)
        if quick
        else _Size(FilmSize(24, 16), (0.5, 1.0, 2.0), 12, 256, 12.0)
    )
    found: Figures = {"budgets_cpu_s": list(size.budgets_cpu_s)}
    for name, figure in FIGURES.items():
        found[name] = _measure(figure, size)
        if not quick:
            _draw(name, figure, found[name])
    return found


def rows(figures: Figures) -> list[Row]:
    """Ratios of the other methods' errors to the first method's, at each time."""
    table = []
    for name, figure in FIGURES.items():
        first, *others = figure.ways
        for other in others:
            ratios = [
                f"{ratio['mean']:.3g} +- {ratio['standard_error']:.2g}"
                for ratio in (each["error_over_first"][other] for each in figures[name])
            ]
            what = f"figure {figure.number}, {name}: relMSE, {other} / {first}"
            budgets = ", ".join(f"{each['budget_cpu_s']:g}" for each in figures[name])
            aim = "above 1" if (first, other) == ("opening", "lamp") else ""
            table.append(Row(f"{what}, at {budgets} CPU s", ", ".join(ratios), aim))
    return table


def _measure(figure: _Figure, size: _Size) -> list[Figures]:
    document: Document = json.loads((CHECKOUT / "examples" / figure.scene / "scene.json").read_text())
    document["kernels"] |= figure.kernels
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:

        def traced_by(place: str, tracing: dict[str, Any]) -> Ours:
            changed = {**document, "tracing": tracing}
            compiled = compile_film(changed, Path(folder) / place, size.film.width, size.film.height, 1)
            return Ours(compiled, size.film, _THREADS)

        ways = {name: traced_by(str(number), way) for number, (name, way) in enumerate(figure.ways.items())}
        truth = _truth(traced_by("reference", figure.reference), size)
        return _compare(ways, truth, size)


def _cpu_s_of_a_sample(way: Ours, size: _Size) -> float:
    return way.frame(size.trial_samples, _TRIAL_SEED).cpu_s / size.trial_samples


def _truth(way: Ours, size: _Size) -> Reference:
    samples = max(1, round(size.reference_cpu_s / _cpu_s_of_a_sample(way, size)))
    return Reference.of([way.frame(samples, _REFERENCE_SEED + number).y for number in range(4)])


def _compare(ways: dict[str, Ours], truth: Reference, size: _Size) -> list[Figures]:
    rates = {name: _cpu_s_of_a_sample(way, size) for name, way in ways.items()}
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
                "error_over_first": {other: _ratio(errors[other], errors[first]) for other in others},
            }
        )
    return found


def _ratio(above: list[float], below: list[float]) -> Figures:
    """Of the means, and its standard error as if both were independent."""
    ratio = statistics.fmean(above) / statistics.fmean(below)
    relative = [
        statistics.stdev(each) / math.sqrt(len(each)) / statistics.fmean(each) if len(each) > 1 else 0.0
        for each in (above, below)
    ]
    return {"mean": significant(ratio), "standard_error": significant(ratio * math.hypot(*relative))}


def _draw(name: str, figure: _Figure, found: list[Figures]) -> None:
    lines = [
        Line(way, [(each["budget_cpu_s"], each["relmse"][way]["median"]) for each in found])
        for way in figure.ways
    ]
    title = f"Figure {figure.number}, {name}: relMSE of 98 % of the pixels over CPU seconds"
    write_chart(results_folder() / f"choices-{name.replace(' ', '-')}.svg", title, "CPU s", "relMSE", lines)
