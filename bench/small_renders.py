"""Gain of the default in renders of a second, whose pilot is a larger part of them.

The figure is relMSE x CPU seconds of photons from the sensor for each pixel alone, over the same of the
default including its pilot. Both are sums over seeds, each with its own pilot. Next to it stands the gain
that the pilots reported, which leaves out the pilot's time; they report none if the default is to trace each
pixel alone.
"""

import math
import re
import statistics
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from bench.errors import true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import FilmSize, Ours
from bench.programs import children_cpu_s
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film
from bench.suite.references import THREADS, samples_for
from bench.suite.scenes import SCENES, Tracing
from bench.trap_scenes import TRAPS

_FILM = FilmSize(96, 64)
_SAMPLES, _QUICK_SAMPLES = (2**18, 2**20), (2**18,)
_FOR_A_REFERENCE = 2**12
_REFERENCE_CPU_S, _REFERENCE_FRAMES, _REFERENCE_SEED = 4.0, 4, 5000
_ALONE: Tracing = {"direction": "adjoint", "sharing": 1}
_OPEN: Tracing = {"direction": "auto", "sharing": "auto"}


def _of_suite(name: str) -> Callable[[Path], Document]:
    return SCENES[name].document


def _trap(name: str) -> Callable[[Path], Document]:
    return lambda _: TRAPS[name]()


_SCENES: Mapping[str, Callable[[Path], Document]] = {
    **{
        name: _of_suite(name)
        for name in ("cornell", "reflector", "prism", "colour chart", "sky", "subsurface")
    },
    **{name: _trap(name) for name in ("keyhole", "lamps", "pool")},
}


def run(quick: bool) -> Figures:
    """All scenes, seeds in turns."""
    names = ("keyhole",) if quick else tuple(_SCENES)
    samples = _QUICK_SAMPLES if quick else _SAMPLES
    return {name: _scene(_SCENES[name], samples, 2 if quick else 4) for name in names}


def rows(figures: Figures) -> list[Row]:
    """By scene and samples."""
    return [
        Row(
            f"{name}, {each['samples']:,} samples in all: time to the same error, pixels alone / the default",
            f"{each['worth']:.3g}; without pilot {each['without_pilot']:.3g}, reported {each['told']:.3g}; "
            f"pilot {100 * each['pilot']:.2g} % of the render",
        )
        for name in _SCENES
        for each in figures.get(name, ())
    ]


def _gain_told(way: str) -> float:
    """By a sentence of a compiled scene."""
    found = re.search(r": ([0-9.]+) to ([0-9.]+) times less time", way)
    return math.sqrt(float(found.group(1)) * float(found.group(2))) if found else 1.0


def _scene(document: Callable[[Path], Document], totals: tuple[int, ...], seeds: int) -> list[Figures]:
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        scene = document(place)

        def compiled(tracing: Tracing, samples: int) -> tuple[Ours, float, str]:
            began = children_cpu_s()
            traced = {**scene, "tracing": {**scene.get("tracing", {}), **tracing}}
            into = Path(tempfile.mkdtemp(dir=place))
            found = compile_film(traced, place, _FILM.width, _FILM.height, samples, into)
            return Ours(found, _FILM, THREADS), children_cpu_s() - began, found.way

        best = compiled(_OPEN, _FOR_A_REFERENCE)[0]
        samples = samples_for(best, _REFERENCE_CPU_S)
        frames = [best.frame(samples, _REFERENCE_SEED + i).y for i in range(_REFERENCE_FRAMES)]
        reference = Reference.of(frames)
        alone, without_pilot, _ = compiled(_ALONE, 1)
        found = []
        for total in totals:
            samples = -(-total // (_FILM.width * _FILM.height))
            theirs, ours, rendered, pilots, told = [], [], [], [], []
            for seed in range(seeds):
                default, taken, way = compiled({**_OPEN, "seed": seed}, samples)
                pilot = max(0.0, taken - without_pilot)
                one, other = alone.frame(samples, 100 + seed), default.frame(samples, 100 + seed)
                theirs.append(true_relmse(one.y, reference.y, reference.error) * one.cpu_s)
                error = true_relmse(other.y, reference.y, reference.error)
                ours.append(error * (other.cpu_s + pilot))
                rendered.append(error * other.cpu_s)
                pilots.append(pilot / other.cpu_s)
                told.append(_gain_told(way))
            found.append(
                {
                    "samples": total,
                    "worth": significant(sum(theirs) / sum(ours)),
                    "without_pilot": significant(sum(theirs) / sum(rendered)),
                    "told": significant(statistics.median(told)),
                    "pilot": significant(sum(pilots) / seeds),
                }
            )
    return found
