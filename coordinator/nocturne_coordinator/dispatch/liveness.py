"""Which workers died with a job in hand. Pure.

A worker's status in Redis is renewed every two seconds and holds for ten. One that stops in order deletes it;
where it was about to run out, or where a new process has the old one's name, the process has died. Only that
is the job's fault, perhaps: a worker that is slow, out of reach for a while, or told to stop has done nothing
wrong.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from nocturne_coordinator.dispatch.scheduler import JobKey

_RENEWED_MS = 6000
"""A status that had less left when it was last seen was not renewed any more; of ten seconds, renewed every
two."""


@dataclass(frozen=True, slots=True)
class Sign:
    """The last observed state of a worker's process."""

    started: float
    left_ms: int


@dataclass(frozen=True, slots=True)
class Holder:
    """A job that a worker has: the entry, and who."""

    entry: bytes
    worker: str


@dataclass(slots=True)
class _Held:
    key: JobKey
    workers: dict[str, float] = field(default_factory=dict)
    """Who had it since it was put on the stream, and when that process started: the lease of a dead worker's
    job may run out before its status does."""


class Liveness:
    """Remembers who had which job, and finds out what became of them."""

    def __init__(self) -> None:
        self._signs: dict[str, Sign] = {}
        self._held: dict[bytes, _Held] = {}

    @property
    def at_work(self) -> list[tuple[JobKey, str]]:
        """Who has which job, at the last look."""
        return [(held.key, worker) for held in self._held.values() for worker in held.workers]

    def look(
        self, signs: Mapping[str, Sign], holders: list[Holder], keys: Mapping[bytes, JobKey]
    ) -> list[tuple[JobKey, str]]:
        """Takes observations, about once a second; gives jobs and the workers that died with them.

        `keys`: the jobs by their entries. An entry that was taken off the stream is remembered while somebody
        has it.
        """
        died = {
            worker: before.started
            for worker, before in self._signs.items()
            if _has_died(before, signs.get(worker))
        }
        lost = []
        for held in self._held.values():
            for worker in [each for each in held.workers if died.get(each) == held.workers[each]]:
                del held.workers[worker]
                lost.append((held.key, worker))
        self._signs = dict(signs)
        before, self._held = self._held, {}
        for holder in holders:
            if holder.entry in before:
                self._held[holder.entry] = before[holder.entry]
            elif holder.entry in keys:
                self._held[holder.entry] = _Held(keys[holder.entry])
            else:
                continue
            if holder.worker in signs:
                self._held[holder.entry].workers[holder.worker] = signs[holder.worker].started
        return lost


def _has_died(before: Sign, now: Sign | None) -> bool:
    if now is None:
        return before.left_ms < _RENEWED_MS
    return now.started != before.started
