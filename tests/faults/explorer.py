"""All states of one tile of two or three ranges, walked breadth first: coordinators, workers, streams.

Long: a step of any kind changes jobs, results and memories together.

The coordinators are the real render, scheduler and result handler; what each of them does in a state is
worked out once and remembered (`cores.py`), so that a step of the whole costs microseconds. The rest is
abstract, and allows more than there is: entries of both streams are taken in any order, any worker may take
over any job at any time (its lease ran out), any coordinator the render (so did that). Workers are alike, and
so are coordinators: states that differ by who is who are one state.
"""

from array import array
from collections import deque
from collections.abc import Iterable, Iterator
from itertools import product
from typing import NamedTuple

import numpy as np

from tests.faults.cores import Cores, Reaction, WentWrong, Work

# An entry of the job stream, in bits: it is on the stream; each of two coordinators takes it for published by
# itself; it is a quick copy; how many workers have it.
_ON_STREAM = 1
_KNOWN = (2, 4)
_QUICK = 8
_WORKER = 16

# An entry of the result stream, a digit to the base 3 for each of two coordinators; a word beyond them says
# that a quick copy was stopped.
_UNREAD, _HELD, _SETTLED = range(3)
_DIGIT = (1, 3)
_STOPPED = 9

CORE, STALE = range(2)


Entries = tuple[tuple[int, ...], ...]
"""For each range the entries of a stream, sorted by content: their identities do not matter."""


class State(NamedTuple):
    """Everything, in small numbers."""

    core: int
    """Number of the memory of the coordinator that has the render by its lease; -1: none has."""
    stale: int
    """Of one that had it and does not know better; -1: there is none."""
    committed: int
    jobs: Entries
    results: Entries
    idle: int
    """Workers without a job."""
    crashes: int
    """That may still happen."""
    takeovers: int
    copies: int
    """Quick copies that may still be made."""


class Explorer:
    """Walks through all states that can be reached."""

    def __init__(
        self,
        ranges: int,
        workers: int,
        crashes: int,
        takeovers: int = 0,
        fenced: bool = True,
        copies: int = 0,
    ) -> None:
        """`takeovers`: how often a lease may run out under a living coordinator. Without `fenced`, nobody
        looks at the fence."""
        self.ranges = ranges
        self.cores = Cores(Work(ranges))
        self._fenced = fenced
        self._shared = takeovers > 0
        nothing: Entries = ((),) * ranges
        first = self.cores.start(0, ()).number
        self.first = State(first, -1, 0, nothing, nothing, workers, crashes, takeovers, copies)

    def walk(self) -> int:
        """The number of states. WentWrong if one is wrong, or can't come to the end any more."""
        seen = {self.first: 0}
        edges_from, edges_to, finished = array("I"), array("I"), []
        waiting = deque([self.first])
        while waiting:
            state = waiting.popleft()
            number = seen[state]
            if state.committed == self.ranges:
                finished.append(number)
                continue
            for untidy in self._steps(state):
                after = self._tidy(untidy)
                if after.committed < state.committed:
                    raise WentWrong(f"{state} is followed by {after}, which has less committed")
                known = seen.get(after)
                if known is None:
                    known = seen[after] = len(seen)
                    waiting.append(after)
                edges_from.append(number)
                edges_to.append(known)
        dead_ends = len(seen) - _count_before(finished, edges_from, edges_to, len(seen))
        if dead_ends:
            raise WentWrong(f"from {dead_ends} states the render can't be finished")
        return len(seen)

    def _tidy(self, state: State) -> State:
        """Without what changes nothing any more: jobs and results of ranges that everybody has behind him. A
        worker that does such a job is as good as idle."""
        behind = state.committed
        if state.stale >= 0:
            behind = min(behind, self.cores.all[state.stale].merged)
        if not any(state.jobs[:behind]) and not any(state.results[:behind]):
            return state
        workers = sum(entry // _WORKER for entries in state.jobs[:behind] for entry in entries)
        nothing = ((),) * behind
        return state._replace(
            jobs=(*nothing, *state.jobs[behind:]),
            results=(*nothing, *state.results[behind:]),
            idle=state.idle + workers,
        )

    def _steps(self, state: State) -> Iterator[State]:
        """Every state that can come next."""
        if state.core >= 0:
            yield from self._coordinate(state, CORE)
        if state.stale >= 0:
            yield from self._coordinate(state, STALE)
            # It looks at the folder.
            yield _without(state, STALE)
        if state.stale < 0 and (state.core < 0 or state.takeovers):
            yield from self._take_over(state)
        yield from _work(state)
        if state.crashes:
            yield from self._crash(state._replace(crashes=state.crashes - 1))

    # --- coordinators ---

    def _coordinate(self, state: State, role: int) -> Iterator[State]:
        number = _number_of(state, role)
        core = self.cores.all[number]
        reaction = self.cores.publish(number)
        if reaction.published:
            yield self._reacted(state, role, reaction)
        for index in sorted(core.out - core.quick) if state.copies else ():
            copied = self.cores.copy(number, index)
            yield self._reacted(state._replace(copies=state.copies - 1), role, copied)
        for index in range(self.ranges):
            for entry in sorted(set(state.results[index])):
                if _digit(entry, role) == _UNREAD:
                    yield self._receive(state, role, index, entry)
        if core.merged > core.saved:
            yield self._commit(state, role)
        elif any(_digit(entry, role) == _SETTLED for entries in state.results for entry in entries):
            if role == STALE and self._fenced:
                # It looks before it deletes.
                return
            left = (tuple(e for e in entries if _digit(e, role) != _SETTLED) for entries in state.results)
            yield state._replace(results=tuple(left))

    def _receive(self, state: State, role: int, index: int, entry: int) -> State:
        take = self.cores.stopped if entry >= _STOPPED else self.cores.receive
        reaction = take(_number_of(state, role), index)
        results = list(state.results)
        held = entry + _HELD * _DIGIT[role]
        results[index] = _changed(results[index], entry, held)
        for settled in reaction.to_acknowledge:
            # The entry itself, or the one of its range that was waiting.
            found = held if settled == index else _find(results[settled], role, _HELD)
            if found is not None:
                after = found + (_SETTLED - _HELD) * _DIGIT[role]
                results[settled] = _changed(results[settled], found, after)
        return self._reacted(state._replace(results=tuple(results)), role, reaction)

    def _commit(self, state: State, role: int) -> State:
        if role == STALE and self._fenced:
            # Refused; it drops the render.
            return _without(state, STALE)
        number = _number_of(state, role)
        after = _put(state, role, self.cores.saved(number))
        return after._replace(committed=self.cores.all[number].merged)

    def _reacted(self, state: State, role: int, reaction: Reaction) -> State:
        """The state with the core's published and withdrawn jobs, and without those that it has forgotten."""
        core = self.cores.all[reaction.number]
        jobs = []
        for index, entries in enumerate(state.jobs):
            after = []
            for entry in entries:
                known = entry & _KNOWN[role]
                if known and index in (reaction.withdrawn_quick if entry & _QUICK else reaction.withdrawn):
                    entry &= ~_ON_STREAM
                out = core.quick if entry & _QUICK else core.out
                if known and (index not in out or index in reaction.published):
                    entry &= ~known
                after.append(entry)
            if index in reaction.published:
                after.append(_ON_STREAM | _KNOWN[role])
            if index in reaction.copied:
                after.append(_ON_STREAM | _KNOWN[role] | _QUICK)
            jobs.append(_ordered(after))
        return _put(state, role, reaction.number)._replace(jobs=tuple(jobs))

    def _take_over(self, state: State) -> Iterator[State]:
        """By one that gives signs of life, from one that does not, or is no more."""
        jobs = [[_roles_moved(entry) for entry in entries] for entries in state.jobs]
        results = tuple(
            tuple(
                sorted(
                    entry // _STOPPED * _STOPPED + _digit(entry, CORE) * _DIGIT[STALE] for entry in entries
                )
            )
            for entries in state.results
        )
        found = [sorted({e for e in entries if e & _ON_STREAM and not e & _QUICK}) for entries in jobs]
        indices = tuple(index for index in range(self.ranges) if found[index])
        start = self.cores.start(state.committed, indices)
        # Of several entries for a range it takes the first on the stream, which may be any.
        for chosen in product(*(found[index] for index in indices)):
            adopted = dict(zip(indices, chosen, strict=True))
            after = tuple(
                _adopted(entries, adopted.get(index), index not in start.withdrawn)
                for index, entries in enumerate(jobs)
            )
            yield state._replace(
                core=start.number,
                stale=state.core,
                jobs=after,
                results=results,
                takeovers=state.takeovers - (state.core >= 0),
            )

    # --- crashes ---

    def _crash(self, state: State) -> Iterator[State]:
        """Of a worker, a coordinator, or Redis with all that is in it."""
        for index, entries in enumerate(state.jobs):
            for entry in sorted(set(entries)):
                if entry >= _WORKER:
                    jobs = _entry_changed(state.jobs, index, entry, entry - _WORKER)
                    yield state._replace(jobs=jobs, idle=state.idle + 1)
        if state.core >= 0:
            gone = _without(state, CORE)
            # Alone, it is started again; of two, the other one takes over in a separate step.
            if self._shared:
                yield gone
            else:
                yield from self._take_over(gone)
        if state.stale >= 0:
            yield _without(state, STALE)
        yield state._replace(
            core=self.cores.redis_lost(state.core) if state.core >= 0 else -1,
            stale=self.cores.redis_lost(state.stale) if state.stale >= 0 else -1,
            jobs=tuple(_ordered(e - e % _WORKER for e in entries) for entries in state.jobs),
            results=((),) * self.ranges,
        )


def _work(state: State) -> Iterator[State]:
    for index, entries in enumerate(state.jobs):
        for entry in sorted(set(entries)):
            if state.idle and entry & _ON_STREAM:
                # Though others may have it: leases run out while their holders still work.
                taken = _entry_changed(state.jobs, index, entry, entry + _WORKER)
                yield state._replace(jobs=taken, idle=state.idle - 1)
            if entry >= _WORKER:
                done = _entry_changed(state.jobs, index, entry, (entry - _WORKER) & ~_ON_STREAM)
                results = list(state.results)
                results[index] = tuple(sorted((*results[index], 0)))
                yield state._replace(jobs=done, results=tuple(results), idle=state.idle + 1)
                if entry & _QUICK:
                    results[index] = tuple(sorted((*state.results[index], _STOPPED)))
                    yield state._replace(jobs=done, results=tuple(results), idle=state.idle + 1)


def _number_of(state: State, role: int) -> int:
    return state.core if role == CORE else state.stale


def _put(state: State, role: int, number: int) -> State:
    return state._replace(core=number) if role == CORE else state._replace(stale=number)


def _without(state: State, role: int) -> State:
    """The coordinator in that role is no more, or has dropped the render."""
    jobs = tuple(_ordered(entry & ~_KNOWN[role] for entry in entries) for entries in state.jobs)
    results = tuple(
        tuple(sorted(entry - _digit(entry, role) * _DIGIT[role] for entry in entries))
        for entries in state.results
    )
    return _put(state, role, -1)._replace(jobs=jobs, results=results)


def _roles_moved(entry: int) -> int:
    """Who had the lease is stale now."""
    known = _KNOWN[STALE] if entry & _KNOWN[CORE] else 0
    return entry & ~_KNOWN[CORE] & ~_KNOWN[STALE] | known


def _adopted(entries: Iterable[int], chosen: int | None, wanted: bool) -> tuple[int, ...]:
    """The chosen one is known to the new coordinator; the others are deleted, or all if none is wanted."""
    after = []
    for entry in entries:
        if entry == chosen and wanted:
            after.append(entry | _KNOWN[CORE])
            chosen = None
        else:
            after.append(entry & ~_ON_STREAM)
    return _ordered(after)


def _digit(entry: int, role: int) -> int:
    return entry // _DIGIT[role] % 3


def _find(entries: tuple[int, ...], role: int, digit: int) -> int | None:
    return next((entry for entry in entries if _digit(entry, role) == digit), None)


def _changed(entries: tuple[int, ...], before: int, after: int) -> tuple[int, ...]:
    """One entry of those that are alike."""
    left = list(entries)
    left.remove(before)
    return tuple(sorted((*left, after)))


def _entry_changed(jobs: Entries, index: int, before: int, after: int) -> Entries:
    left = list(jobs[index])
    left.remove(before)
    return (*jobs[:index], _ordered((*left, after)), *jobs[index + 1 :])


def _ordered(entries: Iterable[int]) -> tuple[int, ...]:
    """Without those that are nowhere and known to nobody."""
    return tuple(sorted(entry for entry in entries if entry & ~_QUICK))


def _count_before(finished: list[int], edges_from: "array[int]", edges_to: "array[int]", states: int) -> int:
    """How many states lead to one of the finished ones, these included."""
    sources, targets = np.array(edges_from), np.array(edges_to)
    order = np.argsort(targets, kind="stable")
    starts = np.searchsorted(targets[order], np.arange(states + 1))
    sources = sources[order]
    reached = np.zeros(states, dtype=bool)
    front = np.array(finished, dtype=np.int64)
    reached[front] = True
    while front.size:
        before = np.concatenate([sources[starts[each] : starts[each + 1]] for each in front])
        front = np.unique(before[~reached[before]])
        reached[front] = True
    return int(reached.sum())
