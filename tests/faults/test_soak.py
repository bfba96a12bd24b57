"""Faults in random composition, for as long as somebody likes: SOAK_SECONDS, 600 unless given; SOAK_SEED
repeats a run."""

import os
import random
import signal
import time
from collections.abc import Callable

import pytest
from nocturne_coordinator import keys

from tests.coordinator.service import Service, check_complete, wait_until
from tests.coordinator.simulated_worker import Shuffled, SimulatedWorker, unaltered

pytestmark = pytest.mark.soak

_FAULTS_PER_RENDER = 6


class Storm:
    """What can happen to a service, one thing after the other."""

    def __init__(self, service: Service, chance: random.Random) -> None:
        self._service = service
        self._chance = chance
        self.render_id = ""
        self._workers: list[SimulatedWorker] = []

    def workers_come(self) -> None:
        for _ in range(self._chance.randint(1, 3)):
            seed = self._chance.randrange(2**32)
            alter = Shuffled(seed) if self._chance.random() < 0.5 else unaltered
            worker = SimulatedWorker(self._service.server.url, alter, self._chance.uniform(0.0, 0.03))
            self._workers.append(self._service.work(worker))

    def workers_go(self) -> None:
        for worker in self._chance.sample(self._workers, len(self._workers) // 2):
            worker.stop()
            self._workers.remove(worker)

    def coordinator_is_killed(self) -> None:
        self._service.stop(signal.SIGKILL)
        time.sleep(self._chance.uniform(0.0, 0.5))
        self._service.start()

    def redis_is_killed(self) -> None:
        self._service.server.kill()
        time.sleep(self._chance.uniform(0.0, 0.5))
        self._service.server.start()

    def redis_is_emptied(self) -> None:
        with self._service.server.client() as client:
            client.flushall()

    def the_group_is_lost(self) -> None:
        with self._service.server.client() as client:
            if client.exists(keys.JOBS):
                client.xgroup_destroy(keys.JOBS, keys.WORKERS_GROUP)

    def somebody_takes_jobs_and_dies(self) -> None:
        with self._service.server.client() as client:
            if client.exists(keys.JOBS) and client.xinfo_groups(keys.JOBS):
                client.xreadgroup(
                    keys.WORKERS_GROUP, f"dead-{self._chance.random()}/0", {keys.JOBS: ">"}, count=3
                )

    def garbage_comes(self) -> None:
        with self._service.server.client() as client:
            client.xadd(keys.RESULTS, {keys.RESULT_FIELD: self._chance.randbytes(100)})
            client.xadd(keys.JOBS, {keys.JOB_FIELD: self._chance.randbytes(20)})

    def it_is_paused_for_a_while(self) -> None:
        if self._service.row(self.render_id).state.ended:
            return
        self._service.folder.request_pause(self.render_id)
        time.sleep(self._chance.uniform(0.0, 0.5))
        self._service.folder.request_resume(self.render_id)

    def all(self) -> list[Callable[[], None]]:
        return [
            *(self.workers_come, self.workers_go, self.coordinator_is_killed, self.redis_is_killed),
            *(self.redis_is_emptied, self.the_group_is_lost, self.somebody_takes_jobs_and_dies),
            *(self.garbage_comes, self.it_is_paused_for_a_while),
        ]


def test_any_faults_leave_the_bits(service: Service) -> None:
    """S3: in random composition, by a seed that it prints."""
    seed = int(os.environ.get("SOAK_SEED", random.SystemRandom().randrange(2**32)))
    print(f"SOAK_SEED={seed}")  # noqa: T201 - to run it again
    chance = random.Random(seed)
    end = time.monotonic() + float(os.environ.get("SOAK_SECONDS", "600"))
    service.start()
    storm = Storm(service, chance)
    renders = 0
    while time.monotonic() < end:
        renders += 1
        storm.render_id = service.create(samples=chance.randint(20, 150), request_id=f"{renders}").id
        for _ in range(_FAULTS_PER_RENDER):
            time.sleep(chance.uniform(0.0, 0.3))
            chance.choice(storm.all())()
        storm.workers_come()
        # Time for a dead worker's lease, a copy of a slow job, and audits that nobody can settle.
        wait_until(lambda: service.row(storm.render_id).state.has_image, 90.0)
        check_complete(service, storm.render_id)
        storm.workers_go()
    assert renders > 0
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) == 0 and client.xlen(keys.RESULTS) == 0)
