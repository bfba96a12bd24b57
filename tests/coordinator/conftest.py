"""Real parts for the tests: a redis-server on a Unix socket, the coordinator as a process, a data folder."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.coordinator.service import RedisServer, Service


@pytest.fixture
def redis_server(tmp_path: Path) -> Iterator[RedisServer]:
    server = RedisServer(tmp_path)
    server.start()
    yield server
    server.kill()


@pytest.fixture
def service(tmp_path: Path, redis_server: RedisServer) -> Iterator[Service]:
    service = Service(tmp_path / "data", redis_server)
    yield service
    service.close()
