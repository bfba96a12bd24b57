"""Carries out the core's instructions, on queue, store and files."""

import logging
from collections.abc import Iterator
from typing import Any

from nocturne_scene.errors import NotFound

from nocturne_coordinator.clock import Clock
from nocturne_coordinator.crash_points import crash_point
from nocturne_coordinator.dispatch import instructions as do
from nocturne_coordinator.dispatch.events import CommitDone
from nocturne_coordinator.dispatch.records import TileRow
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.errors import StoreUnavailable
from nocturne_coordinator.output.previews import Previews
from nocturne_coordinator.queue.dispatcher import Dispatcher
from nocturne_coordinator.store.database import DatabaseTrouble
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.traces import Traces

_log = logging.getLogger("nocturne_coordinator.coordinator")


class Executor:
    """The core's hands."""

    def __init__(
        self,
        ledger: Ledger,
        previews: Previews,
        dispatcher: Dispatcher,
        renders: dict[str, RunningRender],
        clock: Clock,
        traces: Traces,
    ) -> None:
        """`renders`: the core's, whose films are shown."""
        self._traces = traces
        self._ledger = ledger
        self._previews = previews
        self._dispatcher = dispatcher
        self._renders = renders
        self._clock = clock
        self.wants_look = True
        """The core waits for another look at the folder."""

    def carry_out(self, instruction: do.Instruction) -> Any:
        """Gives the answer. LeaseLost, StoreUnavailable and QueueError are answers, too."""
        match instruction:
            case do.Log():
                _log.log(instruction.level, "%s", instruction.message)
            case do.RefreshRenders():
                self.wants_look = True
            case do.AskTime():
                return self._clock.moment()
            case do.Publish():
                entries = self._dispatcher.publish(instruction.jobs, instruction.quick)
                self._traces.published(instruction.jobs)
                return entries
            case do.Withdraw():
                self._dispatcher.withdraw(instruction.entries, instruction.stop)
            case do.Acknowledge():
                self._dispatcher.acknowledge(instruction.entries)
            case do.RereadResults():
                self._dispatcher.take_up(instruction.render_id)
            case do.PublishExclusions():
                self._dispatcher.tell_workers(instruction.reasons)
            case do.IsOpen():
                return self._is_open(instruction.render_id)
            case do.WriteBundle():
                self._write_bundle(instruction)
            case _:
                try:
                    return self._write(instruction)
                except (DatabaseTrouble, OSError) as trouble:
                    raise StoreUnavailable(str(trouble)) from trouble
        return None

    def _write(self, instruction: do.Instruction) -> Any:
        """Instructions that need the data folder, and fail with it."""
        ledger = self._ledger
        match instruction:
            case do.TakeRender():
                return ledger.renders.take(instruction.render_id)
            case do.StartRender():
                unix = self._clock.moment().unix
                return ledger.commits.start(instruction.render_id, instruction.fence, unix)
            case do.ReadTiles():
                return self._tiles(instruction.render_id)
            case do.Commit():
                return self._commit(instruction)
            case do.EndRender():
                unix = self._clock.moment().unix
                return ledger.commits.end(instruction.render, instruction.state, instruction.reason, unix)
            case do.RestartRender():
                ledger.commits.start_anew(instruction.render_id, instruction.fence)
            case do.Recut():
                return ledger.commits.recut(instruction.render, instruction.schedule)
            case do.Quarantine():
                unix, worker = self._clock.moment().unix, instruction.worker
                return ledger.workers.quarantine(worker, instruction.reason, unix, instruction.mismatched)
            case do.ReleaseLease():
                ledger.leases.let_go(instruction.render_id, instruction.fence)
            case do.RecordError():
                point, in_history = instruction.point, instruction.in_history
                ledger.commits.record_preview(instruction.render_id, instruction.fence, point, in_history)
                return self._clock.moment()
            case do.WritePreview():
                self._previews.write_preview(self._renders[instruction.render_id], instruction.final)
                return self._clock.moment()
            case do.WriteThumbnail():
                self._previews.write_thumbnail(self._renders[instruction.render_id])
                return self._clock.moment()
            case do.MakePictures():
                render = self._renders[instruction.render_id]
                return self._previews.made(render, instruction.final, self._clock.moment)
            case do.WriteImage():
                self._previews.write_image(self._renders[instruction.render_id])
                return self._clock.moment()
        return None

    def _tiles(self, render_id: str) -> Iterator[TileRow]:
        """Read one by one, as the core asks for them."""
        try:
            yield from self._ledger.renders.tiles(render_id)
        except (DatabaseTrouble, OSError) as trouble:
            raise StoreUnavailable(str(trouble)) from trouble

    def _commit(self, instruction: do.Commit) -> CommitDone:
        lost = []
        if instruction.commits:
            crash_point("before-commit")
            lost = self._ledger.commits.commit(list(instruction.commits))
            crash_point("after-commit")
            self._traces.committed(each for each in instruction.commits if each.render_id not in lost)
        lost += [each for each in self._ledger.leases.lost(instruction.fences) if each not in lost]
        return CommitDone(self._clock.moment(), tuple(lost))

    def _is_open(self, render_id: str) -> bool:
        try:
            return self._ledger.renders.is_open(render_id)
        except DatabaseTrouble:
            return True

    def _write_bundle(self, instruction: do.WriteBundle) -> None:
        render, failed = self._renders[instruction.render_id], instruction.failed
        try:
            self._previews.write_bundle(render, failed)
        except (OSError, NotFound) as trouble:
            _log.error("render=%s tile=%d has no bundle: %s", render.id, failed.tile_index, trouble)

    def show_ended(self) -> None:
        """Final images of renders that were cancelled or failed, from committed sums; where they are many,
        some at each look. LeaseLost, DatabaseTrouble, OSError."""
        if not self._previews.finish_ended(self._clock.moment().unix):
            self.wants_look = True
