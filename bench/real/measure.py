"""One room by both renderers, at equal processor time."""

import statistics
from dataclasses import dataclass
from pathlib import Path

from nocturne_client.local.compiled import compile_to
from nocturne_client.local.importing import import_to
from nocturne_scene.formats.reading.options import ImportOptions

from bench.errors import trimmed_relmse, true_relmse
from bench.peer.agreement import Reference, agreement
from bench.peer.contenders import SAMPLERS, Contender, FilmSize, Frame, Ours, mitsuba_of
from bench.peer.install import Installed
from bench.peer.turns import OURS, THREADS, in_turns, rate, reference
from bench.programs import children_cpu_s
from bench.real.preparing import prepared
from bench.report import Figures, significant

_TRIAL_SAMPLES = 4
_WORST = 1e-3
"""Part of the pixels that the trimmed error leaves out."""
_COUNTED_FROM_S = 8.0
"""From this budget on the pilot's time counts."""


@dataclass(frozen=True)
class Size:
    """How long it may take."""

    budgets_cpu_s: tuple[float, ...]
    rounds: int
    reference_frames: int
    reference_frame_cpu_s: float


@dataclass(frozen=True)
class _Chosen:
    """The tracer by the method that was chosen for a budget."""

    ours: Ours
    samples: int
    way: str
    pilot_cpu_s: float


def room(file: Path, folder: Path, size: Size, installed: Installed) -> Figures:
    """Efficiencies of all by budget, the agreement of the references, and the cost of each pilot."""
    scene, (width, height) = prepared(file)
    film = FilmSize(width, height)
    imported = import_to(scene, folder / "imported", ImportOptions(allow_missing=True))
    with mitsuba_of(installed, scene, folder, THREADS) as theirs:
        peers: dict[str, Contender] = {name: theirs[name] for name in SAMPLERS}
        rates = {name: rate(peer, _TRIAL_SAMPLES) for name, peer in peers.items()}
        chosen = _chosen(imported.document, folder, film, size)
        runs: dict[tuple[str, float], tuple[Contender, int]] = {}
        for budget, our in chosen.items():
            runs[OURS, budget] = our.ours, our.samples
            runs |= {(name, budget): (peer, _samples(budget, rates[name])) for name, peer in peers.items()}
        frames = in_turns(runs, size.rounds)
        best = chosen[max(chosen)]
        last = {OURS: best.ours, SAMPLERS[0]: peers[SAMPLERS[0]]}
        spent = {OURS: frames[OURS, max(chosen)][0].cpu_s / best.samples, **rates}
        references = {
            name: reference(
                contender, _samples(size.reference_frame_cpu_s, spent[name]), size.reference_frames
            )
            for name, contender in last.items()
        }
    return {
        "film": [width, height],
        "missing": len(imported.missing),
        "ways": {f"{budget:g}": each.way for budget, each in chosen.items()},
        "pilot_cpu_s": {f"{budget:g}": significant(each.pilot_cpu_s) for budget, each in chosen.items()},
        "frames": [
            _figures(name, budget, each, references, chosen) for (name, budget), each in frames.items()
        ],
        "agreement": agreement(references[OURS], references[SAMPLERS[0]]),
    }


def _chosen(document: Path, folder: Path, film: FilmSize, size: Size) -> dict[float, _Chosen]:
    """By budget. The cost of a sample is that of the method which the budget before chose."""
    found: dict[float, _Chosen] = {}
    plain = compile_to(document, folder / "trial", film.width, film.height, _TRIAL_SAMPLES)
    cost = rate(Ours(plain, film, THREADS), _TRIAL_SAMPLES)
    for budget in size.budgets_cpu_s:
        samples = _samples(budget, cost)
        before = children_cpu_s()
        compiled = compile_to(document, folder / f"for-{budget:g}", film.width, film.height, samples)
        pilot = children_cpu_s() - before
        ours = Ours(compiled, film, THREADS)
        cost = rate(ours, _TRIAL_SAMPLES)
        left = budget - pilot if budget >= _COUNTED_FROM_S else budget
        found[budget] = _Chosen(ours, _samples(max(left, 0.25 * budget), cost), compiled.way, pilot)
    return found


def _figures(
    name: str,
    budget: float,
    frames: list[Frame],
    references: dict[str, Reference],
    chosen: dict[float, _Chosen],
) -> Figures:
    reference = references[OURS if name == OURS else SAMPLERS[0]]
    relmse = statistics.median(true_relmse(each.y, reference.y, reference.error) for each in frames)
    trimmed = statistics.median(
        trimmed_relmse(each.y, reference.y, reference.error, _WORST) for each in frames
    )
    cpu_s = statistics.median(each.cpu_s for each in frames)
    counted = cpu_s
    if name == OURS and budget >= _COUNTED_FROM_S:
        counted += chosen[budget].pilot_cpu_s
    return {
        "renderer": name,
        "budget_cpu_s": budget,
        "cpu_s": significant(cpu_s),
        "relmse": significant(relmse),
        "efficiency": significant(1.0 / (relmse * counted)),
        "trimmed_efficiency": significant(1.0 / (trimmed * counted)),
    }


def _samples(budget_cpu_s: float, cpu_s_per_sample: float) -> int:
    return max(1, round(budget_cpu_s / cpu_s_per_sample))
