"""A large density grid through the whole service: upload, compile, fetch, trace; memory by process.

The grid is noise in every voxel, which neither compression nor sparsity makes much smaller. Two worker
processes fetch it into one cache; each has its own copy in memory.
"""

import json
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from nocturne_client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_client.local.programs import need_program

from bench.programs import run as run_program
from bench.report import Figures, Row, significant
from bench.running_service import running_service

WORKERS = 2
MAX_OF_GRID = 1.2
"""A worker's memory over the grid's: bounds may take an eighth, the program itself has some 35 MB."""
_SIZES = {False: (512, 512, 480), True: (128, 128, 120)}
"""Voxels, of 4 bytes: 500 MB."""
_FILM = (64, 64, 16)
_LOOK_S = 0.05
_STEPS = ("upload", "submit", "first result after submit", "end after submit")


@dataclass
class Memory:
    """Most resident bytes of each process below a given one, by name."""

    root: int
    most: dict[str, int] = field(default_factory=dict)

    def look(self) -> None:
        """Once; the kernel keeps each process's own maximum."""
        parents = {pid: _parent(pid) for pid in (int(p.name) for p in Path("/proc").glob("[0-9]*"))}
        for pid in parents:
            above: int | None = pid
            while above is not None and above != self.root:
                above = parents.get(above)
            if above is not None:
                self._keep(pid)

    def _keep(self, pid: int) -> None:
        try:
            words = Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
            lines = Path(f"/proc/{pid}/status").read_text().splitlines()
        except OSError:
            return
        if not words[0]:
            return  # It has just ended.
        name = _name([word.decode(errors="replace") for word in words])
        most = next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM")), 0)
        self.most[name] = max(self.most.get(name, 0), most)


def run(quick: bool) -> Figures:
    """Seconds of each step; the most bytes that each process held."""
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        place = Path(folder)
        scene = _write_scene(place, _SIZES[quick])
        with running_service(workers=WORKERS, threads=1) as service, Client(service.url) as client:
            with _watched(service.pids["up"]) as memory:
                steps = _steps(client, scene)
            # Of those names that a digest has: neither half-fetched files nor the scene.
            cached = sorted(p.stat().st_size for p in (service.data / "cache").glob("??/*"))
            blobs = sorted(p.stat().st_size for p in (service.data / "blobs").glob("??/*"))
        file_bytes = (place / "noise.vdb").stat().st_size
    return {
        "file_bytes": file_bytes,
        "grid_bytes": cached[-1],
        "cache_bytes": sum(cached),
        "store_bytes": sum(blobs),
        "seconds": {name: significant(seconds) for name, seconds in steps.items()},
        "most_bytes": dict(sorted(memory.most.items())),
    }


def rows(figures: Figures) -> list[Row]:
    """Times, and memory as parts of the grid."""
    grid, seconds, most = figures["grid_bytes"], figures["seconds"], figures["most_bytes"]
    # JSON does not keep the order; repeated steps come last.
    order = [first + name for first in ("", "again: ") for name in _STEPS]
    times = ", ".join(f"{name} {seconds[name]:.3g}" for name in order if name in seconds)
    memory = ", ".join(
        f"{name} {value / 1e6:.0f}" for name, value in sorted(most.items(), key=lambda item: -item[1])
    )
    worker = max(value for name, value in most.items() if name.startswith("worker"))
    return [
        Row(f"seconds, with a file of {figures['file_bytes'] / 1e6:.0f} MB", times),
        Row(f"most memory of each process, MB, with a grid of {grid / 1e6:.0f} MB", memory),
        Row("memory of a worker process / grid", f"{worker / grid:.3g}", f"at most {MAX_OF_GRID}"),
        Row(f"cache that {WORKERS} workers share / grid", f"{figures['cache_bytes'] / grid:.3g}", "1"),
    ]


def _write_scene(folder: Path, dims: tuple[int, int, int]) -> Path:
    """A scene of one box of noise; gives its path."""
    noise = np.random.default_rng(1).random(dims, dtype=np.float32) + np.float32(0.5)
    noise.astype("<f4").tofile(folder / "noise.f32")
    del noise
    description: dict[str, Any] = {"dims": dims, "voxel_size": 1.0 / max(dims)}
    description["grids"] = [{"name": "density", "file": "noise.f32"}]
    (folder / "noise.json").write_text(json.dumps(description))
    grid_program = need_program("nocturne-grid")
    run_program([grid_program, "create", folder / "noise.json", "-o", folder / "noise.vdb"])
    (folder / "noise.f32").unlink()
    scene = {
        "nocturne": 1,
        "media": {"noise": {"scattering": 2, "density": {"asset": "noise.vdb", "grid": "density"}}},
        "environment": {"radiance": {"table": [[300, 1], [900, 1]]}},
        "sensor": {
            "type": "pinhole",
            "position": [0.5, 0.5, 3.5],
            "look_at": [0.5, 0.5, 0.5],
            "vertical_field_of_view_degrees": 25,
        },
        "surfaces": [
            {"shape": {"type": "medium_box", "medium": "noise"}, "interior": {"media": ["noise"]}},
        ],
    }
    path = folder / "scene.json"
    path.write_text(json.dumps(scene))
    return path


def _steps(client: Client, scene: Path) -> dict[str, float]:
    """Seconds: upload, submit (which compiles), until the first range is in and until the end; and again."""
    seconds = {}
    start = time.monotonic()
    client.upload(scene.with_name("noise.vdb"))
    seconds["upload"] = time.monotonic() - start
    for what in ("", "again: "):
        start = time.monotonic()
        render_id = client.submit(scene, *_FILM).id
        submitted = time.monotonic()
        first = None
        for render in client.watch(render_id):
            if first is None and render.progress.ranges_done > 0:
                first = time.monotonic()
        if render.state != "SUCCEEDED" or render.progress.invalid_samples > 0 or first is None:
            raise NocturneClientError(f"the render is {render.state}: {render.reason}")
        seconds[f"{what}submit"] = submitted - start
        seconds[f"{what}first result after submit"] = first - submitted
        seconds[f"{what}end after submit"] = time.monotonic() - submitted
    return seconds


@contextmanager
def _watched(root: int) -> Iterator[Memory]:
    """Memory of the processes below `root` while inside `with`."""
    memory, over = Memory(root), threading.Event()

    def look() -> None:
        while not over.wait(_LOOK_S):
            memory.look()

    thread = threading.Thread(target=look)
    thread.start()
    try:
        yield memory
    finally:
        over.set()
        thread.join()


def _parent(pid: int) -> int | None:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return None


def _name(words: list[str]) -> str:
    """What a process is, by its command: workers each by their own number."""
    program = Path(words[0].split(" ")[0]).name
    if program == "nocturne-worker" and "--id" in words:
        return words[words.index("--id") + 1]
    if program.startswith("python") and "-m" in words:
        return words[words.index("-m") + 1].removesuffix(".main")
    return program
