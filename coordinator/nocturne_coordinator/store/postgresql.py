"""A data folder's database on a PostgreSQL server: for coordinators and APIs on several machines.

One writes at a time, as in SQLite: every transaction that writes begins by taking one advisory lock, so all
that is written under SQLite's rules holds here too. Readers wait for nobody. A lost connection is made again
by the next call (decision 0190).
"""

import os
import socket
import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import psycopg
from nocturne_scene.errors import NocturneError
from psycopg.types.numeric import Int8Dumper

from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.database import (
    Database,
    DatabaseTrouble,
    DatabaseUnavailable,
    FolderGone,
    FolderLock,
    Row,
    Values,
)
from nocturne_coordinator.store.migrate import MIGRATIONS, missing
from nocturne_coordinator.store.postgresql_values import Number, Words, casefold, numbered, rows_of
from nocturne_coordinator.store.sqlite import check_room, identity

OLDEST_VERSION = 14

_SCHEMA = "nocturne"
_WAIT_SECONDS = 30.0

# Keys of advisory locks; within one database the second number is free for our own.
_FAMILY = 0x6E6F6374
_WRITING, _WORKING, _STARTING = 1, 2, 3

_SETTINGS: dict[str, Any] = {
    "connect_timeout": 10,
    # Where the other machine is gone, both sides notice within half a minute: one that writes blocks others.
    "keepalives_idle": "10",
    "keepalives_interval": "5",
    "keepalives_count": "3",
    "tcp_user_timeout": "20000",
}
_OPTIONS = {
    "search_path": _SCHEMA,
    "client_encoding": "UTF8",
    "tcp_keepalives_idle": "10",
    "tcp_keepalives_interval": "5",
    "tcp_keepalives_count": "3",
    "tcp_user_timeout": "20000",
    # A process that stands still must not keep others from writing.
    "idle_in_transaction_session_timeout": f"{_WAIT_SECONDS:.0f}s",
}


class PostgresTrouble(NocturneError, DatabaseUnavailable):
    """The server does not answer, refuses, or waited too long; it may pass."""


class PostgresFault(DatabaseTrouble):
    """What PostgreSQL refuses, and would again."""


class PostgresDatabase(Database):
    """One connection that writes, shared by the threads of a process under a lock; for readers more."""

    def __init__(self, root: Path, server: str) -> None:
        """`server`: a connection string of libpq. Raises PostgresTrouble, and UnusableFolder if a newer
        program wrote the database, or the server is too old."""
        self._root, self._server = root, server
        self._folder = identity(root)
        self._lock = threading.RLock()
        self._writer = 0
        """The thread that is inside a transaction."""
        self._changed = False
        self._readers: list[psycopg.Connection[Any]] | None = None
        self._wait_seconds = _WAIT_SECONDS
        self._closed = False
        self._connection = self._connect()
        try:
            self._migrate()
        except BaseException:
            self._connection.close()
            raise

    def _connect(self) -> "psycopg.Connection[Any]":
        options = {**_OPTIONS, "lock_timeout": f"{1000 * self._wait_seconds:.0f}"}
        name = f"{Path(sys.argv[0]).name} {os.getpid()} on {socket.gethostname()}"
        with _trouble():
            connection = psycopg.connect(
                self._server,
                autocommit=True,
                row_factory=rows_of,
                cursor_factory=psycopg.RawCursor,
                context=None,
                application_name=name[:63],
                options=" ".join(f"-c {key}={value}" for key, value in options.items()),
                **_SETTINGS,
            )
        for kind, dumper in ((str, Words), (int, Int8Dumper)):
            connection.adapters.register_dumper(kind, dumper)
        connection.adapters.register_loader("numeric", Number)
        return connection

    def _own(self) -> "psycopg.Connection[Any]":
        """The connection that writes; made again where it was lost, but never inside a transaction."""
        if self._connection.closed:
            if self._writer:
                raise PostgresTrouble("the connection to PostgreSQL was lost in mid-transaction")
            if self._closed:
                raise PostgresTrouble("the database is closed")
            self._connection = self._connect()
        return self._connection

    def _migrate(self) -> None:
        version = self._connection.info.server_version // 10000
        if version < OLDEST_VERSION:
            raise UnusableFolder(f"PostgreSQL {version} is too old; it must be {OLDEST_VERSION} or newer")
        if self._connection.info.parameter_status("server_encoding") != "UTF8":
            raise UnusableFolder(
                f"{self._server_name} has another encoding than UTF8; make it anew with that"
            )
        # Two that start at once would both make it.
        with suppress(PostgresFault):
            self._run(f"CREATE SCHEMA IF NOT EXISTS {_SCHEMA}")
        with self.transaction():
            self._run("CREATE TABLE IF NOT EXISTS schema_version (number bigint NOT NULL)")
            row = self.row("SELECT max(number) AS number FROM schema_version")
            number = int(row["number"] or 0) if row is not None else 0
            for each, text in missing(number, self._server_name, MIGRATIONS / "postgresql"):
                if not number:
                    self._run(casefold())
                number = each
                self._run(text)
                self.execute("INSERT INTO schema_version VALUES (?)", (each,))

    def _run(self, text: str) -> None:
        """Several statements without values."""
        _run(self._connection, text.encode())

    @property
    def _server_name(self) -> str:
        info = self._connection.info
        return f"database {info.dbname} on {info.host or 'this machine'}"

    def read_beside(self, wait_seconds: float) -> None:
        self._wait_seconds = wait_seconds
        self._run(f"SET lock_timeout = {int(1000 * wait_seconds)}")
        self._readers = []

    @contextmanager
    def _reading(self, query: str) -> Iterator["psycopg.Connection[Any]"]:
        """Reads in a transaction see its own writes."""
        readers, writes = self._readers, not query.lstrip().startswith("SELECT")
        if readers is None or writes or self._writer == threading.get_ident():
            with self._lock:
                yield self._own()
            return
        try:
            reader = readers.pop()
        except IndexError:
            reader = self._connect()
        try:
            yield reader
        finally:
            if reader.closed or self._closed:
                reader.close()
            else:
                readers.append(reader)

    @contextmanager
    def transaction(self, durable: bool = True) -> Iterator[None]:
        with self._lock:
            self.check_place()
            connection = self._own()
            try:
                _run(connection, _BEGIN[durable])
                self._writer, self._changed = threading.get_ident(), False
                yield
                _run(connection, _COMMIT_CHANGE if self._changed else b"COMMIT")
            except BaseException:
                # A lost connection has rolled it back already; one that waited too long has begun it.
                with suppress(DatabaseTrouble):
                    _run(connection, b"ROLLBACK")
                raise
            finally:
                self._writer = 0

    @contextmanager
    def snapshot(self) -> Iterator[None]:
        with self._lock:
            connection = self._own()
            _run(connection, b"BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY")
            self._writer = threading.get_ident()
            try:
                yield
            finally:
                self._writer = 0
                with suppress(DatabaseTrouble):
                    _run(connection, b"ROLLBACK")

    def execute(self, statement: str, values: Values = ()) -> int:
        with self._writing() as connection:
            changed = connection.execute(numbered(statement), values).rowcount
            self._changed |= changed > 0
            return changed

    def execute_many(self, statement: str, rows: Iterable[Values]) -> None:
        with self._writing() as connection, connection.cursor() as cursor:
            cursor.executemany(numbered(statement), rows)
            self._changed |= cursor.rowcount > 0

    @contextmanager
    def _writing(self) -> Iterator["psycopg.Connection[Any]"]:
        """A transaction of its own where there is none."""
        with self._lock:
            if self._writer:
                with _trouble():
                    yield self._own()
                return
            with self.transaction(), _trouble():
                yield self._connection

    def rows(self, query: str, values: Values = ()) -> list[Row]:
        if _writes(query):
            # A change that gives rows.
            with self._writing() as connection:
                self._changed = True
                return connection.execute(numbered(query), values, binary=True).fetchall()
        with self._reading(query) as connection, _trouble():
            return connection.execute(numbered(query), values, binary=True).fetchall()

    def row(self, query: str, values: Values = ()) -> Row | None:
        found = self.rows(query, values)
        return found[0] if found else None

    def change_counter(self) -> int:
        row = self.row("SELECT number FROM change")
        return int(row["number"]) if row is not None else 0

    def check_writing(self, wait_seconds: float) -> None:
        self.check_place()
        check_room(self._root)
        connection = self._connect()
        try:
            _run(connection, f"SET lock_timeout = {int(1000 * wait_seconds)}".encode())
            _run(connection, _BEGIN[True] + b"; UPDATE change SET number = number; ROLLBACK")
        finally:
            connection.close()

    def check_place(self) -> None:
        try:
            is_here = identity(self._root) == self._folder
        except OSError:
            is_here = False
        if not is_here:
            raise FolderGone(
                f"{self._root} was moved away or replaced while the service works on it; move it back"
            )

    def lock(self) -> FolderLock:
        return _ServerLock(self._connect())

    def close(self) -> None:
        self._closed = True
        with self._lock:
            for each in (*(self._readers or ()), self._connection):
                each.close()


class _ServerLock(FolderLock):
    """Held by a connection of its own: it ends with it."""

    def __init__(self, connection: "psycopg.Connection[Any]") -> None:
        self._connection = connection

    @contextmanager
    def starting(self) -> Iterator[None]:
        self._ask("pg_advisory_lock", _STARTING)
        try:
            yield
        finally:
            self._ask("pg_advisory_unlock", _STARTING)

    def take(self, alone: bool) -> bool:
        name = "pg_try_advisory_lock" if alone else "pg_try_advisory_lock_shared"
        return bool(self._ask(name, _WORKING))

    def share(self) -> None:
        self._ask("pg_advisory_lock_shared", _WORKING)
        self._ask("pg_advisory_unlock", _WORKING)

    def owner(self) -> str:
        with _trouble():
            row = self._connection.execute(
                b"""SELECT application_name FROM pg_locks JOIN pg_stat_activity USING (pid)
                    WHERE locktype = 'advisory' AND classid = $1 AND objid = $2 AND granted""",
                (_FAMILY, _WORKING),
            ).fetchone()
        return str(row["application_name"]) if row else ""

    def close(self) -> None:
        self._connection.close()

    def _ask(self, function: str, key: int) -> Any:
        with _trouble():
            row = self._connection.execute(
                f"SELECT {function}({_FAMILY}, {key}) AS answer".encode()
            ).fetchone()
        return row["answer"] if row else None


_BEGIN = {
    durable: f"""BEGIN; SET LOCAL synchronous_commit = {"on" if durable else "off"};
        SELECT pg_advisory_xact_lock({_FAMILY}, {_WRITING})""".encode()
    for durable in (True, False)
}
_COMMIT_CHANGE = b"UPDATE change SET number = number + 1; COMMIT"


def _run(connection: "psycopg.Connection[Any]", statements: bytes) -> None:
    """One question to the server; several statements can't be prepared."""
    with _trouble():
        connection.execute(statements, prepare=False)


@contextmanager
def _trouble() -> Iterator[None]:
    try:
        yield
    except (psycopg.OperationalError, psycopg.InternalError) as error:
        # Internal ones are of the state: a server that became a copy, a transaction that took too long.
        raise PostgresTrouble(f"PostgreSQL: {str(error).strip() or type(error).__name__}") from error
    except psycopg.Error as error:
        raise PostgresFault(f"PostgreSQL: {error}") from error


def _writes(query: str) -> bool:
    return not query.lstrip().startswith("SELECT")
