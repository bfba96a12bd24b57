"""Whose fault is it: the job's, where three workers failed; the worker's, where three of its jobs went
elsewhere.

Pure. A failure is charged to a worker only when another one then does the job, so a scene that nobody can
trace costs no worker its place. A worker that says farewell, or is only slow, has not failed.
"""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, field

from .limits import DISTINCT_JOBS, DISTINCT_WORKERS
from .schedule import JobKey


@dataclass(slots=True)
class _Failures:
    reasons: dict[str, str] = field(default_factory=dict)
    """By worker, the last one."""
    times: int = 0


@dataclass(frozen=True, slots=True)
class Verdict:
    """A job that is to be set aside."""

    reason: str
    workers: tuple[str, ...]


class Faults:
    """What went wrong lately, by job and by worker."""

    def __init__(self) -> None:
        self._failures: dict[JobKey, _Failures] = {}
        self._charges: dict[str, set[JobKey]] = {}
        self.by_worker: Counter[str] = Counter()
        """Failures and refused results of each worker, for people to see."""

    def failed(self, key: JobKey, worker: str, reason: str, live: Collection[str]) -> Verdict | None:
        """A worker failed at a job, or sent what can't be right; the verdict if the job is at fault.

        `live`: who works now. Where these are fewer than three, it is enough that all of them failed, and
        that it was tried as often.
        """
        self.by_worker[worker] += 1
        failures = self._failures.setdefault(key, _Failures())
        failures.reasons[worker] = reason
        failures.times += 1
        nobody_else = failures.times >= DISTINCT_WORKERS and set(live) <= failures.reasons.keys()
        if len(failures.reasons) < DISTINCT_WORKERS and not nobody_else:
            return None
        del self._failures[key]
        return Verdict(reason, tuple(sorted(failures.reasons)))

    def succeeded(self, key: JobKey, worker: str) -> list[str]:
        """A job was done; gives the workers that have failed at too many jobs that others could do."""
        failures = self._failures.pop(key, None)
        if failures is None:
            return []
        guilty = []
        for failed in failures.reasons.keys() - {worker}:
            charges = self._charges.setdefault(failed, set())
            charges.add(key)
            if len(charges) >= DISTINCT_JOBS:
                del self._charges[failed]
                guilty.append(failed)
        return guilty

    def forget(self, render_id: str) -> None:
        """The render is not worked on any more."""
        for key in [key for key in self._failures if key.render_id == render_id]:
            del self._failures[key]
