"""Previews, images and bundles in the data folder."""

import json
import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from nocturne.v1 import job_pb2
from nocturne_scene.errors import NotFound
from nocturne_scene.layers import NO_LAYERS, Layers, read_layers
from nocturne_scene.render_warnings import from_messages
from nocturne_scene.replacing import replacing, sync

from nocturne_coordinator.dispatch.records import FailedTile
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
from nocturne_coordinator.sign_of_life import SignOfLife
from nocturne_coordinator.store.bundle import write_bundle
from nocturne_coordinator.store.data_folder import DataFolder, make_folders
from nocturne_coordinator.store.ledger import Ledger

_BUSY_S, _BUSY_S_PER_PIXEL = 60.0, 2e-5
"""What a picture may take: over ten times the processor time of the last EXR, 1.6e-6 s a pixel, for there
may be many other processes and a slow disk."""

_log = logging.getLogger(__name__)


class Previews:
    """Writes images for people; shows committed samples only, so no picture goes back.

    All methods raise LeaseLost where another coordinator has the render.
    """

    def __init__(self, folder: DataFolder, ledger: Ledger, alive: SignOfLife | None = None) -> None:
        """`alive` is notified of work that takes long."""
        self._alive = alive or SignOfLife()
        self._folder = folder
        self._ledger = ledger

    def write_bundle(self, render: RunningRender, failed: FailedTile) -> None:
        """What reproduces the failure of a tile; OSError, NotFound."""
        write_bundle(self._folder, render.planned, failed)

    def finish_ended(self, unix_time: float) -> None:
        """Final images of renders that were cancelled or failed, from committed sums."""
        for waiting in self._ledger.renders.ended_without_image():
            row = self._ledger.renders.take(waiting.id)
            if row is None:
                continue
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

    def write_preview(self, render: RunningRender, final: bool = False) -> None:
        compression = FINAL_COMPRESSION if final else LIVE_COMPRESSION
        with self._in_place(render, self._folder.preview_path, durable=final) as path:
            write_preview(path, render.film.sums, render.film.counts, compression)

    def write_thumbnail(self, render: RunningRender) -> None:
        with self._in_place(render, self._folder.thumbnail_path) as path:
            write_thumbnail(path, render.film.sums, render.film.counts)

    def write_image(self, render: RunningRender) -> None:
        names = render.planned.schedule.further_responses
        with self._in_place(render, self._folder.image_path, durable=True) as path:
            film = render.film
            layers = layers_of(self._folder, render.row.layers_sha256)
            write_image(path, film.sums, film.counts, film.squares, provenance_of(render), names, layers)

    @contextmanager
    def _in_place(
        self, render: RunningRender, place_of: Callable[[str], Path], durable: bool = False
    ) -> Iterator[Path]:
        """Where to write a picture that is put into its place only if the render is still ours.

        `durable`: it survives a power cut, for the render's end is reported after it.
        """
        try:
            path = place_of(render.id)
        except NotFound:
            raise LeaseLost(render.id) from None
        longest = _BUSY_S_PER_PIXEL * render.film.counts.size
        self._alive.busy(_BUSY_S + longest)
        if durable:
            self._ledger.leases.stay(time.time() + longest)
        holding = partial(self._ledger.leases.holding, render.id, render.row.fence)
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


def layers_of(folder: DataFolder, sha256: str) -> Layers:
    """Those of a render; none where it has none, or where their file is gone: the image does without."""
    if not sha256:
        return NO_LAYERS
    try:
        return read_layers(folder.blobs.path(sha256))
    except (NotFound, OSError) as error:
        _log.warning("layers=%s are left out of an image: %s", sha256, error)
        return NO_LAYERS


def provenance_of(render: RunningRender) -> Provenance:
    """What the render's image says of itself."""
    samples = render.film.manifest()
    planned = render.planned
    whole = samples == [planned.ranges_of(index).end for index in range(planned.queues)]
    return Provenance(
        render.planned.scene.hex(),
        schedule_json(render.planned.schedule),
        render.planned.engine,
        "" if whole else manifest_text(samples),
        render.floating_point_profile,
        render.planned.schedule.quantity,
        render.image_doubt,
        render.totals.truncated_paths,
        render.planned.schedule.way,
        from_messages(render.planned.schedule.warnings),
    )


def schedule_json(schedule: job_pb2.RangeSchedule) -> str:
    """The schedule in proto3 JSON, one line, in one fixed spelling: it is part of canonical files."""
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
    if schedule.photon_range_ends:
        content["photonRangeEnds"] = list(schedule.photon_range_ends)
    return json.dumps(content, separators=(",", ":"))
