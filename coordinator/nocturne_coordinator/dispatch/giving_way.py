"""Jobs that give way to those of an owner of whom none is at work. Pure.

Who shares fairly gets the next free thread; but jobs take a minute, some ten, and behind them others are on
the stream. So jobs that nobody has taken are put behind those of the owner that waits. If no thread is free
even so, a job is stopped of an owner who has more threads than its share, but never an owner's only one. It
is the one that was put on the stream last. What it did is lost, which is never more than what others were to
have.
"""

import math
from collections.abc import Collection, Iterable
from typing import NamedTuple

from nocturne_coordinator.dispatch.events import Moment
from nocturne_coordinator.dispatch.instructions import INFO, Log, Steps, TakeBack, Withdraw
from nocturne_coordinator.dispatch.scheduler import JobKey
from nocturne_coordinator.dispatch.state import State

_PATIENCE_SECONDS = 0.3
"""Without a result and without a job at work, before others give way: jobs that take less are never seen at
work."""

_UNTAKEN_SECONDS = 0.2
"""A job that is on the stream for so long when workers are looked at was not taken because none was free."""

_STOPS_SECONDS = 3.0
"""Until a thread that is told to stop its job has taken the next."""

_LOOK_SECONDS, _LONG_LOOK_SECONDS, _MANY = 0.1, 2.0, 1000
"""Between two looks; the longer one where more jobs than that are out, and threads become free all the
time."""


class _Out(NamedTuple):
    """A job or an audit on the stream."""

    at: float
    number: int
    is_audit: bool
    key: JobKey
    entries: tuple[bytes, ...]


class GivingWay:
    """Notes who waits."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._next_look = 0.0
        self._since: dict[str, float] = {}
        self._stopped_at: dict[str, float] = {}

    def make_way(self, at: Moment, not_wanted: Collection[str]) -> Steps[Collection[str]]:
        """Takes jobs off the stream for who waits; gives these owners, whose jobs are to be published
        first."""
        scheduler = self._state.scheduler
        if at.now < self._next_look or len(scheduler.owners) < 2:
            return ()
        pause = _LOOK_SECONDS if scheduler.outstanding < _MANY else _LONG_LOOK_SECONDS
        self._next_look = at.now + pause
        out = self._out()
        at_work = {owner: [job for job in jobs if self._held(job)] for owner, jobs in out.items()}
        waiting = self._waiting(at, {owner for owner, jobs in at_work.items() if jobs}, not_wanted)
        ahead = []
        for owner in waiting:
            first = min(out.get(owner, ()), key=_order, default=None)
            untaken = [
                job
                for other, jobs in out.items()
                for job in jobs
                if other not in waiting and job not in at_work[other]
                if first is None or _order(job) < _order(first)
            ]
            if untaken or first is None:
                # Some may have been taken since workers were looked at.
                free = yield TakeBack(tuple(entry for job in untaken for entry in job.entries))
                self._taken_back(job for job in untaken if all(entry in free for entry in job.entries))
            if first is None:
                ahead.append(owner)
            elif first.at + _UNTAKEN_SECONDS <= self._state.fleet.looked_at:
                yield from self._stop_one_for(owner, at_work, at)
        return ahead

    def _out(self) -> dict[str, list[_Out]]:
        """Jobs and audits on the stream, by owner."""
        scheduler, found = self._state.scheduler, dict[str, list[_Out]]()
        for is_audit, out in ((False, scheduler.out), (True, self._state.auditor.out)):
            for key, job in out.items():
                one = _Out(job.at, job.number, is_audit, key, tuple(job.entries))
                found.setdefault(scheduler.owner_of(key.render_id), []).append(one)
        return found

    def _waiting(self, at: Moment, working: Collection[str], not_wanted: Collection[str]) -> list[str]:
        """Owners of whom nothing is at work, and no result came lately, longest first."""
        scheduler = self._state.scheduler
        idle = scheduler.owners_with_jobs(not_wanted) - set(working)
        self._since = {owner: self._since.get(owner, at.now) for owner in idle}
        came = {owner: max(since, scheduler.last_result(owner)) for owner, since in self._since.items()}
        found = [owner for owner in idle if came[owner] + _PATIENCE_SECONDS <= at.now]
        return sorted(found, key=lambda owner: (self._since[owner], owner))

    def _stop_one_for(self, owner: str, at_work: dict[str, list[_Out]], at: Moment) -> Steps[None]:
        scheduler, stopped_at = self._state.scheduler, self._stopped_at.get(owner, -math.inf)
        if at.now < stopped_at + _STOPS_SECONDS and scheduler.last_result(owner) < stopped_at:
            return
        weights = {each: scheduler.weight_of(each) for each in {*at_work, owner}}
        for_weight = self._state.fleet.threads / sum(weights.values())
        beyond = {
            each: threads - max(1.0, for_weight * weights[each])
            for each, jobs in at_work.items()
            if (threads := sum(len(self._held(job)) for job in jobs)) > max(1.0, for_weight * weights[each])
        }
        if not beyond:
            return
        other = max(beyond, key=lambda each: (beyond[each], each))
        # A copy of a slow job before any job of which there is one.
        job = max(at_work[other], key=lambda each: (len(self._held(each)) > 1, _order(each)))
        self._stopped_at = {each: when for each, when in self._stopped_at.items() if each in weights}
        self._stopped_at[owner] = at.now
        yield Log(
            INFO, f"{job.key} is stopped, and traced later: nothing of {owner or 'another owner'} is at work"
        )
        if len(held := self._held(job)) > 1:
            scheduler.uncopied(job.key, held[-1])
            yield Withdraw(held[-1:], stop=True)
        else:
            yield Withdraw(tuple(self._taken_back([job])), stop=True)

    def _held(self, job: _Out) -> tuple[bytes, ...]:
        """Its entries that workers have."""
        return tuple(entry for entry in job.entries if entry in self._state.fleet.held)

    def _taken_back(self, jobs: Iterable[_Out]) -> list[bytes]:
        """Entries of jobs that are to be published again, and cost their owners nothing until then."""
        scheduler, auditor = self._state.scheduler, self._state.auditor
        return [
            entry for job in jobs for entry in (auditor if job.is_audit else scheduler).taken_back(job.key)
        ]


def _order(job: _Out) -> tuple[float, bool, int]:
    """Of those that were put on the stream at once, audits are the last."""
    return job.at, job.is_audit, job.number
