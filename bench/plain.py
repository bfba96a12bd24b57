"""Cost of unused features: the Cornell box by the tracer, and by one that has no other features.

`nocturne-trace-plain` is nocturne-trace compiled with headers of `worker/plain` in place of the usual ones.
It knows one kernel, no media, and no surfaces that touch. Textures, instances, motion and the other
estimators are in both. The images must be the same to the bit. Instructions are counted by Valgrind, whatever
else the machine does; CPU times are measured in turns.
"""

import math
import statistics
import tempfile
from pathlib import Path

import numpy as np
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.programs import need_program

from bench.counting import instructions
from bench.programs import Traced, bench_program, trace
from bench.report import Figures, Row, significant, spread
from bench.scenes import compile_document, cornell

_NOISE = 1.2533
"""Standard error of a median over that of a mean, for normal errors: sqrt(pi / 2)."""

_FEW, _MANY = 64, 256
"""Samples; the difference has no part of what a run costs by itself."""


def run(quick: bool) -> Figures:
    """Instructions and CPU time of nocturne-trace over those of the plain one, on one thread."""
    edge, rounds = (32, 3) if quick else (64, 32)
    programs = (need_program("nocturne-trace"), bench_program("nocturne-trace-plain"))
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        few, many = (_compiled(folder, 16, samples) for samples in (_FEW, _MANY))
        full, plain = (instructions(each, many) - instructions(each, few) for each in programs)
        ratios = _times(_compiled(folder, edge, _FEW), programs, rounds)
    error = _NOISE * statistics.stdev(ratios) / math.sqrt(rounds)
    return {
        "instructions": significant(full / plain),
        "rounds": rounds,
        "time": spread(ratios),
        "time_error": significant(error),
    }


def rows(figures: Figures) -> list[Row]:
    """Both ratios."""
    time = figures["time"]
    told = f"{time['median']:.4g} ± {figures['time_error']:.1g} ({time['low']:.3g} to {time['high']:.3g})"
    what = "tracer / tracer that can do nothing else"
    return [
        Row(f"cornell: instructions, {what}", f"{figures['instructions']:.4g}", "at most 1.01"),
        Row(f"cornell: CPU time, {what}", told, "at most 1.01"),
    ]


def _compiled(folder: str, edge: int, samples: int) -> CompiledFolder:
    return compile_document(cornell(), Path(folder) / f"{edge}-{samples}", edge, samples, {})


def _times(compiled: CompiledFolder, programs: tuple[Path, Path], rounds: int) -> list[float]:
    ratios = []
    for number in range(rounds):
        order = programs if number % 2 == 0 else programs[::-1]
        by_program = {program: trace(compiled, 1, program=program) for program in order}
        full, plain = (by_program[program] for program in programs)
        _same(full, plain)
        ratios.append(full.tracing_cpu_s / plain.tracing_cpu_s)
    return ratios


def _same(full: Traced, plain: Traced) -> None:
    if full.photons != plain.photons or not np.array_equal(full.xyz, plain.xyz):
        raise NocturneClientError("nocturne-trace-plain gave another image than nocturne-trace")
