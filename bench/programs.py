"""Runs Nocturne's programs and measures their costs."""

import json
import os
import resource
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.compiled import CompiledFolder
from nocturne_client.local.programs import CHECKOUT, need_program

Channel = npt.NDArray[np.float64]

BASELINE = "nocturne-baseline"
"""Traces by `--method path` or `--method march`, for comparison."""


@dataclass(frozen=True)
class Traced:
    """An image by nocturne-trace, and its cost."""

    xyz: Channel
    """Shape (height, width, 3), Y in cd/m2."""
    y_error: Channel
    """Standard error of Y as independent samples would have it, shape (height, width)."""
    y_stderr: Channel
    """The stored standard error, which includes the variance of one more lit sample."""
    photons: int
    rays: int
    tracing_cpu_s: float
    """Without loading the scene and writing the image."""
    process_cpu_s: float
    process_wall_s: float


def trace(
    compiled: CompiledFolder,
    threads: int | None = None,
    options: Sequence[object] = (),
    program: Path | None = None,
) -> Traced:
    """Runs nocturne-trace, with further options; all processors where `threads` is None.

    Another program must take the same words.
    """
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        image, statistics = Path(folder) / "image.exr", Path(folder) / "statistics.json"
        cpu_s, wall_s = children_cpu_s(), time.monotonic()
        trace_to(compiled, image, threads, [*options, "--statistics", statistics], program)
        cpu_s, wall_s = children_cpu_s() - cpu_s, time.monotonic() - wall_s
        said: dict[str, Any] = json.loads(statistics.read_text())
        xyz, y_error = read_image(image)
        told = read_channels(image, ["Y.stderr"])[..., 0]
    counts = said["photons"], said["rays"]
    return Traced(xyz, y_error, told, *counts, said["cpu_seconds"], cpu_s, wall_s)


def trace_to(
    compiled: CompiledFolder,
    image: Path,
    threads: int | None = None,
    options: Sequence[object] = (),
    program: Path | None = None,
) -> None:
    """The same into a file that is kept."""
    files = [compiled.scene, "--schedule", compiled.schedule, "--blobs", compiled.blobs, "-o", image]
    more = [*options, "--threads", threads or os.cpu_count() or 1, "--quiet"]
    run([program or need_program("nocturne-trace"), *files, *more])


def run(command: Sequence[object]) -> str:
    """Gives what the program prints; NocturneClientError with its complaint where it fails."""
    words = [str(word) for word in command]
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise NocturneClientError(f"{words[0]} failed ({done.returncode}): {done.stderr.strip()}")
    return done.stdout


def bench_program(name: str) -> Path:
    """A program of bench/worker; NocturneClientError where it is not built."""
    path = CHECKOUT / "build" / "release" / "bench" / name
    if not path.is_file():
        raise NocturneClientError(f"{path} is missing: `make bench` builds it")
    return path


def children_cpu_s() -> float:
    """User and system time of all children that have ended, seconds."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def running_cpu_s(pid: int) -> float:
    """User and system time of a running process, seconds, in steps of 10 ms; see proc(5)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def kept_waiting_s(pid: int) -> float:
    """Seconds that the first thread of a running process had work and no processor; see proc(5)."""
    return int(Path(f"/proc/{pid}/schedstat").read_text().split()[1]) / 1e9


def read_image(path: Path) -> tuple[Channel, Channel]:
    """XYZ of shape (height, width, 3) and the standard error of Y, by pixels' own samples, of an EXR of
    ours."""
    told, own_ratio = np.moveaxis(read_channels(path, ["Y.stderr", "Y.ownRatio"]), -1, 0)
    return read_channels(path, "XYZ"), told * np.sqrt(own_ratio)


def read_channels(path: Path, names: Sequence[str]) -> Channel:
    """Some channels of a picture, in this order, of shape (height, width, number of names)."""
    image = OpenImageIO.ImageBuf(str(path))
    there = list(image.spec().channelnames)
    pixels: Channel = np.asarray(image.get_pixels(OpenImageIO.FLOAT), dtype=np.float64)
    return pixels[..., [there.index(name) for name in names]]
