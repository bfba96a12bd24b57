"""Brings a database to the newest schema: the numbered files in `migrations/`, in order, each applied once.

A change of the schema is a new file there, `0002_what_it_does.sql`, and for PostgreSQL one with the same
number in `migrations/postgresql`; files that were released stay as they are. The number of the last one
applied is SQLite's `user_version`, or the row of `schema_version`. That is all a migration library would add
here too: the known ones (Alembic, yoyo) bring an ORM, or a separate table for one number.
"""

import sqlite3
from collections.abc import Iterator
from pathlib import Path

from nocturne_coordinator.errors import UnusableFolder

MIGRATIONS = Path(__file__).parent / "migrations"


def newest_schema(folder: Path = MIGRATIONS) -> int:
    """The number of the last migration."""
    return max(_files(folder))


def migrate(connection: sqlite3.Connection, name: str, folder: Path = MIGRATIONS) -> None:
    """Applies missing migrations, to be called inside a transaction: all of it happens, or nothing.

    Raises UnusableFolder if a newer program has written the database, which the message calls `name`.
    """
    for each, text in missing(schema_of(connection), name, folder):
        for statement in _statements(text):
            connection.execute(statement)
        connection.execute(f"PRAGMA user_version = {each}")


def missing(number: int, name: str, folder: Path = MIGRATIONS) -> list[tuple[int, str]]:
    """The migrations after this number, with their text. Raises UnusableFolder, which calls the database
    `name`, where a newer program made that number."""
    files = _files(folder)
    newest = max(files)
    if number > newest:
        raise UnusableFolder(
            f"{name} has schema {number}, and this program knows schemas up to {newest}: a newer program "
            "made it; use that one, or another folder"
        )
    return [(each, files[each].read_text()) for each in sorted(files) if each > number]


def schema_of(connection: sqlite3.Connection) -> int:
    """The number of the last migration that was applied; 0: none."""
    number: int = connection.execute("PRAGMA user_version").fetchone()[0]
    return number


def _files(folder: Path) -> dict[int, Path]:
    return {int(path.name.partition("_")[0]): path for path in folder.glob("*.sql")}


def _statements(text: str) -> Iterator[str]:
    """The statements of a file, each ending with its line; `executescript` would end the transaction."""
    statement = ""
    for line in text.splitlines(keepends=True):
        statement += line
        if sqlite3.complete_statement(statement):
            yield statement
            statement = ""
