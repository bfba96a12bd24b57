"""The SQLite file of a data folder: schema, connection, transactions. For many processes and threads."""

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from nocturne_coordinator.errors import UnusableFolder

SCHEMA_NUMBER = 6

# A tile is 32 KiB: with pages of 16 KiB it is two or three of them, not nine.
_PAGE_BYTES = 16384
_BUSY_MILLISECONDS = 30_000

_STATES = "'QUEUED', 'RUNNING', 'PAUSED', 'SUCCEEDED', 'STOPPED_EARLY', 'DEGRADED', 'FAILED', 'CANCELLED'"

_RENDER_TABLE = f"""
CREATE TABLE render (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    request_id TEXT NOT NULL UNIQUE,
    request_digest TEXT NOT NULL,
    name TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ({_STATES})),
    reason TEXT NOT NULL DEFAULT '',
    width INTEGER NOT NULL,
    height INTEGER NOT NULL,
    samples INTEGER NOT NULL,
    photons_per_sample INTEGER NOT NULL DEFAULT 1,
    scene_sha256 TEXT NOT NULL,
    engine INTEGER NOT NULL,
    sequence INTEGER NOT NULL DEFAULT 1,
    created REAL NOT NULL,
    started REAL NOT NULL DEFAULT 0,
    ended REAL NOT NULL DEFAULT 0,
    ranges_done INTEGER NOT NULL DEFAULT 0,
    ranges_planned INTEGER NOT NULL,
    photons INTEGER NOT NULL DEFAULT 0,
    rays INTEGER NOT NULL DEFAULT 0,
    invalid_samples INTEGER NOT NULL DEFAULT 0,
    relative_error REAL NOT NULL DEFAULT 0,
    photons_per_second REAL NOT NULL DEFAULT 0,
    cpu_seconds REAL NOT NULL DEFAULT 0,
    image_final INTEGER NOT NULL DEFAULT 0 CHECK (image_final IN (0, 1)),
    schedule BLOB NOT NULL,
    scene_document TEXT NOT NULL,
    -- JSON of StopConditions.
    stop TEXT NOT NULL DEFAULT '{{}}',
    priority INTEGER NOT NULL DEFAULT 100,
    owner TEXT NOT NULL DEFAULT '',
    ran_seconds REAL NOT NULL DEFAULT 0,
    tiles INTEGER NOT NULL DEFAULT 0,
    tiles_done INTEGER NOT NULL DEFAULT 0,
    tiles_failed INTEGER NOT NULL DEFAULT 0,
    audited INTEGER NOT NULL DEFAULT 0,
    refused INTEGER NOT NULL DEFAULT 0,
    predicted_end REAL NOT NULL DEFAULT 0,
    predicted_cpu_seconds REAL NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX render_open ON render (state) WHERE state IN ('QUEUED', 'RUNNING') OR image_final = 0;
"""

_NEW_IN_3 = """
-- Tiles that get no more samples, because this range failed on several workers.
CREATE TABLE failed_tile (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    first_sample INTEGER NOT NULL,
    end_sample INTEGER NOT NULL,
    reason TEXT NOT NULL,
    workers TEXT NOT NULL,
    PRIMARY KEY (render_id, tile_index)
) STRICT;

-- Whose work is in a tile's sums.
CREATE TABLE contribution (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    worker_id TEXT NOT NULL,
    PRIMARY KEY (render_id, tile_index, worker_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX contribution_of_worker ON contribution (worker_id);

-- Workers whose results are not taken any more.
CREATE TABLE quarantine (
    worker_id TEXT PRIMARY KEY,
    reason TEXT NOT NULL,
    since REAL NOT NULL
) STRICT;

CREATE TABLE token (
    name TEXT PRIMARY KEY,
    -- SHA-256 of the secret, which is 256 random bits: nothing to guess, so no slow hash.
    sha256 TEXT NOT NULL UNIQUE,
    scopes TEXT NOT NULL,
    weight INTEGER NOT NULL DEFAULT 100,
    created REAL NOT NULL,
    revoked REAL NOT NULL DEFAULT 0
) STRICT;

-- Who changed what.
CREATE TABLE call (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    unix_time REAL NOT NULL,
    who TEXT NOT NULL,
    what TEXT NOT NULL,
    render_id TEXT NOT NULL,
    request_id TEXT NOT NULL,
    outcome TEXT NOT NULL
) STRICT;
"""

_NEW_IN_4 = """
-- Coordinators that are at work, until a unix time that they put off again and again.
CREATE TABLE coordinator (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    until REAL NOT NULL
) STRICT;

-- Which coordinator works on a render. The fence grows whenever somebody takes it, or changes its sums from
-- outside; only who knows the newest may write.
CREATE TABLE lease (
    render_id TEXT PRIMARY KEY REFERENCES render (id) ON DELETE CASCADE,
    coordinator INTEGER NOT NULL,
    fence INTEGER NOT NULL
) STRICT;

-- What coordinators count and measure, for the API to show.
DROP TABLE IF EXISTS meter;
CREATE TABLE meter (
    coordinator INTEGER NOT NULL,
    name TEXT NOT NULL,
    value REAL NOT NULL,
    PRIMARY KEY (coordinator, name)
) STRICT, WITHOUT ROWID;
"""

_TABLES_BESIDE = """
-- Sums of X, Y, Z, Y squared and further responses per pixel over samples [0, samples), float64 little
-- endian, row by row.
CREATE TABLE tile (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    samples INTEGER NOT NULL,
    sums BLOB NOT NULL,
    PRIMARY KEY (render_id, tile_index)
) STRICT;

CREATE TABLE error_point (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    unix_time REAL NOT NULL,
    photons INTEGER NOT NULL,
    samples REAL NOT NULL,
    relative_error REAL NOT NULL
) STRICT;
CREATE INDEX error_point_of_render ON error_point (render_id, unix_time);

CREATE TABLE worker (
    id TEXT PRIMARY KEY,
    engine INTEGER NOT NULL,
    threads INTEGER NOT NULL,
    photons INTEGER NOT NULL,
    rays INTEGER NOT NULL,
    photons_per_second REAL NOT NULL,
    jobs_done INTEGER NOT NULL,
    started REAL NOT NULL,
    seen REAL NOT NULL
) STRICT;

-- Increased whenever a coordinator finds no other one; each commit checks that it is still its own.
CREATE TABLE ownership (
    only_row INTEGER PRIMARY KEY CHECK (only_row = 1),
    epoch INTEGER NOT NULL,
    -- Tells one data folder from another, where both are on one Redis by mistake.
    folder TEXT NOT NULL DEFAULT ''
) STRICT;
INSERT INTO ownership VALUES (1, 0, lower(hex(randomblob(8))));
"""


_NEW_IN_5 = """
-- A commit gives its tiles the render's sequence as their revision: what is above one changed since it.
ALTER TABLE tile ADD COLUMN revision INTEGER NOT NULL DEFAULT 0;
ALTER TABLE tile ADD COLUMN invalid_samples INTEGER NOT NULL DEFAULT 0;
CREATE INDEX tile_by_revision ON tile (render_id, revision, tile_index);

-- How the variance is spread over pixels: see coordinator/nocturne_coordinator/output/images.py, Spread.
ALTER TABLE error_point ADD COLUMN worst_share REAL NOT NULL DEFAULT 0;
ALTER TABLE error_point ADD COLUMN effective_pixels REAL NOT NULL DEFAULT 0;
ALTER TABLE render ADD COLUMN worst_share REAL NOT NULL DEFAULT 0;
ALTER TABLE render ADD COLUMN effective_pixels REAL NOT NULL DEFAULT 0;

-- JSON of Region: which part of the film gets its samples first.
ALTER TABLE render ADD COLUMN look_first TEXT NOT NULL DEFAULT '';

-- Who traces what just now, as each coordinator sees it of its own renders.
CREATE TABLE at_work (
    coordinator INTEGER NOT NULL,
    render_id TEXT NOT NULL,
    tile_index INTEGER NOT NULL,
    worker_id TEXT NOT NULL,
    PRIMARY KEY (coordinator, render_id, tile_index, worker_id)
) STRICT, WITHOUT ROWID;

-- Workers that joined, left, or were put in quarantine.
CREATE TABLE worker_event (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    unix_time REAL NOT NULL,
    worker_id TEXT NOT NULL,
    what TEXT NOT NULL,
    reason TEXT NOT NULL
) STRICT;

-- What all workers together did, minute by minute.
CREATE TABLE rate_point (
    unix_time REAL PRIMARY KEY,
    threads INTEGER NOT NULL,
    photons_per_second REAL NOT NULL
) STRICT;
"""

_NEW_IN_6 = """
-- How the workers of a render round; empty before its first result.
ALTER TABLE render ADD COLUMN floating_point_profile TEXT NOT NULL DEFAULT '';
ALTER TABLE worker ADD COLUMN floating_point_profile TEXT NOT NULL DEFAULT 'unknown';
"""


class Database:
    """One connection, shared by the threads of a process under a lock."""

    def __init__(self, path: Path) -> None:
        """Opens or creates the file; UnusableFolder if another version wrote it, or if it is damaged."""
        self._lock = threading.RLock()
        self._connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        try:
            self._prepare(path)
        except sqlite3.DatabaseError as trouble:
            self._connection.close()
            # Full, locked, not to be written: that passes.
            if isinstance(trouble, sqlite3.OperationalError):
                raise
            raise UnusableFolder(
                f"{path} is damaged ({trouble}); stop the service and run nocturne restore"
            ) from trouble

    def _prepare(self, path: Path) -> None:
        self._connection.row_factory = sqlite3.Row
        # First of all: the statements after it may meet another process that creates the file just now.
        self._connection.execute(f"PRAGMA busy_timeout = {_BUSY_MILLISECONDS}")
        self._connection.execute(f"PRAGMA page_size = {_PAGE_BYTES}")
        self._connection.execute("PRAGMA journal_mode = WAL")
        # A commit lost with the machine's power is only work to be done again; no promise hangs on it.
        self._connection.execute("PRAGMA synchronous = NORMAL")
        self._create_or_check(path)
        # After an upgrade that makes tables anew: dropping the old one must not delete the rows that refer to
        # it.
        self._connection.execute("PRAGMA foreign_keys = ON")

    def _create_or_check(self, path: Path) -> None:
        with self.transaction():
            number = self._connection.execute("PRAGMA user_version").fetchone()[0]
            if number == 0:
                self._execute_all(
                    _RENDER_TABLE + _TABLES_BESIDE + _NEW_IN_3 + _NEW_IN_4 + _NEW_IN_5 + _NEW_IN_6
                )
                number = SCHEMA_NUMBER
            if number == 1:
                self._execute_all(
                    "ALTER TABLE render ADD COLUMN photons_per_sample INTEGER NOT NULL DEFAULT 1"
                )
                number = 2
            if number == 2:
                self._upgrade_to_3()
                number = 3
            if number == 3:
                self._execute_all(_NEW_IN_4)
                number = 4
            if number == 4:
                self._execute_all(_NEW_IN_5)
                number = 5
            if number == 5:
                self._execute_all(_NEW_IN_6)
                number = 6
            if number == SCHEMA_NUMBER:
                self._connection.execute(f"PRAGMA user_version = {number}")
            if number != SCHEMA_NUMBER:
                raise UnusableFolder(
                    f"{path} has schema {number}, this program writes schema {SCHEMA_NUMBER}; "
                    "use the program that made it, or another folder"
                )

    def _upgrade_to_3(self) -> None:
        """New columns and tables; the table of renders anew, as SQLite can't change which states it
        allows."""
        columns = ", ".join(row["name"] for row in self._connection.execute("PRAGMA table_info(render)"))
        self._execute_all(f"""
            CREATE TEMP TABLE before AS SELECT {columns} FROM main.render;
            DROP TABLE main.render;
            {_RENDER_TABLE};
            INSERT INTO main.render ({columns}) SELECT {columns} FROM before;
            DROP TABLE before;
            {_NEW_IN_3};
            ALTER TABLE ownership ADD COLUMN folder TEXT NOT NULL DEFAULT '';
            UPDATE ownership SET folder = lower(hex(randomblob(8)));
            """)  # noqa: S608 - the columns are our own

    def _execute_all(self, statements: str) -> None:
        for statement in statements.split(";\n"):
            self._connection.execute(statement)

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Everything executed inside happens, or nothing does; other processes can't write meanwhile."""
        with self._lock:
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._connection.execute("COMMIT")
            except BaseException:
                # A full disk may have rolled it back already.
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise

    def execute(self, statement: str, values: tuple[Any, ...] | dict[str, Any] = ()) -> int:
        """Executes one statement; gives the number of rows it changed."""
        with self._lock:
            return self._connection.execute(statement, values).rowcount

    def execute_many(self, statement: str, rows: list[tuple[Any, ...]]) -> None:
        """Executes one statement for each row of values."""
        with self._lock:
            self._connection.executemany(statement, rows)

    def rows(self, query: str, values: tuple[Any, ...] = ()) -> list[sqlite3.Row]:
        with self._lock:
            return self._connection.execute(query, values).fetchall()

    def row(self, query: str, values: tuple[Any, ...] = ()) -> sqlite3.Row | None:
        """The first row, if there is any."""
        with self._lock:
            row: sqlite3.Row | None = self._connection.execute(query, values).fetchone()
            return row

    def change_counter(self) -> int:
        """Grows whenever any connection of any process commits a change. Microseconds."""
        with self._lock:
            by_others: int = self._connection.execute("PRAGMA data_version").fetchone()[0]
            return by_others + self._connection.total_changes

    def close(self) -> None:
        with self._lock:
            self._connection.close()
