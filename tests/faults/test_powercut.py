"""The machine loses its power in the instant after an answer; the answered change is there after the restart.

A disk in a file is copied while everything runs, and the copy is mounted elsewhere: it has the data that
reached the block device, without data that was only in the memory of the system.
"""

import os
import shutil
import subprocess
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api.service import Service as Api
from nocturne_api.service import Settings
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_scene.blobs import BlobStore
from nocturne_scene.errors import NotFound
from nocturne_scene.replacing import replacing

from tests.coordinator.service import RedisServer, Service, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.faults.owners import request
from tests.services.endpoints import started

_DISK_BYTES = 48 * 2**20
# Nothing reaches the disk by itself in this time: only what somebody waits for.
_QUIET = "loop,commit=3600"


class Disk:
    """A file system in a file, mounted at `place`."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._image = folder / "disk.img"
        self.place = folder / "disk"
        self._cuts = 0

    def make(self) -> None:
        self.place.mkdir()
        with self._image.open("wb") as file:
            file.truncate(_DISK_BYTES)
        subprocess.run(["mkfs.ext4", "-q", "-F", self._image], check=True, capture_output=True)
        subprocess.run(["mount", "-o", _QUIET, self._image, self.place], check=True, capture_output=True)

    def cut(self) -> Path:
        """What would be left if the power went now."""
        self._cuts += 1
        copy = self._folder / f"cut-{self._cuts}.img"
        shutil.copyfile(self._image, copy)
        return copy

    def close(self) -> None:
        subprocess.run(["umount", self.place], check=False, capture_output=True)

    @contextmanager
    def after(self, copy: Path) -> Iterator[Path]:
        """The file system as it comes back after a cut."""
        place = copy.with_suffix("")
        place.mkdir()
        subprocess.run(["mount", "-o", "loop", copy, place], check=True, capture_output=True)
        try:
            yield place
        finally:
            subprocess.run(["umount", place], check=True)

    @contextmanager
    def folder_after(self, copy: Path) -> Iterator[DataFolder]:
        """The data folder of the same."""
        with self.after(copy) as place:
            folder = DataFolder(place / "data")
            try:
                yield folder
            finally:
                folder.close()


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Disk]:
    found = Disk(tmp_path)
    try:
        found.make()
    except (OSError, subprocess.CalledProcessError) as trouble:
        pytest.skip(f"no disk in a file can be mounted here: {trouble}")
    yield found
    found.close()


@pytest.fixture
async def api(disk: Disk, tmp_path: Path) -> AsyncIterator[Api]:
    async with started(Settings(data=disk.place / "data", web=tmp_path, port=0, grpc_port=0)) as service:
        yield service


@pytest.fixture
async def rest(api: Api) -> AsyncIterator[httpx.AsyncClient]:
    address = f"http://127.0.0.1:{api.port}"
    async with httpx.AsyncClient(base_url=address, timeout=300, trust_env=False, verify=False) as client:  # noqa: S501
        yield client


async def answered(rest: httpx.AsyncClient, path: str, body: Any = None) -> dict[str, Any]:
    answer = await rest.post(f"/v1/renders{path}", json=body or {})
    assert answer.status_code in (200, 201), answer.text
    found: dict[str, Any] = answer.json()
    return found


async def test_the_tests_own_disk_forgets_what_nobody_waited_for(disk: Disk) -> None:
    """P1: or none of these tests could fail."""
    (disk.place / "kept").write_text("kept")
    with (disk.place / "kept").open("rb") as file:
        os.fsync(file.fileno())
    (disk.place / "lost").write_text("lost")
    with disk.after(disk.cut()) as place:
        assert (place / "kept").read_text() == "kept"
        assert not (place / "lost").exists()


async def test_what_the_api_answered_is_there(disk: Disk, rest: httpx.AsyncClient) -> None:
    """P1: uploaded, accepted, extended, paused, cancelled, deleted: a cut in the instant after each."""
    content = b"a file of a scene"
    digest = sha256(content).hexdigest()
    assert (await rest.put(f"/v1/assets/{digest}", content=content)).status_code == 200
    uploaded = disk.cut()
    render = (await answered(rest, "", request("a")))["id"]
    accepted = disk.cut()
    await answered(rest, f"/{render}:extend", {"samples": 64})
    extended = disk.cut()
    await answered(rest, f"/{render}:pause")
    paused = disk.cut()
    await answered(rest, f"/{render}:cancel")
    cancelled = disk.cut()
    assert (await rest.delete(f"/v1/renders/{render}")).status_code == 204
    deleted = disk.cut()

    with disk.folder_after(uploaded) as folder:
        assert folder.blobs.path(digest).read_bytes() == content
    with disk.folder_after(accepted) as folder:
        row = folder.renders.get(render)
        assert (row.state, row.samples) == ("QUEUED", 16)
        assert folder.blobs.is_whole(row.scene_sha256)
        assert folder.calls.last(1)[0]["what"] == "create"
    with disk.folder_after(extended) as folder:
        assert folder.renders.get(render).samples == 64
    with disk.folder_after(paused) as folder:
        assert folder.renders.get(render).state == "PAUSED"
    with disk.folder_after(cancelled) as folder:
        assert folder.renders.get(render).state == "CANCELLED"
    with disk.folder_after(deleted) as folder:
        with pytest.raises(NotFound):
            folder.renders.get(render)
        assert folder.removals.open() == []
        assert folder.blobs.here(row.scene_sha256) is None


async def test_tokens_are_made_and_revoked_for_good(disk: Disk, rest: httpx.AsyncClient) -> None:
    """P1: as the command line does it, while a service runs."""
    assert (await rest.get("/readyz?exclude=merging")).status_code == 200
    here = DataFolder(disk.place / "data")
    secret = here.tokens.create("mallory", ["admin"])
    made = disk.cut()
    here.tokens.revoke("mallory")
    revoked = disk.cut()
    here.close()
    with disk.folder_after(made) as folder:
        assert folder.tokens.find(secret) is not None
    with disk.folder_after(revoked) as folder:
        assert folder.tokens.find(secret) is None


def test_a_finished_image_is_there(disk: Disk, redis_server: RedisServer) -> None:
    """P1: who has seen SUCCEEDED finds state, sums and the same image; a cancelled one's last image too."""
    service = Service(disk.place / "data", redis_server)
    try:
        service.start()
        service.work(SimulatedWorker(redis_server.url))
        first = service.create(request_id="a")
        wait_until(lambda: service.row(first.id).state == "SUCCEEDED")
        succeeded = disk.cut()
        image = service.folder.image_path(first.id).read_bytes()
        second = service.create(request_id="b", samples=10**6)
        wait_until(lambda: service.row(second.id).ranges_done > 0)
        service.folder.requests.cancel(second.id)
        wait_until(lambda: service.row(second.id).image_final)
        cancelled = disk.cut()
        of_cancelled = service.folder.image_path(second.id).read_bytes()
    finally:
        service.close()
    with disk.folder_after(succeeded) as folder:
        row = folder.renders.get(first.id)
        assert (row.state, row.ranges_done) == ("SUCCEEDED", row.ranges_planned)
        assert folder.image_path(first.id).read_bytes() == image
        assert folder.preview_path(first.id).stat().st_size > 0
    with disk.folder_after(cancelled) as folder:
        assert folder.renders.get(second.id).state == "CANCELLED"
        assert folder.image_path(second.id).read_bytes() == of_cancelled


def test_progress_may_be_lost_and_is_whole(disk: Disk, redis_server: RedisServer) -> None:
    """P1: a cut in mid-work leaves the sums of some commit, and the render goes on from there."""
    service = Service(disk.place / "data", redis_server)
    try:
        service.start()
        service.work(SimulatedWorker(redis_server.url, delay=0.01))
        render = service.create(samples=20_000)
        wait_until(lambda: service.row(render.id).ranges_done > 30)
        cut = disk.cut()
    finally:
        service.close()
    with disk.folder_after(cut) as folder:
        assert folder.database.row("PRAGMA integrity_check")[0] == "ok"  # type: ignore[index]
        row = folder.renders.get(render.id)
        assert row.state in ("QUEUED", "RUNNING")
        committed = folder.database.row("SELECT count(*) AS tiles FROM tile WHERE samples > 0")
        assert committed is not None
        assert (committed["tiles"] > 0) == (row.ranges_done > 0)


def test_files_are_synced_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """P1: content before name, name before answer, and new folders' names; on any machine."""
    steps: list[str] = []
    fsync, replace = os.fsync, Path.replace

    def noted_fsync(descriptor: int) -> None:
        steps.append(f"sync {Path(f'/proc/self/fd/{descriptor}').readlink().name}")
        fsync(descriptor)

    def noted_replace(self: Path, target: Path) -> Path:
        steps.append(f"rename to {target.name}")
        return replace(self, target)

    monkeypatch.setattr(os, "fsync", noted_fsync)
    monkeypatch.setattr(Path, "replace", noted_replace)
    blobs = BlobStore(tmp_path / "blobs")
    steps.clear()
    digest = blobs.put(b"content")
    unfinished, *rest = steps
    assert unfinished.startswith("sync .unfinished-")
    assert rest == [f"rename to {digest}", f"sync {digest[:2]}", "sync blobs"]
    steps.clear()
    with replacing(tmp_path / "note") as place:
        place.write_text("found out again")
    assert steps == ["rename to note"]
