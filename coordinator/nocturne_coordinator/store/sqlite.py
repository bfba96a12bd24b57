"""A data folder's database as an SQLite file in it: connection and transactions, for many processes and
threads of one machine."""

import os
import sqlite3
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from urllib.parse import quote

from nocturne_scene.replacing import UNFINISHED

from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.database import Database, FolderGone, FolderLock, Values
from nocturne_coordinator.store.file_lock import FileLock
from nocturne_coordinator.store.migrate import migrate

# A tile is 75 KiB: with pages of 16 KiB it is five of them, not nineteen.
_PAGE_BYTES = 16384
_BUSY_MILLISECONDS = 30_000
_AGAIN_SECONDS = 0.01


class SqliteDatabase(Database):
    """One connection, shared by the threads of a process under a lock; for readers more, where wanted."""

    def __init__(self, path: Path) -> None:
        """Opens or creates the file; UnusableFolder if another version wrote it, or if it is damaged."""
        self._path = path
        self._file: tuple[int, int] | None = None
        self._lock = threading.RLock()
        self._durable: bool | None = None
        self._writer = 0
        """The thread that is inside a transaction."""
        self._readers: list[sqlite3.Connection] | None = None
        """Those that nobody uses just now; None: all read by the one connection."""
        self._counter: sqlite3.Connection | None = None
        self._connection = self._connect()
        try:
            self._prepare(path)
            # One in memory has no file.
            self._file = identity(path) if path.exists() else None
        except BaseException as trouble:
            self._connection.close()
            # An operational error (full, locked, not to be written) passes; any other of SQLite's is damage.
            if not isinstance(trouble, sqlite3.DatabaseError) or isinstance(
                trouble, sqlite3.OperationalError
            ):
                raise
            raise UnusableFolder(
                f"{path} is damaged ({trouble}); stop the service and run nocturne restore"
            ) from trouble

    def _prepare(self, path: Path) -> None:
        # First of all: the statements after it may meet another process that creates the file just now.
        self._connection.execute(f"PRAGMA busy_timeout = {_BUSY_MILLISECONDS}")
        self._connection.execute(f"PRAGMA page_size = {_PAGE_BYTES}")
        self._write_ahead()
        with self.transaction():
            migrate(self._connection, str(path))
        # After an upgrade that remakes tables: dropping the old one must not delete the rows that refer to
        # it.
        self._connection.execute("PRAGMA foreign_keys = ON")

    def _connect(self) -> sqlite3.Connection:
        connection = sqlite3.connect(self._path, isolation_level=None, check_same_thread=False)
        connection.row_factory = sqlite3.Row
        # SQLite's own lower() knows the letters A to Z alone.
        connection.create_function("casefold", 1, str.casefold, deterministic=True)
        return connection

    def read_beside(self, wait_seconds: float) -> None:
        self._connection.execute(f"PRAGMA busy_timeout = {int(1000 * wait_seconds)}")
        self._readers, self._counter = [], self._reader()

    def _reader(self) -> sqlite3.Connection:
        connection = self._connect()
        connection.execute("PRAGMA query_only = ON")
        return connection

    @contextmanager
    def _reading(self, query: str) -> Iterator[sqlite3.Connection]:
        """Reads in a transaction see its own writes."""
        readers, writes = self._readers, not query.lstrip().startswith("SELECT")
        if readers is None or writes or self._writer == threading.get_ident():
            with self._lock:
                yield self._connection
            return
        try:
            reader = readers.pop()
        except IndexError:
            reader = self._reader()
        try:
            yield reader
        finally:
            readers.append(reader)

    def _write_ahead(self) -> None:
        """Changes the journal's mode. Where several do that with a new file at once, SQLite does not wait, as
        each might wait for another."""
        until = time.monotonic() + _BUSY_MILLISECONDS / 1000
        while True:
            try:
                self._connection.execute("PRAGMA journal_mode = WAL")
                return
            except sqlite3.OperationalError as trouble:
                # Only the lower byte: the rest says in which operation it was busy.
                is_busy = trouble.sqlite_errorcode & 0xFF == sqlite3.SQLITE_BUSY
                if not is_busy or time.monotonic() >= until:
                    raise
            time.sleep(_AGAIN_SECONDS)

    @contextmanager
    def transaction(self, durable: bool = True) -> Iterator[None]:
        with self._lock:
            self.check_place()
            self._wait_for_disk(durable)
            self._connection.execute("BEGIN IMMEDIATE")
            self._writer = threading.get_ident()
            try:
                yield
                self._connection.execute("COMMIT")
            except BaseException:
                # A full disk may have rolled it back already.
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise
            finally:
                self._writer = 0

    @contextmanager
    def snapshot(self) -> Iterator[None]:
        with self._lock:
            self._connection.execute("BEGIN")
            try:
                yield
            finally:
                self._connection.execute("ROLLBACK")

    def execute(self, statement: str, values: Values = ()) -> int:
        with self._lock:
            if not self._connection.in_transaction:
                self._wait_for_disk(True)
            return self._connection.execute(statement, values).rowcount

    def execute_many(self, statement: str, rows: Iterable[Values]) -> None:
        with self._lock:
            if not self._connection.in_transaction:
                self._wait_for_disk(True)
            self._connection.executemany(statement, rows)

    def _wait_for_disk(self, durable: bool) -> None:
        """Whether the next commit does; can't be changed inside a transaction."""
        if durable != self._durable:
            self._connection.execute(f"PRAGMA synchronous = {'FULL' if durable else 'NORMAL'}")
            self._durable = durable

    def rows(self, query: str, values: Values = ()) -> list[sqlite3.Row]:
        with self._reading(query) as connection:
            return connection.execute(query, values).fetchall()

    def row(self, query: str, values: Values = ()) -> sqlite3.Row | None:
        with self._reading(query) as connection:
            row: sqlite3.Row | None = connection.execute(query, values).fetchone()
            return row

    def change_counter(self) -> int:
        if self._counter is not None:
            # One that never writes: all changes are others'.
            seen: int = self._counter.execute("PRAGMA data_version").fetchone()[0]
            return seen
        with self._lock:
            by_others: int = self._connection.execute("PRAGMA data_version").fetchone()[0]
            return by_others + self._connection.total_changes

    def check_writing(self, wait_seconds: float) -> None:
        self.check_place()
        check_room(self._path.parent)
        with closing(sqlite3.connect(f"file:{quote(str(self._path))}?mode=rw", uri=True)) as connection:
            connection.isolation_level = None
            connection.execute(f"PRAGMA busy_timeout = {int(1000 * wait_seconds)}")
            connection.execute("BEGIN IMMEDIATE")
            connection.execute("ROLLBACK")

    def check_place(self) -> None:
        if self._file is None:
            return
        try:
            is_here = identity(self._path) == self._file
        except OSError:
            is_here = False
        if not is_here:
            raise FolderGone(
                f"{self._path.parent} was moved away or replaced while the service works on it; move it "
                "back, or start the service again"
            )

    def lock(self) -> FolderLock:
        return FileLock(self._path.parent)

    def close(self) -> None:
        with self._lock:
            for each in (*(self._readers or ()), self._counter, self._connection):
                if each is not None:
                    each.close()


def check_room(folder: Path) -> None:
    """Writes a small file and takes it away; OSError where that can't be done."""
    with tempfile.NamedTemporaryFile(dir=folder, prefix=UNFINISHED) as probe:
        probe.write(bytes(_PAGE_BYTES))
        probe.flush()
        os.fsync(probe.fileno())


def identity(path: Path) -> tuple[int, int]:
    """Tells a file or folder from another one in its place."""
    status = path.stat()
    return status.st_dev, status.st_ino
