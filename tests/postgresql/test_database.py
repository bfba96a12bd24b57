"""A data folder's database on a real PostgreSQL server has the schema and the rules of SQLite's file."""

import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import psycopg
import pytest
from nocturne_coordinator.errors import AlreadyOwned, OwnershipLost, UnusableFolder
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.database import Database, DatabaseUnavailable
from nocturne_coordinator.store.databases import open_database, put_on_server
from nocturne_coordinator.store.migrate import MIGRATIONS, newest_schema
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.restoring import restore
from nocturne_coordinator.store.sqlite import SqliteDatabase

from tests.postgresql.server import PostgresServer

pytestmark = pytest.mark.postgresql


@pytest.fixture
def root(tmp_path: Path, postgres: PostgresServer) -> Path:
    """A data folder on the server."""
    data = tmp_path / "data"
    data.mkdir()
    put_on_server(data, postgres.make())
    return data


@pytest.fixture
def database(root: Path) -> Iterator[Database]:
    with closing(open_database(root)) as database:
        yield database


def test_both_have_the_same_columns_and_indexes(tmp_path: Path, database: Database) -> None:
    kinds = {"TEXT": "text", "INTEGER": "bigint", "REAL": "double precision", "BLOB": "bytea"}
    with closing(SqliteDatabase(tmp_path / "nocturne.db")) as ours:
        tables = [row["name"] for row in ours.rows("SELECT name FROM sqlite_master WHERE type = 'table'")]
        wanted = {
            table: [
                (row["name"], kinds[row["type"]], bool(row["notnull"] or row["pk"]))
                for row in ours.rows("SELECT * FROM pragma_table_info(?)", (table,))
            ]
            for table in tables
            if table != "sqlite_sequence"
        }
        made_by_us = "SELECT name FROM sqlite_master WHERE sql IS NOT NULL AND type = ?"
        indexes, triggers = (
            {row["name"] for row in ours.rows(made_by_us, (kind,))} for kind in ("index", "trigger")
        )
    found: dict[str, list[tuple[str, str, bool]]] = {}
    for row in database.rows(
        """SELECT table_name, column_name, data_type, is_nullable FROM information_schema.columns
           WHERE table_schema = 'nocturne' ORDER BY table_name, ordinal_position"""
    ):
        column = (row["column_name"], row["data_type"], row["is_nullable"] == "NO")
        found.setdefault(row["table_name"], []).append(column)
    assert {"change", "schema_version"} == found.keys() - wanted.keys()
    assert {table: found[table] for table in wanted} == wanted
    there = {row[0] for row in database.rows("SELECT indexname FROM pg_indexes")}
    assert indexes - there == set()
    made = {row[0] for row in database.rows("SELECT tgname FROM pg_trigger WHERE NOT tgisinternal")}
    assert made == triggers


def test_each_migration_after_the_first_is_of_both() -> None:
    numbers = [int(path.name[:4]) for path in (MIGRATIONS / "postgresql").glob("*.sql")]
    assert sorted(numbers) == list(range(21, newest_schema() + 1))


def test_two_that_come_at_once_make_one_schema(tmp_path: Path, postgres: PostgresServer) -> None:
    server = postgres.make()
    folders = [tmp_path / name for name in "abcd"]
    for each in folders:
        each.mkdir()
    with ThreadPoolExecutor() as pool:
        list(pool.map(lambda folder: put_on_server(folder, server), folders))
    with closing(open_database(folders[0])) as database:
        (row,) = database.rows("SELECT count(*) AS count, max(number) AS number FROM schema_version")
        assert (row["count"], row["number"]) == (newest_schema() - 20, newest_schema())
        assert len(database.rows("SELECT * FROM ownership")) == 1


def test_a_newer_programs_database_is_refused(root: Path, database: Database) -> None:
    database.execute("INSERT INTO schema_version VALUES (99)")
    with pytest.raises(UnusableFolder, match="schema 99"):
        DataFolder(root)


def test_words_fold_as_python_folds_them(database: Database) -> None:
    letters = [chr(code) for code in range(1, sys.maxunicode + 1) if not 0xD800 <= code < 0xE000]
    folded = [letter for letter in letters if letter.casefold() != letter]
    for some in (folded, letters[:2000], letters[::997]):
        text = "a" + "b".join(some)
        row = database.row("SELECT casefold(?) AS folded", (text,))
        assert row is not None
        assert row["folded"] == text.casefold()


def test_texts_sort_by_code_points_and_need_no_zeros(database: Database) -> None:
    names = ["b", "B", "a", "é", "Z", "\U0001f600", "-", "z\0"]
    for number, name in enumerate(names):
        database.execute("INSERT INTO quarantine VALUES (?, ?, ?)", (name, "", float(number)))
    rows = database.rows("SELECT worker_id FROM quarantine ORDER BY worker_id")
    assert [row["worker_id"] for row in rows] == sorted(each.replace("\0", "\ufffd") for each in names)


def test_who_writes_keeps_others_from_writing_and_nobody_from_reading(root: Path, database: Database) -> None:
    waited = threading.Event()
    with closing(open_database(root)) as other:
        other.read_beside(0.2)
        before = other.change_counter()
        with database.transaction():
            database.execute("INSERT INTO drain VALUES ('w', '', 1.0)")
            assert len(database.rows("SELECT * FROM drain")) == 1
            assert other.rows("SELECT * FROM drain") == []
            with pytest.raises(DatabaseUnavailable, match="lock timeout"):
                other.execute("DELETE FROM drain")
            with pytest.raises(DatabaseUnavailable, match="lock timeout"):
                other.check_writing(0.2)
            assert other.change_counter() == before
            waited.set()
        assert other.change_counter() == before + 1
        assert other.execute("DELETE FROM drain") == 1
        other.check_writing(0.2)
        assert database.change_counter() == before + 2


def test_a_transaction_that_fails_leaves_nothing(database: Database) -> None:
    before = database.change_counter()

    def fails() -> None:
        with database.transaction():
            database.execute("INSERT INTO drain VALUES ('w', '', 1.0)")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    assert database.rows("SELECT * FROM drain") == []
    assert database.change_counter() == before


def test_a_server_that_was_gone_is_used_again(tmp_path: Path) -> None:
    with PostgresServer() as server:
        root = tmp_path / "data"
        root.mkdir()
        put_on_server(root, server.make())
        with closing(open_database(root)) as database:
            database.read_beside(1.0)
            database.execute("INSERT INTO drain VALUES ('w', '', 1.0)")
            assert len(database.rows("SELECT * FROM drain")) == 1

            def broken_off() -> None:
                with database.transaction():
                    database.execute("DELETE FROM drain")
                    server.stop("immediate")
                    database.execute("DELETE FROM quarantine")

            with pytest.raises(DatabaseUnavailable):
                broken_off()
            for _ in range(2):
                with pytest.raises(DatabaseUnavailable):
                    database.rows("SELECT * FROM drain")
            server.start()
            assert len(database.rows("SELECT * FROM drain")) == 1
            assert database.execute("DELETE FROM drain") == 1


def test_one_coordinator_alone_or_several_that_share(root: Path) -> None:
    with closing(open_database(root)) as first, closing(open_database(root)) as second:
        alone = Ownership(root, first)
        with pytest.raises(AlreadyOwned, match=r"on "):
            Ownership(root, second, shared=True)
        alone.release()
        sharing = [Ownership(root, each, shared=True) for each in (first, second)]
        assert sharing[0].epoch == sharing[1].epoch == alone.epoch + 1
        with pytest.raises(AlreadyOwned):
            Ownership(root, second)
        for each in sharing:
            each.release()
        last = Ownership(root, second)
        with pytest.raises(OwnershipLost):
            sharing[0].check()
        last.release()


def test_folder_and_database_belong_together(tmp_path: Path, root: Path, postgres: PostgresServer) -> None:
    with pytest.raises(UnusableFolder, match="has its database on"):
        put_on_server(root, postgres.make())
    (root / "postgresql").write_text(postgres.make())
    with pytest.raises(UnusableFolder, match="belongs to another database"):
        DataFolder(root)
    old = tmp_path / "old"
    DataFolder(old).close()
    with pytest.raises(UnusableFolder, match=r"nocturne\.db already"):
        put_on_server(old, postgres.make())


def test_a_backup_that_was_brought_back_is_another_folder(root: Path, database: Database) -> None:
    database.execute("UPDATE ownership SET folder = 'as it was'")
    with pytest.raises(UnusableFolder, match="nocturne restore"):
        DataFolder(root)
    assert restore(root).damage == []
    with closing(DataFolder(root)) as folder:
        row = folder.database.row("SELECT folder FROM ownership")
        assert row is not None
        assert row["folder"] not in ("", "as it was")


def test_a_server_that_is_not_there_is_told_of(tmp_path: Path) -> None:
    (tmp_path / "postgresql").write_text(f"postgresql://nobody@/none?host={tmp_path}")
    with pytest.raises(UnusableFolder, match="PostgreSQL: connection"):
        DataFolder(tmp_path)


def test_a_read_only_copy_of_a_server_is_told_of(root: Path) -> None:
    with psycopg.connect((root / "postgresql").read_text().strip(), autocommit=True) as admin:
        admin.execute("ALTER ROLE nocturne SET default_transaction_read_only = on")
        try:
            with pytest.raises(DatabaseUnavailable, match="read-only"):
                open_database(root)
        finally:
            admin.execute("SET default_transaction_read_only = off")
            admin.execute("ALTER ROLE nocturne RESET default_transaction_read_only")
