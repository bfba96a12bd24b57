"""Workers that send wrong, impossible or old results, or take others' jobs: rows L of the fault matrix."""

import random
import time
from itertools import cycle

from nocturne.v1 import job_pb2
from nocturne_coordinator.queue import keys

from tests.coordinator.service import Service, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker, one_bit
from tests.coordinator.test_result_handler import SPOILT
from tests.faults.survival import OVERDUE_SOON, SOME_DELAY, check_survived, note


def test_a_liar_is_found_and_its_work_done_again(service: Service) -> None:
    """L1: by one unit in the last place of one number."""

    service.start("", "--audit-share-new", "0.5")
    before = service.create(samples=16, request_id="before")
    liar = service.work(SimulatedWorker(service.server.url, one_bit))
    # Alone, nobody can tell.
    assert service.wait_for_end(before.id).state == "SUCCEEDED"
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=0.005))
    render = service.create(samples=100)
    check_survived(service, render.id, redone=True)
    assert list(service.folder.workers.in_quarantine()) == [liar.name]
    # The image that was called final is made again.
    wait_until(lambda: service.row(before.id).state == "SUCCEEDED" and service.row(before.id).image_final)
    check_survived(service, before.id, redone=True)


def test_honest_workers_agree(service: Service) -> None:
    """L1: no other worker is found."""
    service.start("", "--audit-share", "0.3", "--audit-share-new", "0.3")
    render = service.create(samples=100)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url))
    check_survived(service, render.id)
    assert service.row(render.id).audited > 0
    assert service.folder.workers.in_quarantine() == {}


class Forger:
    """Sends impossible results of every kind, one in the place of each job's first; the second is good."""

    def __init__(self) -> None:
        self._kinds = cycle(SPOILT.items())
        self._seen: set[bytes] = set()
        self.sent: set[str] = set()

    def __call__(self, result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        job = result.job.SerializeToString()
        if job in self._seen:
            return [result]
        self._seen.add(job)
        name, spoil = next(self._kinds)
        self.sent.add(name)
        forged = job_pb2.JobResult()
        forged.CopyFrom(result)
        spoil(forged)
        return [b"\xff\x00garbage", b"", forged]


def test_garbage(service: Service) -> None:
    """L2: each is refused, and its range done again."""
    # Of some forged results nobody can tell whose job they took the place of.
    service.start("", *OVERDUE_SOON)
    render = service.create(samples=200)
    forger = Forger()
    service.work(SimulatedWorker(service.server.url, forger))
    with service.server.client() as client:
        client.xadd(keys.RESULTS, {"other": "field"})
        client.xadd(keys.JOBS, {"other": "field"})
        client.set(keys.WORKER_PREFIX + "x", b"\xff\xff", px=2000)
    wait_until(lambda: service.row(render.id).state.ended)
    check_survived(service, render.id)
    assert forger.sent == set(SPOILT)


class Flooder:
    """Sends with each result ten that it has sent before, of any render."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._past: list[job_pb2.JobResult] = []

    def __call__(self, result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        self._past.append(result)
        return [*self._random.choices(self._past, k=10), result]


def test_old_results_come_again_and_again(service: Service) -> None:
    """L3: ten for every new one, of the render and of one that has ended."""
    service.start()
    flooder = service.work(SimulatedWorker(service.server.url, Flooder(3)))
    first = service.create(samples=50, request_id="first")
    check_survived(service, first.id)
    second = service.create(samples=100, request_id="second")
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    check_survived(service, second.id)
    assert flooder.jobs_done > 0
    assert service.row(first.id).photons == first.width * first.height * 50


def test_a_worker_takes_the_jobs_of_others_off_the_stream(service: Service) -> None:
    """L4: acknowledged and deleted, and nobody sends a result: they come again when they are overdue."""
    service.start("", *OVERDUE_SOON)
    render = service.create(samples=100)
    # So slow that most jobs are still there when one is done, however busy the machine is.
    worker = SimulatedWorker(service.server.url, delay=1.0)
    with service.server.client() as client:
        wait_until(lambda: bool(client.exists(keys.JOBS)) and client.xlen(keys.JOBS) > 3)
        service.work(worker)
        wait_until(lambda: worker.jobs_done > 0)
        gone = [entry for entry, _ in client.xrange(keys.JOBS)]
        assert gone
        client.xack(keys.JOBS, keys.WORKERS_GROUP, *gone)
        client.xdel(keys.JOBS, *gone)
    worker.delay = SOME_DELAY
    begun = time.monotonic()
    wait_until(lambda: service.row(render.id).state.ended)
    note("L4", ended_s=time.monotonic() - begun)
    check_survived(service, render.id)
