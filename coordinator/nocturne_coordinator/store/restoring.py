"""Puts a data folder in order after a disaster: examines it, takes the newest whole checkpoint if need be.

The loss of Redis needs none of this: nothing in it is needed again. This is for a disk that failed, a machine
that is gone, a file that somebody deleted.
"""

import fcntl
import os
import secrets
import shutil
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.replacing import replacing
from nocturne_scene.tile_sums import decode, numbers_in

from nocturne_coordinator.dispatch.planned_render import (
    PlannedRender,
    RejectedResult,
    check_photon_sums,
    check_sums,
)
from nocturne_coordinator.errors import AlreadyOwned, RestoreFailed
from nocturne_coordinator.store.checkpoint import checkpoints
from nocturne_coordinator.store.databases import open_restored, server_of, write_id
from nocturne_coordinator.store.migrate import newest_schema, schema_of
from nocturne_coordinator.store.privacy import make_private


@dataclass(slots=True)
class Restored:
    """Findings and actions of a restoration."""

    database: Path | None = None
    """The checkpoint's that was taken; None: the folder's own is whole."""
    damage: list[str] = field(default_factory=list)
    """Damage of the folder's own database."""
    renders: int = 0
    open_ranges: int = 0
    """Planned and not committed, of renders that go on: the work traced when the service starts."""
    missing: list[str] = field(default_factory=list)
    """Renders that can't go on, with the scene that is nowhere."""


def restore(data: Path, source: Path | None = None) -> Restored:
    """Examines a data folder, and puts the newest whole checkpoint in the place of a damaged database.

    `source`: where the checkpoints are, DATA/checkpoints unless given. A damaged database is kept next to it.
    Nothing that is whole is ever replaced. Raises RestoreFailed, OSError, and AlreadyOwned while a
    coordinator has the folder."""
    place = source or data / "checkpoints"
    if source is not None and not source.is_dir():
        raise RestoreFailed(f"there is no folder {source}")
    if source is None and not data.is_dir():
        raise RestoreFailed(f"there is no data folder {data}; say with --from where its checkpoints are")
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    make_private(data)
    if server_of(data):
        return _on_server(data, source)
    with _only_one(data):
        found = Restored()
        database = data / "nocturne.db"
        found.damage = damage_of(database) if database.exists() else [f"there is no {database}"]
        if found.damage:
            found.database = _take_newest(place, database, found.damage)
        elif source is not None and not source.resolve().is_relative_to(data.resolve()):
            raise RestoreFailed(
                f"{database} is whole; to make use of {source}, give another folder, or move the file away"
            )
        _fetch_blobs(data, place)
        _take_stock(data, found)
    return found


def _on_server(data: Path, source: Path | None) -> Restored:
    """After the server's own backup was brought back: jobs and images made since are not of this database."""
    if source is not None:
        raise RestoreFailed(
            f"the database of {data} is on a server; bring back its backup there, without --from"
        )
    found = Restored()
    with closing(open_restored(data)) as database:
        lock = database.lock()
        with closing(lock):
            if not lock.take(alone=True):
                raise AlreadyOwned(f"a coordinator works on {data}; stop the service first")
            folder = secrets.token_hex(8)
            with database.transaction():
                database.execute("UPDATE ownership SET folder = ?", (folder,))
                database.execute("UPDATE render SET image_final = 0")
            write_id(data, folder)
        rows = database.rows("SELECT id, state, scene_sha256, ranges_planned - ranges_done FROM render")
    _count(data, found, [(row[0], row[1], row[2], row[3]) for row in rows])
    return found


def damage_of(database: Path) -> list[str]:
    """Faults of a database, in words; empty if there are none."""
    try:
        with closing(sqlite3.connect(database)) as connection:
            connection.row_factory = sqlite3.Row
            found = [row[0] for row in connection.execute("PRAGMA integrity_check(5)") if row[0] != "ok"]
            number = schema_of(connection)
            if not found and not 0 < number <= newest_schema():
                found = [f"it has schema {number}; this program knows up to {newest_schema()}"]
            return found or list(_damaged_tiles(connection))
    except sqlite3.Error as damage:
        return [f"{database}: {damage}"]


def _damaged_tiles(connection: sqlite3.Connection) -> Iterator[str]:
    for row in connection.execute("SELECT id, schedule, scene_sha256, engine FROM render").fetchall():
        try:
            schedule = job_pb2.RangeSchedule.FromString(row["schedule"])
            planned = PlannedRender(row["id"], schedule, bytes.fromhex(row["scene_sha256"]), row["engine"])
            for tile in connection.execute("SELECT * FROM tile WHERE render_id = ?", (row["id"],)):
                _check_tile(planned, tile)
        except (DecodeError, ValueError, IndexError, RejectedResult) as damage:
            yield f"render {row['id']}: {damage}"


def _check_tile(planned: PlannedRender, row: sqlite3.Row) -> None:
    """Raises unless the tile's samples are planned and its sums such as samples have."""
    index, samples = row["tile_index"], row["samples"]
    if samples and len(planned.ranges_of(index)):
        planned.ranges_of(index).merged_at(samples)
    if not row["sums"]:
        # Forward photons' own row, or a tile that has not all kinds of photons yet.
        return
    tile = planned.grid.tile(index)
    sums = decode(row["sums"], tile.width, tile.height, planned.further)
    if planned.photon_ranges:
        check_photon_sums(sums, samples)
    # Of a tile from before squares of all quantities were kept, they are not known.
    elif len(row["sums"]) >= 8 * numbers_in(tile.width, tile.height, planned.further):
        check_sums(sums, samples * planned.photons_per_sample, planned.signed)


def _take_newest(place: Path, database: Path, damage: list[str]) -> Path:
    for checkpoint in checkpoints(place):
        path = checkpoint.database(place)
        if not checkpoint.is_whole(place):
            damage.append(f"checkpoint {path} is damaged, or not there")
            continue
        if wrong := damage_of(path):
            damage.extend(f"checkpoint {path}: {each}" for each in wrong)
            continue
        _set_damaged_aside(database)
        with replacing(database, durable=True) as unfinished:
            shutil.copyfile(path, unfinished)
            _make_anew(unfinished)
        return path
    raise RestoreFailed("; ".join([*damage, f"there is no whole checkpoint in {place}"]))


def _set_damaged_aside(database: Path) -> None:
    number = 1
    while (kept := database.with_name(f"damaged-{number}")).exists():
        number += 1
    left = [path for path in database.parent.glob(f"{database.name}*") if path.is_file()]
    if left:
        kept.mkdir()
    for path in left:
        path.replace(kept / path.name)


def _make_anew(database: Path) -> None:
    """The folder is another one from here on: jobs and results that the old one's workers still have in some
    Redis are distinguished by its lease. Images show committed sums, so they are written again."""
    with closing(sqlite3.connect(database)) as connection:
        connection.execute("UPDATE ownership SET folder = ?", (secrets.token_hex(8),))
        connection.execute("UPDATE render SET image_final = 0")
        connection.commit()


def _fetch_blobs(data: Path, place: Path) -> None:
    here = BlobStore(data / "blobs")
    if not (place / "blobs").is_dir():
        return
    there = BlobStore(place / "blobs")
    for sha256 in there.all():
        here.put_file(sha256, there.path(sha256))


def _take_stock(data: Path, found: Restored) -> None:
    with closing(sqlite3.connect(data / "nocturne.db")) as connection:
        rows = connection.execute(
            "SELECT id, state, scene_sha256, ranges_planned - ranges_done FROM render"
        ).fetchall()
    _count(data, found, rows)


def _count(data: Path, found: Restored, rows: Sequence[tuple[str, str, str, int]]) -> None:
    blobs = BlobStore(data / "blobs")
    found.renders = len(rows)
    for render_id, state, scene, open_ranges in rows:
        if state in ("QUEUED", "RUNNING", "PAUSED"):
            found.open_ranges += open_ranges
            if not blobs.is_whole(scene):
                found.missing.append(f"{render_id} (sha256:{scene})")


@contextmanager
def _only_one(data: Path) -> Iterator[None]:
    """Holds the folder as a coordinator does; AlreadyOwned while one has it."""
    lock = os.open(data / "coordinator.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise AlreadyOwned(f"a coordinator works on {data}; stop the service first") from None
    finally:
        os.close(lock)
