"""Runs nocturne-trace on a scene that is being compiled, for what only the tracer can tell."""

import os
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from nocturne.v1 import scene_pb2

from nocturne_scene.film import Film
from nocturne_scene.scene_ranges import schedule_of

_THREADS = 4


def run_trace(
    program: Path,
    scene: scene_pb2.CompiledScene,
    blobs: Path,
    film: Film,
    words: Sequence[str],
    seconds: float,
) -> bytes:
    """Return the program's output for a scene, a film and further `words` of its command line.

    Raises OSError, and subprocess.SubprocessError where it fails or takes longer than `seconds`.
    """
    with tempfile.TemporaryDirectory(prefix="nocturne-trace-") as folder:
        files = [Path(folder) / name for name in ("scene.pb", "schedule.pb", "output")]
        files[0].write_bytes(scene.SerializeToString(deterministic=True))
        schedule = schedule_of(scene, film.width, film.height, film.samples)
        files[1].write_bytes(schedule.SerializeToString(deterministic=True))
        command = [program, files[0], "--schedule", files[1], "--blobs", blobs, "-o", files[2], *words]
        command += ["--threads", str(min(_THREADS, len(os.sched_getaffinity(0))))]
        subprocess.run(  # noqa: S603 - our own program
            [str(word) for word in command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=seconds,
            check=True,
        )
        return files[2].read_bytes()
