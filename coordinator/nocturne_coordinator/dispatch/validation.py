"""Whether the core's state is one that may be: those invariants of coordinator/README.md that it shows.
Pure.

Each range has one state (I2), which is the same in the scheduler and in the film (I6); samples, counts and
totals are those of the merged ranges (I1); the number of ranges in flight is bounded (I8). For tests, after
every event."""

from collections import Counter

import numpy as np

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.range_queue import RangeState
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.scheduler import JobKey, Scheduler
from nocturne_coordinator.dispatch.state import State


class InvalidState(AssertionError):
    """A state that must not be; says why."""


def validate_state(state: State, window: int) -> None:
    """InvalidState if a range is in two places or in none, a count is wrong, or a bound is passed."""
    _require(state.renders.keys() == state.scheduler.render_ids(), "scheduler and renders differ")
    for render in state.renders.values():
        _check_states(render, state.scheduler)
        _check_counts(render)
    problem = state.scheduler.problem()
    _require(not problem, problem)
    _check_entries(state)
    queues = sum(len(render.film.queues) for render in state.renders.values())
    # One more for each queue, where all that is in flight waits for earlier ranges.
    _require(
        state.scheduler.in_flight <= limits.MAX_WINDOW + queues, "more in flight than the largest window"
    )
    _require(window <= limits.MAX_WINDOW, "a window above its bound")
    _require(len(state.auditor.entries()) <= limits.MAX_AUDITS, "too many audits")


def _check_states(render: RunningRender, scheduler: Scheduler) -> None:
    """The film and the states of ranges say the same."""
    done, open_ = {RangeState.COMPLETED, RangeState.COMMITTED}, {RangeState.PLANNED, RangeState.PUBLISHED}
    for number, queue in enumerate(render.film.queues):
        rest = {RangeState.FAILED, RangeState.UNNEEDED} if queue.closed else open_
        for index in range(len(render.planned.ranges_of(number))):
            right = done if index < queue.merged else {RangeState.HELD} if index in queue.waiting else rest
            key = JobKey(render.id, number, index)
            _require(scheduler.state_of(key) in right, f"{key} is not in the film as its state says")


def _check_counts(render: RunningRender) -> None:
    film = render.film
    count = render.planned.grid.count
    samples = sum(
        film.samples_shown(index) * film.queues[index].sums.pixels[..., 0].size for index in range(count)
    )
    photons = film.traced_samples * render.planned.photons_per_sample
    _require(
        int(film.counts.sum(dtype=np.uint64)) == samples,
        f"{render.id}: counts are not those of the tiles",
    )
    shown = round(film.mean_samples * render.planned.pixels)
    _require(shown == samples, f"{render.id}: shown samples are not those of the tiles")
    _require(render.totals.photons == photons, f"{render.id}: photons are not those of the samples")
    ranges = sum(queue.merged for queue in film.queues)
    _require(render.totals.ranges == ranges, f"{render.id}: ranges are not those of the tiles")
    closed = sum(queue.closed for queue in film.queues)
    done = min(count, closed) if render.planned.ranges else count * film.complete
    _require(film.tiles_done == done, f"{render.id}: tiles done")
    _require(
        all(film.queues[index].closed for index in render.failed_tiles), f"{render.id}: a failed tile goes on"
    )
    for queue in film.queues:
        _require(not (queue.closed and queue.waiting), f"{render.id}: a range waits for what is closed")
        _require(len(queue.waiting) < queue.ahead, f"{render.id}: too many ranges wait")


def _check_entries(state: State) -> None:
    """A job's entry is of one job; a result that waits is not deleted."""
    jobs = Counter([*state.scheduler.entries(), *state.auditor.entries()])
    _require(all(count == 1 for count in jobs.values()), "an entry of two jobs")
    waiting = {entry for render in state.renders.values() for entry in render.waiting_entries()}
    to_acknowledge = [entry for entries in state.to_acknowledge.values() for entry in entries]
    _require(waiting.isdisjoint(to_acknowledge), "a result that waits is to be deleted")


def _require(true: bool, problem: str) -> None:
    if not true:
        raise InvalidState(problem)
