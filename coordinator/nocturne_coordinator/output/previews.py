"""Previews and images in the data folder, never more often than they are worth."""

import json
import logging
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from nocturne.v1 import job_pb2
from nocturne_scene.errors import NotFound

from nocturne_coordinator.dispatch.running_render import RunningRender
from nocturne_coordinator.errors import LeaseLost
from nocturne_coordinator.output.images import (
    FINAL_COMPRESSION,
    LIVE_COMPRESSION,
    Provenance,
    manifest_text,
    write_image,
    write_preview,
    write_thumbnail,
)
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger

_log = logging.getLogger(__name__)

_PREVIEW_SECONDS = 1.0
_PREVIEW_SHARE = 0.01
_FIRST_IMAGE_SECONDS = 10.0
_IMAGE_SECONDS = 60.0
_IMAGE_SHARE = 0.003
"""Shortest time between two, and the part of all time that may go into them. An EXR costs ten previews."""


class Previews:
    """Writes what people look at; shows committed samples only, so no picture goes back.

    All methods raise LeaseLost where another coordinator has the render.
    """

    def __init__(self, folder: DataFolder, ledger: Ledger) -> None:
        self._folder = folder
        self._ledger = ledger

    def refresh(self, renders: Iterable[RunningRender]) -> None:
        """Previews that are due and one image, of renders with new samples; to be called after a commit.

        Results wait meanwhile: for six images of a million pixels in a row, that would be seconds.
        """
        images = []
        for render in renders:
            if render.totals.photons == render.pictured_photons:
                continue
            now = time.monotonic()
            render.next_image = render.next_image or now + _FIRST_IMAGE_SECONDS
            if now >= render.next_preview:
                took = _time_of(lambda render=render: self._preview(render))  # type: ignore[misc]
                render.next_preview = now + max(_PREVIEW_SECONDS, took / _PREVIEW_SHARE)
            if now >= render.next_figures:
                took = _time_of(lambda render=render: self._figures(render))  # type: ignore[misc]
                render.next_figures = now + max(_PREVIEW_SECONDS, took / _PREVIEW_SHARE)
            if now >= render.next_image:
                images.append(render)
        if images:
            longest = min(images, key=lambda render: render.next_image)
            now = time.monotonic()
            took = _time_of(lambda: self._image(longest))
            longest.next_image = now + max(_IMAGE_SECONDS, took / _IMAGE_SHARE)

    def finish(self, render: RunningRender) -> None:
        """The last preview and image of a render, of all that is committed."""
        self._image(render)
        self._preview(render, FINAL_COMPRESSION)
        self._figures(render)

    def finish_ended(self) -> None:
        """Final images of renders that were cancelled or failed, from what was committed."""
        for waiting in self._ledger.ended_without_image():
            row = self._ledger.take(waiting.id)
            if row is None:
                continue
            try:
                render = RunningRender(row, self._ledger.tiles(row.id))
            except ValueError as error:
                _log.error("render=%s has no image: %s", row.id, error)
            else:
                if render.totals.ranges:
                    self.finish(render)
            self._ledger.images_written(row.id, row.fence)
            self._ledger.let_go(row.id, row.fence)

    def _preview(self, render: RunningRender, compression: int = LIVE_COMPRESSION) -> None:
        with self._in_place(render, self._folder.preview_path) as path:
            write_preview(path, render.film.sums, render.film.counts, compression)

    def _figures(self, render: RunningRender) -> None:
        """The error and a small picture, which cost less than a preview; tells watchers of all of them."""
        with self._in_place(render, self._folder.thumbnail_path) as path:
            write_thumbnail(path, render.film.sums, render.film.counts)
        point, in_history = render.error_point(time.time())
        self._ledger.record_preview(render.id, render.row.fence, point, in_history)
        render.pictured_photons = point.photons

    def _image(self, render: RunningRender) -> None:
        names = render.planned.schedule.further_responses
        with self._in_place(render, self._folder.image_path) as path:
            write_image(path, render.film.sums, render.film.counts, provenance_of(render), names)

    @contextmanager
    def _in_place(self, render: RunningRender, place_of: Callable[[str], Path]) -> Iterator[Path]:
        """Where to write a picture that is put into its place only if the render is still ours."""
        try:
            path = place_of(render.id)
        except NotFound:
            raise LeaseLost(render.id) from None
        written = path.with_name(f".{render.row.fence}-{path.name}")
        try:
            try:
                yield written
            except OSError:
                # The folder of a render goes when it is deleted: that is no trouble of ours.
                with self._ledger.holding(render.id, render.row.fence):
                    raise
            with self._ledger.holding(render.id, render.row.fence):
                written.replace(path)
        except LeaseLost:
            written.unlink(missing_ok=True)
            # Of a render that was deleted nothing stays behind; a folder with something in it stays.
            with suppress(OSError):
                path.parent.rmdir()
            raise
        finally:
            written.unlink(missing_ok=True)


def provenance_of(render: RunningRender) -> Provenance:
    """What the render's image says of itself."""
    samples = render.film.manifest()
    whole = all(each == render.planned.schedule.range_ends[-1] for each in samples)
    return Provenance(
        render.planned.scene.hex(),
        schedule_json(render.planned.schedule),
        render.planned.engine,
        "" if whole else manifest_text(samples),
        render.floating_point_profile,
    )


def schedule_json(schedule: job_pb2.RangeSchedule) -> str:
    """The schedule in proto3 JSON, one line, in one spelling for ever: it is part of canonical files."""
    content: dict[str, int | list[int] | list[str]] = {
        "width": schedule.width,
        "height": schedule.height,
        "tileSize": schedule.tile_size,
        "rangeEnds": list(schedule.range_ends),
    }
    if schedule.further_responses:
        content["furtherResponses"] = list(schedule.further_responses)
    if schedule.photons_per_sample:
        content["photonsPerSample"] = schedule.photons_per_sample
    return json.dumps(content, separators=(",", ":"))


def _time_of(work: Callable[[], None]) -> float:
    """Seconds."""
    begun = time.monotonic()
    work()
    return time.monotonic() - begun
