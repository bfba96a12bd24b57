"""Merged samples are committed about once a second, and then shown; then their results are deleted. Pure.

Renders are let go here, too: a commit may find one lost.
"""

from collections.abc import Collection

from nocturne_coordinator.dispatch.events import CommitDone, MadeApart, Moment, PicturesMade
from nocturne_coordinator.dispatch.instructions import (
    ERROR,
    WARNING,
    Acknowledge,
    Commit,
    IsOpen,
    Log,
    MakePictures,
    Quarantine,
    RecordError,
    RefreshRenders,
    ReleaseLease,
    Steps,
    Withdraw,
    WriteImage,
    WritePreview,
    WriteThumbnail,
)
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.dispatch.state import State
from nocturne_coordinator.errors import LeaseLost, StoreUnavailable

_PREVIEW_SECONDS = 1.0
_PREVIEW_SHARE = 0.01
"""Shortest time between two of a render, and the part of all time that may go into them. A preview and the
error have a share each; of EXRs there is the last one only, and the API makes others for who asks."""

_APART_SHARE = 0.02
"""The same of the pictures of large films together, which a process makes."""

_SHOW_SECONDS = 0.5
"""After so much of it, results are merged before the next picture."""

_FULL_SHARES = 2
"""Where more renders than these are at work, they divide the share of so many: pictures that people look at
shall not cost more the more there is to look at."""


class Commits:
    """Commits and shows what changed, and lets renders go."""

    def __init__(self, state: State) -> None:
        self._state = state

    def commit(self, at: Moment, ending: Collection[str] = ()) -> Steps[bool]:
        """Commits what changed; on trouble says so, gives False, and all stays as it is until the next
        time. `ending`: renders whose last pictures come next, so that others are not made."""
        self._state.next_commit = at.now + self._state.settings.commit_seconds
        try:
            yield from self._commit(at, ending)
        except LeaseLost as lost:
            yield from self.lose(lost.render_id)
        except StoreUnavailable as trouble:
            yield from self.report(trouble)
            return False
        self._state.folder_trouble = False
        return True

    def report(self, trouble: StoreUnavailable) -> Steps[None]:
        """No new jobs from here on until a commit works."""
        self._state.folder_trouble = True
        yield Log(ERROR, f"can't write to the data folder: {trouble}; no new jobs until it works")

    def _commit(self, at: Moment, ending: Collection[str]) -> Steps[None]:
        state = self._state
        audits = state.auditor.open_by_render()
        for render in state.renders.values():
            render.count_unaudited(state.auditor.unsettled.pop(render.id, 0))
            render.audits_open = audits[render.id]
        changed = [
            (render, changes)
            for render in state.renders.values()
            if (changes := render.changes(at.now, at.unix))
        ]
        # Who has a render now may need a result that is only a duplicate here.
        fences = {
            each: state.renders[each].row.fence for each in state.to_acknowledge if each in state.renders
        }
        if changed or fences:
            done: CommitDone = yield Commit(tuple(changes for _, changes in changed), fences)
            for render, _ in changed:
                state.scheduler.committed(render.id, render.committing)
                if entries := render.committed():
                    state.to_acknowledge.setdefault(render.id, []).extend(entries)
            for render_id in done.lost:
                yield from self.lose(render_id)
            at = done.at
        if to_acknowledge := [entry for each in state.to_acknowledge.values() for entry in each]:
            yield Acknowledge(tuple(to_acknowledge))
        state.to_acknowledge.clear()
        yield from self._show(at, ending)

    def write_owed(self, at: Moment) -> Steps[None]:
        """Carries out all owed writes, until one fails: that one, and those after it, are owed still."""
        owed, renders = self._state.owed, self._state.renders
        # All work of a worker is committed before it is thrown away, so that none is missed.
        if any(isinstance(each, Quarantine) for each in owed) and not (yield from self.commit(at)):
            return
        try:
            while owed:
                distrusted = yield owed[0]
                match owed.pop(0):
                    case Quarantine(worker):
                        for render_id in distrusted:
                            line = f"render={render_id} tiles with work of {worker=!s} are traced anew"
                            yield Log(ERROR, line)
                            if render_id in renders:
                                yield from self.drop(render_id)
                            yield RefreshRenders()
        except StoreUnavailable as trouble:
            yield from self.report(trouble)

    def lose(self, render_id: str) -> Steps[None]:
        """Another coordinator has the render, or its sums were changed: jobs and results are not ours any
        more. Those of a render that was deleted are nobody's."""
        is_open: bool = yield IsOpen(render_id)
        if render_id in self._state.renders:
            yield Log(
                WARNING, f"render={render_id} is not ours any more; what was not committed is done again"
            )
            yield from self.drop(render_id, jobs_stay=is_open)
        results = self._state.to_acknowledge.pop(render_id, [])
        if not is_open and results:
            yield Acknowledge(tuple(results))
        # It may be ours to take again.
        yield RefreshRenders()

    def drop(self, render_id: str, jobs_stay: bool = False) -> Steps[None]:
        """Works on the render no more. `jobs_stay`: another coordinator will want its jobs and results."""
        state = self._state
        render, jobs = self.set_aside(render_id)
        if not jobs_stay:
            if jobs:
                yield Withdraw(tuple(jobs), stop=True)
            state.to_acknowledge.setdefault(render_id, []).extend(render.waiting_entries())
        state.owed.append(ReleaseLease(render_id, render.row.fence))

    def set_aside(self, render_id: str) -> tuple[RunningRender, list[bytes]]:
        """The render gets no jobs and no results here; both stay where they are, as does its lease. Gives the
        entries of its jobs, too."""
        state = self._state
        jobs = [*state.scheduler.remove(render_id), *state.auditor.forget(render_id)]
        state.failure_policy.forget(render_id)
        state.waits_for_audits_since.pop(render_id, None)
        state.minority_since.pop(render_id, None)
        return state.renders.pop(render_id), jobs

    # --- pictures ---

    def _show(self, at: Moment, ending: Collection[str]) -> Steps[None]:
        """Previews that are due, of renders with new samples, never more often than they are worth."""
        changed = [
            each
            for each in self._state.renders.values()
            if each.totals.photons != each.pictured_photons and each.id not in ending
        ]
        part = min(1.0, _FULL_SHARES / max(1, len(changed)))
        until = at.now + _SHOW_SECONDS
        for render in changed:
            begun = at.now
            if not render.finds_errors:
                at = yield from self._show_apart(render, part, at)
                continue
            if begun >= until:
                continue
            if begun >= render.next_preview:
                at = yield WritePreview(render.id)
                pause = max(_PREVIEW_SECONDS, (at.now - begun) / (part * _PREVIEW_SHARE))
                render.next_preview = begun + pause
            begun = at.now
            if begun >= render.next_figures:
                at = yield from self._show_error(render)
                pause = max(_PREVIEW_SECONDS, (at.now - begun) / (part * _PREVIEW_SHARE))
                render.next_figures = begun + pause

    def _show_apart(self, render: RunningRender, part: float, at: Moment) -> Steps[Moment]:
        """The same of a large film: asked for until it is there."""
        if at.now < render.next_preview:
            return at
        made: PicturesMade | None = yield MakePictures(render.id, final=False)
        if made is None or made.apart is None:
            return at
        pause = max(_PREVIEW_SECONDS, made.apart.cpu_seconds / (part * _APART_SHARE))
        render.next_preview = made.at.now + pause
        return (yield from self._record(render, made.apart))

    def show_final(self, render: RunningRender, made: PicturesMade) -> Steps[None]:
        """The last preview and image of a render, of all that is committed."""
        yield WriteImage(render.id)
        if made.apart is not None:
            yield from self._record(render, made.apart)
            return
        yield WritePreview(render.id, final=True)
        yield from self._show_error(render)

    def _record(self, render: RunningRender, made: MadeApart) -> Steps[Moment]:
        """Tells watchers of pictures that are there."""
        point, in_history = render.judged(made.point, made.estimate)
        at: Moment = yield RecordError(render.id, render.row.fence, point, in_history)
        render.pictured_photons = point.photons
        return at

    def _show_error(self, render: RunningRender) -> Steps[Moment]:
        """The error and a small picture, which cost less than a preview; tells watchers of all of them."""
        at: Moment = yield WriteThumbnail(render.id)
        point, in_history = render.error_point(at.unix)
        at = yield RecordError(render.id, render.row.fence, point, in_history)
        render.pictured_photons = point.photons
        return at
