"""Previews, images and bundles in the data folder."""

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from nocturne_scene.errors import NotFound
from nocturne_scene.replacing import replacing, sync

from nocturne_coordinator.dispatch.events import MadeApart, Moment, PicturesMade
from nocturne_coordinator.dispatch.records import FailedTile, OpenRender
from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.errors import LeaseLost
from nocturne_coordinator.heartbeat import Heartbeat
from nocturne_coordinator.output.images import (
    FINAL_COMPRESSION,
    LIVE_COMPRESSION,
    write_preview,
    write_thumbnail,
)
from nocturne_coordinator.output.pictures import (
    APART_PIXELS,
    IMAGE,
    PREVIEW,
    THUMBNAIL,
    Painted,
    Pauses,
    PictureProcesses,
    write_image_of,
)
from nocturne_coordinator.store.bundle import write_bundle
from nocturne_coordinator.store.data_folder import DataFolder, make_folders
from nocturne_coordinator.store.ledger import Ledger

_BUSY_S, _BUSY_S_PER_PIXEL = 60.0, 2e-5
"""What a picture may take: over ten times the processor time of the last EXR, 1.6e-6 s a pixel, for there
may be many other processes and a slow disk."""

_ENDED_SECONDS = 0.2
"""After so much of pictures of ended renders, those at work get their turn."""

_log = logging.getLogger(__name__)


class Previews:
    """Writes images for people; shows committed samples only, so no picture goes back.

    All methods raise LeaseLost where another coordinator has the render.
    """

    def __init__(self, folder: DataFolder, ledger: Ledger, alive: Heartbeat | None = None) -> None:
        """`alive` is notified of work that takes long."""
        self._alive = alive or Heartbeat()
        self._folder = folder
        self._ledger = ledger
        self._pauses = Pauses()
        self._processes = PictureProcesses(getattr(folder, "root", Path()), self._pauses)
        self._painted: dict[str, Painted] = {}
        """By render, final pictures to be put in place."""

    def write_bundle(self, render: RunningRender, failed: FailedTile) -> None:
        """What reproduces the failure of a tile; OSError, NotFound."""
        write_bundle(self._folder, render.planned, failed)

    def finish_ended(self, unix_time: float) -> bool:
        """Final images of renders that were cancelled or failed, from committed sums. One whose images can't
        be made is tried again later, and delays no other render's. Whether all were looked at: after a while
        the others are left to the next call."""
        until = time.monotonic() + _ENDED_SECONDS
        for waiting in self._ledger.renders.ended_without_image():
            if time.monotonic() > until:
                return False
            if self._is_apart(waiting):
                self._finish_apart(waiting)
            elif self._pauses.over(waiting.id):
                try:
                    self._finish_here(waiting.id, unix_time)
                except OSError as error:
                    self._pauses.failed(waiting.id)
                    _log.error("render=%s has no image yet: %s", waiting.id, error)
                else:
                    self._pauses.worked(waiting.id)
        return True

    def _finish_here(self, render_id: str, unix_time: float) -> None:
        row = self._ledger.renders.take(render_id)
        if row is None:
            return
        try:
            render = RunningRender(row, self._ledger.renders.tiles(row.id))
        except ValueError as error:
            _log.error("render=%s has no image: %s", row.id, error)
        else:
            if render.totals.ranges:
                self.write_image(render)
                self.write_preview(render, final=True)
                self.write_thumbnail(render)
                point, in_history = render.error_point(unix_time)
                self._ledger.commits.record_preview(row.id, row.fence, point, in_history)
        self._ledger.commits.images_written(row.id, row.fence)
        self._ledger.leases.let_go(row.id, row.fence)

    def _finish_apart(self, waiting: OpenRender) -> None:
        painted, photons = None, waiting.totals.photons
        if photons and (painted := self._ask(waiting, photons, final=True)) is None:
            return
        row = self._ledger.renders.take(waiting.id)
        if row is None:
            return
        if painted is not None:
            self._place_all(row, painted, final=True)
            self._ledger.commits.record_preview(row.id, row.fence, painted.point, in_history=True)
        self._ledger.commits.images_written(row.id, row.fence)
        self._ledger.leases.let_go(row.id, row.fence)

    # --- by processes ---

    def made(self, render: RunningRender, final: bool, moment: Callable[[], Moment]) -> PicturesMade | None:
        """Pictures of all that is committed: the `final` ones can be put in place at once, others are there.
        None: asked for again until they are."""
        if not self._is_apart(render.row):
            return PicturesMade(moment())
        painted = self._ask(render.row, render.totals.photons, final)
        if painted is None:
            return None
        if final:
            self._painted[render.id] = painted
        else:
            self._place_all(render.row, painted, final)
        return PicturesMade(moment(), MadeApart(painted.point, painted.estimate, painted.cpu_seconds))

    def close(self) -> None:
        """Ends all work."""
        self._processes.close()

    def _ask(self, row: OpenRender, photons: int, final: bool) -> Painted | None:
        try:
            place = self._folder.image_path(row.id).parent
        except NotFound:
            raise LeaseLost(row.id) from None
        return self._processes.ask(row.id, row.owner, photons, place, final)

    def _is_apart(self, row: OpenRender) -> bool:
        return row.schedule.width * row.schedule.height > APART_PIXELS

    def _place_all(self, row: OpenRender, painted: Painted, final: bool) -> None:
        """Moves what a process made to its place."""
        places = (
            (IMAGE, self._folder.image_path),
            (PREVIEW, self._folder.preview_path),
            (THUMBNAIL, self._folder.thumbnail_path),
        )
        try:
            for name, place_of in places if final else places[1:]:
                with self._in_place(row, place_of, durable=final) as path:
                    (painted.folder / name).replace(path)
        finally:
            painted.remove()

    # --- here ---

    def write_preview(self, render: RunningRender, final: bool = False) -> None:
        compression = FINAL_COMPRESSION if final else LIVE_COMPRESSION
        with self._in_place(render.row, self._folder.preview_path, durable=final) as path:
            write_preview(path, render.film.sums, render.film.counts, compression)

    def write_thumbnail(self, render: RunningRender) -> None:
        with self._in_place(render.row, self._folder.thumbnail_path) as path:
            write_thumbnail(path, render.film.sums, render.film.counts)

    def write_image(self, render: RunningRender) -> None:
        if painted := self._painted.pop(render.id, None):
            self._place_all(render.row, painted, final=True)
            return
        with self._in_place(render.row, self._folder.image_path, durable=True) as path:
            write_image_of(self._folder, render, path)

    @contextmanager
    def _in_place(
        self, row: OpenRender, place_of: Callable[[str], Path], durable: bool = False
    ) -> Iterator[Path]:
        """Where to write a picture that is put into its place only if the render is still ours.

        `durable`: it survives a power cut, for the render's end is reported after it.
        """
        try:
            path = place_of(row.id)
        except NotFound:
            raise LeaseLost(row.id) from None
        longest = _BUSY_S_PER_PIXEL * row.schedule.width * row.schedule.height
        self._alive.busy(_BUSY_S + longest)
        if durable:
            self._ledger.leases.stay(time.time() + longest)
        holding = partial(self._ledger.leases.holding, row.id, row.fence)
        try:
            try:
                make_folders(path)
                with replacing(path, durable, within=holding()) as unfinished:
                    yield unfinished
                if durable:
                    # The render's folder may be new.
                    sync(path.parent.parent)
                    sync(self._folder.root)
            except OSError:
                # The folder of a render goes when it is deleted: that is no trouble of ours.
                with holding():
                    raise
        except LeaseLost:
            # Of a render that was deleted nothing stays behind; a folder with something in it stays.
            with suppress(OSError):
                path.parent.rmdir()
            raise
