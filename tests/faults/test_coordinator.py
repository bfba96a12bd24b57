"""Coordinators killed, slowed, doubled, upgraded, without room, told other things: rows C of the matrix."""

import os
import re
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator import limits
from nocturne_coordinator.errors import UnusableFolder
from nocturne_coordinator.main import EXIT_ALREADY_OWNED, EXIT_UNUSABLE
from nocturne_coordinator.queue import keys
from nocturne_coordinator.store.checkpoint import checkpoints
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.restoring import restore

from tests.coordinator.service import Service, committed_samples, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.coordinator.test_restoring import half_way
from tests.faults.survival import (
    SOME_DELAY,
    check_nothing_left,
    check_resumes,
    check_survived,
    half_done,
    note,
)
from tests.pictures import samples_of
from tests.system.waiting import LIMIT_S


def test_coordinator_killed(service: Service) -> None:
    """C1: with merged sums that are not committed; at each passage of each point in memory."""
    coordinator = service.start(crash_at="before-commit:2")
    render = service.create(samples=100)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    assert coordinator.wait(LIMIT_S) == -signal.SIGKILL
    service.start()
    check_resumes(service, render.id, "C1")
    check_survived(service, render.id)


def test_further_responses_come_through_a_restart(service: Service) -> None:
    """C1: they are kept as X, Y and Z are."""
    coordinator = service.start(crash_at="after-commit:2")
    render = service.create(further_responses=["rod", "far-red"])
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY, further_responses=2))
    assert coordinator.wait(LIMIT_S) != 0
    service.start()
    check_survived(service, render.id)


def test_a_killed_coordinator_is_replaced_at_once(service: Service) -> None:
    """C1: the next one does not wait for the lease of the dead one, here of a day: the epoch says who may
    have it."""
    service.start("", "--lease-seconds", "86400")
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: half_done(service, render.id))
    service.stop(signal.SIGKILL)
    done = service.row(render.id).ranges_done
    service.start()
    wait_until(lambda: service.row(render.id).ranges_done > done)
    check_survived(service, render.id)


def test_coordinator_in_a_crash_loop(service: Service) -> None:
    """C2: three lives in a row are cut off soon after their first commit, and each commits something."""
    service.start()
    render = service.create(width=160, height=120, samples=20_000)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    chance = np.random.default_rng(2)
    for _ in range(3):
        check_resumes(service, render.id, "C2")
        time.sleep(float(chance.uniform(0.0, 0.2)))
        assert service.stop(signal.SIGKILL) == -signal.SIGKILL
        assert service.row(render.id).ranges_done < service.row(render.id).ranges_planned
        service.start()
    check_survived(service, render.id)


def test_disk_full_in_mid_commit(service: Service) -> None:
    """C3: no file of the coordinator can grow; commits fail until it can."""
    process = service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).ranges_done > 0)
    _, hard = resource.prlimit(process.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (0, hard))
    # A write in progress may still finish.
    time.sleep(0.3)
    before = service.row(render.id).ranges_done
    time.sleep(1.0)
    assert service.row(render.id).ranges_done == before
    assert process.poll() is None
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, hard))
    check_resumes(service, render.id, "C3")
    check_survived(service, render.id)


@pytest.mark.parametrize("program", ["coordinator", "api"])
def test_a_full_disk_at_the_start(service: Service, tmp_path: Path, program: str) -> None:
    """C3: it says so and ends, and leaves nothing that blocks a later start."""
    data = tmp_path / "new"
    options = {"coordinator": ("--redis", service.server.url), "api": ("--port", "0", "--grpc-port", "0")}
    run = subprocess.run(
        [
            *("prlimit", "--fsize=0", sys.executable, "-m", f"nocturne_{program}.main", "--data", data),
            *options[program],
        ],
        stderr=subprocess.PIPE,
        text=True,
        timeout=300,
        check=False,
    )
    assert run.returncode == EXIT_UNUSABLE
    assert re.search(f"{program}:? {data} can't be used .*space on its disk", run.stderr)
    assert len(run.stderr.splitlines()) == 1
    DataFolder(data).close()


def test_pictures_that_can_not_be_written_only_delay(service: Service) -> None:
    """C3: images can not be written."""
    obstacle = service.data / "images"
    obstacle.write_text("in the way")
    coordinator = service.start()
    render = service.create(samples=10)
    service.work(SimulatedWorker(service.server.url))
    wait_until(lambda: service.row(render.id).ranges_done > 0)
    time.sleep(0.5)
    assert coordinator.poll() is None
    assert service.row(render.id).state == "RUNNING"
    obstacle.unlink()
    check_survived(service, render.id)


def damage(database: Path) -> None:
    """Writes over the middle of the file, and its head."""
    with database.open("r+b") as file:
        file.seek(0)
        file.write(b"\xff" * 200)
        file.seek(database.stat().st_size // 2)
        file.write(b"\xff" * 5000)


def test_a_damaged_database_is_replaced_by_the_newest_whole_checkpoint(service: Service) -> None:
    """C4: the database is damaged, and the newest checkpoint too."""
    render = half_way(service)
    place = service.data / "checkpoints"
    wait_until(lambda: len(checkpoints(place)) >= 1)
    # Something new to copy, however far the first render is by now.
    service.create(samples=1, request_id="another")
    wait_until(lambda: len(checkpoints(place)) == 2)
    service.stop(signal.SIGKILL)
    newest, before = checkpoints(place)
    assert not list(place.glob(".*"))
    assert {path.name for path in place.glob("*.db")} == {f"{each.number:06}.db" for each in (newest, before)}
    damage(newest.database(place))
    service.folder.close()
    damage(service.data / "nocturne.db")
    assert service.start().wait(LIMIT_S) == EXIT_UNUSABLE
    with pytest.raises(UnusableFolder, match="nocturne restore"):
        service.reopen()

    found = restore(service.data)
    assert found.database == before.database(place)
    assert any("damaged" in each for each in found.damage)
    assert (service.data / "damaged-1" / "nocturne.db").is_file()
    service.reopen()
    assert list(service.folder.tiles.manifest(render)) == samples_of(before.renders[render])
    service.start()
    check_survived(service, render)
    # Once more: nothing to do.
    service.stop()
    assert restore(service.data).damage == []


def test_second_coordinator_is_refused(service: Service) -> None:
    """C5: on one data folder."""
    first = service.start()
    wait_until(lambda: _epoch(service) == 1)
    assert service.start().wait(LIMIT_S) == EXIT_ALREADY_OWNED
    assert first.poll() is None
    assert _epoch(service) == 1
    first.terminate()
    assert first.wait(LIMIT_S) == 0


def _epoch(service: Service) -> int:
    row = service.folder.database.row("SELECT epoch FROM ownership")
    return int(row["epoch"]) if row else 0


def test_coordinator_stopped_and_resumed(service: Service) -> None:
    """C7: in order, by one of the same engine."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: half_done(service, render.id))
    assert service.stop() == 0
    before = service.row(render.id)
    assert before.state == "RUNNING"
    service.start()
    check_survived(service, render.id)


@contextmanager
def ten_times_slower(pid: int) -> Iterator[None]:
    """The process stands still for nine tenths of the time."""
    over = threading.Event()

    def brake() -> None:
        while not over.is_set():
            os.kill(pid, signal.SIGSTOP)
            over.wait(0.09)
            os.kill(pid, signal.SIGCONT)
            over.wait(0.01)

    thread = threading.Thread(target=brake)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def resident_bytes(pid: int) -> int:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * resource.getpagesize()


def test_a_slow_merger_holds_the_workers_back(service: Service) -> None:
    """C6: workers that need no time for a job never have more than a window of them; memory is bounded.

    Beside those are results that wait for a commit, and at most as many while it is being made.
    """
    workers = 6
    window = max(limits.MIN_WINDOW, limits.JOBS_PER_THREAD * workers)
    process = service.start()
    render = service.create(width=320, height=224, samples=300)
    assert render.ranges_planned > 8 * window
    most, committed, memory = 0, 0, []
    with service.server.client() as client, ten_times_slower(process.pid):
        for _ in range(workers):
            service.work(SimulatedWorker(service.server.url))
        wait_until(lambda: service.row(render.id).ranges_done > window)
        before = resident_bytes(process.pid), client.info("memory")["used_memory"]
        begun, done = time.monotonic(), service.row(render.id).ranges_done
        last = done
        while time.monotonic() - begun < 4.0:
            both = client.pipeline(transaction=True).xlen(keys.JOBS).xlen(keys.RESULTS).execute()
            now = service.row(render.id).ranges_done
            most, committed, last = max(most, sum(both)), max(committed, now - last), now
            memory.append((resident_bytes(process.pid), client.info("memory")["used_memory"]))
            # More frequent looks would take as much processor time as the coordinator.
            time.sleep(0.01)
        row = service.row(render.id)
        assert row.ranges_done > done
        assert row.ranges_done < row.ranges_planned, "it was over too soon to say anything"
    grown = [max(values) - first for values, first in zip(zip(*memory, strict=True), before, strict=True)]
    note(
        "C6", most=most, window=window, committed=committed, coordinator_bytes=grown[0], redis_bytes=grown[1]
    )
    bound = window + 2 * committed
    assert most <= bound
    # A result is 75 kB; all that there are would be 42 MB. The coordinator also makes pictures.
    assert grown[1] <= bound * 90_000
    assert grown[0] <= 8_000_000
    check_survived(service, render.id)


def test_an_upgrade_in_mid_render_never_mixes_engines(service: Service) -> None:
    """C7: the render says that it was begun by an older engine: refused in words, and nothing is added."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: half_done(service, render.id))
    service.stop()
    before = committed_samples(service.folder, render.id)
    assert service.row(render.id).ranges_done < render.ranges_planned
    older = job_pb2.ENGINE_CURRENT - 1
    service.folder.database.execute("UPDATE render SET engine = ? WHERE id = ?", (older, render.id))
    service.start()
    wait_until(lambda: service.row(render.id).state.ended)
    row = service.row(render.id)
    assert row.state == "FAILED"
    assert f"made for engine {older}; this service traces with engine {job_pb2.ENGINE_CURRENT}" in row.reason
    check_nothing_left(service)
    assert committed_samples(service.folder, render.id) == before
    # Another is not held up by it.
    check_survived(service, service.create(samples=20, request_id="again").id)
