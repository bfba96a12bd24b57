"""nocturne-trace ends with a sentence and a status, whatever a thread of it meets."""

import subprocess
from pathlib import Path

import pytest
from nocturne.v1 import job_pb2
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.programs import need_program

from tests.accuracy import both_directions
from tests.accuracy.tracing import write

pytestmark = pytest.mark.system


def test_what_a_thread_throws_is_said(tmp_path: Path) -> None:
    """Where forward photons bring all light, tiles have no ranges: they refuse them, each by a thread."""
    document = both_directions.SCENES["plain"].document | {"tracing": {"direction": "forward"}}
    compiled = compile_to(write(document, tmp_path), tmp_path, 64, 64, 4)
    schedule = job_pb2.RangeSchedule.FromString(compiled.schedule.read_bytes())
    schedule.range_ends[:] = [4]
    compiled.schedule.write_bytes(schedule.SerializeToString())
    output = tmp_path / "image.exr"
    command = [need_program("nocturne-trace"), compiled.scene, "--schedule", compiled.schedule]
    command += ["--blobs", compiled.blobs, "-o", output, "--quiet", "--threads", "4"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr == "nocturne-trace: a tile of a scene of forward photons alone\n"
    assert not output.exists()
