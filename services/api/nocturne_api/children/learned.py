"""Looks up one place: the job on standard input, the answer on standard output, both JSON."""

import base64
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from nocturne.v1 import scene_pb2
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.output import blobs_named_in
from nocturne_scene.errors import NocturneError
from nocturne_scene.programs import find_program


def main() -> None:
    """Reads the job, answers it."""
    job = json.load(sys.stdin)
    # nocturne-trace inherits both.
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (job["memory_bytes"], job["memory_bytes"]))
    try:
        answer = _look_up(job)
    except NocturneError as error:
        answer = {"failed": str(error)}
    except (OSError, subprocess.SubprocessError, ValueError):
        answer = {"failed": "nocturne-trace is missing here, or can't read this scene"}
    json.dump(answer, sys.stdout)


def _look_up(job: dict[str, Any]) -> dict[str, Any]:
    store = BlobStore(Path(job["blobs"]), ObjectStore(job["objects"]) if job["objects"] else None)
    scene = scene_pb2.CompiledScene.FromString(store.path(job["scene_sha256"]).read_bytes())
    for digest in set(blobs_named_in(scene)):
        store.path(digest)  # which brings what is not here
    program = find_program("nocturne-trace")
    if program is None:
        raise FileNotFoundError("nocturne-trace")
    with tempfile.TemporaryDirectory(prefix="nocturne-learned-") as folder:
        schedule, output = Path(folder) / "schedule.pb", Path(folder) / "learned.json"
        schedule.write_bytes(base64.b64decode(job["schedule"]))
        command = [program, store.path(job["scene_sha256"]), "--schedule", schedule, "--blobs", store.root]
        command += ["--learned-at", f"{job['x']},{job['y']}", "-o", output, "--threads", "1"]
        subprocess.run(  # noqa: S603 - our own program
            [str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=True
        )
        answer: dict[str, Any] = json.loads(output.read_bytes())
        return answer


if __name__ == "__main__":
    main()
