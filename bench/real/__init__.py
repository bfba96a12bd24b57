"""Rooms that people render, compared with Mitsuba: public scenes of papers on path guiding.

The figure is the efficiency, 1 / (relMSE of Y x CPU seconds), over that of Mitsuba's path tracer with the
better of its samplers; each renderer is judged by its own reference, so that no difference of the scene as
both read it counts as noise.
"""

import statistics
import sys
import tempfile
from pathlib import Path

from bench.peer.contenders import SAMPLERS
from bench.peer.install import install
from bench.peer.turns import OURS
from bench.real.measure import Size, room
from bench.real.scenes import SCENES, there
from bench.report import Figures, Row

_FULL = Size((4.0, 16.0), 3, 8, 16.0)
_QUICK = Size((1.0,), 1, 4, 1.0)
_AIM = 3.0


def run(quick: bool) -> Figures:
    """Of each scene: see measure.room."""
    installed = install()
    figures: Figures = {"peer": f"Mitsuba {installed.version} {installed.variant}"}
    names = set(list(SCENES)[:2]) if quick else set(SCENES)
    for name, found in there(names):
        print(f"bench: real: {name}", file=sys.stderr)
        with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
            figures[name] = room(found.file, Path(folder), _QUICK if quick else _FULL, installed)
        print(f"bench: real: {ratios(figures[name])}", file=sys.stderr)
    return figures


def rows(figures: Figures) -> list[Row]:
    """Each scene, and the median."""
    rooms = {name: found for name, found in figures.items() if name in SCENES}
    table = []
    for name, found in rooms.items():
        for budget, (whole, trimmed) in ratios(found).items():
            what = f"{name}, {budget:g} CPU s: efficiency / Mitsuba's path tracer, whole and trimmed"
            table.append(Row(what, f"{whole:.2g}, {trimmed:.2g}"))
    budgets = next(iter(ratios(found) for found in rooms.values()))
    for budget in budgets:
        middle = statistics.median(ratios(found)[budget][0] for found in rooms.values())
        table.append(Row(f"median of {len(rooms)} rooms, {budget:g} CPU s", f"{middle:.2g}", f">= {_AIM:g}"))
    return table


def ratios(found: Figures) -> dict[float, tuple[float, float]]:
    """Our efficiency over the better sampler's by budget, with and without the worst pixels."""
    by_key = {(each["renderer"], each["budget_cpu_s"]): each for each in found["frames"]}
    budgets = sorted({budget for _, budget in by_key})
    return {budget: _ratio(by_key, budget) for budget in budgets}


def _ratio(by_key: dict[tuple[str, float], Figures], budget: float) -> tuple[float, float]:
    whole, trimmed = (
        by_key[OURS, budget][kind] / max(by_key[name, budget][kind] for name in SAMPLERS)
        for kind in ("efficiency", "trimmed_efficiency")
    )
    return whole, trimmed
