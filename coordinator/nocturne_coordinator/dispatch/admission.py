"""Renders that come, go on otherwise and go, as the data folder says. Pure.

One file, though long: all of it follows from one look at the folder.
"""

from collections import Counter, deque
from collections.abc import Iterable, Mapping
from dataclasses import replace
from heapq import heapify, heappop, heappush

from nocturne.v1 import job_pb2
from nocturne_scene.ranges import ranges_planned

from nocturne_coordinator.dispatch import film
from nocturne_coordinator.dispatch.commits import Commits
from nocturne_coordinator.dispatch.events import Moment, RendersSeen
from nocturne_coordinator.dispatch.film_memory import why_too_large
from nocturne_coordinator.dispatch.instructions import (
    ERROR,
    INFO,
    WARNING,
    AskTime,
    EndRender,
    Log,
    PublishExclusions,
    Quarantine,
    ReadTiles,
    Recut,
    RefreshRenders,
    ReleaseLease,
    RereadResults,
    RestartRender,
    StartRender,
    Steps,
    TakeRender,
    Withdraw,
)
from nocturne_coordinator.dispatch.job_cost import longest_of
from nocturne_coordinator.dispatch.loading import Loading, steps_of, steps_of_other_plan
from nocturne_coordinator.dispatch.profiles import should_start_anew, usual_profiles
from nocturne_coordinator.dispatch.range_queue import RangeQueue
from nocturne_coordinator.dispatch.records import OpenRender, RenderState
from nocturne_coordinator.dispatch.room import Room, is_at_work, share_of
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.state import State
from nocturne_coordinator.errors import LeaseLost, StoreUnavailable

_ODD_SECONDS = 10.0
"""How long most workers must round otherwise than a render's before it is started again: a worker's status
holds as long, so all that are there have been seen."""


_ADMIT_SECONDS = 0.2
"""After so much of taking renders up, results are read, and the folder is looked at again."""

_REPLAN_PAUSE = 2e-4
"""Seconds between two other schedules of a render, for each of its tiles: thirty times what one takes."""


class Admission:
    """Takes renders up, and lets them go."""

    def __init__(self, state: State, commits: Commits) -> None:
        self._state = state
        self._commits = commits
        self._room = Room(state.settings.memory_bytes)
        self._loading: dict[str, Loading] = {}

    def follow(self, event: RendersSeen) -> Steps[None]:
        """Takes renders up and lets them go as the folder says; asks for another look if that has to wait."""
        try:
            if not (yield from self._follow(event)):
                yield RefreshRenders()
        except LeaseLost as lost:
            yield from self._commits.lose(lost.render_id)
        except StoreUnavailable as trouble:
            yield Log(ERROR, f"the data folder can't be used: {trouble}; trying again")
            yield RefreshRenders()

    def _follow(self, event: RendersSeen) -> Steps[bool]:
        state, at = self._state, event.at
        owed = {each.worker: each.reason for each in state.owed if isinstance(each, Quarantine)}
        state.fleet.quarantined, state.fleet.drained = {**event.quarantined, **owed}, event.drained
        rows = {row.id: row for row in event.renders}
        for render in [each for each in state.renders.values() if _is_lost(each, rows)]:
            yield from self._commits.lose(render.id)
        gone = [
            render.id
            for render in state.renders.values()
            if render.id not in rows or not render.can_replan(rows[render.id])
        ]
        # Their merged results are kept, unless they were cancelled.
        for render_id in gone:
            state.renders[render_id].commit_photons_next()
            if jobs := state.auditor.give_up(render_id):
                yield Withdraw(tuple(jobs), stop=True)
        if gone and not (yield from self._commits.commit(at)):
            return False
        # A commit may have found one of them lost.
        for render_id in [each for each in gone if each in state.renders]:
            yield Log(INFO, f"render={render_id} let go")
            yield from self._commits.drop(render_id)
        for render_id, loading in list(self._loading.items()):
            if render_id not in rows or rows[render_id].fence != loading.render.row.fence:
                self._load_no_more(render_id)
        part = -(-len(rows) // event.coordinators)
        yield from self._pass_on(part, at)
        waiting: list[OpenRender] = []
        for row in rows.values():
            if row.id in self._loading:
                continue
            if row.id in state.renders:
                if not row.asks_the_same(state.renders[row.id].row) and self._may_replan(row, at):
                    yield from self._replan(row, at)
                if row.id not in state.renders:
                    continue
                state.scheduler.set_priority(row.id, row.priority)
                self._look_first(row)
                state.renders[row.id].take_layers(row)
                if row.state is RenderState.QUEUED:
                    # Paused and resumed between two looks: it runs as before.
                    yield StartRender(row.id, state.renders[row.id].row.fence)
            elif row.holder in (0, state.settings.number):
                waiting.append(row)
        yield from self._admit_in_turn(waiting, rows.values(), part, at)
        state.fleet.share = share_of(state.renders, rows.values())
        profiles = {render.id: render.floating_point_profile for render in state.renders.values()}
        wanted = {profiles.get(row.id, row.floating_point_profile) for row in rows.values()}
        for worker, reason in state.fleet.set_profiles(wanted).items():
            yield Log(WARNING, f"worker={worker} gets no jobs: {reason}")
        yield PublishExclusions(state.fleet.without_jobs())
        return True

    def restart_minority_profile_renders(self, at: Moment) -> Steps[None]:
        """A render whose first worker rounds as few others do, so that these can't help, loses its start."""
        state = self._state
        machines = state.fleet.votes_by_profile
        for render in list(state.renders.values()):
            # A replay is asked for with that very class.
            fixed = bool(render.row.stop.tile_samples)
            cpu_seconds = render.totals.cpu_seconds
            if fixed or not should_start_anew(render.floating_point_profile, machines, cpu_seconds):
                state.minority_since.pop(render.id, None)
            elif at.now - state.minority_since.setdefault(render.id, at.now) >= _ODD_SECONDS:
                if not (yield from self._commits.commit(at)) or render.id not in state.renders:
                    continue
                profile = render.floating_point_profile
                usual = " or ".join(sorted(usual_profiles(machines)))
                yield Log(
                    WARNING,
                    f"render={render.id} is started anew: it has floating-point profile {profile}, "
                    f"most machines {usual}",
                )
                try:
                    yield RestartRender(render.id, render.row.fence)
                except LeaseLost as lost:
                    yield from self._commits.lose(lost.render_id)
                except StoreUnavailable as trouble:
                    yield from self._commits.report(trouble)
                else:
                    yield from self._commits.drop(render.id)
                    yield RefreshRenders()

    def cut_long_ranges(self, at: Moment) -> Steps[None]:
        """A render whose next jobs would take too long gets shorter ranges."""
        for render in list(self._state.renders.values()):
            schedule = render.recut()
            if schedule is None:
                continue
            try:
                is_done = yield Recut(render.row, schedule)
            except LeaseLost as lost:
                yield from self._commits.lose(lost.render_id)
            except StoreUnavailable as trouble:
                yield from self._commits.report(trouble)
            else:
                if not is_done:
                    # The render was extended meanwhile; its new ranges are cut at the next look.
                    yield RefreshRenders()
                    continue
                longest, bundles = longest_of(schedule.range_ends), longest_of(schedule.photon_range_ends)
                photons = f" and {bundles} bundles of forward photons" if bundles else ""
                line = f"render={render.id} has ranges of at most {longest} samples{photons} from here on"
                yield Log(INFO, line)
                failed = tuple(render.failed_tiles.values())
                yield from self._replan(replace(render.row, schedule=schedule, failed_tiles=failed), at)

    def _replan(self, row: OpenRender, at: Moment) -> Steps[None]:
        """A render that is at work goes on by another schedule, or to other conditions."""
        state, render = self._state, self._state.renders[row.id]
        if len(render.film.queues) > film.QUEUES_AT_ONCE and not state.auditor.disputed(row.id):
            yield from self._replan_in_steps(row, at)
            return
        kept = render.planned.kept_in(row.schedule)
        state.to_acknowledge.setdefault(row.id, []).extend(render.replan(row))
        jobs = state.scheduler.replan(row.id, kept, render.range_queues())
        state.failure_policy.forget(row.id)
        state.waits_for_audits_since.pop(row.id, None)
        if jobs := [*jobs, *state.auditor.forget(row.id, kept)]:
            yield Withdraw(tuple(jobs), stop=True)
        yield Log(INFO, f"render={row.id} goes on with {ranges_planned(row.schedule)} ranges")

    def _replan_in_steps(self, row: OpenRender, at: Moment) -> Steps[None]:
        """The same of a film of many tiles: it is set aside, which others hardly notice, and taken up again,
        with what is on the streams of it. Audits that are open are counted as not made."""
        state = self._state
        state.renders[row.id].commit_photons_next()
        if jobs := state.auditor.give_up(row.id):
            yield Withdraw(tuple(jobs), stop=True)
        if not (yield from self._commits.commit(at)) or row.id not in state.renders:
            yield RefreshRenders()
            return
        render, _ = self._commits.set_aside(row.id)
        self._loading[row.id] = Loading(render, steps_of_other_plan(render, row), is_replanned=True)

    def end(self, render: OpenRender, state: RenderState, reason: str) -> Steps[None]:
        """Writes a final state."""
        if (yield EndRender(render, state, reason)):
            yield Log(INFO, f"render={render.id} {state.value} {reason}".rstrip())
        else:
            # Somebody changed its requests; the next look at the folder shows which.
            yield RefreshRenders()

    def _pass_on(self, part: int, at: Moment) -> Steps[None]:
        """Leaves the youngest renders to other coordinators that have fewer."""
        surplus = list(self._state.renders)[part:]
        if surplus and (yield from self._commits.commit(at)):
            for render_id in [each for each in surplus if each in self._state.renders]:
                yield Log(INFO, f"render={render_id} is left to another coordinator")
                yield from self._commits.drop(render_id, jobs_stay=True)

    def _admit_in_turn(
        self, waiting: Iterable[OpenRender], rows: Iterable[OpenRender], part: int, at: Moment
    ) -> Steps[None]:
        """Resumes renders; then starts those for which there is room, next the owner with fewest at work for
        its weight."""
        queues: dict[str, deque[OpenRender]] = {}
        # Those that ran already hold no one up: their owners had their turn.
        for row in sorted(waiting, key=lambda each: each.state is RenderState.QUEUED):
            queues.setdefault(row.owner, deque()).append(row)
        here = {*self._state.renders, *self._loading}
        at_work = Counter(row.owner for row in rows if row.id in here or is_at_work(row))

        def turn(number: int, owner: str) -> tuple[float, int, str]:
            return at_work[owner] / queues[owner][0].owner_weight, number, owner

        turns = [turn(number, owner) for number, owner in enumerate(queues)]
        heapify(turns)
        while turns and len(self._here) < part:
            _, number, owner = heappop(turns)
            row = queues[owner].popleft()
            is_new = not at_work[owner]
            is_admitted = row.state is RenderState.RUNNING or self._room.has(row, self._here, newcomer=is_new)
            if is_admitted:
                yield from self._admit(row, at)
                at_work[owner] += row.id in (*self._state.renders, *self._loading)
            if queues[owner]:
                heappush(turns, turn(number, owner))
            if is_admitted and turns and (yield AskTime()).now > at.now + _ADMIT_SECONDS:
                # Others may have come meanwhile, whose turn it is.
                yield RefreshRenders()
                return

    def _admit(self, row: OpenRender, at: Moment) -> Steps[None]:
        taken: OpenRender | None = yield TakeRender(row.id)
        if taken is not None and taken.state in (RenderState.QUEUED, RenderState.RUNNING):
            yield from self._work_on(taken, at)

    def _work_on(self, row: OpenRender, at: Moment) -> Steps[None]:
        """A render that is leased to us."""
        if row.engine != job_pb2.ENGINE_CURRENT:
            reason = (
                f"It was made for engine {row.engine}; this service traces with engine "
                f"{job_pb2.ENGINE_CURRENT}, whose bits differ. Submit it again."
            )
            yield from self.end(row, RenderState.FAILED, reason)
            return
        if reason := why_too_large(row.schedule, self._state.settings.memory_bytes):
            yield from self.end(row, RenderState.FAILED, reason)
            return
        if row.state is RenderState.QUEUED and 0.0 < row.stop.until <= at.unix and not row.totals.photons:
            text = row.stop.until_text or "the time"
            reason = f"{text} came before there was room to start it."
            yield from self.end(row, RenderState.STOPPED_EARLY, reason)
            return
        if row.state is RenderState.QUEUED and not (yield StartRender(row.id, row.fence)):
            return
        tiles = yield ReadTiles(row.id)
        render = RunningRender(row, None, at.now, self._state.settings.job_seconds)
        self._loading[row.id] = Loading(render, steps_of(render, iter(tiles)))
        yield from self._load(row.id)

    def load(self) -> Steps[None]:
        """Does some more for the renders that are being taken up: of a large film there are gigabytes, and
        nobody waits for all of them."""
        for render_id in list(self._loading):
            try:
                yield from self._load(render_id)
            except LeaseLost as lost:
                yield from self._commits.lose(lost.render_id)
            except StoreUnavailable as trouble:
                yield from self._commits.report(trouble)

    def _load(self, render_id: str) -> Steps[None]:
        render, steps, is_replanned = self._loading[render_id]
        try:
            queues = next(steps)
            if queues is None:
                return
        except ValueError as error:
            del self._loading[render_id]
            reason = f"Its committed samples can't be read: {error}"
            yield from self.end(render.row, RenderState.FAILED, reason)
            return
        except StoreUnavailable:
            self._load_no_more(render_id)
            yield RefreshRenders()
            raise
        del self._loading[render_id]
        yield from self._begin(render, queues, is_replanned)

    def _load_no_more(self, render_id: str) -> None:
        render = self._loading.pop(render_id).render
        self._state.owed.append(ReleaseLease(render_id, render.row.fence))

    def _begin(self, render: RunningRender, queues: list[RangeQueue], is_replanned: bool) -> Steps[None]:
        """All that was committed of it is here."""
        row = render.row
        self._state.renders[row.id] = render
        self._state.scheduler.add(
            row.id,
            queues,
            owner=row.owner,
            priority=row.priority,
            owner_weight=row.owner_weight,
            cost=render.cost,
        )
        if row.fence > 1 or is_replanned:
            # Its results are read again, those too that were to be deleted when it was let go.
            self._state.to_acknowledge.pop(row.id, None)
            yield RereadResults(row.id)
        self._look_first(row)
        done, planned = render.totals.ranges, ranges_planned(row.schedule)
        how = "goes on by another schedule" if is_replanned else "resumed" if done else "started"
        yield Log(INFO, f"render={row.id} {how}; {done} of {planned} ranges are merged")

    def _look_first(self, row: OpenRender) -> None:
        planned = self._state.renders[row.id].planned
        tiles: frozenset[int] = row.look_first.tiles(planned.grid) if row.look_first else frozenset()
        if tiles:
            # Forward photons fall on any.
            tiles |= {planned.photon_index}
        self._state.scheduler.set_first(row.id, tiles)

    @property
    def _here(self) -> list[RunningRender]:
        """Renders at work, and those that are being taken up."""
        return [*self._state.renders.values(), *(each.render for each in self._loading.values())]

    def _may_replan(self, row: OpenRender, at: Moment) -> bool:
        """Whether a render may get another schedule now: of a large film that holds up all others, so it gets
        one now and then."""
        render = self._state.renders[row.id]
        if at.now < render.next_replan and not render.film.complete:
            return False
        render.next_replan = at.now + len(render.film.queues) * _REPLAN_PAUSE
        return True


def _is_lost(render: RunningRender, rows: Mapping[str, OpenRender]) -> bool:
    return render.id in rows and rows[render.id].fence != render.row.fence
