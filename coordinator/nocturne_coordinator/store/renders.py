"""Renders: making them, finding them, and their requested settings.

Long: all of one table, which one transaction may touch.
"""

import base64
import hashlib
import json
import re
import secrets
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2
from nocturne_scene.errors import InputError, NotFound, Problem
from nocturne_scene.ranges import TileGrid, ranges_planned
from nocturne_scene.render_warnings import RenderWarning
from nocturne_scene.scene_ranges import wavelengths_of
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange
from nocturne_scene.tile_sums import numbers_in

from nocturne_coordinator import limits
from nocturne_coordinator.dispatch.job_cost import USUAL_COST
from nocturne_coordinator.dispatch.records import ErrorPoint, RenderState
from nocturne_coordinator.dispatch.stopping import StopConditions, check_tile_samples
from nocturne_coordinator.errors import AmbiguousId, BlobsMissing, Conflict
from nocturne_coordinator.store.blob_use import BlobUse
from nocturne_coordinator.store.database import Database, Row
from nocturne_coordinator.store.groups import WAITS
from nocturne_coordinator.store.layers import layers_bytes
from nocturne_coordinator.store.quotas import NO_QUOTA, Quota, check_quota
from nocturne_coordinator.store.rows import NewRender, RenderRow
from nocturne_coordinator.store.tags import SEARCHED, TAGGED, words_of

# Columns that have another name than the field.
_SELECTED = {
    "effective_pixels": "effective_pixels AS effective_pixels",
    "wavelengths": "schedule AS wavelengths",
}
_COLUMNS = ", ".join(_SELECTED.get(field.name, field.name) for field in fields(RenderRow))

_ASSET = re.compile(r"sha256:([0-9a-f]{64})")

# SQLite integers are signed 64 bits.
_NEWEST = 2**63 - 1

# X, Y, Z and their errors, three correlations, nine of blocks and tiles, R, G, B, samples: 4 bytes each.
_EXR_CHANNELS = 22


class Renders:
    """The renders of a data folder."""

    def __init__(self, database: Database, blob_here: Callable[[str], Path | None]) -> None:
        """`blob_here` gives the file of a blob, None where it is not on this machine."""
        self._database = database
        self._blob_use = BlobUse(database)
        self._blob_here = blob_here

    def create(self, new: NewRender, quota: Quota = NO_QUOTA) -> RenderRow:
        """As `create_all`, of one render."""
        return self.create_all([new], quota)[0]

    def create_all(self, news: Sequence[NewRender], quota: Quota = NO_QUOTA) -> list[RenderRow]:
        """Queues an owner's renders, all or none; the same requests again give the renders made before.

        Raises InputError for a bad request id or name, Conflict if the owner used an id with other content,
        BlobsMissing if a file of a scene is not there any more, QuotaUsedUp if the owner would have too much.
        """
        for new in news:
            _check_texts(new)
        with self._database.transaction():
            before = [self._made_before(new) for new in news]
            made = [known or self._insert(new) for known, new in zip(before, news, strict=True)]
            if None in before:
                check_quota(self._database, news[0].owner, quota)
            return [self.get(render_id) for render_id in made]

    def _made_before(self, new: NewRender) -> str | None:
        before = self._database.row(
            "SELECT id, request_digest FROM render WHERE owner = ? AND request_id = ?",
            (new.owner, new.request_id),
        )
        if before is not None and before["request_digest"] != _request_digest(new):
            raise Conflict(f"request_id {new.request_id!r} was used before with other content")
        return None if before is None else str(before["id"])

    def _insert(self, new: NewRender) -> str:
        render_id = _new_id()
        tiles = TileGrid.of(new.schedule).count
        if any(self._blob_here(sha256) is None for sha256 in new.files):
            raise BlobsMissing("files of the scene were deleted with another render")
        if new.stop.tile_samples:
            check_tile_samples(new.stop.tile_samples, new.schedule)
        self._database.execute(
            """INSERT INTO render (id, request_id, request_digest, name, state, width, height, samples,
                   photons_per_sample, scene_sha256, engine, created, ranges_planned, schedule,
                   scene_document, stop, priority, owner, tiles, floating_point_profile, quantity,
                   warnings, way, sensor, layers, layers_sha256, in_group, after_group, tags, stored_bytes)
               VALUES (?, ?, ?, ?, 'QUEUED', ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?,
                   ?, ?, ?, ?, ?)""",
            (
                render_id,
                new.request_id,
                _request_digest(new),
                new.name,
                new.width,
                new.height,
                new.samples,
                max(1, new.schedule.photons_per_sample),
                new.scene_sha256,
                int(job_pb2.ENGINE_CURRENT),
                time.time(),
                ranges_planned(new.schedule),
                new.schedule.SerializeToString(deterministic=True),
                new.scene_document,
                new.stop.to_json(),
                new.priority,
                new.owner,
                tiles,
                new.floating_point_profile,
                new.schedule.quantity,
                json.dumps([each.to_json() for each in new.warnings]),
                new.way,
                new.sensor,
                json.dumps(new.all_layers),
                new.layers_sha256,
                new.in_group,
                new.after_group,
                json.dumps(new.tags, ensure_ascii=False),
                self._bytes_of(new),
            ),
        )
        named = _ASSET.findall(new.scene_document)
        used = {new.scene_sha256, new.layers_sha256, *new.files, *named} - {""}
        self._blob_use.note(render_id, used.union(new.further_files))
        return render_id

    def _bytes_of(self, new: NewRender) -> int:
        """The disk space of the render when it is done: sums, image, scene and its files, and layers,
        which are in a separate file and in the image."""
        further = len(new.schedule.further_responses)
        # Forward photons in separate ranges have sums, too, and both together.
        sums = 8 * numbers_in(new.width, new.height, further) * (3 if new.schedule.photon_range_ends else 1)
        sums += 8 * new.width * new.height * new.schedule.coefficients
        layers = 2 * layers_bytes(new.width, new.height, new.all_layers)
        image = 4 * new.width * new.height * (_EXR_CHANNELS + 2 * further)
        files = (self._blob_here(sha256) for sha256 in new.files)
        here = sum(file.stat().st_size for file in files if file is not None)
        return sums + image + layers + len(new.scene_document) + here

    def find_request(self, owner: str, request_id: str) -> RenderRow | None:
        """The render that the owner made with this request id, if there is one."""
        row = self._database.row(
            f"SELECT {_COLUMNS} FROM render WHERE owner = ? AND request_id = ?",  # noqa: S608
            (owner, request_id),
        )
        return None if row is None else _render_row(row)

    def get(self, render_id: str) -> RenderRow:
        """Raises NotFound."""
        return _render_row(self._row(render_id, _COLUMNS))

    def _row(self, render_id: str, columns: str) -> Row:
        row = self._database.row(f"SELECT {columns} FROM render WHERE id = ?", (render_id,))  # noqa: S608
        if row is None:
            raise NotFound(f"there is no render {render_id!r}")
        return row

    def find(self, start: str, owner: str | None = None) -> RenderRow:
        """The render with this id, or the one whose id begins so; of one owner only, or of all.

        Raises NotFound, AmbiguousId.
        """
        # No character of an id comes after the last that there is, so all that begin so lie below it.
        rows = self._database.rows(
            f"""SELECT {_COLUMNS} FROM render WHERE id >= ?1 AND id < ?2 AND owner = coalesce(?3, owner)
                ORDER BY id LIMIT ?4""",  # noqa: S608
            (start, start + chr(sys.maxunicode), owner, limits.IDS_SHOWN + 1),
        )
        if not rows or not start:
            raise NotFound(f"there is no render {start!r}")
        # A whole id comes first of those that begin with it.
        if len(rows) == 1 or rows[0]["id"] == start:
            return _render_row(rows[0])
        shown = ", ".join(str(row["id"]) for row in rows[: limits.IDS_SHOWN])
        more = ", and more" if len(rows) > limits.IDS_SHOWN else ""
        raise AmbiguousId(f"more than one render has an id that begins with {start!r}: {shown}{more}")

    def page(
        self,
        page_size: int,
        page_token: str,
        owner: str | None = None,
        group: str = "",
        tag: str = "",
        search: str = "",
    ) -> tuple[list[RenderRow], str]:
        """Newest first, of one owner or of all; only those of a group, with a tag, or with all words of a
        search, where these are given. The next page's token, empty on the last.

        A page size of 0 means 50, at most 200 come.

        Raises InputError for a page token that was not given out, or a negative size.
        """
        if page_size < 0:
            raise InputError.at("page_size", f"is {page_size}; expected 0 to {limits.MAX_PAGE}")
        size = min(page_size or limits.DEFAULT_PAGE, limits.MAX_PAGE)
        asked = [
            *([("owner = ?", owner)] if owner is not None else []),
            *([("in_group = ?", group)] if group else []),
            *([(TAGGED, tag)] if tag else []),
            *((SEARCHED, word) for word in words_of(search)),
        ]
        conditions = "".join(f"{condition} AND " for condition, _ in asked)
        rows = self._database.rows(
            f"""SELECT number, {_COLUMNS} FROM render WHERE {conditions} number < ?
                ORDER BY number DESC LIMIT ?""",  # noqa: S608
            (*(value for _, value in asked), _decode_page_token(page_token), size + 1),
        )
        token = _encode_page_token(rows[size - 1]["number"]) if len(rows) > size else ""
        return [_render_row(row) for row in rows[:size]], token

    def baselines(self, render_id: str, owner: str | None = None) -> list[RenderRow]:
        """Renders of the same scene document and film by other engines that have ended with an image: the
        newest of each, newest engine first; of one owner or of all. Raises NotFound."""
        render = self.get(render_id)
        rows = self._database.rows(
            f"""SELECT {_COLUMNS} FROM render WHERE width = ? AND height = ? AND engine <> ?
                    AND state IN ('SUCCEEDED', 'STOPPED_EARLY') AND owner = coalesce(?4, owner)
                    AND scene_document = (SELECT scene_document FROM render WHERE id = ?5)
                ORDER BY number""",  # noqa: S608
            (render.width, render.height, render.engine, owner, render_id),
        )
        newest = {row["engine"]: _render_row(row) for row in rows}
        return [newest[engine] for engine in sorted(newest, reverse=True)]

    def scene_document(self, render_id: str) -> str:
        """The JSON that was submitted; raises NotFound."""
        return str(self._row(render_id, "scene_document")["scene_document"])

    def engine(self, render_id: str) -> int:
        """Version of the tracing engine that the render was made for; raises NotFound."""
        return int(self._row(render_id, "engine")["engine"])

    def schedule(self, render_id: str) -> job_pb2.RangeSchedule:
        """Raises NotFound."""
        return job_pb2.RangeSchedule.FromString(self._row(render_id, "schedule")["schedule"])

    def error_history(self, render_id: str) -> list[ErrorPoint]:
        """One point per preview, oldest first; raises NotFound."""
        self.get(render_id)
        rows = self._database.rows(
            """SELECT unix_time, photons, samples, relative_error, top_percent_share,
                   effective_pixels AS effective_pixels
               FROM error_point WHERE render_id = ? ORDER BY unix_time""",
            (render_id,),
        )
        return [ErrorPoint(**dict(row)) for row in rows]

    def count_by_state(self) -> dict[str, int]:
        """How many renders there are in each state that any is in."""
        rows = self._database.rows("SELECT state, count(*) AS renders FROM render GROUP BY state")
        return {row["state"]: row["renders"] for row in rows}

    def count_running(self) -> int:
        """Renders that are being worked on."""
        row = self._database.row("SELECT count(*) AS running FROM render WHERE state = 'RUNNING'")
        return 0 if row is None else int(row["running"])

    def backlog(self) -> int:
        """Ranges of queued and running renders that are not merged."""
        row = self._database.row(
            "SELECT sum(ranges_planned - ranges_done) AS open FROM render "
            "WHERE state IN ('QUEUED', 'RUNNING')"
        )
        return int(row["open"] or 0) if row is not None else 0

    def open_cpu_seconds(self) -> float:
        """Processor seconds that queued and running renders should still need, but for those that wait for
        others: by their forecast, or by what a sample cost so far in all renders. One each at least, so that
        no render that took longer than forecast is left without a worker."""
        counted = self.counted()
        known = counted["samples"] and counted["cpu_seconds"] / counted["samples"]
        row = self._database.row(
            f"""SELECT sum(max(1.0, iif(predicted_cpu_seconds > 0.0, predicted_cpu_seconds - cpu_seconds,
                    iif(?1 > 0.0, ?1, ?2 * photons_per_sample)
                    * (1.0 * width * height * samples - 1.0 * photons / photons_per_sample)))) AS open
                FROM render WHERE state IN ('QUEUED', 'RUNNING') AND NOT ({WAITS})""",  # noqa: S608
            (known, USUAL_COST),
        )
        return float(row["open"] or 0.0) if row is not None else 0.0

    def counted(self) -> dict[str, float]:
        """All work that was ever merged, and ends of renders by state, those deleted or traced again
        included."""
        rows = self._database.rows("SELECT name, value FROM counted")
        return {row["name"]: row["value"] for row in rows}


def _render_row(row: Row) -> RenderRow:
    """From a row with _COLUMNS."""
    values = {field.name: row[field.name] for field in fields(RenderRow)}
    values["state"] = RenderState(values["state"])
    values["image_final"] = bool(values["image_final"])
    values["warnings"] = tuple(map(RenderWarning.from_json, json.loads(values["warnings"])))
    values["layers"] = tuple(json.loads(values["layers"]))
    values["tags"] = tuple(json.loads(values["tags"]))
    values["stop"] = StopConditions.from_json(values["stop"])
    values["wavelengths"] = _wavelengths(values["wavelengths"])
    return RenderRow(**values)


def _wavelengths(schedule: bytes) -> WavelengthRange:
    """Of a schedule's scene; the usual ones where it can't be read, which others say more clearly."""
    try:
        return wavelengths_of(job_pb2.RangeSchedule.FromString(schedule))
    except DecodeError:
        return VISIBLE


def _new_id() -> str:
    """60 random bits in lower-case letters and digits: can be read aloud and stand in any URL or path."""
    return "r-" + base64.b32encode(secrets.token_bytes(8)).decode().lower()[:12]


def _request_digest(new: NewRender) -> str:
    content: list[object] = [new.name, new.scene_document, new.width, new.height, new.samples]
    if new.stop.request() or new.priority != limits.DEFAULT_PRIORITY:
        content += [new.stop.request(), new.priority]
    if new.layers:
        content.append(["layers", *new.layers])
    if new.in_group or new.after_group:
        content.append(["group", new.in_group, new.after_group])
    if new.tags:
        content.append(["tags", *new.tags])
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
