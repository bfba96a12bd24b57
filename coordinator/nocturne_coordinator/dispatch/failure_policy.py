"""Whose fault is it: the job's, where three workers failed; the worker's, where three of its jobs went
elsewhere.

Pure. A failure is charged to a worker only when another one then does the job, so a scene that nobody can
trace costs no worker its place. A worker that says farewell, or is only slow, has not failed.

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

_LIES_SECONDS = 86400.0


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


class FailurePolicy:
    """Recent failures, by job and by worker."""

    def __init__(self) -> None:
        self._failures: dict[JobKey, _Failures] = {}
        self._charges: dict[str, set[JobKey]] = {}
        self._deaths_in_a_row: dict[str, set[JobKey]] = {}
        self._lies: dict[str, dict[str, float]] = {}
        """By token, its machines that lied, and when."""
        self._deaths = 0
        self._done = 0

    def failed(
        self, key: JobKey, worker: str, reason: str, live: Collection[str], died: bool = False
    ) -> PoisonedJob | None:
        """A worker failed at a job, or sent what can't be right, or died; the verdict if the job is at fault.

        `live`: who works now, as far as is known. Where these are too few, it is enough that all of them
        failed, and that it was tried as often.
        """
        failures = self._failures.setdefault(key, _Failures())
        failures.reasons[worker] = reason
        failures.times += 1
        if died:
            failures.died.add(worker)
            self._deaths += 1
            self._deaths_in_a_row.setdefault(worker, set()).add(key)
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

    def succeeded(self, key: JobKey, worker: str) -> list[str]:
        """A job was done; gives the workers that have failed at too many jobs that others could do."""
        self._done += 1
        self._deaths_in_a_row.pop(worker, None)
        failures = self._failures.pop(key, None)
        if failures is None:
            return []
        guilty = [
            died
            for died in failures.died - {worker}
            if len(self._deaths_in_a_row.get(died, ())) >= self._deaths_needed()
        ]
        for failed in failures.reasons.keys() - failures.died - {worker}:
            charges = self._charges.setdefault(failed, set())
            charges.add(key)
            if len(charges) >= DISTINCT_JOBS:
                del self._charges[failed]
                guilty.append(failed)
        return guilty

    def lied(self, machine: str, now: float) -> bool:
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
        part = (self._deaths + 1) / (self._deaths + self._done + 2)
        by_chance = math.ceil(math.log(_BY_CHANCE) / math.log(part))
        return min(max(DISTINCT_WORKERS, by_chance), _MAX_DEATHS)

    def forget(self, render_id: str) -> None:
        """The render is not worked on any more."""
        for key in [key for key in self._failures if key.render_id == render_id]:
            del self._failures[key]
