"""Files on the disk: unused ones are removed in time, their size is bounded, and a full disk is reported."""

import asyncio
import hashlib
import logging
import os
import subprocess
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_api import limits
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.removal import delete_render, sweep, sweep_unused

from tests.faults.owners import Guarded, guarded, request
from tests.system.up import NOCTURNE

# A mesh by its file, so that a render uses an upload.
PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)


async def upload(client: httpx.AsyncClient, content: bytes) -> str:
    digest = hashlib.sha256(content).hexdigest()
    answer = await client.put(f"/v1/assets/{digest}", content=content)
    assert answer.status_code == 200, answer.text
    return digest


def with_mesh(request_id: str, digest: str) -> dict[str, Any]:
    body = request(request_id)
    body["scene"]["surfaces"][0]["shape"] = {"type": "mesh", "asset": f"sha256:{digest}", "format": "ply"}
    return body


@pytest.fixture
async def service(tmp_path: Path) -> AsyncIterator[Guarded]:
    async with guarded(tmp_path) as service:
        yield service


def grow_old(folder: DataFolder) -> None:
    """As if nobody had asked for any file for a week."""
    for digest in folder.blobs.all():
        os.utime(folder.blobs.path(digest), (0, time.time() - 2 * limits.UNUSED_SECONDS))


async def test_files_that_no_render_uses_go_after_a_while(service: Guarded) -> None:
    """P11: files that a render uses stay, as do young or recently requested ones; removed files are not
    counted."""
    token = service.token("alice", "submit")
    folder = service.folder
    async with service.rest(token) as alice:
        used, unused, asked, gone = [
            await upload(alice, content)
            for content in (PLY, b"unused", b"asked about", b"of a deleted render")
        ]
        made = (await alice.post("/v1/renders", json=with_mesh("a", used))).json()["id"]
        (folder.root / "blobs" / "incoming" / ".unfinished-by-a-crash").write_bytes(b"half a file")
        assert sweep_unused(folder, limits.UNUSED_SECONDS) == []
        grow_old(folder)
        os.utime(folder.root / "blobs" / "incoming" / ".unfinished-by-a-crash", (0, 0))
        await alice.post("/v1/assets:batchMissing", json={"sha256": [asked]})
        young = await upload(alice, b"young")
        assert sweep_unused(folder, limits.UNUSED_SECONDS) == sorted([unused, gone])
        assert set(folder.blobs.all()) >= {used, asked, young, folder.renders.get(made).scene_sha256}
        assert list((folder.root / "blobs" / "incoming").iterdir()) == []
        rows = folder.database.rows("SELECT sha256 FROM upload")
        assert {row["sha256"] for row in rows} == {used, asked, young}
        # The render is all that it was.
        assert (await alice.post("/v1/renders", json=with_mesh("b", used))).status_code == 201


async def test_nothing_goes_while_it_is_not_known_what_is_used(service: Guarded) -> None:
    """P11: a render of a former version, whose files nobody noted, may need any; and so may its replays."""
    async with service.rest(service.token("alice", "submit")) as alice:
        unused = await upload(alice, b"unused")
        made = (await alice.post("/v1/renders", json=request("a"))).json()["id"]
    folder = service.folder
    scene = folder.renders.get(made).scene_sha256
    known = folder.blob_use.of(made)
    assert scene in known
    folder.database.execute("DELETE FROM blob_use")
    folder.blob_use.note(made, [""])
    grow_old(folder)
    assert sweep_unused(folder, limits.UNUSED_SECONDS) == []
    folder.blob_use.note(made, known)
    assert sweep_unused(folder, limits.UNUSED_SECONDS) == []
    folder.requests.cancel(made)
    delete_render(folder, made)
    sweep(folder)
    assert sweep_unused(folder, limits.UNUSED_SECONDS) == [unused]


async def test_the_service_sweeps_by_itself(tmp_path: Path) -> None:
    """P11: with a short time set."""
    async with (
        guarded(tmp_path, unused_seconds=0.3) as service,
        service.rest(service.token("alice", "submit")) as alice,
    ):
        digest = await upload(alice, b"unused")
        for _ in range(1000):
            if service.folder.blobs.here(digest) is None:
                return
            await asyncio.sleep(0.1)
    pytest.fail("it is still there")


async def test_the_data_folder_has_a_bound(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """P11: 507 with a sentence beyond the bound, a warning before it; stored files can be read and
    deleted."""
    async with (
        guarded(tmp_path, data_bytes=2_000_000) as service,
        service.rest(service.token("alice", "submit", "read")) as alice,
    ):
        made = (await alice.post("/v1/renders", json=request("a"))).json()["id"]
        sizes = []
        for number in range(100):
            content = bytes([number]) * 100_000
            answer = await alice.put(f"/v1/assets/{hashlib.sha256(content).hexdigest()}", content=content)
            if answer.status_code != 200:
                break
            sizes.append(len(content))
        assert (answer.status_code, answer.json()["reason"]) == (507, "FOLDER_FULL")
        assert answer.headers["retry-after"]
        assert "of the 2,000,000 that it may have; delete renders" in answer.json()["detail"]
        assert 5 < len(sizes) < 20
        assert str(tmp_path) not in answer.text
        # An announced file that never came takes no room.
        small = b"small"
        for _ in range(3):
            wrong = await alice.put(f"/v1/assets/{'0' * 64}", content=bytes(90_000))
            assert wrong.status_code in (422, 507)
        assert (await alice.put(f"/v1/assets/{hashlib.sha256(small).hexdigest()}", content=small)).is_success
        assert (await alice.get(f"/v1/renders/{made}")).status_code == 200
        assert (await alice.post(f"/v1/renders/{made}:cancel")).status_code == 200
        assert (await alice.delete(f"/v1/renders/{made}")).status_code == 204
        figures = (await alice.get("/metrics")).text
        assert "nocturne_data_bytes_bound 2e+06" in figures
    with caplog.at_level(logging.WARNING, "nocturne_api.background.space"):
        async with guarded(tmp_path, data_bytes=2_000_000):
            pass
    assert "of the 2,000,000 that it may have; delete renders, or make room" in caplog.text


@pytest.mark.parametrize("command", [["up", "--port", "1"], ["up", "--auth", "--port", "1"]])
def test_nocturne_up_on_a_full_disk_says_so(tmp_path: Path, command: list[str]) -> None:
    """P13: one sentence with the folder and what to do, no traceback, also where the folder is there."""
    for data in (tmp_path / "new", tmp_path / "new"):
        run = subprocess.run(
            ["prlimit", "--fsize=0", NOCTURNE, *command, "--data", data],
            stderr=subprocess.PIPE,
            text=True,
            timeout=300,
            check=False,
        )
        assert run.returncode == 2
        said = " ".join(run.stderr.split())
        assert f"{data} can't be written" in said
        assert "make room on its disk, or choose another folder with --data" in said
        assert "Traceback" not in said
