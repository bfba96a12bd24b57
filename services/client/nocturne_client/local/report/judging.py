"""Checks of a requirement, each with the probability that it holds."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from nocturne_scene.photometry.requirements import Certainty, Requirement, certainty, together

from nocturne_client.contract import Glare
from nocturne_client.local.report.contents import Check, between, with_half
from nocturne_client.local.report.grid_values import GridValues


def checks_of(
    wanted: Requirement,
    task: GridValues,
    grids: Sequence[GridValues],
    glares: Sequence[tuple[str, Glare]],
    annual: Mapping[str, Any] | None,
) -> list[Check]:
    """One for each limit."""
    found, measured = list[Check](), task.measured
    if wanted.em is not None:
        sure = certainty(measured.mean, _known(task, measured.mean_error), wanted.em)
        told = f"{with_half(measured.mean, measured.mean_error)} lx"
        found.append(Check(f"Em, {task.part.name}", f"≥ {wanted.em:g} lx", told, sure))
    if wanted.u0 is not None:
        u0 = task.u0
        told = "-" if u0 is None else between(u0.value, u0.low, u0.high, 2)
        sure = task.u0_is_at_least(wanted.u0)
        found.append(Check(f"U0, {task.part.name}", f"≥ {wanted.u0:g}", told, sure))
    if wanted.ugr is not None:
        found += _glare_checks(wanted.ugr, glares)
    if wanted.ra is not None:
        found.append(_colour_check(wanted.ra, task))
    if wanted.ez is not None:
        cylinders = [each for each in grids if each.part.measures == "cylindrical"]
        for each in cylinders:
            mean, error = each.measured.mean, each.measured.mean_error
            told, sure = f"{with_half(mean, error)} lx", certainty(mean, _known(each, error), wanted.ez)
            found.append(Check(f"Ez, {each.part.name}", f"≥ {wanted.ez:g} lx", told, sure))
        if not cylinders:
            found.append(Check("Ez", f"≥ {wanted.ez:g} lx", "-", None))
    if wanted.df is not None:
        factor = task.daylight
        told = "-" if factor is None else f"{with_half(factor.mean, factor.mean_error, 3)} %"
        sure_of = None if factor is None else certainty(factor.mean, factor.mean_error, wanted.df)
        found.append(Check("daylight factor, mean", f"≥ {wanted.df:g} %", told, sure_of))
    if wanted.sda is not None:
        found.append(_annual_check(wanted.sda, annual))
    return found


def judged(checks: list[Check], *, is_trusted: bool) -> tuple[list[Check], Certainty | None]:
    """With the certainty of all that were measured; where errors are not to be trusted, nothing is sure."""
    if not is_trusted:
        checks = [
            Check(each.what, each.limit, each.found, None if each.certainty is None else Certainty(0.0, 0.0))
            for each in checks
        ]
    measured = [each.certainty for each in checks if each.certainty is not None]
    return checks, together(measured) if measured else None


def _known(grid: GridValues, error: float) -> float | None:
    """An error of meters of which one has seen nothing is not known."""
    return None if grid.unseen else error


def _glare_checks(limit: float, glares: Sequence[tuple[str, Glare]]) -> list[Check]:
    told = f"≤ {limit:g}"
    if not glares:
        return [Check("UGR", told, "-", None)]
    found = []
    for name, glare in glares:
        if glare.ugr is None:
            found.append(Check(f"UGR, {name}", told, "not known", None))
            continue
        sure = certainty(glare.ugr, glare.ugr_error, limit, at_most=True)
        found.append(Check(f"UGR, {name}", told, with_half(glare.ugr, glare.ugr_error, 3), sure))
    return found


def _colour_check(limit: float, task: GridValues) -> Check:
    ra = next((each for each in task.colour if each.name == "Ra"), None)
    if ra is None:
        return Check("Ra", f"≥ {limit:g}", "-", None)
    sure = certainty(ra.value, ra.error, limit)
    return Check(f"Ra, {task.part.name}", f"≥ {limit:g}", with_half(ra.value, ra.error, 3), sure)


def _annual_check(limit: float, annual: Mapping[str, Any] | None) -> Check:
    """By the probabilities of the points, each of which passes by itself."""
    if annual is None:
        return Check("sDA", f"≥ {limit:g} %", "-", None)
    share = annual["sDA"]
    told = f"{100 * share['value']:.1f} % ({100 * share['low']:.1f} to {100 * share['high']:.1f})"
    passes = share.get("probabilities")
    if passes is None:
        said = {each["says"]: each["probability"] for each in annual.get("verdicts", ())}
        known = said.get(f"sDA >= {limit / 100:.0%}")
        sure = None if known is None else Certainty(known, 1.0 - known)
        return Check("sDA", f"≥ {limit:g} %", told, sure)
    numbers = np.ones(1)
    for each in passes:
        numbers = np.convolve(numbers, [1.0 - each, each])
    needed = int(np.ceil(limit / 100.0 * len(passes) - 1e-9))
    holds = float(np.clip(numbers[needed:].sum(), 0.0, 1.0))
    return Check("sDA", f"≥ {limit:g} %", told, Certainty(holds, 1.0 - holds))
