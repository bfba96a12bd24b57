"""The pictures of a render as files: small ones are written at once, those of large films by processes."""

import json
import logging
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from nocturne.v1 import job_pb2
from nocturne_scene.errors import NotFound
from nocturne_scene.layers import NO_LAYERS, Layers, read_layers
from nocturne_scene.render_warnings import from_messages
from nocturne_scene.replacing import UNFINISHED
from nocturne_scene.scene_ranges import wavelengths_of

from nocturne_coordinator.dispatch.error_estimate import ErrorEstimate
from nocturne_coordinator.dispatch.records import ErrorPoint
from nocturne_coordinator.dispatch.running_render import RunningRender
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

APART_PIXELS = 2**18
"""The last pictures of larger films are written by processes: the EXR of so many pixels takes 0.4 s."""

IMAGE, PREVIEW, THUMBNAIL = "image.exr", "preview.png", "thumbnail.png"
ANSWER = "answer.json"
"""Of a process: the photons and the error of its pictures."""

_SHORTEST_PAUSE, _LONGEST_PAUSE = 5.0, 300.0
"""Seconds after which pictures that could not be made are tried again: twice as long each time."""

_UNWANTED_SECONDS = 30.0
"""Pictures that nobody asks for any more are thrown away after so long: their render was deleted."""

_log = logging.getLogger(__name__)


class Pauses:
    """Pictures that could not be made are tried again, after longer and longer."""

    def __init__(self) -> None:
        self._next: dict[str, tuple[float, float]] = {}

    def over(self, render_id: str) -> bool:
        """Whether the render's may be tried now."""
        return time.monotonic() >= self._next.get(render_id, (0.0, 0.0))[0]

    def failed(self, render_id: str) -> None:
        """The last try came to nothing."""
        pause = self._next.get(render_id, (0.0, _SHORTEST_PAUSE))[1]
        self._next[render_id] = time.monotonic() + pause, min(2.0 * pause, _LONGEST_PAUSE)

    def worked(self, render_id: str) -> None:
        """The last try did not."""
        self._next.pop(render_id, None)


@dataclass(frozen=True, slots=True)
class Painted:
    """Pictures that a process made; to be moved to their places."""

    folder: Path
    photons: int
    """Of how many photons they are."""
    point: ErrorPoint
    estimate: ErrorEstimate
    cpu_seconds: float

    def remove(self) -> None:
        """Deletes the files that were not moved."""
        shutil.rmtree(self.folder, ignore_errors=True)


@dataclass(slots=True)
class _Running:
    render_id: str
    process: subprocess.Popen[bytes]
    folder: Path
    final: bool
    asked: float


class PictureProcesses:
    """The processes that make pictures: one at a time for each owner."""

    def __init__(self, data: Path, pauses: Pauses) -> None:
        self._data = data
        self._pauses = pauses
        self._running: dict[str, _Running] = {}

    def ask(self, render_id: str, owner: str, photons: int, place: Path, final: bool) -> Painted | None:
        """Pictures of a render, the `final` ones with so many photons; None: they are being made, or will be.
        `place` is where its pictures lie."""
        running = self._running.get(owner)
        if running is not None and running.render_id != render_id:
            if time.monotonic() < running.asked + _UNWANTED_SECONDS:
                return None
            self._end(owner)
            running = None
        if running is not None and running.final != final:
            self._end(owner)
            running = None
        if running is None:
            if self._pauses.over(render_id):
                self._start(render_id, owner, place, final)
            return None
        running.asked = time.monotonic()
        if running.process.poll() is None:
            return None
        del self._running[owner]
        painted = self._result(running)
        if painted is not None and final and painted.photons != photons:
            # More was committed meanwhile.
            painted.remove()
            painted = None
        return painted

    def close(self) -> None:
        """Ends them."""
        for owner in list(self._running):
            self._end(owner)

    def _start(self, render_id: str, owner: str, place: Path, final: bool) -> None:
        place.mkdir(parents=True, exist_ok=True)
        for left in place.glob(f"{UNFINISHED}pictures-*"):
            shutil.rmtree(left, ignore_errors=True)
        folder = Path(tempfile.mkdtemp(prefix=f"{UNFINISHED}pictures-", dir=place))
        program = (sys.executable, "-m", "nocturne_coordinator.output.picture_process")
        process = subprocess.Popen(  # noqa: S603 - a program of our own
            [*program, str(self._data), render_id, str(folder), *(["--final"] if final else [])],
            stdin=subprocess.DEVNULL,
        )
        self._running[owner] = _Running(render_id, process, folder, final, time.monotonic())

    def _result(self, running: _Running) -> Painted | None:
        try:
            told = json.loads((running.folder / ANSWER).read_bytes())
            point, estimate = ErrorPoint(**told["point"]), ErrorEstimate(**told["estimate"])
            painted = Painted(running.folder, told["photons"], point, estimate, told["cpu_seconds"])
            self._pauses.worked(running.render_id)
        except (OSError, ValueError, KeyError, TypeError):
            shutil.rmtree(running.folder, ignore_errors=True)
            self._pauses.failed(running.render_id)
            code = running.process.returncode
            _log.error("render=%s has no pictures yet: their process ended with %d", running.render_id, code)
            return None
        return painted

    def _end(self, owner: str) -> None:
        running = self._running.pop(owner)
        running.process.kill()
        running.process.wait()
        shutil.rmtree(running.folder, ignore_errors=True)


def write_pictures(folder: DataFolder, render: RunningRender, place: Path, final: bool) -> list[Path]:
    """Preview and small picture of all that is merged, and the `final` image, as files of a folder."""
    if final:
        write_image_of(folder, render, place / IMAGE)
    compression = FINAL_COMPRESSION if final else LIVE_COMPRESSION
    write_preview(place / PREVIEW, render.film.sums, render.film.counts, compression)
    write_thumbnail(place / THUMBNAIL, render.film.sums, render.film.counts)
    return [place / name for name in (IMAGE, PREVIEW, THUMBNAIL) if final or name != IMAGE]


def write_image_of(folder: DataFolder, render: RunningRender, path: Path) -> None:
    """The EXR of a render."""
    film, names = render.film, render.planned.schedule.further_responses
    layers = layers_of(folder, render.row.layers_sha256)
    write_image(path, film.sums, film.counts, film.squares, provenance_of(render), names, layers)


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
        render.image_warning,
        render.totals.truncated_paths,
        render.planned.schedule.way,
        from_messages(render.planned.schedule.warnings),
        wavelengths_of(render.planned.schedule),
        render.planned.schedule.instruments,
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
