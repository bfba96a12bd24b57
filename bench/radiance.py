"""Illuminance and daylight factor on grids in three rooms, compared with Radiance's: root mean square
relative error of points against processor time, and whether both agree."""

import statistics
import tempfile
from pathlib import Path

import numpy as np

from bench.peer import radiance
from bench.peer.pieces import Vec, box, diffuse, quad
from bench.programs import Channel, trace
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film

_OUTDOORS_LX = 10_000.0
_WIDTH, _DEPTH, _HEIGHT = 6.0, 5.0, 2.8
"""m; the window's wall is y = 0, z is up."""
_COLUMNS, _ROWS = 8, 6
_DESK = 0.75

SETTINGS = {
    "fast": "-ab 4 -ad 512 -as 128 -aa 0.15 -ar 128 -lw 2e-3",
    "usual": "-ab 6 -ad 2048 -as 512 -aa 0.1 -ar 256 -lw 5e-4",
    "fine": "-ab 8 -ad 4096 -as 1024 -aa 0.05 -ar 512 -lw 1e-4",
}
"""Of rtrace, without its own threads."""

_TRUTH_SEED = 10_000


def run(quick: bool) -> Figures:
    """Errors of both at several settings, by a long render of ours, whose own error is told."""
    samples, truth, seeds = ((64, 256), 4096, 1) if quick else ((64, 256, 1024, 4096), 2**18, 4)
    settings = list(SETTINGS)[:1] if quick else list(SETTINGS)
    figures: Figures = {"peer": f"Radiance of pyradiance {radiance.VERSION}", "points": _COLUMNS * _ROWS}
    for name, room in rooms().items():
        with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
            figures[name] = _room(room, Path(folder), samples, truth, seeds, settings)
    return figures


def rows(figures: Figures) -> list[Row]:
    """For each room the time of ours to the error of each of Radiance's settings, and how the means agree."""
    table = []
    for name in rooms():
        found = figures[name]
        for theirs in found["radiance"]:
            faster = _seconds_to(found["ours"], theirs["error"])
            said = (
                f"{100 * theirs['error']:.2g} % in {theirs['cpu_s']:.2g} s; here in {faster:.2g} s; "
                f"mean {theirs['mean_ratio']:.4f}"
            )
            table.append(Row(f"{name}: Radiance, {theirs['settings']}", said, ""))
    return table


def rooms() -> dict[str, Document]:
    """By name, with meters on a grid."""
    window = [(1.5, 0.9, 3.0, 1.4)]
    lamps = [
        quad([x, y, _HEIGHT - 0.01], [0, 0.6, 0], [0.6, 0, 0], diffuse(0.0))
        | {"luminaire": {"radiance": {"constant": 1.0, "luminance": 3183.0}}}
        for x in (0.95, 2.7, 4.45)
        for y in (1.0, 3.4)
    ]
    sky = {"cie": 16, "illuminance": _OUTDOORS_LX, "up": [0, 0, 1]}
    screen = [box([0.6, 2.4, 0.0], [5.4, 2.45, 2.2], diffuse(0.4))]
    return {
        "daylight factor": _document(_walls(window), environment=sky),
        "daylight factor behind a screen": _document([*_walls(window), *screen], environment=sky),
        "illuminance by six lamps": _document([*_walls([]), *lamps, *screen]),
    }


def _document(surfaces: list[Document], **more: object) -> Document:
    points = [[*place] for place in _points()]
    sensor = {
        "type": "meters",
        "instruments": [{"name": "desk", "points": points, "normal": [0, 0, 1]}],
        "wavelengths": "response",
    }
    return {"nocturne": 1, "sensor": sensor, "surfaces": surfaces, **more}


def _points() -> list[tuple[float, float, float]]:
    across, deep = (_WIDTH - 1.0) / _COLUMNS, (_DEPTH - 1.0) / _ROWS
    return [
        (0.5 + (i + 0.5) * across, 0.5 + (j + 0.5) * deep, _DESK)
        for j in range(_ROWS)
        for i in range(_COLUMNS)
    ]


def _walls(windows: list[tuple[float, float, float, float]]) -> list[Document]:
    x, y, z = [_WIDTH, 0, 0], [0, _DEPTH, 0], [0, 0, _HEIGHT]
    wall = diffuse(0.5)
    return [
        quad([0, 0, 0], x, y, diffuse(0.2)),
        quad([0, 0, _HEIGHT], y, x, diffuse(0.7)),
        quad([0, _DEPTH, 0], x, z, wall),
        quad([0, 0, 0], y, z, wall),
        quad([_WIDTH, 0, 0], z, y, wall),
        *_window_wall(windows, x, z),
    ]


def _window_wall(windows: list[tuple[float, float, float, float]], x: Vec, z: Vec) -> list[Document]:
    """At y = 0, with at most one opening (x, z, width, height)."""
    wall = diffuse(0.5)
    if not windows:
        return [quad([0, 0, 0], z, x, wall)]
    left, low, width, height = windows[0]
    high, right = low + height, left + width
    return [
        quad([0, 0, 0], [0, 0, low], x, wall),
        quad([0, 0, high], [0, 0, _HEIGHT - high], x, wall),
        quad([0, 0, low], [0, 0, height], [left, 0, 0], wall),
        quad([right, 0, low], [0, 0, height], [_WIDTH - right, 0, 0], wall),
    ]


def _room(
    document: Document,
    folder: Path,
    samples: tuple[int, ...],
    truth_samples: int,
    seeds: int,
    settings: list[str],
) -> Figures:
    truth, truth_error, _ = _ours(document, folder, truth_samples, _TRUTH_SEED)
    ours = []
    for count in samples:
        found = [_ours(document, folder, count, seed) for seed in range(1, seeds + 1)]
        errors = [_error(each[0], truth) for each in found]
        ours.append(
            {
                "samples": count,
                "error": significant(float(np.sqrt(np.mean(np.square(errors))))),
                "cpu_s": significant(statistics.median(each[2] for each in found)),
            }
        )
    scene = radiance.prepare(document, folder)
    theirs = []
    for name in settings:
        lux, cpu_s = scene.readings(_points(), SETTINGS[name])
        theirs.append(
            {
                "settings": name,
                "error": significant(_error(lux, truth)),
                "cpu_s": significant(cpu_s),
                "mean_ratio": round(float(lux.mean() / truth.mean()), 5),
            }
        )
    mean = float(truth.mean())
    return {
        "mean": round(mean, 3),
        "mean_error": significant(float(np.sqrt(np.sum(truth_error**2))) / truth.size),
        "truth_error": significant(float(np.sqrt(np.mean((truth_error / truth) ** 2)))),
        "ours": ours,
        "radiance": theirs,
    }


def _ours(document: Document, folder: Path, samples: int, seed: int) -> tuple[Channel, Channel, float]:
    """Illuminances, their standard errors, and processor seconds."""
    seeded = document | {"tracing": {"seed": seed}}
    compiled = compile_film(seeded, folder, 1, 1, samples, folder / "out")
    found = trace(compiled, 1)
    return found.xyz[..., 1].ravel(), found.y_error.ravel(), found.tracing_cpu_s


def _error(found: Channel, truth: Channel) -> float:
    return float(np.sqrt(np.mean((found / truth - 1.0) ** 2)))


def _seconds_to(ours: list[Figures], error: float) -> float:
    """By errors that fall as one over the root of the time, from the nearest measured."""
    nearest = min(ours, key=lambda each: abs(np.log(each["error"] / error)))
    return float(nearest["cpu_s"] * (nearest["error"] / error) ** 2)
