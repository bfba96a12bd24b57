"""Error bars: how often intervals hold the truth, and whether the heavy-tail diagnostic knows when not.

Films of 12 by 12 pixels with 64 samples, rendered 50 times (200 times with BENCH=full; the last row has the
number) with other seeds. The truth is the mean of 16 images with together at least 200 times the
samples of a render. The pilot chooses the method, as for a long render, unless the scene names one. Intervals
are right if 68, 95 and 99 % of them hold the truth, and called broken if fewer than 90 % of the 95 %
intervals do. Sobol points make errors smaller than error bars say: coverage above nominal is no fault.

The headlight is left out: each photon that its clear cover catches meets up to a thousand surfaces, and 200
renders with their truth would take hours.
"""

import math
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_coordinator.dispatch.heavy_tails import HEAVY, unevenness

from bench.peer.contenders import FilmSize, Ours
from bench.programs import Channel
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film, example

SCENES = (
    "cornell",
    "subsurface",
    "smoke",
    "both_directions",
    "colour_chart",
    "mixtures",
    "reflector",
)
SEQUENCES = ("independent", "sobol")
LEVELS = {"68 %": 1.0, "95 %": 1.959964, "99 %": 2.575829}
"""Nominal coverage: standard errors to both sides; 68 % is one."""

BROKEN = 0.9
"""Coverage of 95 % intervals below which error bars are said to be broken."""

_REFERENCE_SEED = 100_000
_FOR_A_PILOT = 2**15
"""Samples of the render that the pilot is to choose for: 4.7 million in all."""


@dataclass(frozen=True)
class _Size:
    film: FilmSize
    samples: int
    renders: int
    reference: int
    """Times the samples of all renders together."""


def run(quick: bool) -> Figures:
    """Coverage over pixels and renders, and what the diagnostic said of each render."""
    renders = 200 if os.environ.get("BENCH") == "full" else 50
    size = _Size(FilmSize(8, 8), 16, 10, 4) if quick else _Size(FilmSize(12, 12), 64, renders, 4)
    found: Figures = {"samples": size.samples, "renders": size.renders}
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        for name in SCENES:
            document = example(name, Path(folder) / name)
            for sequence in SEQUENCES:
                found[f"{name}, {sequence}"] = _measure(document, sequence, Path(folder) / name, size)
    return found


def rows(figures: Figures) -> list[Row]:
    """Coverage by scene, and the diagnostic's hits and misses."""
    table = []
    for name, each in _each(figures):
        observed = " / ".join(f"{100 * each['coverage'][level]:.3g}" for level in LEVELS)
        warned = f"warned in {100 * each['flagged']:.3g} % of renders"
        nominal = " / ".join(level.removesuffix(" %") for level in LEVELS)
        what = f"{name}: truth in the interval of nominal {nominal} %"
        table.append(Row(what, f"{observed} %; {warned}", "at least nominal, or warned"))
    count = diagnosis(figures)
    table.append(
        Row(
            f"heavy-tail diagnostic, of {figures['renders']} renders of each",
            f"broken and warned {count['hits']}, broken and not warned {count['misses']}; "
            f"sound and warned {count['false alarms']}, sound and not warned {count['sound']}",
        )
    )
    return table


def table(figures: Figures) -> list[str]:
    """The same with a column for each level."""
    lines = [f"| scene | sampler | {' | '.join(f'nominal {level}' for level in LEVELS)} | warned |"]
    lines.append("| --- " * (3 + len(LEVELS)) + "|")
    for name, each in _each(figures):
        scene, _, sampler = name.partition(", ")
        observed = " | ".join(f"{100 * each['coverage'][level]:.3g} %" for level in LEVELS)
        lines.append(f"| {scene} | {sampler} | {observed} | {100 * each['flagged']:.3g} % |")
    diagnostic = rows(figures)[-1]
    return [*lines, "", f"The {diagnostic.what}: {diagnostic.figure}."]


def diagnosis(figures: Figures) -> dict[str, int]:
    """Renders by whether their scene's intervals are broken and whether the diagnostic says so."""
    count = {"hits": 0, "misses": 0, "false alarms": 0, "sound": 0}
    for _, each in _each(figures):
        told = round(each["flagged"] * figures["renders"])
        broken = each["coverage"]["95 %"] < BROKEN
        count["hits" if broken else "false alarms"] += told
        count["misses" if broken else "sound"] += figures["renders"] - told
    return count


def _each(figures: Figures) -> list[tuple[str, Any]]:
    names = (f"{name}, {sequence}" for name in SCENES for sequence in SEQUENCES)
    return [(name, figures[name]) for name in names if name in figures]


def _measure(scene: Document, sequence: str, folder: Path, size: _Size) -> Figures:
    document = {**scene, "tracing": {**scene.get("tracing", {}), "sequence": sequence}}
    compiled = compile_film(
        document, folder, size.film.width, size.film.height, _FOR_A_PILOT, folder / sequence
    )
    ours = Ours(compiled, size.film, threads=2)
    frames = [ours.traced(size.samples, seed) for seed in range(size.renders)]
    parts = 16
    each = size.reference * size.samples * size.renders // parts
    long = [ours.traced(each, _REFERENCE_SEED + part) for part in range(parts)]
    truth = np.mean([frame.xyz[..., 1] for frame in long], axis=0)
    truth_error = np.std([frame.xyz[..., 1] for frame in long], axis=0, ddof=1) / math.sqrt(parts)
    lit = truth > 0.0
    covered: dict[str, list[Channel]] = {level: [] for level in LEVELS}
    uneven = []
    for frame in frames:
        y, error = frame.xyz[..., 1], np.hypot(frame.y_stderr, truth_error)
        for level, factor in LEVELS.items():
            covered[level].append(np.abs(y - truth)[lit] <= factor * error[lit])
        uneven.append(unevenness(y, frame.y_error**2))
    return {
        "coverage": {level: significant(float(np.mean(hits))) for level, hits in covered.items()},
        # Pixels of one render are independent, renders of one pixel share its truth: by pixels.
        "coverage_error": {
            level: significant(float(np.mean(hits, axis=0).std(ddof=1)) / math.sqrt(np.count_nonzero(lit)))
            for level, hits in covered.items()
        },
        "flagged": significant(float(np.mean(np.array(uneven) > HEAVY))),
        "unevenness": significant(float(np.median(uneven))),
        "threshold": HEAVY,
    }
