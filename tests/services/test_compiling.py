"""Scenes are compiled in a child process, within limits of time and memory."""

import copy
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from nocturne_api.compiling.pool import CompileLimits, compile_in_child
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


def test_a_compile_that_never_ends_is_ended() -> None:
    endless = (
        "from nocturne_api.compiling.server import bound\n"
        "from nocturne_api.compiling.pool import CompileLimits\n"
        "bound(CompileLimits(cpu_seconds=1))\nwhile True: pass"
    )
    ended = subprocess.run([sys.executable, "-c", endless], timeout=300, check=False)
    assert ended.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
