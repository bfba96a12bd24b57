"""Database migrations: numbered files, each applied once, all or nothing."""

import json
import shutil
import sqlite3
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from threading import Barrier

import pytest
from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.migrate import MIGRATIONS, migrate, newest_schema, schema_of
from nocturne_coordinator.store.sqlite import SqliteDatabase

NEXT = """
-- A column and a trigger: a statement may have others inside.
ALTER TABLE render ADD COLUMN colour TEXT NOT NULL DEFAULT 'grey; or so';
CREATE TRIGGER counts AFTER UPDATE OF name ON render
BEGIN
    UPDATE render SET sequence = sequence + 1 WHERE id = NEW.id;
    UPDATE render SET colour = 'blue' WHERE id = NEW.id;
END;
"""


@pytest.fixture
def old(tmp_path: Path) -> Iterator[sqlite3.Connection]:
    """A database of this program's schema, with a render, as a program of the next schema finds it."""
    DataFolder(tmp_path / "data").close()
    with closing(sqlite3.connect(tmp_path / "data" / "nocturne.db", isolation_level=None)) as connection:
        connection.execute(
            """INSERT INTO render (id, request_id, request_digest, name, state, width, height, samples,
                   scene_sha256, engine, created, ranges_planned, schedule, scene_document)
               VALUES ('r-old', 'a', 'd', 'old', 'CANCELLED', 64, 64, 20, 's', 1, 5.0, 16, x'00', '{}')"""
        )
        yield connection


@pytest.fixture
def migrations(tmp_path: Path) -> Path:
    """Those of this program, and one more."""
    folder = tmp_path / "migrations"
    shutil.copytree(MIGRATIONS, folder)
    (folder / f"{newest_schema() + 1:04}_colour.sql").write_text(NEXT)
    return folder


def upgrade(connection: sqlite3.Connection, folder: Path) -> None:
    """As Database does it."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        migrate(connection, "nocturne.db", folder)
    except BaseException:
        connection.execute("ROLLBACK")
        raise
    connection.execute("COMMIT")


def columns(connection: sqlite3.Connection) -> set[str]:
    return {row[1] for row in connection.execute("PRAGMA table_info(render)")}


def test_numbers_have_no_gaps_and_no_doubles() -> None:
    numbers = sorted(int(path.name[:4]) for path in MIGRATIONS.glob("*.sql"))
    assert numbers == list(range(1, newest_schema() + 1))


def test_a_new_database_gets_them_all(tmp_path: Path, migrations: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "new.db", isolation_level=None)) as connection:
        upgrade(connection, migrations)
        assert schema_of(connection) == newest_schema() + 1
        assert {"id", "colour"} < columns(connection)
        assert connection.execute("SELECT count(*) FROM ownership").fetchone() == (1,)


def test_an_older_one_gets_what_is_missing_and_keeps_its_rows(
    old: sqlite3.Connection, migrations: Path
) -> None:
    upgrade(old, migrations)
    upgrade(old, migrations)
    assert schema_of(old) == newest_schema() + 1
    assert old.execute("SELECT name, colour FROM render").fetchall() == [("old", "grey; or so")]
    old.execute("UPDATE render SET name = 'new'")
    assert old.execute("SELECT colour, sequence FROM render").fetchall() == [("blue", 2)]


UNDONE = {
    15: "ALTER TABLE render DROP COLUMN sensor",
    17: "DROP TABLE blob_use",
    18: "ALTER TABLE render DROP COLUMN unaudited",
    19: "ALTER TABLE machine DROP COLUMN token",
    20: "DROP TRIGGER work_is_counted; DROP TRIGGER end_is_counted; DROP TABLE counted",
    21: """DROP TRIGGER webhook_of_unreachable_target;
        ALTER TABLE render RENAME COLUMN error_warning TO doubt;
        ALTER TABLE render RENAME COLUMN target_unreachable TO out_of_reach;
        ALTER TABLE render RENAME COLUMN unreachable_reported TO out_of_reach_told;
        ALTER TABLE render RENAME COLUMN zero_pixels TO unseen_pixels;
        ALTER TABLE render RENAME COLUMN top_percent_share TO worst_share;
        ALTER TABLE error_point RENAME COLUMN top_percent_share TO worst_share;
        ALTER TABLE webhook_message RENAME COLUMN error_warning TO doubt;
        CREATE TRIGGER webhook_of_render_out_of_reach AFTER UPDATE OF out_of_reach ON render
        BEGIN UPDATE render SET out_of_reach_told = 1 WHERE id = NEW.id; END;""",
    22: "DROP TABLE session;",
}
"""What takes back a migration, where there is anything to take back."""


def back_to(database: sqlite3.Connection, schema: int) -> None:
    for number, statement in UNDONE.items():
        if number > schema:
            database.executescript(statement)
    database.execute(f"PRAGMA user_version = {schema}")


def test_the_sensors_of_older_renders_are_known(old: sqlite3.Connection) -> None:
    back_to(old, 14)
    columns = [row[1] for row in old.execute("PRAGMA table_info(render)")]
    others = ", ".join(
        name for name in columns if name not in ("number", "id", "request_id", "scene_document")
    )
    for number, document in enumerate(['{"sensor": {"type": "panorama"}}', "no document"]):
        old.execute(
            f"INSERT INTO render (id, request_id, scene_document, {others}) "  # noqa: S608
            f"SELECT ?, ?, ?, {others} FROM render WHERE id = 'r-old'",
            (f"r-{number}", f"{number}", document),
        )
    upgrade(old, MIGRATIONS)
    assert old.execute("SELECT sensor FROM render ORDER BY id").fetchall() == [("panorama",), ("",), ("",)]


def test_the_warnings_of_older_renders_get_a_kind(old: sqlite3.Connection) -> None:
    back_to(old, 15)
    before = ['$.surfaces[2].shape: is "open"', "It has no layers: nocturne-trace failed"]
    old.execute("UPDATE render SET warnings = ?", (json.dumps(before),))
    upgrade(old, MIGRATIONS)
    [(kept,)] = old.execute("SELECT warnings FROM render").fetchall()
    assert json.loads(kept) == [
        {"kind": "scene", "sentence": before[0], "parts": []},
        {"kind": "layers", "sentence": before[1], "parts": []},
    ]


def test_it_is_unknown_what_older_renders_use(old: sqlite3.Connection) -> None:
    """An empty digest stands for files that nobody noted: none is removed then."""
    back_to(old, 16)
    upgrade(old, MIGRATIONS)
    assert old.execute("SELECT * FROM blob_use").fetchall() == [("r-old", "")]


def test_two_may_open_a_new_one_at_once(tmp_path: Path) -> None:
    """As API and coordinator do: SQLite told one of six that the database was locked, and did not wait."""
    both = Barrier(2, timeout=30.0)

    def open_all() -> None:
        for number in range(40):
            both.wait()
            SqliteDatabase(tmp_path / f"{number}.db").close()

    with ThreadPoolExecutor(2) as executor:
        for done in [executor.submit(open_all) for _ in range(2)]:
            done.result()


def test_a_newer_one_is_refused_in_a_sentence(old: sqlite3.Connection, migrations: Path) -> None:
    upgrade(old, migrations)
    path = Path(old.execute("PRAGMA database_list").fetchone()[2])
    with pytest.raises(
        UnusableFolder, match=rf"nocturne\.db has schema {newest_schema() + 1}.*a newer program"
    ):
        SqliteDatabase(path)


def test_a_crash_in_the_middle_leaves_the_old_one(old: sqlite3.Connection, migrations: Path) -> None:
    broken = migrations / f"{newest_schema() + 2:04}_broken.sql"
    broken.write_text("ALTER TABLE render DROP COLUMN look_first;\nINSERT INTO nowhere VALUES (1);\n")
    with pytest.raises(sqlite3.OperationalError, match="nowhere"):
        upgrade(old, migrations)
    assert schema_of(old) == newest_schema()
    assert "look_first" in columns(old)
    assert "colour" not in columns(old)
    broken.unlink()
    upgrade(old, migrations)
    assert {"look_first", "colour"} < columns(old)
