"""Whatever is killed, emptied, repeated or forged: the image is that of a run without faults, bit for bit."""

import json
import random
import resource
import signal
import threading
import time
import zipfile
from pathlib import Path

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator import keys, limits
from nocturne_coordinator.main import EXIT_ALREADY_OWNED, EXIT_UNUSABLE

from tests.coordinator.service import (
    RedisServer,
    Service,
    check_committed,
    check_complete,
    committed_samples,
    wait_until,
)
from tests.coordinator.simulated_worker import SimulatedWorker, TwiceAndShuffled

SOME_DELAY = 0.02
"""Seconds per job: a fault hits a render in the middle."""


def half_done(service: Service, render_id: str) -> bool:
    row = service.row(render_id)
    return row.ranges_done >= row.ranges_planned // 3


def test_two_renders_share_the_workers(service: Service) -> None:
    service.start()
    renders = [service.create(request_id=name, samples=20 + index) for index, name in enumerate("ab")]
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url))
    for render in renders:
        check_complete(service, render.id)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.RESULTS) == 0 and client.xlen(keys.JOBS) == 0)
    assert service.folder.error_history(renders[0].id)
    wait_until(lambda: len(service.folder.workers()) == 2)
    assert service.stop() == 0


def test_further_responses_come_through_a_restart(service: Service) -> None:
    coordinator = service.start(crash_at="after-commit:2")
    render = service.create(further_responses=["rod", "far-red"])
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY, further_responses=2))
    assert coordinator.wait(15) != 0
    service.start()
    check_complete(service, render.id)


@pytest.mark.parametrize("seed", [1, 2])
def test_results_twice_and_shuffled(service: Service, seed: int) -> None:
    service.start()
    render = service.create()
    for offset in range(2):
        service.work(SimulatedWorker(service.server.url, TwiceAndShuffled(seed + 10 * offset)))
    check_complete(service, render.id)


@pytest.mark.parametrize(
    "place",
    ["received:9", "merged:9", "before-commit:2", "after-commit:2", "after-acknowledge:2"],
)
def test_coordinator_killed(service: Service, place: str) -> None:
    coordinator = service.start(crash_at=place)
    render = service.create(samples=100)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    assert coordinator.wait(15) == -signal.SIGKILL
    service.start()
    check_complete(service, render.id)


def test_coordinator_stopped_and_resumed(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: half_done(service, render.id))
    assert service.stop() == 0
    before = service.row(render.id)
    assert before.state == "RUNNING"
    service.start()
    check_complete(service, render.id)


def test_redis_killed_and_restarted_empty(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    for pause in (0.0, 0.4):
        ranges = service.row(render.id).ranges_done
        wait_until(lambda ranges=ranges: service.row(render.id).ranges_done > ranges)  # type: ignore[misc]
        service.server.kill()
        time.sleep(pause)
        service.server.start()
    check_complete(service, render.id)


def test_redis_comes_late(service: Service) -> None:
    service.server.kill()
    service.start()
    render = service.create(samples=10)
    time.sleep(0.5)
    service.server.start()
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)


def test_redis_emptied(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    with service.server.client() as client:
        for _ in range(3):
            time.sleep(0.2)
            client.flushall()
    check_complete(service, render.id)


def test_consumer_group_destroyed(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: half_done(service, render.id))
    with service.server.client() as client:
        client.xgroup_destroy(keys.JOBS, keys.WORKERS_GROUP)
    check_complete(service, render.id)


def test_worker_killed_in_mid_job(service: Service) -> None:
    service.start()
    render = service.create(samples=20)
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.JOBS)) and client.xlen(keys.JOBS) > 0)
        # Takes jobs and is never heard of again.
        client.xreadgroup(keys.WORKERS_GROUP, "dead/0", {keys.JOBS: ">"}, count=3)
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)


@pytest.mark.soak
def test_a_worker_takes_the_jobs_of_others_off_the_stream(service: Service) -> None:
    """Acknowledged and deleted, and nobody sends a result: they are overdue after a minute."""
    service.start()
    render = service.create(samples=100)
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.JOBS)) and client.xlen(keys.JOBS) > 3)
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
        wait_until(lambda: half_done(service, render.id))
        gone = [entry for entry, _ in client.xrange(keys.JOBS)]
        assert gone
        client.xack(keys.JOBS, keys.WORKERS_GROUP, *gone)
        client.xdel(keys.JOBS, *gone)
    wait_until(lambda: service.row(render.id).state.ended, seconds=100.0)
    check_complete(service, render.id)


def test_redis_out_of_memory(service: Service) -> None:
    with service.server.client() as client:
        client.config_set("maxmemory", 1)
        service.start()
        render = service.create(samples=20)
        wait_until(lambda: service.folder.meters().get("redis_in_step") == 0.0)
        assert service.row(render.id).ranges_done == 0
        client.config_set("maxmemory", 0)
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)


def test_disk_full_in_mid_commit(service: Service) -> None:
    """No file of the coordinator can grow; commits fail until it can."""
    process = service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).ranges_done > 0)
    _, hard = resource.prlimit(process.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (0, hard))
    # What was being written may still arrive.
    time.sleep(0.3)
    before = service.row(render.id).ranges_done
    time.sleep(1.0)
    assert service.row(render.id).ranges_done == before
    assert process.poll() is None
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, hard))
    check_complete(service, render.id)


class Forger:
    """Sends impossible results, now and then in the place of a good one; each job's second result is good."""

    def __init__(self) -> None:
        self._random = random.Random(3)
        self._seen: set[bytes] = set()

    def __call__(self, result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        job = result.job.SerializeToString()
        if job in self._seen:
            return [result]
        self._seen.add(job)
        return [b"\xff\x00garbage", b"", self._forged(result)]

    def _forged(self, result: job_pb2.JobResult) -> job_pb2.JobResult:
        forged = job_pb2.JobResult()
        forged.CopyFrom(result)
        match self._random.randrange(6):
            case 0:
                forged.partial.sums = forged.partial.sums[:-8]
            case 1:
                forged.partial.sums = b"\xff" * len(forged.partial.sums)
            case 2:
                forged.partial.photons += 1
            case 3:
                forged.ClearField("outcome")
            case 4:
                forged.failure = "The scene could not be fetched."
            case 5:
                forged.partial.rejected = forged.partial.photons + 1
        return forged


def test_garbage(service: Service) -> None:
    service.start()
    render = service.create(samples=20)
    service.work(SimulatedWorker(service.server.url, Forger()))
    with service.server.client() as client:
        client.xadd(keys.RESULTS, {"other": "field"})
        client.xadd(keys.JOBS, {"other": "field"})
        client.set(keys.WORKER_PREFIX + "x", b"\xff\xff")
    check_complete(service, render.id)


def failure_of(result: job_pb2.JobResult, reason: str) -> job_pb2.JobResult:
    return job_pb2.JobResult(job=result.job, worker_id=result.worker_id, failure=reason)


@pytest.mark.parametrize("workers", [1, 4])
def test_a_range_that_keeps_failing_degrades_the_render(service: Service, workers: int) -> None:
    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        if result.job.tile_index == 1 and result.job.first_sample == 8:
            return [failure_of(result, "The scene has a hole.")]
        return [result]

    service.start()
    render = service.create(samples=100)
    for _ in range(workers):
        service.work(SimulatedWorker(service.server.url, failing))
    row = service.wait_for_end(render.id)
    assert row.state == "DEGRADED"
    assert "Tiles 1 (x 32, y 0, 8 samples)" in row.reason
    assert "The scene has a hole." in row.reason
    assert row.ended >= row.started > 0
    samples = committed_samples(service.folder, render.id)
    assert samples == dict.fromkeys(range(6), 100) | {1: 8}
    assert row.tiles_set_aside == 1
    check_committed(service, row)
    assert service.folder.workers_in_quarantine() == {}
    with zipfile.ZipFile(service.folder.bundle_path(render.id, 1)) as bundle:
        job = job_pb2.Job.FromString(bundle.read("job.pb"))
        assert (job.render_id, job.tile_index, job.first_sample) == (render.id, 1, 8)
        said = json.loads(bundle.read("failure.json"))
    assert said["reason"] == "The scene has a hole."
    assert len(said["workers"]) == min(workers, limits.DISTINCT_WORKERS)


def test_a_degraded_render_can_be_tried_again(service: Service) -> None:
    broken = threading.Event()
    broken.set()

    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        if broken.is_set() and result.job.tile_index == 2:
            return [failure_of(result, "The disk is full.")]
        return [result]

    service.start()
    render = service.create(samples=20)
    service.work(SimulatedWorker(service.server.url, failing))
    assert service.wait_for_end(render.id).state == "DEGRADED"
    broken.clear()
    service.folder.request_resume(render.id)
    wait_until(lambda: service.row(render.id).state == "SUCCEEDED")
    check_complete(service, render.id)


def test_a_scene_that_nobody_can_trace_fails_the_render_and_no_worker(service: Service) -> None:
    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        return [failure_of(result, "The scene has no sensor.")]

    service.start()
    render = service.create(samples=100)
    for _ in range(3):
        service.work(SimulatedWorker(service.server.url, failing))
    row = service.wait_for_end(render.id)
    assert (row.state, row.reason) == ("FAILED", "The scene has no sensor.")
    assert service.folder.workers_in_quarantine() == {}


def test_a_worker_that_fails_jobs_which_others_can_do_is_quarantined(service: Service) -> None:
    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        return [failure_of(result, "Out of memory.")]

    service.start()
    render = service.create(samples=100)
    bad = service.work(SimulatedWorker(service.server.url, failing))
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    check_complete(service, render.id)
    assert list(service.folder.workers_in_quarantine()) == [bad.name]
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.QUARANTINE_PREFIX + bad.name)))
    service.folder.release_worker(bad.name)
    assert service.folder.workers_in_quarantine() == {}


def test_cancel_keeps_what_was_merged(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: half_done(service, render.id))
    assert service.folder.request_cancel(render.id).state == "CANCELLED"
    row = service.wait_for_end(render.id)
    assert 0 < row.ranges_done < row.ranges_planned
    check_committed(service, row)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) == 0 and client.xlen(keys.RESULTS) == 0)


def test_cancel_while_no_coordinator_runs(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: half_done(service, render.id))
    service.stop(signal.SIGKILL)
    service.folder.request_cancel(render.id)
    queued = service.create(request_id="queued")
    service.folder.request_cancel(queued.id)
    service.start()
    row = service.wait_for_end(render.id)
    assert row.state == "CANCELLED"
    check_committed(service, row)
    assert service.wait_for_end(queued.id).photons == 0


def test_pictures_that_can_not_be_written_only_delay(service: Service) -> None:
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
    check_complete(service, render.id)


def test_second_coordinator_is_refused(service: Service) -> None:
    first = service.start()
    wait_until(lambda: (service.data / "coordinator.lock").exists() and _epoch(service) == 1)
    assert service.start().wait(15) == EXIT_ALREADY_OWNED
    assert first.poll() is None
    assert _epoch(service) == 1
    first.terminate()
    assert first.wait(15) == 0


def _epoch(service: Service) -> int:
    row = service.folder.database.row("SELECT epoch FROM ownership")
    return int(row["epoch"]) if row else 0


def test_redis_that_forgets_is_refused(tmp_path: Path) -> None:
    server = RedisServer(tmp_path, "--maxmemory-policy", "allkeys-lru")
    server.start()
    service = Service(tmp_path / "data", server)
    try:
        assert service.start().wait(15) == EXIT_UNUSABLE
    finally:
        service.close()
        server.kill()
