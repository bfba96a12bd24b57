"""How often a pilot's choice is a good one: forty scenes, and pilots by sixteen seeds in each.

The figure is the efficiency, 1 / (relMSE x CPU seconds), of each pilot's choice, over the best of all choices
and of the methods that a user could name. The best is found by half of the images and compared in the other
half, and vice versa: otherwise the least of many equal figures would look better than it is.
"""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from bench.errors import true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import FilmSize, Ours
from bench.programs import Channel
from bench.rare_scenes import rare_scenes
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film
from bench.suite.references import THREADS, samples_for
from bench.suite.scenes import SCENES
from bench.trap_scenes import TRAPS
from bench.traps import ALONE, DEFAULT, WAYS
from bench.ways import gathers

_FILM = FilmSize(48, 32)
_SAMPLES = 512
"""Of the render that a pilot chooses for, and of the images that judge the choice: 786,432 in all."""
_FORTY = 40
_SEEDS = 16
_ROUNDS, _MORE_ROUNDS, _CLOSE = 4, 12, 3.0
"""Rounds of all methods, then of those that are at most so many times worse than the best."""
_REFERENCES, _REFERENCE_CPU_S, _REFERENCE_SEED = 8, 1.5, 5000
_GOOD, _BAD, _LEAST = 1.25, 2.0, 1e-12
_AIM = 0.9


def run(quick: bool) -> Figures:
    """Of each scene: the loss by each pilot."""
    seeds, rounds, more_rounds = (2, 2, 2) if quick else (_SEEDS, _ROUNDS, _MORE_ROUNDS)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        scenes = _scenes(Path(folder))
        names = list(scenes)[::8] if quick else list(scenes)
        return {name: _scene(scenes[name], Path(folder), seeds, rounds, more_rounds) for name in names}


def rows(figures: Figures) -> list[Row]:
    """All choices together, and the scenes with bad ones."""
    scenes = {name: found for name, found in figures.items() if isinstance(found, dict)}
    losses = [loss for found in scenes.values() for loss in found["losses"]]
    bad = [
        f"{name} ({max(found['losses']):.2g})"
        for name, found in scenes.items()
        if max(found["losses"]) > _BAD
    ]
    good = sum(loss <= _GOOD for loss in losses) / len(losses)
    return [
        Row(
            f"pilots of {len(scenes)} scenes by {len(losses) // len(scenes)} seeds: choices within {_GOOD:g} "
            "of the best",
            f"{good:.1%}",
            f"at least {_AIM:.0%}",
        ),
        Row(
            f"scenes in which any choice is worse than {_BAD:g}: {', '.join(bad) or 'none'}",
            str(len(bad)),
            "0",
        ),
    ]


def _scenes(place: Path) -> dict[str, Document]:
    scenes = {name: scene.document(place) for name, scene in SCENES.items()}
    scenes |= {name: document() for name, document in TRAPS.items()}
    rare = list(rare_scenes().items())
    return scenes | dict(rare[:: len(rare) // (_FORTY - len(scenes))][: _FORTY - len(scenes)])


def _scene(document: Document, place: Path, seeds: int, rounds: int, more_rounds: int) -> Figures:
    by_way: dict[str, Ours] = {}
    for name, tracing in WAYS.items():
        if name == DEFAULT or (tracing.get("direction") == "both" and not gathers(document)):
            continue
        by_way[name] = _compiled(document, dict(tracing), place)[0]
    chosen = []
    for seed in range(seeds):
        ours, way = _compiled(document, {"seed": seed}, place)
        by_way.setdefault(way, ours)
        chosen.append(way)
    long = by_way[max(set(chosen), key=chosen.count)]
    samples = samples_for(long, _REFERENCE_CPU_S)
    reference = Reference.of([long.frame(samples, _REFERENCE_SEED + i).y for i in range(_REFERENCES)])
    products: dict[str, list[float]] = {way: [] for way in by_way}

    def render(ways: list[str], seeds: range) -> None:
        for seed in seeds:
            for way in ways:
                frame = by_way[way].frame(_SAMPLES, seed)
                products[way].append(true_relmse(frame.y, reference.y, reference.error) * frame.cpu_s)

    render(list(by_way), range(rounds))
    least = min(float(np.mean(each)) for each in products.values())
    close = [way for way, each in products.items() if float(np.mean(each)) < _CLOSE * max(least, _LEAST)]
    render(close, range(rounds, rounds + more_rounds))
    losses = _losses({way: np.array(products[way]) for way in by_way})
    return {
        "chosen": {way: chosen.count(way) for way in sorted(set(chosen))},
        "products": {
            way: [significant(float(np.mean(each))), significant(float(np.std(each) / np.sqrt(len(each))))]
            for way, each in sorted(products.items(), key=lambda item: float(np.mean(item[1])))
        },
        "losses": [significant(losses[way]) for way in chosen],
    }


def _losses(products: dict[str, Channel]) -> dict[str, float]:
    """How many times more of error x time each has than the best, of which others may have been rendered
    more often."""
    halves = [
        {way: max(_LEAST, float(np.mean(each[half::2]))) for way, each in products.items()} for half in (0, 1)
    ]
    losses = dict.fromkeys(products, 1.0)
    for by, judged in (halves, halves[::-1]):
        best = min(by, key=by.__getitem__)
        for way in losses:
            losses[way] *= (judged[way] / judged[best]) ** 0.5
    return losses


def _compiled(document: Document, tracing: dict[str, Any], place: Path) -> tuple[Ours, str]:
    """And the way in words; that of what names none is each pixel alone."""
    traced = {**document, "tracing": tracing}
    into = Path(tempfile.mkdtemp(dir=place))
    compiled = compile_film(traced, place, _FILM.width, _FILM.height, _SAMPLES, into)
    words = compiled.way.partition(":")[0]
    return Ours(compiled, _FILM, THREADS), ALONE if words == "photons from the sensor" else words
