"""The matrix as JSON and as a page."""

import json
from typing import Any

from bench.rare_light import AIM
from bench.ways import WAYS
from tests.stability.cases import GROUPS
from tests.stability.verdict import NOISY, Verdict, Word

Matrix = dict[str, dict[str, Verdict]]
"""Verdicts by case and method."""

_SUMMARY = """# Stability: scenes that break methods

<!-- Made by `make stability`; edit tests/stability/page.py, not this page. -->

Is the default right in extreme scenes, and which method is not? {count} small scenes with a known answer,
each with one extreme feature, are traced by every method that applies. The {cells} results: {summary}.

- *Right*: the mean over the film is the truth, within chance. *Noisy*: no fault is seen, but the standard
  error is above {noisy:g} % or tails are heavy. *Biased*: more samples do not help. *Uneven*: pixels that
  should be alike differ. *Found nothing*: no photon met light. *Refused*: an error before anything is traced.
- *mixture* and *split* multiply a weight at every vertex. After dozens of vertices few photons carry the sum:
  their means are right in theory, and hardly any image shows it.

Every case with its truth and each method's result: [torture cases](../../tests/stability/README.md). Methods:

{methods}

## By kind of scene

Results that are right, of all that apply.

{groups}

## Where the default is not right

{wrong}
"""

_HEAD = """# Torture cases

<!-- Made by `make stability`; edit tests/stability, not this page. -->

Small scenes with a known answer, each with one extreme feature, are traced by every applicable method
([summary](../../docs/explanation/stability.md)). A cell gives the result:

- **right**: the mean over the film is the truth, within chance and what the case allows; behind ± is the
  standard error, which says how small a fault could have been seen.
- **noisy**: no fault is seen, but the standard error is above {noisy:g} %, or single pixels carry the sum, or
  a deviation became smaller with more samples (a heavy tail: error bars are not to be trusted).
- **off by** so much: the measured value is not the truth, and more samples do not help. *Warned of*:
  compiling the scene says so. Every such cell of the default method has this warning.
- **uneven**: pixels that should be alike differ by far more than their error bars.
- **found nothing**: no photon met any light.
- **refused**: an error, before anything is traced. For the last group this is the only right answer.
- **failed**: a crash, photons that are not finite, or more than a minute of the processor.

*mixture* and *split* multiply a weight at every vertex. After dozens of vertices few photons carry the whole
sum: their means are right in theory, and "off by" says that hardly any image will show it.

The bound on a deviation is that of Student's t for all cells together: false alarms, 1 in 100 pages.

{methods}

{count} cases, {cells} cells: {summary}.
"""


def as_json(matrix: Matrix, machine: str) -> str:
    """For programs: word, deviation, standard error and CPU seconds of each cell."""
    cells = {
        case: {
            method: _plain(verdict)
            for method, verdict in row.items()
            if verdict.word is not Word.NOT_APPLICABLE
        }
        for case, row in matrix.items()
    }
    lines = ",\n".join(f"  {json.dumps(case)}: {json.dumps(row)}" for case, row in cells.items())
    return f'{{"machine": {json.dumps(machine)}, "cases": {{\n{lines}\n}}}}\n'


def from_json(text: str) -> Matrix:
    """The matrix that `as_json` wrote."""
    return {
        case: {
            method: Verdict(
                Word(cell["verdict"]),
                cell.get("off"),
                cell.get("error"),
                cell.get("said", ""),
                cell["cpu_s"],
                cell.get("warned", False),
            )
            for method, cell in row.items()
        }
        for case, row in json.loads(text)["cases"].items()
    }


def _plain(verdict: Verdict) -> dict[str, Any]:
    found: dict[str, Any] = {"verdict": verdict.word.value}
    if verdict.off is not None:
        found["off"] = float(f"{verdict.off:.3g}")
    if verdict.error is not None:
        found["error"] = float(f"{verdict.error:.3g}")
    if verdict.said:
        found["said"] = verdict.said
    if verdict.warned:
        found["warned"] = True
    return found | {"cpu_s": round(verdict.cpu_s, 2)}


_RARE = """
## Rare light

Forty scenes have small bright lights and surfaces that focus their light ([searched
for](../../docs/explanation/units-and-errors.md#light-that-may-be-missing)), each traced by the default
alone. A cell shows how many squares
of 8 x 8 pixels, of {images} images, hold the truth in their 95 % interval; "of 90 %" if the images name the
others as not to be trusted. The truth is a longer image by photons from both directions, those from the
luminaires aimed at all surfaces that focus their light, {samples:,} samples of each pixel. **Bold**: fewer
than {aim:g} %. *Warned*: the images say how much of the mean may be missing. Made by `python -m bench
rare_light`.

| scene | {counts} |
| --- |{rules}
"""


def _rare_light(figures: dict[str, Any]) -> str:
    scenes = figures["scenes"]
    counts = sorted(next(iter(scenes.values())), key=int)
    lines = [
        _RARE.format(
            samples=figures["truth_samples"],
            images=figures.get("images", 1),
            aim=100 * AIM,
            counts=" | ".join(f"{count} samples" for count in counts),
            rules=" --- |" * len(counts),
        ).rstrip()
    ]
    for name, found in scenes.items():
        cells = []
        for count in counts:
            trusted, held = found[count]["trusted"], found[count]["trusted_held"]
            cells.append(
                (f"**{held:.0%}**" if held < AIM else f"{held:.0%}")
                + (f" of {trusted:.0%}" if trusted < 1.0 else "")
                + (", warned" if found[count]["told"] else "")
            )
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def page(matrix: Matrix, rare_light: dict[str, Any] | None = None) -> str:
    """The matrix for readers. `rare_light`: the figures of the bench of that name."""
    cells = [verdict for row in matrix.values() for verdict in row.values()]
    done = [verdict for verdict in cells if verdict.word is not Word.NOT_APPLICABLE]
    counts = {word: sum(verdict.word is word for verdict in done) for word in Word}
    summary = ", ".join(f"{count} {word.value}" for word, count in counts.items() if count)
    methods = "\n".join(f"- *{method.name}*: {method.about}" for method in WAYS)
    text = _HEAD.format(
        noisy=100 * NOISY, methods=methods, count=len(matrix), cells=len(done), summary=summary
    )
    lines = [text]
    for group, cases in GROUPS.items():
        here = [case for case in cases if case.name in matrix]
        lines += [f"\n## {group}\n"]
        names = [m.name for m in WAYS if any(_applies(matrix[case.name], m.name) for case in here)]
        lines += [f"| case | {' | '.join(names)} |", f"| --- |{' --- |' * len(names)}"]
        for case in here:
            row = matrix[case.name]
            told = " | ".join(_cell(row[name], case.truth) if name in row else "" for name in names)
            lines.append(f"| {case.name} | {told} |")
        lines.append("")
        for case in here:
            told = f"{case.stress}. Truth: {case.source}.{_advice(matrix[case.name], case.remedy)}"
            lines.append(f"- **{case.name}**: {told}")
    return "\n".join(lines) + "\n" + (_rare_light(rare_light) if rare_light else "")


def summary_page(matrix: Matrix) -> str:
    """The matrix in one screen: counts by group and method, and what the default is not right at."""
    done = [v for row in matrix.values() for v in row.values() if v.word is not Word.NOT_APPLICABLE]
    counts = {word: sum(verdict.word is word for verdict in done) for word in Word}
    names = [each.name for each in WAYS]
    groups = [f"| | {' | '.join(names)} |", f"| --- |{' --- |' * len(names)}"]
    groups += [
        f"| {group} | {' | '.join(_shares(matrix, group, name) for name in names)} |" for group in GROUPS
    ]
    wrong = []
    for case in (case for cases in GROUPS.values() for case in cases if case.name in matrix):
        verdict = matrix[case.name][names[0]]
        if verdict.word not in _FINE:
            told = _cell(verdict, case.truth).replace("**", "")
            remedy = f" Remedy: {case.remedy}." if case.remedy else ""
            wrong.append(f"- **{case.name}**: {told}. {case.stress}.{remedy}")
    return _SUMMARY.format(
        count=len(matrix),
        cells=len(done),
        summary=", ".join(f"{count} {word.value}" for word, count in counts.items() if count),
        noisy=100 * NOISY,
        methods="\n".join(f"- *{method.name}*: {method.about}" for method in WAYS),
        groups="\n".join(groups),
        wrong="\n".join(wrong),
    )


def _shares(matrix: Matrix, group: str, method: str) -> str:
    """How many cases of a group a method is right at, of how many; refusals count where they are right."""
    rows = [matrix[case.name] for case in GROUPS[group] if case.name in matrix]
    words = [row[method].word for row in rows if _applies(row, method)]
    right = sum(word in {Word.RIGHT, Word.REFUSED} for word in words)
    return f"{right} of {len(words)}" if words else ""


def _applies(row: dict[str, Verdict], method: str) -> bool:
    return method in row and row[method].word is not Word.NOT_APPLICABLE


def _cell(verdict: Verdict, truth: float | None) -> str:
    error = f" ± {100 * (verdict.error or 0.0):.1g} %"
    match verdict.word:
        case Word.RIGHT:
            return "right" + (error if verdict.error else "")
        case Word.NOISY:
            return ("**noisy**, heavy tail" if verdict.said else "**noisy**") + error
        case Word.BIASED if truth == 0.0:
            return f"**{verdict.off:.2g} instead of 0**"
        case Word.BIASED:
            told = ", warned of" if verdict.warned else ""
            return f"**off by {100 * (verdict.off or 0.0):+.2g} %**{error}{told}"
        case Word.NOT_APPLICABLE:
            return ""
        case Word.REFUSED:
            return "refused"
        case _:
            return f"**{verdict.word.value}**"


def _advice(row: dict[str, Verdict], remedy: str) -> str:
    """What to do about cells that are not right."""
    wrong = [name for name, verdict in row.items() if verdict.word not in _FINE]
    if not wrong:
        return ""
    biases = [abs(v.off or 0.0) for v in row.values() if v.word is Word.BIASED]
    # A method that would not have shown the others' fault is no remedy.
    enough = min(biases) / _SHARP if biases else 1.0
    right = [name for name, v in row.items() if v.word is Word.RIGHT and (v.error or 0.0) <= enough]
    use = (
        f" Instead of {', '.join(wrong)}: {', '.join(right)}."
        if right
        else " No method is known to be right."
    )
    return use + (f" Remedy: {remedy}." if remedy else "")


_SHARP = 5.0
"""Times smaller than a bias that a standard error must be to say that it is not there."""

_FINE = (Word.RIGHT, Word.NOT_APPLICABLE, Word.REFUSED)
