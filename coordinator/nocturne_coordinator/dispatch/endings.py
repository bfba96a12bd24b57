"""Renders that have all that was asked for, or whose time is over, or that fail. Pure."""

from nocturne_coordinator.dispatch.admission import Admission
from nocturne_coordinator.dispatch.audit import MAX_WAIT
from nocturne_coordinator.dispatch.commits import Commits
from nocturne_coordinator.dispatch.events import Moment, PicturesMade
from nocturne_coordinator.dispatch.instructions import MakePictures, Steps, Withdraw
from nocturne_coordinator.dispatch.records import RenderState
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.state import State
from nocturne_coordinator.errors import LeaseLost, StoreUnavailable

_LONELY_SECONDS = 10.0
"""How long audits at the end of a render wait for a worker that could settle them, while there is none."""


class Endings:
    """Ends renders, their images first."""

    def __init__(self, state: State, commits: Commits, admission: Admission) -> None:
        self._state = state
        self._commits = commits
        self._admission = admission
        self._next_finish = 0.0
        self._pictured_at: dict[str, float] = {}
        """When to ask again for the pictures of renders that wait for them."""

    def finish(self, at: Moment) -> Steps[None]:
        """Ends the renders that are to end now."""
        ending = [
            (render, *how)
            for render in self._state.renders.values()
            if (how := render.ending(at.now, at.unix))
        ]
        endings = [
            each
            for each in ending
            if self._audits_are_done(each[0], at.now)
            and not each[0].row.layers_due
            and at.now >= self._pictured_at.get(each[0].id, 0.0)
        ]
        self._state.needs_audits_only = {each[0].id for each in ending} - {each[0].id for each in endings}
        # An owed quarantine may throw samples away that an image would have.
        if at.now < self._next_finish or self._state.owed or not (endings or self._state.failed):
            return
        self._next_finish = at.now + self._state.settings.commit_seconds
        for render, *_ in endings:
            if jobs := self._state.auditor.give_up(render.id):
                yield Withdraw(tuple(jobs), stop=True)
        if not (yield from self._commits.commit(at, {render.id for render, *_ in endings})):
            return
        try:
            yield from self._end_failed()
            for render, state, reason in endings:
                yield from self._end_with_image(render, state, reason, at)
        except LeaseLost as lost:
            yield from self._commits.lose(lost.render_id)
        except StoreUnavailable as trouble:
            yield from self._commits.report(trouble)
        else:
            self._next_finish = at.now

    def _audits_are_done(self, render: RunningRender, now: float) -> bool:
        """Whether no audit of the render is open, or none that others than the audited worker could
        settle. Where all others are at long jobs it waits no longer than it ran, except for disputed ones.
        """
        state = self._state
        if not state.auditor.pending(render.id):
            return True
        live = state.fleet.live(render.floating_point_profile)
        if state.auditor.only_others_could(render.id, live):
            return True
        waited = now - state.waits_for_audits_since.setdefault(render.id, now)
        disputed = state.auditor.disputed(render.id)
        if len(live) < (3 if disputed else 2):
            return waited >= _LONELY_SECONDS
        ran = render.ran_seconds(now) - waited
        return waited >= (MAX_WAIT if disputed else min(MAX_WAIT, max(_LONELY_SECONDS, ran)))

    def _end_failed(self) -> Steps[None]:
        failed = self._state.failed
        while failed:
            render_id, reason = next(iter(failed.items()))
            if render_id in self._state.renders:
                row = self._state.renders[render_id].row
                yield from self._admission.end(row, RenderState.FAILED, reason)
                yield from self._commits.drop(render_id)
            del failed[render_id]

    def _end_with_image(
        self, render: RunningRender, state: RenderState, reason: str, at: Moment
    ) -> Steps[None]:
        """Images first, then the state: who sees that it has ended finds them."""
        if render.id not in self._state.renders:
            return
        if render.totals.photons:
            made: PicturesMade | None = yield MakePictures(render.id)
            if made is None:
                self._pictured_at[render.id] = at.now + self._state.settings.commit_seconds
                self._state.needs_audits_only.add(render.id)
                return
            self._pictured_at.pop(render.id, None)
            yield from self._commits.show_final(render, made)
            if made.apart is not None:
                # The sentences about the error are known now.
                state, reason = render.ending(at.now, at.unix) or (state, reason)
        if disputed := self._state.auditor.disputed(render.id):
            key, workers = disputed[0]
            state = RenderState.DEGRADED
            reason = (
                f"Workers {' and '.join(workers)} have different results of tile {key.tile_index}, "
                f"and there was no third one to tell who is right. {reason}"
            ).strip()
        yield from self._admission.end(render.row, state, reason)
        yield from self._commits.drop(render.id)
