"""The real coordinator and a real Redis against ten thousand simulated workers on this machine."""

import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import redis
from nocturne.v1 import job_pb2
from nocturne_client.local.programs import need_program
from nocturne_coordinator.queue import keys
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule

from bench.fleet import MACHINE
from bench.programs import kept_waiting_s, running_cpu_s
from bench.report import Figures, Row, significant

WORKERS = 10_000
JOB_S = 30.0
RENDERS, EDGE = 6, 1024
"""A night's work: six renders of a million pixels."""

AIM = 333.0
"""Results a second of 10,000 cores with jobs of 30 s."""

_LOOK_S = 0.5


@dataclass
class Farm:
    """What runs, and where to look."""

    folder: DataFolder
    client: Any
    coordinator: "subprocess.Popen[bytes]"
    redis_pid: int
    url: str
    key: bytes = b""
    """Of the machine that all workers are of; empty: none."""

    def merged(self) -> int:
        row = self.folder.database.row("SELECT sum(ranges_done) AS done FROM render")
        return int(row["done"] or 0) if row is not None else 0

    def merged_cpu_s(self) -> float:
        """Processor seconds of all ranges that are merged and committed."""
        return self.folder.renders.counted()["cpu_seconds"]

    def waiting_cpu_s(self) -> float:
        """The same of ranges whose results wait for earlier ones."""
        waiting: dict[tuple[str, int, int], float] = {}
        for _, fields in self.client.xrange(keys.RESULTS):
            result = job_pb2.JobResult.FromString(fields[keys.RESULT_FIELD])
            place = (result.job.render_id, result.job.tile_index, result.job.first_sample)
            waiting[place] = result.partial.cpu_seconds
        return sum(waiting.values())

    def failed_tiles(self) -> int:
        """Tiles that get no more samples, because a range failed on several workers."""
        return len(self.folder.database.rows("SELECT * FROM failed_tile"))


def run(quick: bool) -> Figures:
    """First as fast as it goes, a few workers without pause; then steady, all workers with jobs of 30 s."""
    workers, flood_s, steady_s = (500, 5.0, 10.0) if quick else (WORKERS, 20.0, 60.0)
    with farm() as here, fleet(here.url, 64, 0.0):
        flood = _watched(here, 3.0, flood_s)
    with farm(enrolled=True) as here, fleet(here.url, 64, 0.0, key=here.key):
        signed = _watched(here, 3.0, flood_s)
    job_s = 3.0 if quick else JOB_S
    with farm() as here, fleet(here.url, workers, job_s):
        steady = _watched(here, 1.5 * job_s, steady_s)
    steady["asked_per_s"] = significant(workers / job_s)
    return {"workers": workers, "job_s": job_s, "flood": flood, "signed": signed, "steady": steady}


def rows(figures: Figures) -> list[Row]:
    """The coordinator's capacity in a flood, and its behaviour at the steady rate."""
    flood, steady = figures["flood"], figures["steady"]
    kept_waiting = steady["coordinator_kept_waiting"]
    many = f"{figures['workers']} workers, {figures['job_s']:g} s a job"
    return [
        Row("flood: merges/s", f"{flood['merged_per_s']:.3g}"),
        *_signed_rows(figures),
        Row(
            f"{many}: merges per CPU second of the coordinator, of Redis",
            f"{steady['merged_per_cpu_s']:.4g}, {steady['merged_per_redis_cpu_s']:.4g}",
            f"above {AIM:g}",
        ),
        Row(f"{many}: merges/s", f"{steady['merged_per_s']:.3g} of {steady['asked_per_s']:.3g}"),
        Row(
            f"{many}: longest wait of a result in two seconds, s",
            f"{steady['lag_s_median']:.2g}, at most {steady['lag_s_most']:.2g}",
        ),
        Row(
            f"{many}: of a processor, coordinator and Redis; coordinator kept from one by other programs",
            f"{steady['coordinator_cpu']:.2f}, {steady['redis_cpu']:.2f}; {kept_waiting:.2f}",
        ),
        Row(
            f"{many}: memory, coordinator and Redis",
            f"{steady['coordinator_mib']:.0f} MiB, {steady['redis_mib']:.0f} MiB",
        ),
    ]


def _signed_rows(figures: Figures) -> list[Row]:
    """Where workers enrol; figures of before that have none."""
    if "signed" not in figures:
        return []
    cost = figures["flood"]["merged_per_cpu_s"] / figures["signed"]["merged_per_cpu_s"]
    return [
        Row(
            "flood, signed by a machine: coordinator's CPU for each result, against unsigned",
            f"{cost:.3g}",
            "1.1",
        )
    ]


def _watched(here: Farm, settle_s: float, seconds: float) -> Figures:
    time.sleep(settle_s)
    began, merged = time.monotonic(), here.merged()
    cpu, redis_cpu = running_cpu_s(here.coordinator.pid), running_cpu_s(here.redis_pid)
    kept_waiting = kept_waiting_s(here.coordinator.pid)
    lags, redis_bytes = [], 0
    while time.monotonic() < began + seconds:
        time.sleep(_LOOK_S)
        lags.append(here.folder.meters.read().get("result_seconds", 0.0))
        redis_bytes = max(redis_bytes, int(here.client.info("memory")["used_memory"]))
    took, merged = time.monotonic() - began, here.merged() - merged
    used = running_cpu_s(here.coordinator.pid) - cpu
    redis_used = running_cpu_s(here.redis_pid) - redis_cpu
    return {
        "merged_per_s": significant(merged / took),
        "merged_per_cpu_s": significant(merged / used),
        "merged_per_redis_cpu_s": significant(merged / redis_used),
        "lag_s_median": significant(sorted(lags)[len(lags) // 2]),
        "lag_s_most": significant(max(lags)),
        "coordinator_cpu": significant(used / took),
        "coordinator_kept_waiting": significant((kept_waiting_s(here.coordinator.pid) - kept_waiting) / took),
        "redis_cpu": significant(redis_used / took),
        "coordinator_mib": significant(_resident_bytes(here.coordinator.pid) / 2**20),
        "redis_mib": significant(redis_bytes / 2**20),
    }


def night_of_renders(folder: DataFolder) -> None:
    """Renders that last the night."""
    schedule = make_schedule(EDGE, EDGE, 2**20)
    for number in range(RENDERS):
        folder.renders.create(NewRender(f"{number}", "", "5c" * 32, "{}", EDGE, EDGE, 2**20, schedule))


def _resident_bytes(pid: int) -> int:
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * 4096


@contextmanager
def farm(*options: str, enrolled: bool = False) -> Iterator[Farm]:
    """Redis, a coordinator with these options, and renders that last the night."""
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as place:
        socket = Path(place) / "redis.sock"
        url = f"unix://{socket}"
        server = subprocess.Popen(
            [str(need_program("redis-server")), "--port", "0", "--unixsocket", str(socket), "--save", ""],
            stdout=subprocess.DEVNULL,
        )
        folder = DataFolder(Path(place) / "data")
        coordinator = None
        key = b""
        if enrolled:
            folder.tokens.create(MACHINE, ["worker"])
            _, key = folder.machines.enrol(MACHINE)
        try:
            night_of_renders(folder)
            while not socket.exists():
                time.sleep(0.05)
            words: list[str | Path] = [
                "--data",
                folder.root,
                "--redis",
                url,
                "--checkpoint-seconds",
                "0",
                "--log-level",
                "error",
                # Jobs here take as long, whatever their samples: they would be cut.
                "--job-seconds",
                "1e9",
                *(["--enrolled"] if enrolled else []),
                *options,
            ]
            coordinator = subprocess.Popen([sys.executable, "-m", "nocturne_coordinator.main", *words])
            client: Any = redis.Redis.from_url(url, protocol=2)
            yield Farm(folder, client, coordinator, server.pid, url, key)
        finally:
            for process in (coordinator, server):
                if process is not None:
                    process.kill()
                    process.wait()
            folder.close()


@contextmanager
def fleet(
    url: str, workers: int, job_s: float, lease_s: float = 10.0, killed_s: float = 0.0, key: bytes = b""
) -> Iterator[dict[str, Any]]:
    """Runs workers in a separate process; their final report is in the dictionary afterwards."""
    words = ["-m", "bench.fleet", url, *map(str, (workers, job_s, lease_s, killed_s)), key.hex()]
    said: dict[str, Any] = {}
    with subprocess.Popen([sys.executable, *words], stdout=subprocess.PIPE) as process:
        try:
            yield said
        finally:
            process.send_signal(signal.SIGTERM)
        assert process.stdout is not None  # noqa: S101 - asked for
        said.update(json.loads(process.stdout.read()))
