"""Workers that are killed, poisoned, slow, gone, restarted, of another engine: rows W of the fault matrix."""

import json
import random
import threading
import time
import zipfile

import pytest
from nocturne.v1 import job_pb2
from nocturne_coordinator import limits
from nocturne_coordinator.queue import keys

from tests.coordinator.service import Service, check_committed, check_complete, committed_samples, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker, simulated_result
from tests.faults.survival import OVERDUE_SOON, SOME_DELAY, check_resumes, check_survived, half_done


def test_worker_killed_in_mid_job(service: Service) -> None:
    """W1: it takes jobs and is never heard of again."""
    service.start()
    render = service.create(samples=20)
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.JOBS)) and client.xlen(keys.JOBS) > 0)
        client.xreadgroup(keys.WORKERS_GROUP, "dead/0", {keys.JOBS: ">"}, count=3)
    service.work(SimulatedWorker(service.server.url))
    check_survived(service, render.id)


@pytest.mark.parametrize("acknowledged_first", [False, True])
def test_killed_between_result_and_acknowledgement(service: Service, acknowledged_first: bool) -> None:
    """W2: for workers they are one step, so another program does one half and never the other."""
    service.start("", *OVERDUE_SOON)
    render = service.create(samples=20)
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.JOBS)) and client.xlen(keys.JOBS) > 3)
        taken = client.xreadgroup(keys.WORKERS_GROUP, "dead/0", {keys.JOBS: ">"}, count=3)
        for entry, fields in taken[0][1]:
            if acknowledged_first:
                client.xack(keys.JOBS, keys.WORKERS_GROUP, entry)
            else:
                result = simulated_result(job_pb2.Job.FromString(fields[keys.JOB_FIELD]), "dead")
                client.xadd(keys.RESULTS, {keys.RESULT_FIELD: result.SerializeToString()})
    service.work(SimulatedWorker(service.server.url))
    check_survived(service, render.id)


def test_a_job_that_kills_workers_is_given_up(service: Service) -> None:
    """W3: three distinct workers die of it."""
    service.start()
    render = service.create(samples=8)

    def dies(result: job_pb2.JobResult) -> bool:
        return result.job.tile_index == 4 and result.job.first_sample == 4

    def seen(worker: str) -> bool:
        return (4, worker) in service.folder.tiles.at_work(render.id)

    for _ in range(3):
        service.work(SimulatedWorker(service.server.url, dies=dies, seen=seen, status_ms=1500, lease_ms=2500))
    wait_until(lambda: service.row(render.id).image_final)
    row = service.row(render.id)
    assert row.state == "DEGRADED"
    assert "died of it" in row.reason
    assert committed_samples(service.folder, render.id) == dict.fromkeys(range(6), 8) | {4: 4}


def failure_of(result: job_pb2.JobResult, reason: str) -> job_pb2.JobResult:
    return job_pb2.JobResult(job=result.job, worker_id=result.worker_id, failure=reason)


@pytest.mark.parametrize("workers", [4])
def test_a_range_that_keeps_failing_degrades_the_render(service: Service, workers: int) -> None:
    """W3: its tile fails, with what reproduces it, and the render goes on."""

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
    assert row.tiles_failed == 1
    check_committed(service, row)
    assert service.folder.workers.in_quarantine() == {}
    with zipfile.ZipFile(service.folder.bundle_path(render.id, 1)) as bundle:
        job = job_pb2.Job.FromString(bundle.read("job.pb"))
        assert (job.render_id, job.tile_index, job.first_sample) == (render.id, 1, 8)
        said = json.loads(bundle.read("failure.json"))
    assert said["reason"] == "The scene has a hole."
    assert len(said["workers"]) == min(workers, limits.DISTINCT_WORKERS)


def test_a_degraded_render_can_be_tried_again(service: Service) -> None:
    """W3: and finished, once the cause is gone."""
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
    service.folder.requests.resume(render.id)
    wait_until(lambda: service.row(render.id).state == "SUCCEEDED")
    check_survived(service, render.id)


def test_a_scene_that_nobody_can_trace_fails_the_render_and_no_worker(service: Service) -> None:
    """W3: where every job fails, it is the scene."""

    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        return [failure_of(result, "The scene has no sensor.")]

    service.start()
    render = service.create(samples=100)
    for _ in range(3):
        service.work(SimulatedWorker(service.server.url, failing))
    row = service.wait_for_end(render.id)
    assert (row.state, row.reason) == ("FAILED", "The scene has no sensor.")
    assert service.folder.workers.in_quarantine() == {}


def test_a_worker_that_fails_jobs_which_others_can_do_is_quarantined(service: Service) -> None:
    """W3: where others can do them, it is the worker."""

    def failing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        return [failure_of(result, "Out of memory.")]

    service.start()
    render = service.create(samples=100)
    bad = service.work(SimulatedWorker(service.server.url, failing))
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    check_survived(service, render.id)
    assert list(service.folder.workers.in_quarantine()) == [bad.name]
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.QUARANTINE_PREFIX + bad.name)))
    service.folder.workers.release(bad.name)
    assert service.folder.workers.in_quarantine() == {}


def test_a_drained_worker_finishes_what_it_has_and_gets_nothing_more(service: Service) -> None:
    """Its current job counts, all others are done by other workers."""
    service.start()
    render = service.create(samples=4000)
    drained = service.work(SimulatedWorker(service.server.url, delay=0.1))
    wait_until(lambda: service.row(render.id).ranges_done > 0 and bool(service.folder.workers.alive()))
    service.folder.workers.drain(drained.name, "ann")
    with service.server.client() as client:
        wait_until(lambda: client.get(keys.QUARANTINE_PREFIX + drained.name) == b"It is drained, by ann.")
        # It hears of it when it has delivered the job in hand, and takes no other.
        wait_until(lambda: client.xpending(keys.JOBS, "workers")["pending"] == 0)
    taken = drained.jobs_taken
    service.work(SimulatedWorker(service.server.url))
    wait_until(lambda: service.row(render.id).ranges_done > taken + 3)
    assert drained.jobs_taken == taken
    assert service.row(render.id).refused == 0
    assert service.folder.workers.drained() in ({drained.name: False}, {drained.name: True})
    service.folder.workers.release(drained.name)
    wait_until(lambda: drained.jobs_taken > taken or service.row(render.id).state == "SUCCEEDED")
    service.folder.requests.cancel(render.id)


def test_a_slow_worker_does_not_hold_up_the_end(service: Service) -> None:
    """W5: an idle worker gets its job as well."""
    service.start()
    service.work(SimulatedWorker(service.server.url, delay=60.0))
    render = service.create(samples=20)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) and client.xpending(keys.JOBS, "workers")["pending"])
    begun = time.monotonic()
    # The lease is long, so that nobody takes the job over: only a copy of it helps.
    service.work(SimulatedWorker(service.server.url, lease_ms=60_000))
    check_complete(service, render.id)
    # Less than the slow worker takes for one.
    assert time.monotonic() - begun < 45.0


def test_all_workers_are_gone_for_long_and_come_back(service: Service) -> None:
    """W6: each dies with a job in hand; nobody is there for many leases, until nobody is listed any more."""
    service.start()
    render = service.create(samples=200)
    gone = threading.Event()
    first = [
        service.work(
            SimulatedWorker(
                service.server.url, delay=SOME_DELAY, dies=lambda _: gone.is_set(), status_ms=1000
            )
        )
        for _ in range(3)
    ]
    wait_until(lambda: half_done(service, render.id))
    gone.set()
    wait_until(lambda: not any(worker.is_alive() for worker in first))
    wait_until(lambda: service.folder.workers.alive() == [])
    row = service.row(render.id)
    assert row.state == "RUNNING"
    assert row.ranges_done < row.ranges_planned
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    check_resumes(service, render.id, "W6")
    check_survived(service, render.id)
    assert service.folder.workers.in_quarantine() == {}


def test_a_third_of_the_fleet_is_restarted_again_and_again(service: Service) -> None:
    """W7: two of six workers die with a job in hand, and two new ones come, twice in a second."""
    chance = random.Random(7)
    service.start()
    render = service.create(width=160, height=120, samples=100_000)
    fleet: list[tuple[SimulatedWorker, threading.Event]] = []

    def come() -> None:
        killed = threading.Event()
        worker = SimulatedWorker(
            service.server.url, delay=2 * SOME_DELAY, dies=lambda _: killed.is_set(), status_ms=1500
        )
        fleet.append((service.work(worker), killed))

    for _ in range(6):
        come()

    for _ in range(2):
        for victim in chance.sample(fleet, 2):
            victim[1].set()
            fleet.remove(victim)
            come()
        time.sleep(0.5)
        check_resumes(service, render.id, "W7")
    check_survived(service, render.id)
    assert service.folder.workers.in_quarantine() == {}
    assert service.row(render.id).tiles_failed == 0


def test_a_worker_of_another_engine_does_nothing(service: Service) -> None:
    """W8: it refuses every job, as `worker_test.cpp` shows of the real one, and then gets none.

    What `nocturne explain` says of it: `tests/services/test_status_reason.py`.
    """

    def refusing(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        return [failure_of(result, f"it has engine 1, the job needs engine {result.job.engine}")]

    service.start()
    render = service.create(samples=100)
    other = service.work(SimulatedWorker(service.server.url, refusing))
    honest = [service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY)).name for _ in range(2)]
    check_survived(service, render.id)
    assert list(service.folder.workers.in_quarantine()) == [other.name]
    rows = service.folder.database.rows("SELECT DISTINCT worker_id FROM contribution")
    assert {row["worker_id"] for row in rows} <= set(honest)
