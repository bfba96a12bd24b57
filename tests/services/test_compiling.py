"""Scenes are compiled in a child process, within limits of time and memory."""

import copy
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from nocturne_api.compiling.pool import CompileLimits, compile_in_child
from nocturne_api.compiling.server import NICE
from nocturne_api.errors import failure_of
from nocturne_coordinator.errors import StoreUnavailable
from nocturne_scene.blobs import BlobStore
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError


def test_a_scene_that_takes_too_much_is_refused(scene: dict[str, Any], tmp_path: Path) -> None:
    document = check_document(scene)
    blobs = BlobStore(tmp_path)
    sha256 = compile_in_child(document, blobs, CompileLimits()).scene_sha256
    assert len(sha256) == 64
    big = copy.deepcopy(scene)
    count = 30_000
    big["surfaces"][0]["shape"] = {
        "type": "mesh",
        "vertices": [[index, index % 7, 0] for index in range(count)],
        "triangles": [[index, index + 1, (index * 7) % count] for index in range(count - 1)],
    }
    # What the child has already is more than that; so the first larger array that it asks for is refused.
    with pytest.raises(InputError, match="needs more than 16 MiB"):
        compile_in_child(check_document(big), blobs, CompileLimits(memory_bytes=2**24))
    # The next is none the worse for it.
    assert compile_in_child(document, blobs, CompileLimits()).scene_sha256 == sha256


def test_a_folder_that_cannot_be_written_is_not_the_scenes_fault(
    scene: dict[str, Any], tmp_path: Path
) -> None:
    """As on a disk that is full or became read-only: the same call may succeed later."""
    blobs = BlobStore(tmp_path / "blobs")
    shutil.rmtree(blobs.root)
    # Nobody may write there.
    blobs.root.symlink_to("/sys/kernel")
    with pytest.raises(StoreUnavailable, match="can't be written to the data folder") as raised:
        compile_in_child(check_document(scene), blobs, CompileLimits())
    kind = failure_of(raised.value).kind
    assert (kind.http_status, kind.retry_after_s) == (503, 5)


def test_long_compiles_give_way_to_others() -> None:
    """After 0.3 s of processor time, or three seconds, with the programs that they started."""
    code = (
        "import os, subprocess\n"
        "from nocturne_api.compiling import server\n"
        "os.setpgid(0, 0)\n"
        "child = subprocess.Popen(['sleep', '60'])\n"
        "nice = lambda: [os.getpriority(os.PRIO_PROCESS, each) for each in (0, child.pid)]\n"
        "before = nice()\n"
        "server.QUICK_WALL_S = 0.0\n"
        "server._give_way()\n"
        "print(*(after - earlier for earlier, after in zip(before, nice())))\n"
        "child.kill()\n"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == [str(NICE), str(NICE)]


def test_a_compile_that_never_ends_is_ended() -> None:
    endless = (
        "from nocturne_api.compiling.server import bound\n"
        "from nocturne_api.compiling.pool import CompileLimits\n"
        "bound(CompileLimits(cpu_seconds=1))\nwhile True: pass"
    )
    ended = subprocess.run([sys.executable, "-c", endless], timeout=300, check=False)
    assert ended.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
