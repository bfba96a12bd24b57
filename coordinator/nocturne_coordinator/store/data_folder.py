"""One folder that holds everything worth keeping: renders, committed sums, blobs, images.

    nocturne.db      renders, tiles, workers (SQLite in WAL mode)
    blobs/           scenes and assets by SHA-256
    images/<id>/     preview.png, thumbnail.png and image.exr of a render, failed-tile-<tile>.zip
    checkpoints/     the last two copies of the database (see checkpoint.py)
    coordinator.lock held by the coordinator that works on the folder

The API and the coordinator open it at the same time; only the coordinator's `store.ledger` writes sums.
"""

import base64
import hashlib
import json
import secrets
import sqlite3
import sys
import time
from dataclasses import fields
from pathlib import Path

from nocturne.v1 import job_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import InputError, NotFound, Problem
from nocturne_scene.ranges import TileGrid, extended_schedule

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.profiles import incompatible
from nocturne_coordinator.dispatch.records import ErrorPoint, RenderState, WorkerRow
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import StopConditions, check_tile_samples
from nocturne_coordinator.errors import AmbiguousId, Conflict, FilesGone, UnusableFolder, WrongState
from nocturne_coordinator.store.archive import Archive
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.events import note_worker
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.removals import Removals
from nocturne_coordinator.store.rows import (
    NewRender,
    RatePoint,
    RenderRow,
    TileChange,
    WorkerEvent,
)
from nocturne_coordinator.store.tokens import Tokens
from nocturne_coordinator.store.webhooks import Webhooks

__all__ = ["DataFolder", "ErrorPoint", "NewRender", "RenderRow", "RenderState", "TileChange", "WorkerRow"]

RENDER_COLUMNS = ", ".join(field.name for field in fields(RenderRow))
_WORKER_COLUMNS = ", ".join(field.name for field in fields(WorkerRow))

# SQLite integers are signed 64 bits.
_NEWEST = 2**63 - 1


class DataFolder:
    """Opens, or creates, the folder. Safe for many threads and processes; calls take milliseconds."""

    def __init__(self, path: Path, objects: ObjectStore | None = None) -> None:
        """`objects` keeps blobs too.

        Raises UnusableFolder if another version wrote it, it is damaged, it can't be written, or only
        checkpoints are left.
        """
        self.root = path
        try:
            path.mkdir(parents=True, exist_ok=True)
            if not (path / "nocturne.db").exists() and any((path / "checkpoints").glob("*.json")):
                raise UnusableFolder(f"{path / 'nocturne.db'} is gone; run nocturne restore")
            self.database = Database(path / "nocturne.db")
            self.object_store = objects
            self.blobs = BlobStore(path / "blobs", objects)
        except (OSError, sqlite3.Error) as trouble:
            raise UnusableFolder.because(path, trouble) from trouble
        self.tokens = Tokens(self.database)
        self.archive = Archive(self.database)
        self.webhooks = Webhooks(self.database)
        self.removals = Removals(self.database)

    def close(self) -> None:
        self.database.close()

    # --- renders ---

    def create_render(self, new: NewRender) -> RenderRow:
        """Queues a render; the same request again gives the render made before.

        Raises InputError for a bad request id or name, Conflict if the id was used with other content,
        FilesGone if a file of the scene is not there any more.
        """
        _check_texts(new)
        digest = _request_digest(new)
        with self.database.transaction():
            before = self.database.row(
                "SELECT id, request_digest FROM render WHERE request_id = ?", (new.request_id,)
            )
            if before is None:
                return self.get_render(self._insert(new, digest))
            if before["request_digest"] != digest:
                raise Conflict(f"request_id {new.request_id!r} was used before with other content")
            return self.get_render(before["id"])

    def _insert(self, new: NewRender, digest: str) -> str:
        render_id = _new_id()
        tiles = TileGrid.of(new.schedule).count
        if any(self.blobs.here(sha256) is None for sha256 in new.files):
            raise FilesGone("files of the scene were deleted with another render")
        if new.stop.tile_samples:
            check_tile_samples(new.stop.tile_samples, tiles, new.schedule.range_ends)
        self.database.execute(
            """INSERT INTO render (id, request_id, request_digest, name, state, width, height, samples,
                   photons_per_sample, scene_sha256, engine, created, ranges_planned, schedule,
                   scene_document, stop, priority, owner, tiles, floating_point_profile)
               VALUES (?, ?, ?, ?, 'QUEUED', ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)""",
            (
                render_id,
                new.request_id,
                digest,
                new.name,
                new.width,
                new.height,
                new.samples,
                max(1, new.schedule.photons_per_sample),
                new.scene_sha256,
                int(job_pb2.ENGINE_CURRENT),
                time.time(),
                tiles * len(new.schedule.range_ends),
                new.schedule.SerializeToString(deterministic=True),
                new.scene_document,
                new.stop.to_json(),
                new.priority,
                new.owner,
                tiles,
                new.floating_point_profile,
            ),
        )
        return render_id

    def find_request(self, request_id: str) -> RenderRow | None:
        """The render that this request id made, if there is one."""
        row = self.database.row(f"SELECT {RENDER_COLUMNS} FROM render WHERE request_id = ?", (request_id,))  # noqa: S608
        return None if row is None else render_row(row)

    def get_render(self, render_id: str) -> RenderRow:
        """Raises NotFound."""
        row = self.database.row(f"SELECT {RENDER_COLUMNS} FROM render WHERE id = ?", (render_id,))  # noqa: S608
        if row is None:
            raise NotFound(f"there is no render {render_id!r}")
        return render_row(row)

    def find_render(self, start: str) -> RenderRow:
        """The render with this id, or the one whose id begins so. Raises NotFound, AmbiguousId."""
        # No character of an id comes after the last that there is, so all that begin so lie below it.
        rows = self.database.rows(
            f"SELECT {RENDER_COLUMNS} FROM render WHERE id >= ? AND id < ? ORDER BY id LIMIT ?",  # noqa: S608
            (start, start + chr(sys.maxunicode), limits.IDS_SHOWN + 1),
        )
        if not rows or not start:
            raise NotFound(f"there is no render {start!r}")
        # A whole id comes first of those that begin with it.
        if len(rows) == 1 or rows[0]["id"] == start:
            return render_row(rows[0])
        shown = ", ".join(str(row["id"]) for row in rows[: limits.IDS_SHOWN])
        more = ", and more" if len(rows) > limits.IDS_SHOWN else ""
        raise AmbiguousId(f"more than one render has an id that begins with {start!r}: {shown}{more}")

    def list_renders(self, page_size: int, page_token: str) -> tuple[list[RenderRow], str]:
        """Newest first; the next page's token, empty on the last. A page size of 0 means 50, at most 200.

        Raises InputError for a page token that was not given out, or a negative size.
        """
        if page_size < 0:
            raise InputError.at("page_size", f"is {page_size}; expected 0 to {limits.MAX_PAGE}")
        size = min(page_size or limits.DEFAULT_PAGE, limits.MAX_PAGE)
        rows = self.database.rows(
            f"SELECT number, {RENDER_COLUMNS} FROM render WHERE number < ? ORDER BY number DESC LIMIT ?",  # noqa: S608
            (_decode_page_token(page_token), size + 1),
        )
        token = _encode_page_token(rows[size - 1]["number"]) if len(rows) > size else ""
        return [render_row(row) for row in rows[:size]], token

    def request_cancel(self, render_id: str) -> RenderRow:
        """Cancels the render if it has not ended; sums committed so far stay, later ones are refused.

        Works without a coordinator; one that runs stops the work and writes the final image within a second.
        Raises NotFound.
        """
        self.database.execute(
            """UPDATE render SET state = 'CANCELLED', reason = 'Cancelled by request.', ended = ?,
                   photons_per_second = 0, sequence = sequence + 1
               WHERE id = ? AND state IN ('QUEUED', 'RUNNING', 'PAUSED')""",
            (time.time(), render_id),
        )
        return self.get_render(render_id)

    def request_pause(self, render_id: str) -> RenderRow:
        """No more work on a queued or running render until it is resumed; what is merged is kept.

        Pausing twice is pausing once. Raises NotFound, and WrongState for a render that has ended.
        """
        self._change_state(render_id, "PAUSED", "Paused by request.", ("QUEUED", "RUNNING"))
        return self._now_in(render_id, (RenderState.PAUSED,), "paused")

    def request_resume(self, render_id: str) -> RenderRow:
        """Goes on with a paused render; with a degraded one, by tracing its failed tiles again.

        Resuming twice is resuming once. Raises NotFound, and WrongState for a render in another state.
        """
        with self.database.transaction():
            self.database.execute(
                """DELETE FROM failed_tile WHERE render_id IN
                   (SELECT id FROM render WHERE id = ? AND state = 'DEGRADED')""",
                (render_id,),
            )
            self._change_state(render_id, "QUEUED", "", ("PAUSED", "DEGRADED"))
        return self._now_in(render_id, (RenderState.QUEUED, RenderState.RUNNING), "resumed")

    def request_priority(self, render_id: str, priority: int) -> RenderRow:
        """The render's weight among its owner's. Raises NotFound, and InputError for a wrong priority."""
        check_priority(priority)
        self.database.execute(
            "UPDATE render SET priority = ?, sequence = sequence + 1 WHERE id = ? AND priority <> ?",
            (priority, render_id, priority),
        )
        return self.get_render(render_id)

    def request_look_first(self, render_id: str, region: Region | None) -> RenderRow:
        """Which part of the film gets its samples first; None: all alike. Raises NotFound, InputError."""
        render = self.get_render(render_id)
        if region is not None:
            region.check(render.width, render.height)
        text = region.to_json() if region else ""
        self.database.execute(
            "UPDATE render SET look_first = ?, sequence = sequence + 1 WHERE id = ? AND look_first <> ?",
            (text, render_id, text),
        )
        return self.get_render(render_id)

    def request_extension(self, render_id: str, samples: int, stop: StopConditions) -> RenderRow:
        """More samples, or other conditions, for a render in any state but FAILED; nothing is traced again.

        `samples` is what each pixel is to have in all, at least as many as before; the conditions replace
        those before. Repeating it changes nothing. Raises NotFound, InputError and WrongState.
        """
        with self.database.transaction():
            render = self.get_render(render_id)
            if render.state is RenderState.FAILED:
                raise WrongState(f"{render_id} has failed, and can't be extended: {render.reason}")
            schedule = extended_schedule(self.schedule(render_id), samples)
            if (samples, stop.request()) == (render.samples, render.stop.request()):
                return render
            goes_on = render.state in (RenderState.RUNNING, RenderState.PAUSED)
            self.database.execute("DELETE FROM failed_tile WHERE render_id = ?", (render_id,))
            self.database.execute(
                """UPDATE render SET samples = ?, schedule = ?, stop = ?, ranges_planned = ?, state = ?,
                reason =
                '', ended = 0, image_final = 0, sequence = sequence + 1 WHERE id = ?""",
                (
                    samples,
                    schedule.SerializeToString(deterministic=True),
                    stop.to_json(),
                    TileGrid.of(schedule).count * len(schedule.range_ends),
                    render.state.value if goes_on else "QUEUED",
                    render_id,
                ),
            )
        return self.get_render(render_id)

    def _change_state(self, render_id: str, to: str, reason: str, of: tuple[str, ...]) -> None:
        """Ends what predicts, as nothing runs in any state that people ask for."""
        marks = ", ".join("?" * len(of))
        self.database.execute(
            f"""UPDATE render SET state = ?, reason = ?, ended = 0, image_final = 0, photons_per_second = 0,
                    predicted_end = 0, sequence = sequence + 1 WHERE id = ? AND state IN ({marks})""",  # noqa: S608
            (to, reason, render_id, *of),
        )

    def _now_in(self, render_id: str, states: tuple[RenderState, ...], what: str) -> RenderRow:
        render = self.get_render(render_id)
        if render.state not in states:
            raise WrongState(f"{render_id} is {render.state} and can't be {what}")
        return render

    def create_replay(self, render_id: str, request_id: str, owner: str = "") -> RenderRow:
        """A render of the same scene and schedule, with the samples that each tile has now, by workers of the
        same floating-point profile: it gives the same bits.

        Raises NotFound, WrongState where there are no samples, and Conflict.
        """
        original = self.get_render(render_id)
        manifest = self.manifest(render_id)
        if not any(manifest):
            raise WrongState(f"{render_id} has no samples yet")
        return self.create_render(
            NewRender(
                request_id=request_id,
                name=f"{original.name[: limits.MAX_NAME - 10]} (replay)",
                scene_sha256=original.scene_sha256,
                scene_document=self.scene_document(render_id),
                width=original.width,
                height=original.height,
                samples=original.samples,
                schedule=self.schedule(render_id),
                stop=StopConditions(tile_samples=manifest),
                owner=owner,
                floating_point_profile=original.floating_point_profile,
            )
        )

    def manifest(self, render_id: str) -> tuple[int, ...]:
        """Committed samples of each tile, row by row; raises NotFound."""
        count = TileGrid.of(self.schedule(render_id)).count
        rows = self.database.rows("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
        samples = {row["tile_index"]: row["samples"] for row in rows}
        return tuple(samples.get(index, 0) for index in range(count))

    def scene_document(self, render_id: str) -> str:
        """The JSON that was submitted; raises NotFound."""
        row = self.database.row("SELECT scene_document FROM render WHERE id = ?", (render_id,))
        if row is None:
            raise NotFound(f"there is no render {render_id!r}")
        return str(row["scene_document"])

    def schedule(self, render_id: str) -> job_pb2.RangeSchedule:
        """Raises NotFound."""
        row = self.database.row("SELECT schedule FROM render WHERE id = ?", (render_id,))
        if row is None:
            raise NotFound(f"there is no render {render_id!r}")
        return job_pb2.RangeSchedule.FromString(row["schedule"])

    def error_history(self, render_id: str) -> list[ErrorPoint]:
        """One point per preview, oldest first; raises NotFound."""
        self.get_render(render_id)
        rows = self.database.rows(
            """SELECT unix_time, photons, samples, relative_error, worst_share, effective_pixels
               FROM error_point WHERE render_id = ? ORDER BY unix_time""",
            (render_id,),
        )
        return [ErrorPoint(**dict(row)) for row in rows]

    # --- tiles ---

    def changed_tiles(self, render_id: str, since: tuple[int, int], limit: int) -> list[TileChange]:
        """Tiles whose (revision, index) is above `since`, in that order, at most `limit`.

        Asking again with the last one's gives the rest: a tile that changes meanwhile comes once more, later.
        """
        rows = self.database.rows(
            """SELECT tile_index, revision, samples, invalid_samples FROM tile
               WHERE render_id = ? AND (revision, tile_index) > (?, ?)
               ORDER BY revision, tile_index LIMIT ?""",
            (render_id, *since, limit),
        )
        return [TileChange(**dict(row)) for row in rows]

    def tile_sums(self, render_id: str, since: tuple[int, int], limit: int) -> list[tuple[TileChange, bytes]]:
        """The same tiles with their sums, float64, little endian, row by row."""
        rows = self.database.rows(
            """SELECT tile_index, revision, samples, invalid_samples, sums FROM tile
               WHERE render_id = ? AND (revision, tile_index) > (?, ?)
               ORDER BY revision, tile_index LIMIT ?""",
            (render_id, *since, limit),
        )
        return [
            (
                TileChange(row["tile_index"], row["revision"], row["samples"], row["invalid_samples"]),
                row["sums"],
            )
            for row in rows
        ]

    # --- images ---

    def preview_path(self, render_id: str) -> Path:
        """The PNG; may not exist yet."""
        return self._images(render_id) / "preview.png"

    def thumbnail_path(self, render_id: str) -> Path:
        """The small PNG; may not exist yet."""
        return self._images(render_id) / "thumbnail.png"

    def image_path(self, render_id: str) -> Path:
        """The EXR; may not exist yet."""
        return self._images(render_id) / "image.exr"

    def bundle_path(self, render_id: str, tile_index: int) -> Path:
        """What is needed to see again why a tile failed; may not exist."""
        return self._images(render_id) / f"failed-tile-{tile_index}.zip"

    def _images(self, render_id: str) -> Path:
        # The id becomes part of a path: only one that this folder gave out may.
        self.get_render(render_id)
        return self.root / "images" / render_id

    # --- workers, changes ---

    def workers(self) -> list[WorkerRow]:
        """Workers heard of in the last ten seconds, by name."""
        rows = self.database.rows(
            f"SELECT {_WORKER_COLUMNS} FROM worker WHERE seen > ? ORDER BY id",  # noqa: S608
            (time.time() - limits.WORKER_SECONDS,),
        )
        return [WorkerRow(**dict(row)) for row in rows]

    def incompatible_workers(self) -> dict[str, str]:
        """Workers that get no jobs though they are not in quarantine, and why."""
        renders = self.database.rows(
            "SELECT DISTINCT floating_point_profile FROM render WHERE state IN ('QUEUED', 'RUNNING')"
        )
        classes = [row["floating_point_profile"] for row in renders]
        return incompatible(self.workers(), self.workers_in_quarantine(), classes)

    def count_by_state(self) -> dict[str, int]:
        """How many renders there are in each state that any is in."""
        rows = self.database.rows("SELECT state, count(*) AS renders FROM render GROUP BY state")
        return {row["state"]: row["renders"] for row in rows}

    def backlog(self) -> int:
        """Ranges of queued and running renders that are not merged."""
        row = self.database.row(
            "SELECT sum(ranges_planned - ranges_done) AS open FROM render "
            "WHERE state IN ('QUEUED', 'RUNNING')"
        )
        return int(row["open"] or 0) if row is not None else 0

    def spent(self) -> tuple[int, float]:
        """Photons merged and processor seconds, of all renders."""
        row = self.database.row("SELECT sum(photons) AS photons, sum(cpu_seconds) AS cpu FROM render")
        return (int(row["photons"] or 0), float(row["cpu"] or 0.0)) if row is not None else (0, 0.0)

    def count_running(self) -> int:
        """Renders that are being worked on."""
        row = self.database.row("SELECT count(*) AS running FROM render WHERE state = 'RUNNING'")
        return 0 if row is None else int(row["running"])

    def workers_in_quarantine(self) -> dict[str, str]:
        """Workers whose results are not taken, and why."""
        rows = self.database.rows("SELECT worker_id, reason FROM quarantine ORDER BY since")
        return {row["worker_id"]: row["reason"] for row in rows}

    def release_worker(self, worker_id: str) -> None:
        """Takes a worker's results again; raises NotFound where it is not in quarantine."""
        with self.database.transaction():
            if not self.database.execute("DELETE FROM quarantine WHERE worker_id = ?", (worker_id,)):
                raise NotFound(f"no worker {worker_id!r} is in quarantine")
            note_worker(self.database, time.time(), worker_id, "released", "")

    def at_work(self, render_id: str) -> list[tuple[int, str]]:
        """Tiles of a render that are being traced, and by whom."""
        rows = self.database.rows(
            "SELECT tile_index, worker_id FROM at_work WHERE render_id = ? ORDER BY tile_index", (render_id,)
        )
        return [(row["tile_index"], row["worker_id"]) for row in rows]

    def worker_history(self, events: int) -> tuple[list[WorkerEvent], list[RatePoint]]:
        """The last of what happened to workers, newest first; and what all of them did, oldest first."""
        happened = self.database.rows(
            "SELECT unix_time, worker_id, what, reason FROM worker_event ORDER BY number DESC LIMIT ?",
            (events,),
        )
        rates = self.database.rows("SELECT * FROM rate_point ORDER BY unix_time")
        return [WorkerEvent(**dict(row)) for row in happened], [RatePoint(**dict(row)) for row in rates]

    def meters(self) -> dict[str, float]:
        """What the coordinators last counted and measured, by name: of several, the sum, or what fits."""
        together = {"coordinator_seen": max, "folder_trouble": max, "worker_threads": max}
        together |= {"job_seconds": max, "result_seconds": max, "redis_in_step": min}
        values: dict[str, list[float]] = {}
        for row in self.database.rows("SELECT name, value FROM meter"):
            values.setdefault(row["name"], []).append(row["value"])
        return {name: float(together.get(name, sum)(found)) for name, found in values.items()}

    def record_call(
        self, who: str, what: str, render_id: str, request_id: str, outcome: str, keep: int
    ) -> None:
        """One more line of who changed what; the last `keep` are kept."""
        with self.database.transaction():
            self.database.execute(
                "INSERT INTO call (unix_time, who, what, render_id, request_id, outcome) "
                "VALUES (?, ?, ?, ?, ?, ?)",
                (time.time(), who, what, render_id, request_id, outcome),
            )
            self.database.execute(
                "DELETE FROM call WHERE number <= (SELECT max(number) FROM call) - ?", (keep,)
            )

    def calls(self, limit: int) -> list[dict[str, object]]:
        """The last calls that changed something, newest first."""
        rows = self.database.rows("SELECT * FROM call ORDER BY number DESC LIMIT ?", (limit,))
        return [dict(row) for row in rows]

    def change_counter(self) -> int:
        """Another number whenever anything in the folder's database changed; cheap enough to ask often."""
        return self.database.change_counter()


def render_row(row: sqlite3.Row) -> RenderRow:
    """From a row with RENDER_COLUMNS."""
    values = {field.name: row[field.name] for field in fields(RenderRow)}
    values["state"] = RenderState(values["state"])
    values["image_final"] = bool(values["image_final"])
    values["stop"] = StopConditions.from_json(values["stop"])
    return RenderRow(**values)


def _new_id() -> str:
    """60 random bits in lower-case letters and digits: can be read aloud and stand in any URL or path."""
    return "r-" + base64.b32encode(secrets.token_bytes(8)).decode().lower()[:12]


def _request_digest(new: NewRender) -> str:
    content: list[object] = [new.name, new.scene_document, new.width, new.height, new.samples]
    if new.stop.request() or new.priority != limits.DEFAULT_PRIORITY:
        content += [new.stop.request(), new.priority]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _check_texts(new: NewRender) -> None:
    problems = []
    if not 1 <= len(new.request_id) <= limits.MAX_REQUEST_ID:
        problems.append(Problem("$.request_id", f"expected 1 to {limits.MAX_REQUEST_ID} characters"))
    if len(new.name) > limits.MAX_NAME:
        problems.append(Problem("$.name", f"expected at most {limits.MAX_NAME} characters"))
    if problems:
        raise InputError(problems)
    check_priority(new.priority)


def check_priority(priority: int) -> None:
    """Raises InputError for one that can't be."""
    if not 1 <= priority <= limits.MAX_PRIORITY:
        raise InputError.at("$.priority", f"is {priority}; expected 1 to {limits.MAX_PRIORITY}")


def _encode_page_token(number: int) -> str:
    return base64.urlsafe_b64encode(number.to_bytes(8, "big")).decode()


def _decode_page_token(token: str) -> int:
    """The render number that the page starts below."""
    if not token:
        return _NEWEST
    try:
        number = int.from_bytes(base64.b64decode(token, altchars=b"-_", validate=True), "big")
    except ValueError:
        number = 0
    if not 0 < number <= _NEWEST:
        raise InputError.at("page_token", "was not given out by this service")
    return number
