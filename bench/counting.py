"""Counts instructions, whatever else the machine does."""

import re
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder

from bench.report import Skipped


def instructions(program: Path, compiled: CompiledFolder, options: Sequence[object] = ()) -> int:
    """Of a run of nocturne-trace, or of a program that takes the same words, on one thread. Skipped without
    Valgrind."""
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise Skipped("Valgrind is not there (`apt-get install valgrind`)")
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        words = [valgrind, "--tool=callgrind", f"--callgrind-out-file={folder}/profile", program]
        words += [compiled.scene, "--schedule", compiled.schedule, "--blobs", compiled.blobs]
        words += ["-o", f"{folder}/image.exr", *options, "--threads", "1", "--quiet"]
        done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    counted = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or counted is None:
        raise NocturneClientError(f"Valgrind failed ({done.returncode}): {done.stderr.strip()[-500:]}")
    return int(counted[1])
