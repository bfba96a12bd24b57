"""Workers that round otherwise: row W8 of the fault matrix. With real workers: test_same_bits.py."""

import time
from collections.abc import Callable

import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
import pytest
from nocturne.v1 import job_pb2
from nocturne_api.operations.status_reason import sentence, situation_of
from nocturne_coordinator.dispatch.profiles import REDONE_SECONDS
from nocturne_coordinator.queue import keys

from tests.coordinator.service import Service, wait_until
from tests.coordinator.simulated_worker import Alter, SimulatedWorker, rounds_otherwise, unaltered
from tests.faults.survival import SOME_DELAY, check_survived

MOST, ODD = "a" * 16, "b" * 16


@pytest.fixture
def work(service: Service) -> Callable[..., str]:
    """Starts a worker of a class, gives its name."""

    def start(floating_point_profile: str, alter: Alter = unaltered, delay: float = SOME_DELAY) -> str:
        worker = SimulatedWorker(
            service.server.url, alter, delay, floating_point_profile=floating_point_profile
        )
        return service.work(worker).name

    return start


def contributors(service: Service) -> set[str]:
    rows = service.folder.database.rows("SELECT DISTINCT worker_id FROM contribution")
    return {row["worker_id"] for row in rows}


def classes_of_jobs(service: Service) -> set[str]:
    with service.server.client() as client:
        jobs = [job_pb2.Job.FromString(fields[keys.JOB_FIELD]) for _, fields in client.xrange(keys.JOBS)]
    return {job.floating_point_profile for job in jobs}


def class_in_image(service: Service, render_id: str) -> str:
    image = oiio.ImageInput.open(str(service.folder.image_path(render_id)))
    assert image is not None
    try:
        return str(image.spec().get_string_attribute("nocturne:floatingPointProfile"))
    finally:
        image.close()


def test_a_fleet_of_two_classes_uses_one(service: Service, work: Callable[..., str]) -> None:
    """W8: the odd worker gets no jobs, with a reason, and is not counted as faulty; its earlier work is not
    merged."""
    service.start()
    honest = {work(MOST), work(MOST)}
    odd = work(ODD, rounds_otherwise)
    wait_until(lambda: len(service.folder.workers.alive()) == 3)
    render = service.create(samples=2000)
    wait_until(lambda: bool(service.folder.workers.incompatible()))
    assert service.folder.workers.incompatible() == {
        odd: f"It rounds otherwise: floating-point profile {ODD}; the open renders have {MOST}."
    }
    # Whoever takes a job learns whose it is.
    wait_until(lambda: MOST in classes_of_jobs(service))
    check_survived(service, render.id)
    assert contributors(service) <= honest
    assert service.folder.workers.in_quarantine() == {}
    row = service.row(render.id)
    assert (row.floating_point_profile, row.tiles_failed) == (MOST, 0)
    assert class_in_image(service, render.id) == MOST


def test_long_work_waits_for_its_class(service: Service, work: Callable[..., str]) -> None:
    """W8: what took long is not thrown away; other renders go on meanwhile, and so does it later."""

    def costs_much(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        result.partial.cpu_seconds = REDONE_SECONDS
        return [result]

    # Ranges that cost so much would be cut.
    service.start("", "--job-seconds", "1e6")
    first = service.work(
        SimulatedWorker(
            service.server.url, costs_much, SOME_DELAY, status_ms=1500, floating_point_profile=ODD
        )
    )
    long = service.create(samples=2000)
    wait_until(lambda: service.row(long.id).ranges_done >= 6)
    first.stop()
    wait_until(lambda: service.folder.workers.alive() == [])
    # Results go when they are committed, which may be later than their worker.
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.RESULTS) == 0)
    before = service.row(long.id).ranges_done
    # Created before its workers come; otherwise they would wait until they are marked as compatible.
    other = service.create(request_id="b", samples=100)
    work(MOST, rounds_otherwise)
    assert service.wait_for_end(other.id).floating_point_profile == MOST
    waits = f"traced by workers of floating-point profile {ODD}. The workers that are there have {MOST}"
    wait_until(lambda: waits in sentence(situation_of(service.folder, long.id), time.time()))
    assert service.row(long.id).ranges_done == before
    # Replays need that class as well, from their start.
    replay = service.folder.requests.replay(long.id, "c")
    assert replay.floating_point_profile == ODD
    work(ODD)
    check_survived(service, long.id)
    assert service.wait_for_end(replay.id).floating_point_profile == ODD
