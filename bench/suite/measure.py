"""Error over CPU time: every method at every budget, in turns."""

import json
import math
import statistics
import sys
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client.errors import NocturneClientError

from bench.errors import trimmed_relmse, true_relmse
from bench.peer.agreement import Reference
from bench.peer.contenders import PARTICLES, SAMPLERS, Contender, Ours, mitsuba
from bench.peer.install import Installed, install
from bench.programs import Channel
from bench.report import Figures, Skipped, significant
from bench.scenes import Document, compile_film
from bench.suite.references import THREADS, load, samples_for
from bench.suite.scenes import AIMED, OPENINGS, SuiteScene
from bench.ways import FORWARD, WAYS, Way

WORST = 0.001
"""Part of the pixels that the second error leaves out, at least one pixel."""

TARGET = 1e-4
"""relMSE of an image that is right to 1 %."""

MITSUBA = "Mitsuba "

_FOR_A_PILOT = 2**16
"""Samples of the small films: some 25 million in all, half a minute."""


NOT_FALLING = -0.5
"""With an exponent of time above this, more time does not help as it should, so no time to an error is
shown."""


def _has_important(document: Document) -> bool:
    return bool(document.get("important_directions"))


_OPENINGS = Way(
    "openings",
    "mixture that aims at what the scene calls important",
    OPENINGS,
    applies=_has_important,
)
_OPEN = {"direction": "auto", "sharing": "auto"}
_AUTO = Way("auto", "the default: what a pilot chooses, whose time is left out", _OPEN)
_UNDECLARED = Way(
    "auto, nothing declared", "the default of a scene whose important directions nobody told", _OPEN
)
_AIMED = Way(
    "forward, aimed",
    "photons from the luminaires, nine of ten towards what the scene calls important",
    AIMED,
    applies=lambda document: _has_important(document) and FORWARD.applies(document),
)


@dataclass(frozen=True)
class Size:
    """How long it may take."""

    budgets_cpu_s: tuple[float, ...]
    """Of an image."""
    rounds: int


QUICK = Size((0.02, 0.05), 1)
MINUTES = Size((0.05, 0.1, 0.2, 0.4, 0.8), 3)
"""Three images: one of subsurface's is off by a factor of three where a rare photon decides."""
FULL = Size((0.5, 1.0, 2.0, 4.0, 8.0), 3)


@dataclass(frozen=True)
class _Runner:
    """A contender, and the costs by which its number of samples follows from a time."""

    contender: Contender
    cpu_s_per_sample: float
    cpu_s_per_image: float = 0.0
    """Whatever the number of samples."""

    def samples(self, budget_cpu_s: float) -> int:
        """The power of two nearest to the budget, where Sobol points are at their best; 0: not even one."""
        count = (budget_cpu_s - self.cpu_s_per_image) / self.cpu_s_per_sample
        return int(2 ** max(0, round(math.log2(count)))) if count >= 0.5 else 0


def peer() -> Installed | None:
    """Mitsuba, or None where it can't be had."""
    try:
        return install()
    except (Skipped, NocturneClientError) as reason:
        print(f"bench: no Mitsuba: {reason}", file=sys.stderr)
        return None


def measure(name: str, scene: SuiteScene, size: Size, installed: Installed | None) -> Figures:
    """Errors of all methods that apply to a scene; NocturneClientError if its reference is missing."""
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder, ExitStack() as stack:
        place = Path(folder)
        document = scene.document(place)
        reference = load(name, document).reference
        ways = [way for way in (*WAYS, _OPENINGS, _AIMED) if way.applies(document)]
        runners = {way.name: _ours(way, scene, document, place, size)[0] for way in ways}
        runners[_AUTO.name], chosen = _ours(_AUTO, scene, document, place, size, _FOR_A_PILOT)
        if _has_important(document):
            told_less = {key: value for key, value in document.items() if key != "important_directions"}
            found = _ours(_UNDECLARED, scene, told_less, place, size, _FOR_A_PILOT)
            runners[_UNDECLARED.name] = found[0]
        refused: dict[str, str] = {}
        for each in installed.variants() if installed is not None else ():
            theirs = MITSUBA + each.variant
            try:
                runners |= _theirs(theirs, each, scene, document, place, size, stack)
            except NocturneClientError as reason:
                refused[theirs] = _told(reason)
        errors = _compare(runners, reference, size, refused)
    return {"ways": errors, "not there": refused, "chosen": chosen}


def _told(reason: NocturneClientError) -> str:
    """The features that can't be exported; for any other error, its message."""
    problems = list(dict.fromkeys(problem.message for problem in reason.problems))
    return "; ".join(problems) if problems else str(reason)


def _ours(
    way: Way, scene: SuiteScene, document: Document, place: Path, size: Size, samples: int = 1
) -> tuple[_Runner, str]:
    """Compiled for a render of so many samples, and what a pilot chose for that."""
    film, into = scene.film, place / way.name
    compiled = compile_film(way.document(document), place, film.width, film.height, samples, into)
    ours = Ours(compiled, scene.film, THREADS, way.baseline)
    enough = 0.3 * max(size.budgets_cpu_s)
    return _Runner(ours, enough / samples_for(ours, enough)), compiled.way


def _theirs(
    name: str,
    installed: Installed,
    scene: SuiteScene,
    document: Document,
    place: Path,
    size: Size,
    stack: ExitStack,
) -> dict[str, _Runner]:
    """Mitsuba with its best sampler."""
    folder = place / installed.variant
    folder.mkdir()
    path = place / "scene.json"
    path.write_text(json.dumps(document))
    found = stack.enter_context(mitsuba(installed, path, folder / "exported", scene.film, THREADS))
    contenders = {name: found[SAMPLERS[0]]}
    # By the vectorised variant: the scalar one takes minutes to begin.
    if scene.peers_particles and "llvm" in installed.variant:
        contenders[f"{name}, {PARTICLES}"] = found[PARTICLES]
    longest = max(size.budgets_cpu_s)
    runners = {}
    for each, contender in contenders.items():
        few, many = 16, 16
        first = last = contender.frame(few, 1).cpu_s
        while last < 0.2 * longest:
            many *= 8
            last = contender.frame(many, 2).cpu_s
        rate = max(last - first, 0.5 * last) / (many - few) if many > few else last / many
        runners[each] = _Runner(contender, rate, max(0.0, first - few * rate))
    return runners


def _compare(
    runners: Mapping[str, _Runner], reference: Reference, size: Size, refused: dict[str, str]
) -> Figures:
    """Contenders that fail are dropped, with the reason in `refused`."""
    rows: dict[tuple[str, float], list[dict[str, float]]] = {}
    for seed in range(size.rounds):
        for budget in size.budgets_cpu_s:
            for name, runner in runners.items():
                samples = runner.samples(budget)
                if samples == 0 or name in refused:
                    continue
                try:
                    frame = runner.contender.frame(samples, seed)
                except NocturneClientError as reason:
                    if not name.startswith(MITSUBA):
                        raise
                    refused[name] = _told(reason)
                    continue
                errors = _errors(frame.y, reference)
                rows.setdefault((name, budget), []).append({**errors, "cpu_s": frame.cpu_s, "n": samples})
    return {name: _way(name, rows, size) for name in runners if name not in refused}


def _errors(y: Channel, reference: Reference) -> dict[str, float]:
    """The reference's own error is subtracted, so the difference may be negative by chance.

    Pixels that are not finite count as if they were right, and their number is reported.

    The bias is that of the image's mean; its error is from the pixels' deviations, which include it, so
    that a bias everywhere can't make itself look small.
    """
    worst = max(WORST, 1.0 / y.size)
    finite = np.isfinite(y)
    y = np.where(finite, y, reference.y)
    deviations = y - reference.y
    error = float(np.sqrt(np.sum(deviations.var(ddof=1) + reference.error**2))) / y.size
    return {
        "relmse": true_relmse(y, reference.y, reference.error),
        "trimmed": trimmed_relmse(y, reference.y, reference.error, worst),
        "z": float(deviations.mean()) / error,
        "not_finite": float(np.mean(~finite)),
    }


def _way(name: str, rows: Mapping[tuple[str, float], list[dict[str, float]]], size: Size) -> Figures:
    points = []
    for budget in size.budgets_cpu_s:
        found = rows.get((name, budget))
        if found:
            middle = {key: significant(statistics.median(row[key] for row in found)) for key in found[0]}
            points.append({"budget_cpu_s": budget, **middle})
    return {"points": points, **time_to_target(points)}


def time_to_target(points: list[dict[str, Any]]) -> Figures:
    """How fast the error falls and, where it does, the CPU seconds to 1 %.

    The exponent of time is -1 for independent samples. `error` is what a line through the points says of the
    longest budget, so that one lucky image does not decide. The time is from the median of error times time
    over budgets, since all noise falls at least as 1 over time. Empty where fewer than two budgets show an
    error.
    """
    good = [point for point in points if point["relmse"] > 0.0 and point["cpu_s"] > 0.0]
    if len({point["cpu_s"] for point in good}) < 2:
        return {}
    times = np.log([point["cpu_s"] for point in good])
    exponent, offset = np.polyfit(times, np.log([point["relmse"] for point in good]), 1)
    longest = math.log(points[-1]["budget_cpu_s"])
    found: Figures = {
        "exponent": round(float(exponent), 2),
        "error": significant(math.exp(offset + exponent * longest)),
    }
    if exponent <= NOT_FALLING:
        product = statistics.median(point["relmse"] * point["cpu_s"] for point in good)
        found["seconds_to_1_percent"] = significant(product / TARGET)
    return found
