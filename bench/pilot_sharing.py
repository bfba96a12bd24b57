"""How often a pilot lets neighbours share, by seeds and sizes of renders, and the gain of sharing there.

The gain is the efficiency, 1 / (relMSE x CPU seconds), of 4 x 4 pixels that share over that of pixels alone.
A pilot counts rays instead of timing them: the cost of an occlusion query between neighbours is given in rays
of pixels alone.
"""

import statistics
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.errors import true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import FilmSize, Ours
from bench.peer.scenes import Scene, scenes
from bench.programs import Traced
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film

_THREADS = 2
_REFERENCE_SEED = 5000
_ADJOINT = {"direction": "adjoint", "guide": "none"}
_RENDERS = (256, 1024, 4096)
"""Samples of a pixel of the renders that pilots choose for."""
_SAMPLES = 64


@dataclass(frozen=True)
class _Size:
    shrink: int
    """The films' edges are divided by this."""
    seeds: int
    """Of pilots."""
    frames: int
    reference_samples: int


def run(quick: bool) -> Figures:
    """All scenes that the peers are compared on."""
    size = _Size(8, 1, 2, 32) if quick else _Size(1, 8, 8, 512)
    return {name: _scene(scene, size) for name, scene in scenes().items()}


def rows(figures: Figures) -> list[Row]:
    """One for each scene. Between the aims' bounds rare bright samples decide what sharing is worth."""
    table = []
    sizes = ", ".join(str(samples) for samples in _RENDERS)
    for name in scenes():
        found = figures[name]
        chosen = ", ".join(f"{part:.3g}" for part in found["chosen"])
        said = f"{chosen}; efficiency {found['efficiency']:.3g}"
        said += f", a query costs {found['query']:.2g} rays" if found["query"] is not None else ""
        aim = "1" if found["efficiency"] > 2.0 else "0" if found["efficiency"] < 0.8 else ""
        table.append(Row(f"{name}: part of pilots that share, for {sizes} samples", said, aim))
    return table


def _scene(scene: Scene, size: _Size) -> Figures:
    film = FilmSize(scene.width // size.shrink, scene.height // size.shrink)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as name:
        folder = Path(name)
        document = scene.write(folder)
        ways = {sharing: _traced(document, folder, film, sharing) for sharing in (1, 16)}
        chosen = [
            statistics.fmean(_shares(document, folder, film, samples, 1 + i) for i in range(size.seeds))
            for samples in _RENDERS
        ]
        alone, shared = ([way.traced(_SAMPLES, i) for i in range(size.frames)] for way in ways.values())
        truths = [
            Reference.of([way.frame(size.reference_samples, _REFERENCE_SEED + i).y for i in range(4)])
            for way in ways.values()
        ]
    reference = min(truths, key=lambda each: float((each.error**2).mean()))
    rays, more_rays = alone[0].rays, shared[0].rays - alone[0].rays
    more_time = _cpu_s(shared) / _cpu_s(alone) - 1.0
    return {
        "chosen": chosen,
        "efficiency": significant(_product(alone, reference) / _product(shared, reference)),
        "query": significant(more_time * rays / more_rays) if more_rays > 0.01 * rays else None,
    }


def _traced(document: Document, folder: Path, film: FilmSize, sharing: int) -> Ours:
    changed = _changed(document, {"sharing": sharing})
    into = folder / str(sharing)
    return Ours(compile_film(changed, folder, film.width, film.height, 1, into), film, _THREADS)


def _shares(document: Document, folder: Path, film: FilmSize, samples: int, seed: int) -> bool:
    changed = _changed(document, {"seed": seed})
    return "shared" in compile_film(changed, folder, film.width, film.height, samples, folder / "pilot").way


def _changed(document: Document, more: dict[str, Any]) -> Document:
    return {**document, "tracing": {**document.get("tracing", {}), **_ADJOINT, **more}}


def _product(frames: list[Traced], reference: Reference) -> float:
    relmse = statistics.fmean(
        true_relmse(frame.xyz[..., 1], reference.y, reference.error) for frame in frames
    )
    return relmse * _cpu_s(frames)


def _cpu_s(frames: list[Traced]) -> float:
    return statistics.median(frame.tracing_cpu_s for frame in frames)
