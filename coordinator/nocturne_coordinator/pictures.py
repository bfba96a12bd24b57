"""Previews and images in the data folder, never more often than they are worth."""

import logging
import time
from collections.abc import Callable, Iterable

from .data_folder import DataFolder
from .images import FINAL_COMPRESSION, LIVE_COMPRESSION, write_image, write_preview
from .running_render import RunningRender
from .store.ledger import Ledger

_log = logging.getLogger(__name__)

_PREVIEW_SECONDS = 1.0
_PREVIEW_SHARE = 0.01
_FIRST_IMAGE_SECONDS = 10.0
_IMAGE_SECONDS = 60.0
_IMAGE_SHARE = 0.003
"""Shortest time between two, and the part of all time that may go into them. An EXR costs ten previews."""


class Pictures:
    """Writes what people look at; shows committed samples only, so no picture goes back."""

    def __init__(self, folder: DataFolder, ledger: Ledger) -> None:
        self._folder = folder
        self._ledger = ledger

    def refresh(self, renders: Iterable[RunningRender]) -> None:
        """Previews and images that are due, of renders with new samples; to be called after a commit."""
        for render in renders:
            if render.totals.photons == render.pictured_photons:
                continue
            now = time.monotonic()
            render.next_image = render.next_image or now + _FIRST_IMAGE_SECONDS
            if now >= render.next_preview:
                took = _time_of(lambda render=render: self._preview(render))  # type: ignore[misc]
                render.next_preview = now + max(_PREVIEW_SECONDS, took / _PREVIEW_SHARE)
            if now >= render.next_image:
                took = _time_of(lambda render=render: self._image(render))  # type: ignore[misc]
                render.next_image = now + max(_IMAGE_SECONDS, took / _IMAGE_SHARE)

    def finish(self, render: RunningRender) -> None:
        """The last preview and image of a render, of all that is committed."""
        self._image(render)
        self._preview(render, FINAL_COMPRESSION)

    def finish_ended(self) -> None:
        """Final images of renders that were cancelled or failed, from what was committed."""
        for row in self._ledger.ended_without_image():
            try:
                render = RunningRender(row, self._ledger.tiles(row.id))
            except ValueError as error:
                _log.error("render=%s has no image: %s", row.id, error)
            else:
                if render.totals.ranges:
                    self.finish(render)
            self._ledger.images_written(row.id)

    def _preview(self, render: RunningRender, compression: int = LIVE_COMPRESSION) -> None:
        path = self._folder.preview_path(render.id)
        write_preview(path, render.film.sums, render.film.counts, compression)
        point, in_history = render.error_point(time.time())
        self._ledger.record_preview(render.id, point, in_history)
        render.pictured_photons = point.photons

    def _image(self, render: RunningRender) -> None:
        path = self._folder.image_path(render.id)
        names = render.planned.plan.further_responses
        write_image(path, render.film.sums, render.film.counts, render.provenance(), names)


def _time_of(work: Callable[[], None]) -> float:
    """Seconds."""
    begun = time.monotonic()
    work()
    return time.monotonic() - begun
