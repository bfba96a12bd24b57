"""Which jobs are put on the stream of quick copies as well (docs/decisions/0185). Pure.

Jobs may take a minute, and another owner's small render would wait behind them. Each worker has two further
threads that take quick copies and nothing else. A quick copy is a job like any other; the first result of a
range counts, wherever it was traced.
"""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.quick_entries import is_quick
from nocturne_coordinator.dispatch.scheduler import JobKey, Published
from nocturne_coordinator.dispatch.state import State
from nocturne_coordinator.limits import MAX_QUICK_COPIES, QUICK_CPU_SECONDS

WAIT_SECONDS = 0.3
"""That a job is out before it gets a quick copy: where a thread is about to be free, none is needed."""

LOOK_SECONDS = 0.1
"""Between two looks for jobs that need one."""

_PLACES_OF_WORKER = 2
"""So that with one worker, too, no owner has all."""

_PART_OF_OWNER = 4
"""One owner has one of so many, and at least one."""

_PREDICTED = 0.5
"""Part of the time after which it is stopped, that a job with a quick copy should take at most."""


class QuickCopies:
    """Jobs of small renders whose owners have less than their part of the threads, and wait."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._held: list[JobKey] = []
        self._next_look = 0.0
        self._last: dict[str, float] = {}
        """By owner, when the last one was made."""
        self.made = 0
        """Since the start."""

    def seen(self, holders: Sequence[Holder], keys: Mapping[bytes, JobKey]) -> None:
        """Who works on what; `keys`: the jobs by their entries."""
        self._held = [
            keys[holder.entry] for holder in holders if holder.entry in keys and not is_quick(holder.entry)
        ]

    def renders(self, now: float) -> list[str]:
        """Renders whose jobs may have quick copies now. None at most times: few are small, and where a
        thread is free it takes the job itself."""
        state = self._state
        if now < self._next_look:
            return []
        self._next_look = now + LOOK_SECONDS
        small = [render for render in state.renders.values() if render.gets_quick_copies and render.is_small]
        if not small or self._is_a_thread_free():
            return []
        refused = {owner for owner, until in state.no_quick_copies.items() if until > now}
        state.no_quick_copies = {owner: state.no_quick_copies[owner] for owner in refused}
        part = state.fleet.threads / len({render.row.owner for render in state.renders.values()})
        held = self._held_by_owner()
        return [
            render.id for render in small if render.row.owner not in refused and held[render.row.owner] < part
        ]

    def rooms_ahead(
        self, renders: Collection[str], taken: Collection[JobKey]
    ) -> Iterator[tuple[set[str], int]]:
        """Of each owner of these renders its renders, and how many jobs of them may be published though the
        window is full, besides those that are `taken` now: one owner's do not stand in for another's."""
        of_owner: dict[str, set[str]] = {}
        for render in renders:
            of_owner.setdefault(self._state.renders[render].row.owner, set()).add(render)
        keys = [key for key, _ in self._state.scheduler.out(renders)]
        out = Counter(
            self._owner(key) for key in (*keys, *(key for key in taken if key.render_id in renders))
        )
        left = MAX_QUICK_COPIES - out.total()
        for owner in sorted(of_owner, key=lambda owner: self._last.get(owner, 0.0)):
            room = min(self._most_of_owner - out[owner], left)
            if room > 0:
                left -= room
                yield of_owner[owner], room

    def wanted(self, renders: Collection[str], now: float) -> list[JobKey]:
        """Jobs and audits of these renders that get a quick copy now, of each owner a few, the owner first
        who has waited longest."""
        if not renders:
            return []
        state = self._state
        out = [*state.scheduler.out(state.renders), *state.auditor.out(state.renders)]
        by_owner = Counter(self._owner(key) for key, published in out if published.has_quick)
        left = self._room - by_owner.total()
        most = self._most_of_owner
        waiting = [each for each in out if each[0].render_id in renders and self._needs_one(*each, now)]
        found: list[JobKey] = []
        for key, _ in sorted(waiting, key=self._turn):
            owner = self._owner(key)
            if left > 0 and by_owner[owner] < most:
                by_owner[owner] += 1
                left -= 1
                found.append(key)
        return found

    def copied(self, key: JobKey, entry: bytes, now: float) -> None:
        """One is on the stream."""
        state = self._state
        of = state.auditor if state.auditor.is_out(key) else state.scheduler
        of.copied(key, entry)
        at_work = {render.row.owner for render in state.renders.values()}
        self._last = {owner: at for owner, at in self._last.items() if owner in at_work}
        self._last[self._owner(key)] = now
        self.made += 1

    def _turn(self, waiting: tuple[JobKey, Published]) -> tuple[float, float]:
        key, published = waiting
        return self._last.get(self._owner(key), 0.0), published.at

    @property
    def _most_of_owner(self) -> int:
        return max(1, self._room // _PART_OF_OWNER)

    @property
    def _room(self) -> int:
        return min(_PLACES_OF_WORKER * self._state.fleet.takers, MAX_QUICK_COPIES)

    def _is_a_thread_free(self) -> bool:
        state = self._state
        out = state.scheduler.outstanding + state.auditor.outstanding + state.fleet.jobs_of_others
        return out < state.fleet.threads

    def _held_by_owner(self) -> Counter[str]:
        """Threads, without those that have done their job since it was seen."""
        out = set(self._state.scheduler.entries().values()) | set(self._state.auditor.entries().values())
        return Counter(self._owner(key) for key in self._held if key in out)

    def _owner(self, key: JobKey) -> str:
        return self._state.renders[key.render_id].row.owner

    def _needs_one(self, key: JobKey, published: Published, now: float) -> bool:
        cost = self._state.renders[key.render_id].cost(key.tile_index, key.range_index)
        has_waited = published.at <= now - WAIT_SECONDS
        return has_waited and not published.has_quick and cost <= _PREDICTED * QUICK_CPU_SECONDS
