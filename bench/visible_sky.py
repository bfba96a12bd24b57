"""The gain of photons that know the visible sky: a room with a window, with and without."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client.local.compiled import compile_to

from bench.peer.contenders import FilmSize, Ours
from bench.report import Figures, Row, significant
from tests.accuracy.tracing import write
from tests.accuracy.window_rooms import SCENES

_ROOMS = ("sky", "even sky", "sky and Sun", "pane", "haze", "lamp", "film")
_THREADS = 2
_DARK = 1e-4
"""Square of the part of the mean below which a pixel's error counts relative to that."""


def run(quick: bool) -> Figures:
    """Efficiency, 1 / (relative squared error x CPU seconds), of `"guide": "auto"` over that of `none`."""
    film, samples, seeds = (FilmSize(48, 32), 192, 3) if quick else (FilmSize(96, 64), 64, 12)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        return {name: _room(name, Path(folder), film, samples, seeds) for name in _ROOMS}


def rows(figures: Figures) -> list[Row]:
    """Of each room."""
    return [
        Row(
            f"room with a window, {name}: efficiency of photons that know the visible sky",
            f"{of['gain']:.3g}",
        )
        for name, of in figures.items()
        if isinstance(of, dict)
    ]


def _room(name: str, folder: Path, film: FilmSize, samples: int, seeds: int) -> Figures:
    found: dict[str, tuple[float, float]] = {}
    for guide in ("none", "auto"):
        document: dict[str, Any] = {**SCENES[name], "tracing": {"guide": guide}}
        compiled = compile_to(write(document, folder), folder, film.width, film.height, samples)
        frames = [Ours(compiled, film, _THREADS).frame(samples, seed) for seed in range(seeds)]
        y = np.stack([each.y for each in frames])
        error = y.var(axis=0, ddof=1) / (y.mean(axis=0) ** 2 + _DARK * y.mean() ** 2)
        found[guide] = float(error.mean()), float(np.median([each.cpu_s for each in frames]))
    (before, cpu_before), (after, cpu_after) = found["none"], found["auto"]
    return {
        "relmse": [significant(before), significant(after)],
        "cpu_s": [significant(cpu_before), significant(cpu_after)],
        "gain": significant(before * cpu_before / (after * cpu_after)),
    }
