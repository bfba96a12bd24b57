"""Copies of short jobs for owners who wait while all threads are at others' long jobs. Pure.

Owners share the workers fairly, but only when a thread becomes free, and a job may take a minute. So each
worker has a thread more, which takes quick jobs only: copies, each stopped after half a second. The job
itself stays on its stream, and the first result counts, as of the copies of slow jobs (decision 0139).
"""

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

from nocturne_coordinator.dispatch.events import Moment
from nocturne_coordinator.dispatch.job_cost import QUICK_SECONDS
from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.scheduler import JobKey, Published
from nocturne_coordinator.dispatch.state import State

_PATIENCE_SECONDS = 0.5
"""Without a result and without a job at work, before an owner waits."""

_LOST_SECONDS = 10.0
"""After which a copy is taken back: no worker wants it, or its worker dropped it."""

_PAUSE_SECONDS = 5e-5
"""Between two looks, for each job that is looked at, which takes a fiftieth of that."""


class _Copy(NamedTuple):
    entry: bytes
    at: float
    owner: str


class QuickCopies:
    """Knows who waits, and which copies are out."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._held: frozenset[bytes] = frozenset()
        self._copies: dict[JobKey, _Copy] = {}
        self._next_look = 0.0

    def holders_seen(self, holders: Iterable[Holder]) -> None:
        """Entries of jobs that workers have now."""
        self._held = frozenset(holder.entry for holder in holders)

    def take(self, at: Moment) -> list[JobKey]:
        """Jobs and audits to copy now; `published` must follow, unless Redis failed."""
        scheduler, fleet = self._state.scheduler, self._state.fleet
        if at.now < self._next_look or (len(scheduler.owners) < 2 and not fleet.jobs_of_others):
            return []
        self._next_look = at.now + scheduler.outstanding * _PAUSE_SECONDS
        on_stream = [*scheduler.out.items(), *self._state.auditor.out.items()]
        out = sum(len(published.entries) for _, published in on_stream)
        if out + fleet.jobs_of_others <= fleet.threads:
            return []
        at_work = self._held - {copy.entry for copy in self._copies.values()}
        jobs: dict[str, list[tuple[float, JobKey]]] = {}
        served = set()
        for key, published in on_stream:
            owner = scheduler.owner_of(key.render_id)
            if not at_work.isdisjoint(published.entries):
                served.add(owner)
            elif self._is_short(key):
                jobs.setdefault(owner, []).append((published.at, key))
        waiting = {
            owner: sorted(found)
            for owner, found in jobs.items()
            if owner not in served and scheduler.served(owner) + _PATIENCE_SECONDS <= at.now
        }
        has = Counter(copy.owner for copy in self._copies.values())
        each = max(1, fleet.workers_at_work // max(1, len(waiting)))
        return [key for owner, found in waiting.items() for _, key in found[: max(0, each - has[owner])]]

    def published(self, keys: list[JobKey], entries: list[bytes], at: Moment) -> None:
        """These copies are out."""
        for key, entry in zip(keys, entries, strict=True):
            if published := self._published(key):
                published.entries.append(entry)
            self._copies[key] = _Copy(entry, at.now, self._state.scheduler.owner_of(key.render_id))

    def forget(self, at: Moment) -> list[bytes]:
        """Forgets copies whose jobs are done, which took too long, and that nobody took; gives entries to
        delete."""
        gone = []
        for key, copy in list(self._copies.items()):
            published = self._published(key)
            if published is None or copy.entry not in published.entries:
                del self._copies[key]
            elif key.render_id in self._state.not_quick or copy.at < at.now - _LOST_SECONDS:
                published.entries.remove(copy.entry)
                gone.append(copy.entry)
                del self._copies[key]
        self._state.not_quick &= self._state.renders.keys()
        return gone

    def _is_short(self, key: JobKey) -> bool:
        """Whether a copy of a job may help."""
        if key in self._copies or key.render_id in self._state.not_quick:
            return False
        return self._state.scheduler.cost_of(key) <= QUICK_SECONDS

    def _published(self, key: JobKey) -> Published | None:
        return self._state.scheduler.out.get(key) or self._state.auditor.published_of(key)
