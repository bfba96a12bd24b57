"""Whose fault is it: the job's, where three workers failed; the worker's, where three of its jobs went
elsewhere.

Pure. A failure is charged to a worker only when another one then does the job, so a scene that nobody can
trace costs no worker its place. A worker that says farewell, or is only slow, has not failed. Failures that
were longer ago than an hour are forgotten: everybody fails at times, and a coordinator lives for months.

A process that died with a job in hand may have died of it, or because somebody pulled a plug. Where plugs are
pulled often, three deaths at one job, or three of a worker in a row, come about by chance in a long night; so
the more die, the more it takes.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass, field

from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.enrolment import token_of
from nocturne_coordinator.limits import DISTINCT_JOBS, DISTINCT_LIARS, DISTINCT_WORKERS

_BY_CHANCE = 1e-7
"""How improbable as many deaths must be before they are somebody's fault: a night has some 1e5 jobs."""

_MAX_DEATHS = 8

_CHARGED_SECONDS = 3600.0
"""Failures count for so long: who fails at every twentieth job and takes minutes for each is still found."""

_LIES_SECONDS = 86400.0

_LONG, _SHORT = 3600.0, 60.0
"""Half-lives of the counts of deaths: processes die at a rate, and at times many at once."""

_ENOUGH = 1000.0
"""Ends of jobs within the short one that show the current rate of deaths."""


@dataclass(slots=True)
class _Failures:
    reasons: dict[str, str] = field(default_factory=dict)
    """By worker, the last one."""
    died: set[str] = field(default_factory=set)
    """Those of them that said nothing."""
    times: int = 0


@dataclass(frozen=True, slots=True)
class PoisonedJob:
    """A job that is given up, and why: its tile gets no more samples."""

    reason: str
    workers: tuple[str, ...]


class _Lately:
    """Deaths and done jobs, of which each counts half after so many seconds."""

    def __init__(self, half_life: float) -> None:
        self._half_life = half_life
        self._deaths = 0.0
        self._done = 0.0
        self._at = 0.0

    def count(self, now: float, deaths: int = 0, done: int = 0) -> None:
        """More of them."""
        left = 0.5 ** (max(0.0, now - self._at) / self._half_life)
        self._deaths = left * self._deaths + deaths
        self._done = left * self._done + done
        self._at = max(self._at, now)

    @property
    def ends(self) -> float:
        """Of either kind."""
        return self._deaths + self._done

    @property
    def part(self) -> float:
        """Of all jobs those that end by the death of a process, if nothing else is known one in two."""
        return (self._deaths + 1.0) / (self.ends + 2.0)


class FailurePolicy:
    """Recent failures, by job and by worker."""

    def __init__(self) -> None:
        self._failures: dict[JobKey, _Failures] = {}
        self._charges: dict[str, dict[JobKey, float]] = {}
        """By worker, jobs that others could do, and when they did."""
        self._deaths_in_a_row: dict[str, dict[JobKey, float]] = {}
        self._lies: dict[str, dict[str, float]] = {}
        """By token, its machines that sent a wrong result, and when."""
        self._long, self._short = _Lately(_LONG), _Lately(_SHORT)

    def failed(
        self, key: JobKey, worker: str, reason: str, live: Collection[str], now: float, died: bool = False
    ) -> PoisonedJob | None:
        """A worker failed at a job, or sent an impossible result, or died; the verdict if the job is at
        fault.

        `live`: who works now, as far as is known. Where these are too few, it is enough that all of them
        failed, and that it was tried as often.
        """
        failures = self._failures.setdefault(key, _Failures())
        failures.reasons[worker] = reason
        failures.times += 1
        if died:
            failures.died.add(worker)
            self._count(now, deaths=1)
            self._deaths_in_a_row[worker] = {**self._recent(self._deaths_in_a_row, worker, now), key: now}
        needed = self._deaths_needed() if failures.died else DISTINCT_WORKERS
        owners = {token_of(each) for each in failures.reasons}
        # Who holds a token may give its machines any names: others must have failed, too, if there are any.
        of_all = len(owners) >= needed or {token_of(each) for each in live} <= owners
        # Until statuses are read nobody is known to work, not even who has just failed.
        is_known = died or worker in live
        nobody_else = is_known and failures.times >= DISTINCT_WORKERS and set(live) <= failures.reasons.keys()
        if not nobody_else and not (of_all and len(failures.reasons) >= needed):
            return None
        del self._failures[key]
        return PoisonedJob(reason, tuple(sorted(failures.reasons)))

    def succeeded(self, key: JobKey, worker: str, now: float) -> list[str]:
        """A job was done; gives the workers that have failed at too many jobs that others could do."""
        self._count(now, done=1)
        self._deaths_in_a_row.pop(worker, None)
        failures = self._failures.pop(key, None)
        if failures is None:
            return []
        guilty = [
            died
            for died in failures.died - {worker}
            if len(self._recent(self._deaths_in_a_row, died, now)) >= self._deaths_needed()
        ]
        for failed in failures.reasons.keys() - failures.died - {worker}:
            charges = {**self._recent(self._charges, failed, now), key: now}
            self._charges[failed] = charges
            if len(charges) >= DISTINCT_JOBS:
                del self._charges[failed]
                guilty.append(failed)
        return guilty

    def mismatched(self, machine: str, now: float) -> bool:
        """A machine was found faulty; whether all of its token's are not to be trusted any more."""
        token = token_of(machine)
        if token == machine:
            return False
        before = self._lies.get(token, {})
        lies = {each: at for each, at in before.items() if at > now - _LIES_SECONDS}
        self._lies[token] = {**lies, machine: now}
        return len(self._lies[token]) >= DISTINCT_LIARS

    def _deaths_needed(self) -> int:
        """So many of them that they do not come about by chance, as often as processes die lately."""
        part = self._long.part
        if self._short.ends >= _ENOUGH:
            part = max(part, self._short.part)
        by_chance = math.ceil(math.log(_BY_CHANCE) / math.log(part))
        return min(max(DISTINCT_WORKERS, by_chance), _MAX_DEATHS)

    def _count(self, now: float, deaths: int = 0, done: int = 0) -> None:
        for lately in (self._long, self._short):
            lately.count(now, deaths, done)

    def _recent(
        self, failures: dict[str, dict[JobKey, float]], worker: str, now: float
    ) -> dict[JobKey, float]:
        """A worker's that still count."""
        return {key: at for key, at in failures.get(worker, {}).items() if at > now - _CHARGED_SECONDS}

    def forget(self, render_id: str) -> None:
        """The render is not worked on any more; what its workers failed at counts on."""
        for key in [key for key in self._failures if key.render_id == render_id]:
            del self._failures[key]
