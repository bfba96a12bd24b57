"""A plugin: every data folder that a test makes has its database on PostgreSQL.

    pytest -p tests.postgresql.everywhere tests/coordinator tests/services tests/faults

Processes that tests start find it by the folder. What is about SQLite's file alone is left out, by name.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from nocturne_coordinator.store import data_folder, databases
from nocturne_coordinator.store.database import Database

from tests.postgresql.server import PostgresServer

_OF_THE_FILE = {
    "test_a_folder_of_another_version_is_refused": "changes SQLite's user_version; test_database.py too",
    "test_migrations.py": "about SQLite's own migrations; test_database.py compares the schemas",
    "test_a_full_disk_at_the_start": "the folder is made by the program that it starts",
    "test_a_damaged_database_is_replaced": "about checkpoints, which are copies of SQLite's file",
    "test_powercut.py": "about the file's disk",
    "test_disk_full_in_mid_commit": "about the file's disk",
    "test_looking.py": "counts SQLite's instructions",
    "test_privacy.py": "about the files of SQLite",
    "test_restoring.py": "about checkpoints, which are copies of SQLite's file",
    "test_a_locked_database_is_told_of": "locks SQLite's file; test_database.py too",
    "test_a_create_hears_soon_that_the_database_is_locked": "locks SQLite's file",
    "test_one_that_was_stopped_beyond_its_lease_merges_nothing_twice": "asks SQLite's file for its lock",
}


def pytest_configure(config: pytest.Config) -> None:
    """Many tests leave their folder to the end of the process."""
    config.addinivalue_line("filterwarnings", "ignore:.*psycopg.Connection.*was deleted while still open")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Says why each test that is left out is."""
    for item in items:
        for name, why in _OF_THE_FILE.items():
            if name in item.nodeid:
                item.add_marker(pytest.mark.skip(reason=why))


@pytest.fixture(scope="session", autouse=True)
def _on_postgresql() -> Iterator[None]:
    with PostgresServer() as server, pytest.MonkeyPatch.context() as patch:

        def open_database(root: Path) -> Database:
            if not databases.server_of(root):
                databases.put_on_server(root, server.make())
            return databases.open_database(root)

        patch.setattr(data_folder, "open_database", open_database)
        yield
