"""/readyz tests the service's functions, and names those that fail; a locked database is reported soon."""

import asyncio
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api import limits
from nocturne_api.service import Settings
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership

from tests.services.endpoints import rest_client, started


@pytest.fixture(autouse=True)
def always_new(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "READY_KEPT_S", 0.0)
    monkeypatch.setattr(limits, "READY_WAIT_S", 0.3)


@contextmanager
def locked(data: Path) -> Iterator[None]:
    """Another process writes, and does not come to an end."""
    with closing(sqlite3.connect(data / "nocturne.db", isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        yield


async def failing(rest: httpx.AsyncClient) -> dict[str, str]:
    """What fails, and why."""
    answer = await rest.get("/readyz")
    found = answer.json()
    failed = {each["name"]: each["trouble"] for each in found["checks"] if not each["ok"]}
    assert answer.status_code == (503 if failed else 200)
    assert found["ready"] is not bool(failed)
    assert ("Retry-After" in answer.headers) is bool(failed)
    return failed


def works(folder: DataFolder, seen: float, **meters: float) -> None:
    """A coordinator says that it is there."""
    ownership = Ownership(folder.root, folder.database)
    values = {"coordinator_seen": seen, "redis_in_step": 1.0, "folder_trouble": 0.0, **meters}
    Ledger(folder.database, ownership).write_meters(values)
    ownership.release()


async def test_merging_needs_a_coordinator_that_writes(rest: httpx.AsyncClient, folder: DataFolder) -> None:
    assert await failing(rest) == {"merging": "No coordinator works on the data folder: start one."}
    assert (await rest.get("/readyz?exclude=merging")).json()["ready"]
    works(folder, time.time())
    assert await failing(rest) == {}
    works(folder, time.time() - 100)
    assert list(await failing(rest)) == ["merging"]
    works(folder, time.time(), folder_trouble=1.0)
    assert "can't write" in (await failing(rest))["merging"]
    works(folder, time.time(), redis_in_step=0.0)
    assert "Redis" in (await failing(rest))["merging"]


async def test_a_locked_database_is_told_of(rest: httpx.AsyncClient, folder: DataFolder) -> None:
    works(folder, time.time())
    with locked(folder.root):
        assert await failing(rest) == {"writing": "database is locked"}
    assert await failing(rest) == {}


async def test_a_folder_that_is_gone_is_told_of(rest: httpx.AsyncClient, folder: DataFolder) -> None:
    works(folder, time.time())
    folder.root.rename(folder.root.with_name("elsewhere"))
    found = await failing(rest)
    assert "reading" in found
    assert "was moved away or replaced" in found["writing"]


async def test_a_disk_that_takes_nothing_is_told_of(
    rest: httpx.AsyncClient, folder: DataFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    works(folder, time.time())

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    assert await failing(rest) == {"writing": "[Errno 28] No space left on device"}


async def test_a_full_folder_takes_no_renders(tmp_path: Path, web: Path) -> None:
    settings = Settings(data=tmp_path / "data", web=web, port=0, grpc_port=0, data_bytes=1.0)
    async with started(settings) as service, rest_client(service) as rest:
        found = await failing(rest)
    assert "of the 1 that it may have" in found["admission"]


async def test_a_create_hears_soon_that_the_database_is_locked(
    rest: httpx.AsyncClient, folder: DataFolder, body: dict[str, Any]
) -> None:
    """Others that read hear at once, and all of them who write do soon, not one after the other."""
    bodies = [{**body, "request_id": f"r-{number}"} for number in range(6)]
    await rest.post("/v1/renders", json=body)
    with locked(folder.root):
        begun = time.monotonic()
        creates = [asyncio.create_task(rest.post("/v1/renders", json=each)) for each in bodies]
        await asyncio.sleep(1.0)
        read_from = time.monotonic()
        assert (await rest.get("/v1/renders")).status_code == 200
        assert time.monotonic() - read_from < 0.5
        for create in creates:
            answer = await create
            assert (answer.status_code, answer.headers["Retry-After"]) == (503, "5")
        assert time.monotonic() - begun < limits.DATABASE_TURN_S + limits.DATABASE_LOCK_S + 2.0
    assert (await rest.post("/v1/renders", json=bodies[0])).status_code == 201
