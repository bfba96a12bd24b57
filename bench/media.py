"""Media: photons a second, cost over optical thickness, and ray marching for comparison.

The paper's figures 6 to 8. A photon's way through a medium costs in proportion to its optical thickness; a
ray marcher that looks for light at each of n steps takes n steps each time, so its cost grows with n squared,
and what it leaves out between steps is a bias.
"""

import itertools
import json
import shutil
import statistics
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.programs import CHECKOUT

from bench.chart import Line, write_chart
from bench.errors import true_relmse
from bench.programs import Traced, trace
from bench.programs import run as run_program
from bench.report import Figures, Row, results_folder, significant
from bench.scenes import Document, compile_film

SCENES = ("fog", "smoke", "sky")
_SMOKE = CHECKOUT / "scenes" / "smoke"


@dataclass(frozen=True)
class _Size:
    width: int
    height: int
    samples: int
    rounds: int
    thicknesses: tuple[float, ...]
    steps: tuple[int, ...]
    sample_counts: tuple[int, ...]
    reference_samples: int


def run(quick: bool) -> Figures:
    """Rates in photons a second of CPU time; nanoseconds a photon; relMSE of Y over CPU time."""
    size = (
        _Size(12, 16, 4, 1, (1, 10), (8, 16), (4, 16), 64)
        if quick
        else _Size(48, 64, 32, 3, (1, 10, 100), (8, 16, 32, 64, 128), (4, 16, 64, 256), 1024)
    )
    if not (_SMOKE / "smoke.vdb").is_file():
        run_program([sys.executable, _SMOKE / "make_smoke.py", _SMOKE])
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        figures: Figures = {
            "photons_per_cpu_second": _rates(place, size),
            "ns_per_photon": _thickness(place / "slab", size),
            "single_scattering": _marching(place / "marching", size),
        }
    if not quick:
        _draw(figures["single_scattering"])
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
    marched = single["marching"]
    for low_steps, high_steps in itertools.pairwise(marched):
        what = f"marching: cost of {high_steps['steps']} / {low_steps['steps']} steps"
        table.append(Row(what, f"{high_steps['cpu_s'] / low_steps['cpu_s']:.3g}"))
    return table


def _document(name: str) -> Document:
    document: Document = json.loads((CHECKOUT / "scenes" / name / "scene.json").read_text())
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
    photons = []
    for samples in size.sample_counts:
        traced = trace(_compile(document, place / f"{samples}", size, samples, once), threads=1)
        photons.append({"samples": samples, **_error(traced, reference)})
    marching = []
    compiled = _compile(document, place / "march", size, 4, once)
    for steps in size.steps:
        traced = trace(compiled, threads=1, options=["--method", "march", "--steps", steps])
        marching.append({"steps": steps, **_error(traced, reference)})
    return {"photons": photons, "marching": marching}


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
    lines = [
        Line(name, [(each["cpu_s"], each["relmse"]) for each in figures[key]])
        for name, key in (("photons", "photons"), ("marching", "marching"))
    ]
    title = "Smoke, light scattered once: relMSE over CPU seconds"
    write_chart(results_folder() / "media-marching.svg", title, "CPU s", "relMSE", lines)
