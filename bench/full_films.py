"""Gain of the default on a film of 1920 x 1080 pixels, where photons start at the luminaires.

Efficiency is 1 / (relMSE x CPU seconds). Pixels have too few samples for a reference image. So the squared
error of a method is half the squared difference of its images by two seeds, and the reference value of a
pixel is the mean over all images of a square of 20 x 20 pixels. The default's time includes the pilot.
"""

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import true_relmse
from bench.peer.contenders import FilmSize, Ours
from bench.programs import Channel, children_cpu_s
from bench.report import Figures, Row, significant
from bench.scenes import compile_film, example
from bench.suite.references import THREADS

SCENES = ("reflector", "headlight")
DEFAULT, ALONE = "auto", "alone"
ALONE_SAYS = {"direction": "adjoint", "sharing": 1}
NAMED: Mapping[str, Mapping[str, Any]] = {
    "both directions": {"direction": "both", "sharing": 1},
    "both, shared": {"direction": "both", "sharing": 16},
    "both, 4 times as many from luminaires": {"direction": "both", "sharing": 1, "forward_ratio": 4},
}

_FILM, _QUICK_FILM = FilmSize(1920, 1080), FilmSize(96, 54)
_CPU_S, _QUICK_CPU_S = 60.0, 0.5
_BLOCK = 20


def run(quick: bool) -> Figures:
    """All methods on both scenes, in turns."""
    film, cpu_s = (_QUICK_FILM, _QUICK_CPU_S) if quick else (_FILM, _CPU_S)
    return {name: _scene(name, film, cpu_s) for name in SCENES}


def rows(figures: Figures) -> list[Row]:
    """The default against the best of the others, and against photons from the sensor."""
    table = []
    for name in SCENES:
        ways = figures[name]["ways"]
        best = max((ALONE, *NAMED), key=ways.__getitem__)
        ratio = ways[DEFAULT] / ways[best]
        table += [
            Row(
                f"{name}, 1920 x 1080: efficiency, default / the best method ({best})",
                f"{ratio:.3g}",
                "at least 0.67",
            ),
            Row(f"{name}, 1920 x 1080: efficiency, default / {ALONE}", f"{ways[DEFAULT] / ways[ALONE]:.3g}"),
        ]
    return table


def _scene(name: str, film: FilmSize, cpu_s: float) -> Figures:
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        document = example(name, place)

        def compiled(tracing: Mapping[str, Any], samples: int, into: str) -> tuple[Ours, str, float]:
            began = children_cpu_s()
            found = compile_film(
                {**document, "tracing": dict(tracing)}, place, film.width, film.height, samples, place / into
            )
            return Ours(found, film, THREADS), found.way, children_cpu_s() - began

        alone, _, without_pilot = compiled(ALONE_SAYS, 1, "alone")
        as_many = _samples(alone, cpu_s)
        default, chosen, with_pilot = compiled({}, as_many, "auto")
        ways = {DEFAULT: default, ALONE: alone}
        ways |= {way: compiled(tracing, 1, way)[0] for way, tracing in NAMED.items()}
        samples = {way: _samples(ours, cpu_s) for way, ours in ways.items()}
        frames = {way: [ours.frame(samples[way], seed) for seed in (1, 2)] for way, ours in ways.items()}
    shown = _around(np.mean([f.y for way in frames if way != ALONE for f in frames[way]], axis=0))
    efficiency = {}
    for way, (one, other) in frames.items():
        error = (one.y - other.y) / np.sqrt(2.0)
        taken = (one.cpu_s + other.cpu_s) / 2 + (with_pilot - without_pilot if way == DEFAULT else 0.0)
        efficiency[way] = significant(1.0 / (true_relmse(shown + error, shown, np.zeros_like(shown)) * taken))
    pilot_cpu_s = significant(with_pilot - without_pilot)
    return {"chosen": chosen, "pilot_cpu_s": pilot_cpu_s, "samples": samples, "ways": efficiency}


def _samples(ours: Ours, cpu_s: float) -> int:
    """Of a pixel, by what one takes."""
    return max(1, round(cpu_s / ours.frame(1, 0).cpu_s))


def _around(image: Channel) -> Channel:
    """Its means over squares, each in the place of its pixels."""
    height, width = image.shape
    rows, columns = np.arange(height) // _BLOCK, np.arange(width) // _BLOCK
    sums = np.add.reduceat(
        np.add.reduceat(image, np.flatnonzero(np.diff(rows, prepend=-1)), axis=0),
        np.flatnonzero(np.diff(columns, prepend=-1)),
        axis=1,
    )
    areas = np.outer(np.bincount(rows), np.bincount(columns))
    around: Channel = (sums / areas)[np.ix_(rows, columns)]
    return around
