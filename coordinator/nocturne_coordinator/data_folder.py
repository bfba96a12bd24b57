"""One folder that holds everything worth keeping: renders, committed sums, blobs, images.

    nocturne.db      renders, tiles, workers (SQLite in WAL mode)
    blobs/           scenes and assets by SHA-256
    images/<id>/     preview.png and image.exr of a render
    coordinator.lock held by the coordinator that works on the folder

The API and the coordinator open it at the same time; only the coordinator's `store.ledger` writes sums.
"""

import base64
import hashlib
import json
import secrets
import sqlite3
import time
from dataclasses import fields
from pathlib import Path

from nocturne.v1 import job_pb2

from . import limits
from .blobs import BlobStore
from .errors import Conflict, InputError, NotFound, Problem
from .plan import TileGrid
from .store.database import Database
from .store.rows import ErrorPoint, NewRender, RenderRow, RenderState, WorkerRow

__all__ = ["DataFolder", "ErrorPoint", "NewRender", "RenderRow", "RenderState", "WorkerRow"]

RENDER_COLUMNS = ", ".join(field.name for field in fields(RenderRow))
_WORKER_COLUMNS = ", ".join(field.name for field in fields(WorkerRow))

# SQLite integers are signed 64 bits.
_NEWEST = 2**63 - 1


class DataFolder:
    """Opens, or creates, the folder. Safe for many threads and processes; calls take milliseconds."""

    def __init__(self, path: Path) -> None:
        """Raises UnusableFolder if another version wrote it."""
        self.root = path
        path.mkdir(parents=True, exist_ok=True)
        self.database = Database(path / "nocturne.db")
        self.blobs = BlobStore(path / "blobs")

    def close(self) -> None:
        self.database.close()

    # --- renders ---

    def create_render(self, new: NewRender) -> RenderRow:
        """Queues a render; the same request again gives the render made before.

        Raises InputError for a bad request id or name, Conflict if the id was used with other content.
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
        ranges_planned = TileGrid.of(new.plan).count * len(new.plan.range_ends)
        self.database.execute(
            """INSERT INTO render (id, request_id, request_digest, name, state, width, height, samples,
                   photons_per_sample, scene_sha256, engine, created, ranges_planned, plan, scene_document)
               VALUES (?, ?, ?, ?, 'QUEUED', ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)""",
            (
                render_id,
                new.request_id,
                digest,
                new.name,
                new.width,
                new.height,
                new.samples,
                max(1, new.plan.photons_per_sample),
                new.scene_sha256,
                int(job_pb2.ENGINE_CURRENT),
                time.time(),
                ranges_planned,
                new.plan.SerializeToString(deterministic=True),
                new.scene_document,
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

    def list_renders(self, page_size: int, page_token: str) -> tuple[list[RenderRow], str]:
        """Newest first; the next page's token, empty on the last. A page size of 0 means 50, at most 200.

        Raises InputError for a page token that was not given out, or a negative size.
        """
        if page_size < 0:
            raise InputError.at("page_size", f"is {page_size}; expected 0 to {limits.MAXIMUM_PAGE}")
        size = min(page_size or limits.DEFAULT_PAGE, limits.MAXIMUM_PAGE)
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
               WHERE id = ? AND state IN ('QUEUED', 'RUNNING')""",
            (time.time(), render_id),
        )
        return self.get_render(render_id)

    def scene_document(self, render_id: str) -> str:
        """The JSON that was submitted; raises NotFound."""
        row = self.database.row("SELECT scene_document FROM render WHERE id = ?", (render_id,))
        if row is None:
            raise NotFound(f"there is no render {render_id!r}")
        return str(row["scene_document"])

    def plan(self, render_id: str) -> job_pb2.RenderPlan:
        """Raises NotFound."""
        row = self.database.row("SELECT plan FROM render WHERE id = ?", (render_id,))
        if row is None:
            raise NotFound(f"there is no render {render_id!r}")
        return job_pb2.RenderPlan.FromString(row["plan"])

    def error_history(self, render_id: str) -> list[ErrorPoint]:
        """One point per preview, oldest first; raises NotFound."""
        self.get_render(render_id)
        rows = self.database.rows(
            """SELECT unix_time, photons, samples, relative_error FROM error_point
               WHERE render_id = ? ORDER BY unix_time""",
            (render_id,),
        )
        return [ErrorPoint(**dict(row)) for row in rows]

    # --- images ---

    def preview_path(self, render_id: str) -> Path:
        """The PNG; may not exist yet."""
        return self._images(render_id) / "preview.png"

    def image_path(self, render_id: str) -> Path:
        """The EXR; may not exist yet."""
        return self._images(render_id) / "image.exr"

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

    def change_counter(self) -> int:
        """Another number whenever anything in the folder's database changed; cheap enough to ask often."""
        return self.database.change_counter()


def render_row(row: sqlite3.Row) -> RenderRow:
    """From a row with RENDER_COLUMNS."""
    values = {field.name: row[field.name] for field in fields(RenderRow)}
    values["state"] = RenderState(values["state"])
    values["image_final"] = bool(values["image_final"])
    return RenderRow(**values)


def _new_id() -> str:
    """60 random bits in lower-case letters and digits: can be read aloud and stand in any URL or path."""
    return "r-" + base64.b32encode(secrets.token_bytes(8)).decode().lower()[:12]


def _request_digest(new: NewRender) -> str:
    content = [new.name, new.scene_document, new.width, new.height, new.samples]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _check_texts(new: NewRender) -> None:
    problems = []
    if not 1 <= len(new.request_id) <= limits.MAXIMUM_REQUEST_ID:
        problems.append(Problem("$.request_id", f"expected 1 to {limits.MAXIMUM_REQUEST_ID} characters"))
    if len(new.name) > limits.MAXIMUM_NAME:
        problems.append(Problem("$.name", f"expected at most {limits.MAXIMUM_NAME} characters"))
    if problems:
        raise InputError(problems)


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
