"""One server for the tests of this folder."""

from collections.abc import Iterator

import pytest

from tests.postgresql.server import PostgresServer


@pytest.fixture(scope="session")
def postgres() -> Iterator[PostgresServer]:
    with PostgresServer() as server:
        yield server
