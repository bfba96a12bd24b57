"""Efficiency of the mixture's weight for luminaires, and of roulette by weight or by albedo alone."""

import itertools
import statistics
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from nocturne_client.local.compiled import CompiledFolder

from bench.errors import expected_relmse
from bench.programs import Channel, Traced, trace
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_document, cornell, furnace

LUMINAIRES = (0.0, 0.1, 0.2, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7)
ROULETTES = ("weight", "albedo")
DEFAULT = ("weight", 0.35)
PAPER = ("albedo", 0.0)


@dataclass(frozen=True)
class _Film:
    edge: int
    samples: int
    rounds: int


@dataclass
class _Variant:
    roulette: str
    luminaires: float
    compiled: list[CompiledFolder]
    """One for each round's seed."""
    traced: list[Traced] = field(default_factory=list)

    def figures(self, truth: Channel) -> Figures:
        """relMSE of Y after one photon per pixel, CPU time, and 1 / (relMSE x CPU seconds) of a round."""
        relmse = statistics.fmean(expected_relmse(each.y_error, truth) for each in self.traced)
        cpu_s = statistics.median(each.tracing_cpu_s for each in self.traced)
        photons = self.traced[0].photons
        return {
            "roulette": self.roulette,
            "luminaires": self.luminaires,
            "relmse_of_one_sample": significant(relmse * photons / truth.size),
            "cpu_us_per_photon": significant(1e6 * cpu_s / photons),
            "efficiency": significant(1.0 / (relmse * cpu_s)),
        }


def run(quick: bool) -> Figures:
    """Independent sampling, so that the tracer's own standard error is right for every variant."""
    # All pixels of the furnace are alike, and its photons live long: fewer will do.
    films = (
        {"cornell": _Film(16, 64, 1), "furnace_0.9": _Film(8, 64, 1)}
        if quick
        else {"cornell": _Film(96, 256, 3), "furnace_0.9": _Film(32, 256, 3)}
    )
    scenes = {"cornell": cornell(), "furnace_0.9": furnace(0.9)}
    return {name: _scene(document, films[name]) for name, document in scenes.items()}


def rows(figures: Figures) -> list[Row]:
    """For each scene, the default and the best of both roulettes, relative to the paper's sampling."""
    table = []
    for scene in ("cornell", "furnace_0.9"):
        by_key = {(each["roulette"], each["luminaires"]): each["efficiency"] for each in figures[scene]}
        what = f"{scene}: efficiency / that of kernel sampling with roulette by albedo"
        table.append(Row(f"{what}, default", f"{by_key[DEFAULT] / by_key[PAPER]:.3g}"))
        for roulette in ROULETTES:
            value, weight = max((value, key[1]) for key, value in by_key.items() if key[0] == roulette)
            best = f"{value / by_key[PAPER]:.3g} at luminaires {weight:g}"
            table.append(Row(f"{what}, best with roulette by {roulette}", best))
    return table


def _scene(document: Document, film: _Film) -> list[Figures]:
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        variants = [
            _Variant(*choice, _compile(document, Path(folder), film, *choice))
            for choice in itertools.product(ROULETTES, LUMINAIRES)
        ]
        for number in range(film.rounds):
            for variant in variants:
                variant.traced.append(trace(variant.compiled[number]))
    # All are right on average, so together they are the best picture of the truth.
    truth: Channel = np.mean([each.xyz[..., 1] for variant in variants for each in variant.traced], axis=0)
    return [variant.figures(truth) for variant in variants]


def _compile(
    document: Document, folder: Path, film: _Film, roulette: str, luminaires: float
) -> list[CompiledFolder]:
    tracing = {
        "roulette": roulette,
        "estimator": "mixture",
        "photons_together": 1,
        "h": 1.0,
        "roulette_after": 0,
        "mixture": {"kernel": 1.0 - luminaires, "luminaires": luminaires, "uniform": 0.0},
        "sequence": "independent",
    }
    places = [folder / f"{roulette}-{luminaires}-{seed}" for seed in range(film.rounds)]
    return [
        compile_document(document, place, film.edge, film.samples, {**tracing, "seed": seed})
        for seed, place in enumerate(places)
    ]
