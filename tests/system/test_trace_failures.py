"""nocturne-trace ends with a sentence and a status, whatever a thread of it meets."""

import subprocess
from pathlib import Path

import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.programs import need_program

from tests.accuracy.scenes import furnace
from tests.accuracy.tracing import write

pytestmark = pytest.mark.system


def test_what_a_thread_throws_is_said(tmp_path: Path) -> None:
    """The path tracer knows no media, and says so when the first tile is traced."""
    document = furnace(0.5, 1.0) | {"media": {"fog": {"scattering": 1.0}}}
    document["surfaces"].append(
        {
            "shape": {"type": "sphere", "centre": [0.5, 0.5, 0.5], "radius": 0.1},
            "interior": {"media": ["fog"]},
        }
    )
    compiled = compile_to(write(document, tmp_path), tmp_path, 64, 64, 4)
    output = tmp_path / "image.exr"
    command = [need_program("nocturne-trace"), compiled.scene, "--schedule", compiled.schedule]
    command += ["--blobs", compiled.blobs, "-o", output, "--quiet", "--method", "path", "--threads", "4"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == "nocturne-trace: the path tracer knows no media\n"
    assert not output.exists()
