"""Copies of a data folder's database, each whole and provably so, made while the service runs.

    DIR/<number>.db      the database at one moment: renders with schedules, sums and samples of all tiles,
    tokens
    DIR/<number>.json    its SHA-256 and contents; written last, so one that is there is complete
    DIR/blobs/           scenes and assets by SHA-256, unless DIR lies in the data folder itself

The last two are kept: should one be damaged, there is one before it. `restoring.py` reads them.
"""

import fcntl
import hashlib
import json
import logging
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from nocturne.v1 import job_pb2
from nocturne_scene.blobs import BlobStore
from nocturne_scene.ranges import manifest_of
from nocturne_scene.replacing import UNFINISHED, replacing

from nocturne_coordinator.output.images import manifest_text

_log = logging.getLogger(__name__)

CHECKPOINT_SECONDS = 300.0
"""Between two: the work of five minutes is what the loss of a disk costs."""

_KEPT = 2
_SHARE = 0.02
"""Part of all time that may go into checkpoints, as each holds the whole database."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """One that is complete; what its manifest says."""

    number: int
    unix_time: float
    sha256: str
    """Of the database."""
    size_bytes: int
    renders: dict[str, str]
    """By id, the samples of all tiles as in `nocturne:tileSamples`."""

    def database(self, place: Path) -> Path:
        return place / f"{self.number:06}.db"

    def is_whole(self, place: Path) -> bool:
        """Whether the database has every bit that it had."""
        path = self.database(place)
        return path.is_file() and _sha256(path) == self.sha256

    @classmethod
    def read(cls, manifest: Path) -> Self:
        """ValueError if the file is no manifest."""
        content: dict[str, Any] = json.loads(manifest.read_text(encoding="utf-8"))
        try:
            return cls(**content)
        except TypeError as error:
            raise ValueError(f"{manifest} is no manifest of a checkpoint: {error}") from None


def checkpoints(place: Path) -> list[Checkpoint]:
    """All that are complete, newest first; those that can't be read are left out."""
    found = []
    for manifest in place.glob("[0-9]*.json"):
        try:
            found.append(Checkpoint.read(manifest))
        except (OSError, ValueError) as trouble:
            _log.warning("checkpoint %s can't be read: %s", manifest, trouble)
    return sorted(found, key=lambda each: each.number, reverse=True)


class Checkpointer:
    """Makes checkpoints of a data folder while its coordinator runs, without stopping it."""

    def __init__(self, data: Path, place: Path, seconds: float = CHECKPOINT_SECONDS) -> None:
        """`place`: the folder for them, DATA/checkpoints or one on another disk."""
        self._database = data / "nocturne.db"
        self._place = place
        self._seconds = seconds
        inside = place.resolve().is_relative_to(data.resolve())
        if not inside:
            # With the same secrets; a folder that is there already has the rights that somebody gave it.
            place.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._blobs = None if inside else (BlobStore(data / "blobs"), BlobStore(place / "blobs"))
        self._seen: tuple[Any, ...] = ()

    def run(self, stop: threading.Event) -> None:
        """Until `stop`; trouble with the disk is logged, and the next one is due as ever."""
        wait = self._seconds
        while not stop.wait(wait):
            begun = time.monotonic()
            try:
                self.make()
            except (sqlite3.Error, OSError) as trouble:
                _log.error("no checkpoint in %s: %s", self._place, trouble)
            wait = max(self._seconds, (time.monotonic() - begun) / _SHARE)

    def make(self) -> Checkpoint | None:
        """A new checkpoint; None if nothing has changed since the last, or another is being made. Raises
        sqlite3.Error and OSError."""
        with closing(sqlite3.connect(self._database)) as source:
            state = _state(source)
            if state == self._seen:
                return None
            self._place.mkdir(mode=0o700, exist_ok=True)
            with (self._place / "checkpointing.lock").open("w") as lock:
                try:
                    fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    # Another coordinator of the folder makes one just now, under the same number.
                    return None
                # Before the database: the files it refers to are there.
                self._copy_blobs()
                made = self._copy(source)
                self._remove_old()
        self._seen = state
        _log.info("checkpoint %d of %d renders, %d bytes", made.number, len(made.renders), made.size_bytes)
        return made

    def _copy(self, source: sqlite3.Connection) -> Checkpoint:
        before = checkpoints(self._place)
        number = before[0].number + 1 if before else 1
        for left in self._place.glob(f"{UNFINISHED}*"):
            left.unlink()
        database = self._place / f"{number:06}.db"
        with replacing(database, durable=True) as unfinished:
            with closing(sqlite3.connect(unfinished)) as target:
                # All pages in one step: one moment of the database, whoever writes meanwhile.
                source.backup(target, pages=-1)
                # One file, without a separate log.
                target.execute("PRAGMA journal_mode = DELETE")
                renders = dict(_manifests(target))
            made = Checkpoint(number, time.time(), _sha256(unfinished), unfinished.stat().st_size, renders)
        with replacing(database.with_suffix(".json"), durable=True) as unfinished:
            unfinished.write_text(json.dumps(asdict(made), indent=1) + "\n", encoding="utf-8")
        return made

    def _copy_blobs(self) -> None:
        if self._blobs is None:
            return
        here, there = self._blobs
        for sha256 in here.all():
            there.put_file(sha256, here.path(sha256))

    def _remove_old(self) -> None:
        for old in checkpoints(self._place)[_KEPT:]:
            path = old.database(self._place)
            path.with_suffix(".json").unlink(missing_ok=True)
            path.unlink(missing_ok=True)


def _state(source: sqlite3.Connection) -> tuple[Any, ...]:
    """Another one whenever something worth keeping has changed."""
    row: tuple[Any, ...] = source.execute(
        """SELECT (SELECT count(*) FROM render), (SELECT total(sequence) FROM render),
               (SELECT count(*) FROM token), (SELECT total(revoked) FROM token),
               (SELECT total(since) FROM quarantine), (SELECT total(since) FROM drain),
               (SELECT total(enrolled) FROM machine), (SELECT count(*) FROM lease_key),
               (SELECT total(created) FROM webhook), (SELECT max(number) FROM webhook_message),
               (SELECT count(*) FROM upload), (SELECT total(size_bytes) FROM upload),
               (SELECT group_concat(render_id || regions) FROM measured_region),
               (SELECT total(renders) FROM deleted_usage), (SELECT max(number) FROM call)"""
    ).fetchone()
    return row


def _manifests(database: sqlite3.Connection) -> Iterator[tuple[str, str]]:
    for render_id, schedule in database.execute("SELECT id, schedule FROM render ORDER BY number").fetchall():
        rows = database.execute("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
        samples = manifest_of(job_pb2.RangeSchedule.FromString(schedule), map(tuple, rows))
        yield render_id, manifest_text(samples)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
