"""What several runs of `make crossings` found: each leaves a file, and false alarms are of all together."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from nocturne.v1 import job_pb2

from tests.crossings.campaign import ENOUGH, Campaign, told, told_leans
from tests.crossings.judging import ALPHA, holm

RESULTS = Path("bench/results/crossings")


class Overlap(Exception):
    """Two runs have the same scenes."""


@dataclass(frozen=True)
class Run:
    """Scenes of consecutive seeds."""

    engine: int
    first: int
    scenes: int
    samples: int
    """Of a pixel by one seed, at the first look."""
    held: int
    """Intervals that hold the truth, of `intervals`; those of faulty scenes are left out."""
    intervals: int
    again: int
    """Scenes that were looked at again."""
    differ: dict[str, float]
    """Probabilities of those that still differ then, by the seed."""
    broken: dict[str, str]
    """Messages for scenes that were not traced, by the seed."""
    cpu_s: float
    leans: dict[str, tuple[float, int]]
    """Sums of how much more light methods brought than the plain one, in standard errors, and scenes."""


def run_of(found: Campaign, first: int, samples: int) -> Run:
    """The record of a campaign."""
    outcomes, faults = found.outcomes, found.faults
    sound = [each for each in outcomes if each not in faults]
    return Run(
        job_pb2.ENGINE_CURRENT,
        first,
        len(outcomes),
        samples,
        sum(each.held for each in sound),
        sum(each.intervals for each in sound),
        sum(each.looks > 1 for each in outcomes),
        {str(each.scene.seed): each.probability for each in outcomes if each.probability < 1.0},
        {str(each.scene.seed): told(each) for each in outcomes if each.broken},
        round(sum(each.cpu_s for each in outcomes), 1),
        {name: (round(total, 2), count) for name, (total, count) in found.leans.items()},
    )


def write(run: Run, folder: Path) -> None:
    """Beside those of other runs."""
    folder.mkdir(parents=True, exist_ok=True)
    name = f"engine-{run.engine}-from-{run.first}.json"
    (folder / name).write_text(f"{json.dumps(asdict(run), indent=1)}\n")


def read(folder: Path, engine: int = job_pb2.ENGINE_CURRENT) -> list[Run]:
    """All runs by an engine, by their first seeds."""
    files = folder.glob(f"engine-{engine}-from-*.json")
    return sorted((_run(json.loads(each.read_text())) for each in files), key=lambda run: run.first)


def _run(kept: dict[str, Any]) -> Run:
    return Run(**{**kept, "leans": {name: (total, count) for name, (total, count) in kept["leans"].items()}})


def summary(runs: Sequence[Run]) -> str:
    """Of all of them, as if they were one. Raises Overlap."""
    for one, other in pairwise(runs):
        if one.first + one.scenes > other.first:
            raise Overlap(
                f"runs from {one.first} and {other.first} have scenes in common, which would count twice; "
                "remove one of their files"
            )
    scenes = sum(each.scenes for each in runs)
    differ = {seed: each for run in runs for seed, each in run.differ.items()}
    # All others are as probable as can be.
    wrong = holm([*differ.values(), *[1.0] * (scenes - len(differ))], ALPHA)
    faults = {seed for seed, is_wrong in zip(differ, wrong, strict=False) if is_wrong}
    faults |= {seed for run in runs for seed in run.broken}
    held, intervals = (sum(getattr(each, name) for each in runs) for name in ("held", "intervals"))
    covered = held / max(1, intervals)
    return (
        f"{len(runs)} runs, {scenes} scenes: {len(faults)} faults"
        f"{''.join(f', seed {seed}' for seed in sorted(faults, key=int))}; false alarms {ALPHA:.0%} for all; "
        f"{sum(each.again for each in runs)} looked at again; {covered:.2%} of {intervals} stated 95 % "
        f"intervals hold the truth (at least {ENOUGH:.0%}); "
        f"{sum(each.cpu_s for each in runs):.0f} CPU s of tracing; {told_leans(_together(runs))}"
    )


def _together(runs: Sequence[Run]) -> dict[str, tuple[float, int]]:
    names = dict.fromkeys(name for run in runs for name in run.leans)
    of_each = {name: [run.leans.get(name, (0.0, 0)) for run in runs] for name in names}
    return {
        name: (sum(total for total, _ in all_), sum(count for _, count in all_))
        for name, all_ in of_each.items()
    }
