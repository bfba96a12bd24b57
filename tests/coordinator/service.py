"""Starts and kills the processes of the fault tests, and checks their images."""

import os
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import redis
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.film import MergedFilm
from nocturne_coordinator.dispatch.planned_render import PlannedRender
from nocturne_coordinator.dispatch.stopping import EVERYTHING, StopConditions
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.rows import NewRender, RenderRow
from nocturne_scene.ranges import make_schedule
from nocturne_scene.responses import is_signed
from nocturne_scene.tile_sums import TileSums
from nocturne_scene.uncertainty import moments_of

from tests.coordinator.simulated_worker import SimulatedWorker, simulated_sums
from tests.system.forked import Forked
from tests.system.waiting import LIMIT_S, pause

SCENE = "5c" * 32


def wait_until(true: Callable[[], bool], seconds: float = LIMIT_S) -> None:
    """Fails the test if it does not become true. Tests of promised times pass their own seconds."""
    begun = time.monotonic()
    while not true():
        waited = time.monotonic() - begun
        assert waited < seconds, "did not happen in time"
        pause(waited)


class RedisServer:
    """redis-server without persistence, on a Unix socket."""

    def __init__(self, folder: Path, *options: str) -> None:
        self._socket = folder / "redis.sock"
        self._options = options
        self._process: subprocess.Popen[bytes] | None = None
        self.url = f"unix://{self._socket}"

    def start(self) -> None:
        self._process = subprocess.Popen(
            ["redis-server", "--port", "0", "--unixsocket", str(self._socket), "--save", "", *self._options],
            stdout=subprocess.DEVNULL,
        )
        wait_until(self._answers)

    def kill(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._socket.unlink(missing_ok=True)

    def client(self) -> "redis.Redis":
        return redis.Redis.from_url(self.url, protocol=2)

    def _answers(self) -> bool:
        client = self.client()
        try:
            return bool(client.ping())
        except redis.RedisError:
            return False
        finally:
            client.close()


class Service:
    """A data folder, coordinator processes that can be killed, simulated workers."""

    def __init__(self, data: Path, server: RedisServer) -> None:
        self.data = data
        self.server = server
        self.folder = DataFolder(data)
        self._process: Forked | None = None
        self._others: list[Forked] = []
        self._workers: list[SimulatedWorker] = []

    def start(self, crash_at: str = "", *options: str) -> Forked:
        """Another coordinator, in addition to the running ones."""
        if self._process is not None:
            self._others.append(self._process)
        words = ["--data", str(self.data), "--redis", self.server.url, "--commit-seconds", "0.1", *options]
        environment = os.environ | {"NOCTURNE_CRASH_AT": crash_at}
        self._process = Forked("nocturne_coordinator.main", words, environment)
        return self._process

    @property
    def pid(self) -> int:
        """Of the coordinator that was started last."""
        assert self._process is not None
        return self._process.pid

    def reopen(self) -> None:
        """Looks at the data folder that is there now."""
        self.folder.close()
        self.folder = DataFolder(self.data)

    def stop(self, number: int = signal.SIGTERM) -> int:
        """Ends the coordinator; gives its exit code."""
        assert self._process is not None
        self._process.send_signal(number)
        return self._process.wait(LIMIT_S)

    def work(self, worker: SimulatedWorker) -> SimulatedWorker:
        self._workers.append(worker)
        worker.start()
        return worker

    def stop_workers(self) -> None:
        for worker in self._workers:
            worker.stop()

    def close(self) -> None:
        self.stop_workers()
        for process in (*self._others, self._process):
            if process is not None and process.poll() is None:
                process.kill()
                process.wait()
        self.folder.close()

    def create(
        self,
        width: int = 70,
        height: int = 40,
        samples: int = 50,
        request_id: str = "a",
        further_responses: Sequence[str] = (),
        stop: StopConditions = EVERYTHING,
    ) -> RenderRow:
        schedule = make_schedule(width, height, samples, further_responses)
        return self.folder.renders.create(
            NewRender(request_id, "a test", SCENE, "{}", width, height, samples, schedule, stop)
        )

    def row(self, render_id: str) -> RenderRow:
        return self.folder.renders.get(render_id)

    def wait_for_end(self, render_id: str) -> RenderRow:
        # The image of a render that was extended is final for a moment more.
        wait_until(
            lambda: (row := self.row(render_id)).image_final and row.state not in ("QUEUED", "RUNNING")
        )
        return self.row(render_id)


def expected_film(folder: DataFolder, render_id: str, samples: dict[int, int]) -> MergedFilm:
    """What tracing alone, tile by tile and range by range, gives; `samples` merged per tile."""
    planned = PlannedRender(
        render_id, folder.renders.schedule(render_id), bytes.fromhex(SCENE), job_pb2.ENGINE_1
    )
    film = MergedFilm(planned)
    for index, end in samples.items():
        tile = planned.grid.tile(index)
        total = TileSums.zeros(tile.width, tile.height, planned.further)
        for position in range(planned.ranges.merged_at(end)):
            total += simulated_sums(planned.job(index, planned.ranges[position]), planned.further)
        film.load(index, end, total.encode())
    film.loaded()
    return film


def committed_samples(folder: DataFolder, render_id: str) -> dict[int, int]:
    rows = folder.database.rows("SELECT tile_index, samples FROM tile WHERE render_id = ?", (render_id,))
    return {row["tile_index"]: row["samples"] for row in rows}


def check_committed(service: Service, row: RenderRow, redone: bool = False) -> None:
    """Sums, counts, totals and the EXR are those of the committed samples, in every bit.

    `redone`: some were traced twice, as the first were not to be trusted; their rays count.
    """
    samples = committed_samples(service.folder, row.id)
    film = expected_film(service.folder, row.id, samples)
    planned = PlannedRender(
        row.id, service.folder.renders.schedule(row.id), bytes.fromhex(SCENE), job_pb2.ENGINE_1
    )
    for tile_row in service.folder.database.rows("SELECT * FROM tile WHERE render_id = ?", (row.id,)):
        assert tile_row["sums"] == film.tile_bytes(tile_row["tile_index"])
    assert row.photons == int(film.counts.sum(dtype=np.uint64))
    assert row.rays > 3 * row.photons if redone else row.rays == 3 * row.photons
    assert row.ranges_done == sum(planned.ranges.merged_at(end) for end in samples.values())
    xyz, stderr, read_counts = read_exr(service.folder.image_path(row.id))
    moments = moments_of(film.sums, film.counts, *film.squares)
    means = moments.mean.astype(np.float32)
    errors = np.sqrt(moments.variance + moments.one_more).astype(np.float32)
    assert np.array_equal(xyz, means[..., :3])
    assert np.array_equal(stderr, errors[..., 1])
    assert np.array_equal(read_counts, film.counts)
    further = read_further_responses(service.folder.image_path(row.id))
    assert sorted(further) == sorted(planned.schedule.further_responses)
    for index, name in enumerate(planned.schedule.further_responses):
        assert np.array_equal(further[name], means[..., 3 + index])


def check_complete(service: Service, render_id: str, redone: bool = False) -> None:
    """The render succeeded, and equals the one without any fault."""
    row = service.wait_for_end(render_id)
    assert row.state == "SUCCEEDED", row.reason
    tiles = len(committed_samples(service.folder, render_id))
    assert committed_samples(service.folder, render_id) == dict.fromkeys(range(tiles), row.samples)
    assert row.ranges_done == row.ranges_planned
    assert row.photons == row.width * row.height * row.samples
    check_committed(service, row, redone)
    assert service.folder.preview_path(render_id).is_file()


def read_exr(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """XYZ, standard error, counts."""
    channel = _read_channels(path)
    return np.stack([channel[name] for name in "XYZ"], axis=-1), channel["Y.stderr"], channel["n"]


def read_channel(path: Path, name: str) -> np.ndarray:
    """One of an EXR."""
    return np.asarray(_read_channels(path)[name])


def read_rgb(path: Path) -> np.ndarray:
    """What viewers show; empty where not all three are there."""
    channel = _read_channels(path)
    if not channel.keys() >= set("RGB"):
        return np.empty(0, dtype=np.float32)
    return np.stack([channel[name] for name in "RGB"], axis=-1)


def read_manifest(path: Path) -> str:
    """Samples of each tile, as the file tells them; empty where it does not."""
    image: Any = oiio.ImageInput.open(str(path))
    text = image.spec().get_string_attribute("nocturne:tileSamples")
    image.close()
    return str(text)


def read_further_responses(path: Path) -> dict[str, np.ndarray]:
    """Those channels by name."""
    return {
        name: channel
        for name, channel in _read_channels(path).items()
        if ("." not in name or (is_signed(name) and not name.endswith(".stderr")))
        and name not in ("X", "Y", "Z", "n", "R", "G", "B")
    }


def _read_channels(path: Path) -> dict[str, np.ndarray]:
    image: Any = oiio.ImageInput.open(str(path))
    channels = {
        name: image.read_image(0, 0, index, index + 1, "uint" if name == "n" else "float")[..., 0]
        for index, name in enumerate(image.spec().channelnames)
    }
    image.close()
    return channels
