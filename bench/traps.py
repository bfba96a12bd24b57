"""Gain of the default where light is hard to find: scenes made to fool the pilot.

Efficiency is 1 / (relMSE x CPU seconds). The default, with nothing declared, is compared with photons from
the sensor for each pixel alone, and with the best of the methods that a user could name. The pilot's time is
not counted.
"""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import scene_pb2

from bench.errors import true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import FilmSize, Ours
from bench.report import Figures, Row, significant
from bench.scenes import compile_film
from bench.suite.references import samples_for
from bench.trap_scenes import TRAPS
from bench.ways import gathers

ALONE, DEFAULT = "alone", "auto"
WAYS: Mapping[str, Mapping[str, Any]] = {
    ALONE: {"direction": "adjoint", "sharing": 1},
    "shared": {"direction": "adjoint", "sharing": 16},
    "both directions": {"direction": "both", "sharing": 1},
    "both, shared": {"direction": "both", "sharing": 16},
    DEFAULT: {},
}

_THREADS = 2
_FILM = FilmSize(48, 32)
_FOR_A_PILOT = 2**13
"""Samples of the render that the pilot is to choose for: 12 million in all."""
_REFERENCE_SEED = 5000


@dataclass(frozen=True)
class _Size:
    cpu_s: float
    """Of an image."""
    rounds: int
    reference_frames: int
    reference_cpu_s: float


# Rare bright samples decide: in three rounds a method had three times the efficiency of another, or a third.
_FULL, _QUICK = _Size(0.5, 12, 12, 2.0), _Size(0.05, 2, 2, 0.1)


def run(quick: bool) -> Figures:
    """All methods on all scenes, seeds in turns."""
    size = _QUICK if quick else _FULL
    return {name: _scene(document(), size) for name, document in TRAPS.items()}


def rows(figures: Figures) -> list[Row]:
    """The default against two others."""
    table = []
    for name in TRAPS:
        found = figures[name]
        ways = found["ways"]
        # Of equals one that has a name.
        best = max((way for way in WAYS if way in ways), key=ways.__getitem__)
        table += [
            Row(
                f"{name}: efficiency, default / each pixel alone",
                f"{ways[DEFAULT] / ways[ALONE]:.3g}",
                "at least 1",
            ),
            Row(
                f"{name}: efficiency, default / the best method ({best})", f"{ways[DEFAULT] / ways[best]:.3g}"
            ),
        ]
    return table


def _scene(document: dict[str, Any], size: _Size) -> Figures:
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        ours: dict[bytes, Ours] = {}
        traced_as, chosen = {}, ""
        for way, tracing in WAYS.items():
            if tracing.get("direction") == "both" and not gathers(document):
                # Then photons from the luminaires bring nothing.
                continue
            place = Path(folder)
            traced = {**document, "tracing": dict(tracing)}
            compiled = compile_film(traced, place, _FILM.width, _FILM.height, _FOR_A_PILOT, place / way)
            chosen = compiled.way or chosen
            # Methods that trace alike are measured once: otherwise they would differ by chance alone.
            traced_as[way] = _but_words(compiled.scene)
            ours.setdefault(traced_as[way], Ours(compiled, _FILM, _THREADS))
        default = ours[traced_as[DEFAULT]]
        frames = [
            default.frame(samples_for(default, size.reference_cpu_s), _REFERENCE_SEED + i).y
            for i in range(size.reference_frames)
        ]
        reference = Reference.of(frames)
        samples = {key: samples_for(each, size.cpu_s) for key, each in ours.items()}
        products: dict[bytes, list[float]] = {key: [] for key in ours}
        for seed in range(size.rounds):
            for key, each in ours.items():
                frame = each.frame(samples[key], seed)
                products[key].append(true_relmse(frame.y, reference.y, reference.error) * frame.cpu_s)
    efficiency = {
        key: significant(1.0 / max(1e-12, float(np.median(each)))) for key, each in products.items()
    }
    return {"chosen": chosen, "ways": {way: efficiency[key] for way, key in traced_as.items()}}


def _but_words(scene: Path) -> bytes:
    """The compiled scene without the sentence on the choice of its method."""
    message = scene_pb2.CompiledScene.FromString(scene.read_bytes())
    message.tracing.way = ""
    return message.SerializeToString(deterministic=True)
