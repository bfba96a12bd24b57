"""Many scenes, judged together."""

import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path

from tests.crossings import assets
from tests.crossings.judging import ALPHA, holm
from tests.crossings.looking import SAMPLES, Outcome, features, look
from tests.crossings.methods import CHOSEN
from tests.crossings.scenes import scene

ENOUGH = 0.93
"""Of the stated 95 % intervals hold the truth, over all scenes."""


@dataclass
class Campaign:
    """Results of many scenes."""

    outcomes: list[Outcome] = field(default_factory=list)
    pairs: Counter[tuple[str, str]] = field(default_factory=Counter)
    """Scenes that have both of two types of things, such as a kernel and a sensor."""

    def add(self, outcome: Outcome) -> None:
        self.outcomes.append(outcome)
        kinds = sorted(name for name in features(outcome.scene) if "." not in name)
        self.pairs.update(combinations(kinds, 2))

    @property
    def faults(self) -> list[Outcome]:
        """Scenes with a fault. False alarms: ALPHA for all of them; a broken run is always a fault."""
        wrong = holm([each.probability for each in self.outcomes], ALPHA)
        return [each for each, is_wrong in zip(self.outcomes, wrong, strict=True) if is_wrong or each.broken]

    @property
    def coverage(self) -> float:
        """Part of the stated 95 % intervals that hold the truth; faulty scenes know no truth."""
        sound = [each for each in self.outcomes if each not in self.faults]
        return sum(each.held for each in sound) / max(1, sum(each.intervals for each in sound))

    @property
    def leans(self) -> dict[str, tuple[float, int]]:
        """The sum over sound scenes and their number, for each method except the first."""
        found = dict[str, tuple[float, int]]()
        faults = self.faults
        for outcome in self.outcomes:
            for name, score in outcome.leans.items() if outcome not in faults else ():
                total, count = found.get(name, (0.0, 0))
                found[name] = (total + score, count + 1)
        return found

    def summary(self) -> str:
        """In a few lines."""
        methods = Counter(name for each in self.outcomes for name in each.methods)
        again = sum(each.looks > 1 for each in self.outcomes)
        kinds = {name for pair in self.pairs for name in pair}
        possible = len(kinds) * (len(kinds) - 1) // 2
        intervals = sum(each.intervals for each in self.outcomes)
        lines = [
            f"{len(self.outcomes)} scenes: {len(self.faults)} faults; {again} were looked at again",
            "traced by " + ", ".join(f"{name} {count}" for name, count in methods.items()),
            f"{self.coverage:.2%} of {intervals} stated 95 % intervals hold the truth",
            told_leans(self.leans),
            f"{len(kinds)} types of things; {len(self.pairs)} of {possible} pairs of them met, "
            f"{sum(count >= 5 for count in self.pairs.values())} in five scenes or more",
            f"{sum(each.cpu_s for each in self.outcomes):.0f} CPU s of tracing",
        ]
        return "\n".join(lines)


def told_leans(leans: Mapping[str, tuple[float, int]]) -> str:
    """Standard normal each, if all methods meet the same light equally often."""
    scores = ", ".join(f"{name} {total / count**0.5:+.1f}" for name, (total, count) in leans.items())
    return f"means of all scenes together, beside plain: {scores}"


def told(outcome: Outcome) -> str:
    """A fault in a line or two."""
    said = [f"{name}: {why}" for name, why in outcome.broken.items()]
    if outcome.worst is not None and outcome.probability < 1.0:
        said.append(str(outcome.worst))
    return f"seed {outcome.scene.seed}: " + "; ".join(said)


def run(
    seeds: Iterable[int],
    folder: Path,
    seconds: float = float("inf"),
    tell: Callable[[Outcome], None] | None = None,
    samples: int = SAMPLES,
    pilots: int = 1,
) -> Campaign:
    """Scenes of these seeds, or as many as there is time for; `folder` is for files.

    `pilots`: of how many scenes one is traced as a pilot chooses, which takes longer than all else.
    """
    assets.write(folder)
    found, end = Campaign(), time.monotonic() + seconds
    for seed in seeds:
        if time.monotonic() > end:
            break
        outcome = look(scene(seed), folder, samples, () if seed % pilots == 0 else (CHOSEN,))
        found.add(outcome)
        if tell is not None:
            tell(outcome)
    return found
