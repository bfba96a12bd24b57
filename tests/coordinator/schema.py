"""Tables and columns of the database, by a fresh file: both stores have the same (tests/postgresql)."""

import functools
import tempfile
from contextlib import closing
from pathlib import Path

from nocturne_coordinator.store.sqlite import SqliteDatabase


@functools.cache
def columns_by_table() -> dict[str, list[str]]:
    """Names in the order in which they were made."""
    with tempfile.TemporaryDirectory() as folder, closing(SqliteDatabase(Path(folder) / "new.db")) as new:
        tables = [row["name"] for row in new.rows("SELECT name FROM sqlite_master WHERE type = 'table'")]
        return {
            table: [row["name"] for row in new.rows("SELECT name FROM pragma_table_info(?)", (table,))]
            for table in tables
            if table != "sqlite_sequence"
        }
