"""Media: photons a second, cost over optical thickness, and ray marching for comparison.

The paper's figures 6 to 8. A photon's path through a medium costs in proportion to its optical thickness, n.
A ray marcher whose steps have a fixed optical thickness takes n steps, and n more towards the light at each,
so its cost grows with n squared. The parts that it skips between steps are a bias.
"""

import itertools
import json
import math
import shutil
import statistics
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client.local.chart import Line, write_chart
from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.programs import CHECKOUT

from bench.errors import true_relmse
from bench.programs import BASELINE, Traced, bench_program, trace
from bench.programs import run as run_program
from bench.report import Figures, Row, results_folder, significant
from bench.scenes import Document, compile_film

SCENES = ("fog", "smoke", "sky")
_SMOKE = CHECKOUT / "examples" / "smoke"


@dataclass(frozen=True)
class _Size:
    width: int
    height: int
    samples: int
    rounds: int
    thicknesses: tuple[float, ...]
    densities: tuple[int, ...]
    sample_counts: tuple[int, ...]
    marched: dict[int, tuple[int, ...]]
    """Samples by steps."""
    reference_samples: int


def run(quick: bool) -> Figures:
    """Rates in photons a second of CPU time; nanoseconds a photon; relMSE of Y over CPU time."""
    size = (
        _Size(12, 16, 4, 1, (1, 10), (1, 2), (4, 16), {8: (4, 16)}, 64)
        if quick
        else _Size(
            *(48, 64, 32, 3, (1, 10, 100), (1, 2, 4, 8, 16), (4, 16, 64, 256)),
            {8: (4, 16, 64), 32: (4, 16)},
            1024,
        )
    )
    if not (_SMOKE / "smoke.vdb").is_file():
        run_program([sys.executable, _SMOKE / "make_smoke.py", _SMOKE])
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        figures: Figures = {
            "photons_per_cpu_second": _rates(place, size),
            "ns_per_photon": _thickness(place / "slab", size),
            "single_scattering": _marching(place / "marching", size),
            "ns_over_density": _denser(place / "denser", size),
        }
    if not quick:
        _draw(figures)
    return figures


def rows(figures: Figures) -> list[Row]:
    """Rates, the growth of cost with thickness and with steps."""
    rates = figures["photons_per_cpu_second"]
    table = [Row(f"{name}: photons a CPU second", f"{rates[name]:.3g}") for name in SCENES]
    cost = {float(tau): each for tau, each in figures["ns_per_photon"].items()}
    for low, high in itertools.pairwise(sorted(cost)):
        what = f"white slab: cost of a photon, thickness {high:g} / {low:g}"
        table.append(Row(what, f"{cost[high] / cost[low]:.3g}", f"at most {high / low:g}"))
    single = figures["single_scattering"]
    for steps, line in single["marching"].items():
        last = line[-1]
        ratio = last["relmse"] / _photons_error(single["photons"], last["cpu_s"])
        what = (
            f"smoke, scattered once: relMSE, marching {steps} steps / photons, at {last['cpu_s']:.2g} CPU s"
        )
        table.append(Row(what, f"{ratio:.3g}", "above 1"))
    for who, cost in figures["ns_over_density"].items():
        factors = sorted(int(factor) for factor in cost)
        what = f"smoke, {factors[-1]} times as dense / as it is: cost of a sample by {who}"
        table.append(Row(what, f"{cost[str(factors[-1])] / cost[str(factors[0])]:.3g}"))
    return table


def _document(name: str) -> Document:
    document: Document = json.loads((CHECKOUT / "examples" / name / "scene.json").read_text())
    return document


def _rates(place: Path, size: _Size) -> dict[str, float]:
    compiled = {name: _compile(_document(name), place / name, size, size.samples, {}) for name in SCENES}
    found: dict[str, list[float]] = {name: [] for name in SCENES}
    for _ in range(size.rounds):
        for name in SCENES:
            traced = trace(compiled[name], threads=1)
            found[name].append(traced.photons / traced.tracing_cpu_s)
    return {name: significant(max(rates)) for name, rates in found.items()}


def _thickness(place: Path, size: _Size) -> dict[str, float]:
    """A layer that absorbs nothing, above a bright ground: each photon is in it until it leaves."""
    found = {}
    for tau in size.thicknesses:
        compiled = _compile(_slab(tau), place / f"{tau:g}", size, size.samples, {})
        runs = [trace(compiled, threads=1) for _ in range(size.rounds)]
        found[f"{tau:g}"] = significant(min(1e9 * each.tracing_cpu_s / each.photons for each in runs))
    return found


def _slab(tau: float) -> Document:
    return {
        "nocturne": 1,
        "media": {"white": {"scattering": tau}},
        "environment": {"radiance": {"table": [[300, 1], [900, 1]]}},
        "sensor": {
            "type": "pinhole",
            "position": [0, 0, 3],
            "look_at": [0, 0, 0],
            "vertical_field_of_view_degrees": 60,
        },
        "surfaces": [
            {
                "shape": {"type": "box", "minimum": [-50, -50, 0], "maximum": [50, 50, 1]},
                "interior": {"media": ["white"]},
            }
        ],
    }


def _marching(place: Path, size: _Size) -> Figures:
    document, once = _document("smoke"), {"maximum_depth": 1}
    reference = trace(
        _compile(document, place / "reference", size, size.reference_samples, {**once, "seed": 7})
    )
    photons = [
        {"samples": samples, **_error(_by_chance(document, place, size, samples), reference)}
        for samples in size.sample_counts
    ]
    marching = {
        str(steps): [
            {"samples": samples, **_error(_march(document, place, size, steps, samples), reference)}
            for samples in counts
        ]
        for steps, counts in size.marched.items()
    }
    return {"photons": photons, "marching": marching}


def _by_chance(document: Document, place: Path, size: _Size, samples: int) -> Traced:
    return trace(_once(document, place / f"photons {samples}", size, samples), threads=1)


def _march(document: Document, place: Path, size: _Size, steps: int, samples: int) -> Traced:
    compiled = _once(document, place / f"march {steps} {samples}", size, samples)
    return _marched(compiled, steps)


def _marched(compiled: CompiledFolder, steps: int) -> Traced:
    options = ["--method", "march", "--steps", steps]
    return trace(compiled, threads=1, options=options, program=bench_program(BASELINE))


def _once(document: Document, folder: Path, size: _Size, samples: int) -> CompiledFolder:
    """With light that is scattered once."""
    return _compile(document, folder, size, samples, {"maximum_depth": 1})


def _photons_error(photons: list[dict[str, float]], cpu_s: float) -> float:
    """The error of photons at the same time, by a straight line over both logarithms."""
    times, errors = (np.log([each[key] for each in photons]) for key in ("cpu_s", "relmse"))
    slope, start = np.polyfit(times, errors, 1)
    return math.exp(start + slope * math.log(cpu_s))


def _denser(place: Path, size: _Size) -> dict[str, dict[str, float]]:
    """CPU time of a sample, ns, where smoke is denser; by marching with as many times the steps."""
    found: dict[str, dict[str, float]] = {"photons": {}, "marching": {}}
    for factor in size.densities:
        document = _document("smoke")
        document["media"]["smoke"]["density"]["factor"] = factor
        by_chance, marched = partial(trace, threads=1), partial(_marched, steps=8 * factor)
        for who, samples, traced in (("photons", size.samples, by_chance), ("marching", 4, marched)):
            compiled = _once(document, place / f"{factor} {who}", size, samples)
            runs = [traced(compiled) for _ in range(size.rounds)]
            least = min(each.tracing_cpu_s for each in runs)
            found[who][str(factor)] = significant(1e9 * least / (samples * size.width * size.height))
    return found


def _error(traced: Traced, reference: Traced) -> dict[str, Any]:
    relmse = true_relmse(traced.xyz[..., 1], reference.xyz[..., 1], reference.y_error)
    means = (statistics.fmean(each.xyz[..., 1].flat) for each in (traced, reference))
    mean, true_mean = means
    return {
        "cpu_s": significant(traced.tracing_cpu_s),
        "relmse": significant(relmse),
        "mean_over_reference": significant(mean / true_mean),
    }


def _compile(
    document: Document, folder: Path, size: _Size, samples: int, tracing: dict[str, Any]
) -> CompiledFolder:
    changed = {**document, "tracing": {**document.get("tracing", {}), **tracing}}
    folder.mkdir(parents=True)
    shutil.copy(_SMOKE / "smoke.vdb", folder)
    return compile_film(changed, folder, size.width, size.height, samples)


def _draw(figures: Figures) -> None:
    single, cost = figures["single_scattering"], figures["ns_over_density"]
    marched = {f"{steps} steps": points for steps, points in single["marching"].items()}
    errors = [
        Line(name, [(each["cpu_s"], each["relmse"]) for each in points])
        for name, points in {"photons": single["photons"], **marched}.items()
    ]
    title = "Smoke, light scattered once: relMSE over CPU seconds"
    write_chart(results_folder() / "media-marching.svg", title, "CPU s", "relMSE", errors)
    costs = [
        Line(who, [(float(factor), ns) for factor, ns in points.items()]) for who, points in cost.items()
    ]
    title = "The same, denser, steps of equal optical thickness: CPU time of a sample"
    write_chart(results_folder() / "media-cost.svg", title, "times as dense", "ns", costs)
