"""How often the intervals of a year of daylight hold what many more samples find: a small room, repeated with
other random numbers."""

import json
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client.local.annual import read_weather
from nocturne_client.local.daylight_rounds import Rounds, daylight_scene, rounds
from nocturne_scene.daylight.coefficients import Layout
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight.year_of_light import Traces, YearOfLight, counting_of, measure
from nocturne_scene.daylight.year_of_skies import skies_of
from scipy import stats

from bench.report import Figures, Row
from tests.weather import epw

_BATCHES = 32
_AIM = 0.93
_LAYOUT = Layout(Patches(1), Patches(2))
_FIGURES = ("DA", "cDA", "UDI autonomous", "mean illuminance")


def run(quick: bool) -> Figures:
    """Repeated runs, and one of many samples as the truth."""
    times, samples, many = (8, 8, 64) if quick else (100, 16, 2048)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as name:
        folder = Path(name)
        (folder / "room.json").write_text(json.dumps(_room()))
        (folder / "year.epw").write_text(epw())
        truth = _year(folder, many, 1_000_000)
        found = [_year(folder, samples, seed) for seed in range(times)]
    held = [each.sda.low <= truth.sda.value <= each.sda.high for each in found]
    figures: Figures = {
        "runs": times,
        "samples a point": samples * _BATCHES,
        "samples of the truth": many * _BATCHES,
        "sDA": truth.sda.value,
        "sDA is between": [truth.sda.low, truth.sda.high],
        "sDA of runs": [min(each.sda.value for each in found), max(each.sda.value for each in found)],
        "sDA held": float(np.mean(held)),
        "sDA held, 95 %": _interval(sum(held), times),
    }
    for name in _FIGURES:
        figures[f"{name} held"] = float(np.mean([_held(each, truth, name) for each in found]))
    return figures


def rows(figures: Figures) -> list[Row]:
    """Of sDA, and of single points."""
    told = f"{figures['sDA held']:.0%}"
    said = [Row(f"sDA: 95 % intervals of {figures['runs']} runs that hold the truth", told, f"{_AIM:.0%}")]
    return said + [
        Row(f"{name} of points: 95 % intervals that hold it", f"{figures[f'{name} held']:.1%}", f"{_AIM:.0%}")
        for name in _FIGURES
    ]


def _held(found: YearOfLight, truth: YearOfLight, name: str) -> Any:
    """Of each point; the truth has errors, too."""
    one, other = found.by_point[name], truth.by_point[name]
    half = one.interval()[1] - one.value
    slack = other.interval()[1] - other.value
    return np.abs(one.value - other.value) <= np.hypot(half, slack)


def _year(folder: Path, samples: int, seed: int) -> YearOfLight:
    year = read_weather(folder / "year.epw")
    scene = daylight_scene(folder / "room.json", {}, None)
    skies = skies_of(year, _LAYOUT.sky, 0.2)
    counting = counting_of(year, skies, (8.0, 18.0), 300.0)
    asked = Rounds(_BATCHES, samples, len(os.sched_getaffinity(0)), seed)
    *_, coefficients = rounds(scene, _LAYOUT, skies, asked)
    return measure(year, scene.points, skies, _LAYOUT, counting, Traces(coefficients), 0.99)


def _interval(held: int, times: int) -> list[float]:
    """Of a part of many (Clopper and Pearson 1934)."""
    low = 0.0 if held == 0 else float(stats.beta.ppf(0.025, held, times - held + 1))
    high = 1.0 if held == times else float(stats.beta.ppf(0.975, held + 1, times - held))
    return [round(low, 3), round(high, 3)]


def _room() -> dict[str, Any]:
    """4 m x 6 m x 3 m, an opening of 1.2 m x 1 m to the south; 24 points."""

    def quad(corner: list[float], u: list[float], v: list[float], reflectance: float) -> dict[str, Any]:
        shape = {"type": "quad", "corner": corner, "edge_u": u, "edge_v": v}
        return {"shape": shape, "kernel": {"type": "lambertian", "reflectance": reflectance}}

    left, right, low, high = 1.4, 2.6, 0.9, 1.9
    grid = {"corner": [0, 0.8, 6], "right": [4, 0, 0], "up": [0, 0, -6], "columns": 4, "rows": 6}
    return {
        "nocturne": 1,
        "sensor": {"type": "meters", "instruments": [{"name": "plane", "grid": grid}]},
        "environment": {"radiance": 1.0},
        "surfaces": [
            quad([0, 0, 0], [0, 0, 6], [4, 0, 0], 0.2),
            quad([0, 3, 0], [4, 0, 0], [0, 0, 6], 0.7),
            quad([0, 0, 0], [4, 0, 0], [0, 3, 0], 0.5),
            quad([0, 0, 0], [0, 3, 0], [0, 0, 6], 0.5),
            quad([4, 0, 0], [0, 0, 6], [0, 3, 0], 0.5),
            quad([0, 0, 6], [0, low, 0], [4, 0, 0], 0.5),
            quad([0, high, 6], [0, 3 - high, 0], [4, 0, 0], 0.5),
            quad([0, low, 6], [0, high - low, 0], [left, 0, 0], 0.5),
            quad([right, low, 6], [0, high - low, 0], [4 - right, 0, 0], 0.5),
        ],
    }
