"""Efficiency compared with Mitsuba 3's, and whether both show the same picture."""

import math
import statistics
import sys
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from bench.errors import true_relmse
from bench.peer.agreement import Reference, agreement
from bench.peer.contenders import SAMPLERS, Contender, FilmSize, Frame, Ours, mitsuba
from bench.peer.install import Installed, install
from bench.peer.scenes import Scene, scenes
from bench.peer.turns import OURS, THREADS, in_turns, rate, reference
from bench.report import Figures, Row, significant
from bench.scenes import Document, compile_film


@dataclass(frozen=True)
class _Size:
    """How long it may take."""

    shrink: int
    """The films' edges are divided by this."""
    budgets_cpu_s: tuple[float, ...]
    """For a frame; more frames than one show how the efficiency changes with the number of samples."""
    rounds: int
    reference_frames: int
    reference_frame_cpu_s: float
    trial_samples: int


_FULL = _Size(1, (2.0, 4.0, 8.0), 3, 16, 4.0, 16)
_QUICK = _Size(8, (0.05, 0.1, 0.2), 1, 8, 0.1, 16)


def run(quick: bool) -> Figures:
    """1 / (relMSE of Y x CPU seconds) at equal budgets, in turns; and how far the references agree."""
    installed = install()
    size = _QUICK if quick else _FULL
    figures: Figures = {
        "peer": f"Mitsuba {installed.version} {installed.variant}",
        "threads": THREADS,
        "budgets_cpu_s": list(size.budgets_cpu_s),
    }
    for name, scene in scenes().items():
        print(f"bench: peers: {name}", file=sys.stderr)
        figures[name] = _scene(scene, size, installed)
    return figures


def rows(figures: Figures) -> list[Row]:
    """Efficiency over the peer's for each scene and budget, and the agreement of the references."""
    table = []
    for scene in scenes():
        found = figures[scene]
        by_key = {(each["renderer"], each["budget_cpu_s"]): each for each in found["frames"]}
        for peer in SAMPLERS:
            ratios = [
                by_key[OURS, budget]["efficiency"] / by_key[peer, budget]["efficiency"]
                for budget in figures["budgets_cpu_s"]
            ]
            budgets = ", ".join(f"{budget:g}" for budget in figures["budgets_cpu_s"])
            what = f"{scene}: efficiency / {figures['peer']} {peer}, at {budgets} CPU s"
            aim = "1" if peer == SAMPLERS[0] else ""
            table.append(Row(what, ", ".join(f"{ratio:.3g}" for ratio in ratios), aim))
        agree = found["agreement"]
        said = (
            f"{agree['ratio']:.5f} ± {agree['ratio_error']:.1g}; rms z of pixels {agree['rms_z']:.3g}, "
            f"difference beyond noise {100 * agree['difference']:.2g} %"
        )
        table.append(Row(f"{scene}: luminance / peer's", said, "1; rms z 1"))
    return table


def _scene(scene: Scene, size: _Size, installed: Installed) -> Figures:
    film = FilmSize(scene.width // size.shrink, scene.height // size.shrink)
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as name, ExitStack() as stack:
        folder = Path(name)
        ours, way = _ours(scene.write(folder), folder, film, size)
        contenders: dict[str, Contender] = {OURS: ours}
        theirs = stack.enter_context(
            mitsuba(installed, folder / "scene.json", folder / "mitsuba", film, THREADS)
        )
        contenders |= {sampler: theirs[sampler] for sampler in SAMPLERS}
        return _compare(contenders, replace(size, rounds=scene.rounds * size.rounds)) | {"way": way}


def _ours(document: Document, folder: Path, film: FilmSize, size: _Size) -> tuple[Ours, str]:
    """The tracer with the method that a pilot chooses for the largest budget, and that method in words. The
    pilot's time is not counted."""
    plain = Ours(compile_film(document, folder, film.width, film.height, 1), film, THREADS)
    samples = _samples(max(size.budgets_cpu_s), rate(plain, size.trial_samples))
    chosen = compile_film(document, folder, film.width, film.height, samples, folder / "chosen")
    return Ours(chosen, film, THREADS), chosen.way


def _compare(contenders: Mapping[str, Contender], size: _Size) -> Figures:
    rates = {name: rate(contender, size.trial_samples) for name, contender in contenders.items()}
    counts = {
        (name, budget): _samples(budget, rates[name]) for budget in size.budgets_cpu_s for name in contenders
    }
    measured = in_turns({key: (contenders[key[0]], count) for key, count in counts.items()}, size.rounds)
    references = {
        name: reference(
            contenders[name], _samples(size.reference_frame_cpu_s, rates[name]), size.reference_frames
        )
        for name in (OURS, SAMPLERS[0])
    }
    frames = [
        {
            "renderer": name,
            "budget_cpu_s": budget,
            "samples": counts[name, budget],
            **_figures(measured[name, budget], references[OURS if name == OURS else SAMPLERS[0]]),
        }
        for name, budget in counts
    ]
    return {"frames": frames, "agreement": agreement(references[OURS], references[SAMPLERS[0]])}


def _figures(frames: list[Frame], reference: Reference) -> Figures:
    relmse = statistics.fmean(true_relmse(frame.y, reference.y, reference.error) for frame in frames)
    cpu_s = statistics.median(frame.cpu_s for frame in frames)
    return {
        "relmse": significant(relmse),
        "cpu_s": significant(cpu_s),
        "efficiency": significant(1.0 / (relmse * cpu_s)),
    }


def _samples(budget_cpu_s: float, cpu_s_per_sample: float) -> int:
    """The power of two nearest to the budget: Sobol points and jittered grids are at their best there."""
    return int(2 ** max(0, round(math.log2(budget_cpu_s / cpu_s_per_sample))))
