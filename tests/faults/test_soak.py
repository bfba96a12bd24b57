"""FailurePolicy in random composition, for as long as somebody likes: SOAK_SECONDS, 600 unless given;
SOAK_SEED repeats a run."""

import os
import random
import resource
import signal
import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np
import pytest
import redis
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.errors import WrongState
from nocturne_coordinator.queue import keys

from tests.coordinator.service import (
    Service,
    check_complete,
    committed_samples,
    expected_film,
    wait_until,
)
from tests.coordinator.simulated_worker import Alter, Shuffled, SimulatedWorker, unaltered
from tests.faults.survival import OVERDUE_SOON, check_nothing_left, note
from tests.faults.test_lies import Flooder
from tests.system.forked import Forked

pytestmark = pytest.mark.soak

_FAULTS_PER_RENDER = 6

_AUDITS_OF_ALL = ("--audit-share", "1", "--audit-share-new", "1")


class Liar:
    """Tells a wrong number, its own one, in a part of its results."""

    def __init__(self, seed: int, part: float) -> None:
        self._chance = random.Random(seed)
        self._part = part

    def __call__(self, result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        if result.HasField("partial") and self._chance.random() < self._part:
            sums = np.frombuffer(result.partial.sums, dtype="<f8").copy()
            sums[self._chance.randrange(8)] *= 1.0 + self._chance.uniform(1e-15, 1e-12)
            result.partial.sums = sums.tobytes()
        return [result]


class Corrupter:
    """Has memory in which now and then a bit flips, anywhere in a result."""

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(seed)

    def __call__(self, result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        data = bytearray(result.SerializeToString())
        if self._chance.random() < 0.2:
            data[self._chance.randrange(len(data))] ^= 1 << self._chance.randrange(8)
        return [bytes(data)]


class Storm:
    """The possible faults of a service, one after the other."""

    options: tuple[str, ...] = OVERDUE_SOON
    """Of the coordinator."""

    def __init__(self, service: Service, chance: random.Random) -> None:
        self._service = service
        self._chance = chance
        self.render_id = ""
        self._workers: list[SimulatedWorker] = []
        self._coordinator: Forked

    def workers_come(self) -> None:
        for _ in range(self._chance.randint(1, 3)):
            seed = self._chance.randrange(2**32)
            self._comes(self._chance.choice(self.kinds(seed)), self._chance.uniform(0.0, 0.03))

    def kinds(self, seed: int) -> list[Alter]:
        return [unaltered, Shuffled(seed), Shuffled(seed, copies=10), Flooder(seed)]

    def a_slow_worker_comes(self) -> None:
        self._comes(unaltered, 5.0)

    def _comes(self, alter: Alter, delay: float) -> None:
        self._workers.append(self._service.work(SimulatedWorker(self._service.server.url, alter, delay)))

    def workers_go(self) -> None:
        for worker in self._chance.sample(self._workers, len(self._workers) // 2):
            worker.stop()
            self._workers.remove(worker)

    def coordinator_is_killed(self) -> None:
        self._service.stop(signal.SIGKILL)
        time.sleep(self._chance.uniform(0.0, 0.5))
        self.coordinator_starts()

    def coordinator_starts(self) -> None:
        self._coordinator = self._service.start("", *self.options)

    def supervise(self) -> None:
        """As an init system does: a coordinator that finds the disk full when it starts ends."""
        if self._coordinator.poll() is not None:
            self.coordinator_starts()

    def has_image(self) -> bool:
        self.supervise()
        return self._service.row(self.render_id).state.has_image

    def coordinator_stands_still(self) -> None:
        self._coordinator.send_signal(signal.SIGSTOP)
        time.sleep(self._chance.uniform(0.0, 1.0))
        self._coordinator.send_signal(signal.SIGCONT)

    def the_disk_is_full(self) -> None:
        pid = self._coordinator.pid
        soft, hard = resource.prlimit(pid, resource.RLIMIT_FSIZE)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, hard))
        time.sleep(self._chance.uniform(0.0, 1.0))
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (soft, hard))

    def everything_is_killed(self) -> None:
        self._service.stop(signal.SIGKILL)
        self._service.server.kill()
        parts = [self._service.server.start, self.coordinator_starts, self.workers_come]
        for start in self._chance.sample(parts, len(parts)):
            start()

    def redis_is_killed(self) -> None:
        self._service.server.kill()
        time.sleep(self._chance.uniform(0.0, 0.5))
        self._service.server.start()

    def redis_is_emptied(self) -> None:
        with self._service.server.client() as client:
            client.flushall()

    def redis_is_full(self) -> None:
        with self._service.server.client() as client:
            client.config_set("maxmemory", 1)
            time.sleep(self._chance.uniform(0.0, 0.5))
            client.config_set("maxmemory", 0)

    def the_group_is_rewound(self) -> None:
        with self._service.server.client() as client, suppress(redis.ResponseError):
            client.xgroup_setid(keys.JOBS, keys.WORKERS_GROUP, "0")

    def jobs_are_taken_off_the_stream(self) -> None:
        with self._service.server.client() as client, suppress(redis.ResponseError):
            for entry, _ in client.xrange(keys.JOBS, count=3):
                client.xack(keys.JOBS, keys.WORKERS_GROUP, entry)
                client.xdel(keys.JOBS, entry)

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
        with suppress(WrongState):
            self._service.folder.requests.pause(self.render_id)
            time.sleep(self._chance.uniform(0.0, 0.5))
            self._service.folder.requests.resume(self.render_id)

    def it_is_asked_for_otherwise(self) -> None:
        """More samples, another priority."""
        row = self._service.row(self.render_id)
        with suppress(WrongState):
            self._service.folder.requests.set_priority(row.id, self._chance.randint(1, 1000))
            self._service.folder.requests.extend(row.id, row.samples + 10, StopConditions())

    def all(self) -> list[Callable[[], None]]:
        return [
            *(
                self.workers_come,
                self.a_slow_worker_comes,
                self.workers_go,
                self.somebody_takes_jobs_and_dies,
            ),
            *(self.garbage_comes, self.jobs_are_taken_off_the_stream),
            *(self.redis_is_killed, self.redis_is_emptied, self.redis_is_full),
            *(self.the_group_is_lost, self.the_group_is_rewound),
            *(self.coordinator_is_killed, self.coordinator_stands_still, self.the_disk_is_full),
            *(self.it_is_paused_for_a_while, self.it_is_asked_for_otherwise, self.everything_is_killed),
        ]


class LyingStorm(Storm):
    """With workers that lie always, or once in a while, and whose memory fails; all is audited."""

    options = (*OVERDUE_SOON, *_AUDITS_OF_ALL)

    def kinds(self, seed: int) -> list[Alter]:
        return [*super().kinds(seed), Liar(seed, 1.0), Liar(seed, 0.05), Corrupter(seed), Corrupter(seed + 1)]


def _is_right(service: Service, render_id: str) -> bool:
    """Whether each of its numbers is that of an undisturbed run."""
    samples = committed_samples(service.folder, render_id)
    film = expected_film(service.folder, render_id, samples)
    tiles = service.folder.database.rows("SELECT * FROM tile WHERE render_id = ?", (render_id,))
    return all(tile["sums"] == film.tile_bytes(tile["tile_index"]) for tile in tiles)


def test_liars_leave_the_bits_or_the_render_says_so(service: Service) -> None:
    """S3: liars and failing memory among all the other faults, two honest workers beside them. What is wrong
    in the end says that not all of it was audited, or why it is DEGRADED."""
    seed = int(os.environ.get("SOAK_SEED", random.SystemRandom().randrange(2**32)))
    print(f"SOAK_SEED={seed}")  # noqa: T201 - to run it again
    chance = random.Random(seed)
    end = time.monotonic() + float(os.environ.get("SOAK_SECONDS", "900"))
    storm = LyingStorm(service, chance)
    storm.coordinator_starts()
    honest = [service.work(SimulatedWorker(service.server.url, delay=0.01)) for _ in range(2)]
    renders: list[str] = []
    while time.monotonic() < end:
        made = service.create(samples=chance.randint(20, 150), request_id=f"{len(renders)}")
        storm.render_id = made.id
        renders.append(made.id)
        for _ in range(_FAULTS_PER_RENDER):
            time.sleep(chance.uniform(0.0, 0.3))
            chance.choice(storm.all())()
            storm.supervise()
        storm.workers_come()
        wait_until(storm.has_image, 120.0)
        storm.workers_go()
    # Of a liar that was found late all work is done again.
    for render_id in renders:
        storm.render_id = render_id
        wait_until(storm.has_image, 120.0)
    rows = {render_id: service.row(render_id) for render_id in renders}
    wrong = [each for each in renders if not _is_right(service, each)]
    told = [each for each in wrong if rows[each].state == "DEGRADED" or rows[each].unaudited]
    quarantined = service.folder.workers.in_quarantine()
    note(
        "S3 with liars",
        seed=seed,
        renders=len(renders),
        faults=len(renders) * _FAULTS_PER_RENDER,
        quarantined=len(quarantined),
        wrong=len(wrong),
        told=len(told),
    )
    print(f"{len(renders)} renders, {len(quarantined)} in quarantine, wrong {len(wrong)}, told {len(told)}")  # noqa: T201
    assert not {worker.name for worker in honest} & quarantined.keys()
    assert [(each, rows[each].reason) for each in wrong if each not in told] == []


def test_any_faults_leave_the_bits(service: Service) -> None:
    """S3: in random composition, by a seed that it prints."""
    seed = int(os.environ.get("SOAK_SEED", random.SystemRandom().randrange(2**32)))
    print(f"SOAK_SEED={seed}")  # noqa: T201 - to run it again
    chance = random.Random(seed)
    end = time.monotonic() + float(os.environ.get("SOAK_SECONDS", "600"))
    storm = Storm(service, chance)
    storm.coordinator_starts()
    renders = 0
    while time.monotonic() < end:
        renders += 1
        storm.render_id = service.create(samples=chance.randint(20, 150), request_id=f"{renders}").id
        for _ in range(_FAULTS_PER_RENDER):
            time.sleep(chance.uniform(0.0, 0.3))
            chance.choice(storm.all())()
            storm.supervise()
        storm.workers_come()
        # Time for a dead worker's lease, a copy of a slow job, and audits that nobody can settle.
        wait_until(storm.has_image, 90.0)
        check_complete(service, storm.render_id)
        storm.workers_go()
    assert renders > 0
    note("S3", seed=seed, renders=renders, faults=renders * _FAULTS_PER_RENDER)
    check_nothing_left(service)
