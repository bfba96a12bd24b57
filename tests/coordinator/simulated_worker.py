"""A worker that does everything but trace: its sums are a fixed function of the job."""

import hashlib
import os
import random
import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import redis
from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2
from nocturne_coordinator.enrolment import machine_of, redis_password, redis_user, signature
from nocturne_coordinator.queue import keys
from nocturne_scene.tile_sums import TileSums

from tests.sums import sums_of_independent

WORKER = "simulated"
"""Its name, unless it has another."""

Alter = Callable[[job_pb2.JobResult], list[job_pb2.JobResult | bytes]]
"""What a worker sends instead of one result."""


def simulated_sums(job: job_pb2.Job, further_responses: int = 0) -> TileSums:
    """Sums of the job's samples: possible ones, that do not add up exactly; later tiles are noisier."""
    place = f"{job.scene.hex()} {job.tile_index} {job.first_sample} {job.end_sample}"
    seed = int.from_bytes(hashlib.sha256(place.encode()).digest()[:8], "little")
    samples = job.end_sample - job.first_sample
    drawn = np.random.default_rng(seed).random((job.tile.height, job.tile.width, 4 + further_responses))
    spread = 1.0 + 0.5 * (1 + job.tile_index) * (0.5 + drawn[..., 0])
    return sums_of_independent((0.5 + drawn[..., 1:]) * samples, spread, samples)


def simulated_result(
    job: job_pb2.Job, worker_id: str = WORKER, further_responses: int = 0
) -> job_pb2.JobResult:
    photons = job.tile.width * job.tile.height * (job.end_sample - job.first_sample)
    return job_pb2.JobResult(
        job=job,
        worker_id=worker_id,
        partial=job_pb2.Partial(
            sums=simulated_sums(job, further_responses).encode(),
            photons=photons,
            rays=3 * photons,
            invalid_samples=job.tile_index % 2,
            cpu_seconds=0.001,
        ),
    )


class Machine(NamedTuple):
    """The credentials that a machine receives when it enrols."""

    name: str
    key: bytes

    def client(self, url: str) -> Any:
        """Signed on to Redis as this machine."""
        return redis.Redis.from_url(
            url, protocol=2, username=redis_user(self.name), password=redis_password(self.key)
        )

    def signed(self, lease: bytes, data: bytes) -> dict[bytes, bytes]:
        """The fields of a stream entry that identify and sign a result."""
        return {
            keys.MACHINE_FIELD: self.name.encode(),
            keys.SIGNATURE_FIELD: signature(self.key, lease, data),
        }


def unaltered(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
    return [result]


def one_bit(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
    """One number is one unit in the last place larger."""
    sums = np.frombuffer(result.partial.sums, dtype="<f8").copy()
    sums[0] = np.nextafter(sums[0], np.inf)
    result.partial.sums = sums.tobytes()
    return [result]


def rounds_otherwise(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
    """Every sum is one unit in the last place larger, as those of a correct worker of another profile may
    be."""
    sums = np.frombuffer(result.partial.sums, dtype="<f8")
    result.partial.sums = np.nextafter(sums, np.inf).tobytes()
    return [result]


class SimulatedWorker(threading.Thread):
    """Follows the protocol of coordinator/README.md in a thread; reconnects without limit, as workers
    do."""

    def __init__(
        self,
        url: str,
        alter: Alter = unaltered,
        delay: float = 0.0,
        lease_ms: int = 500,
        further_responses: int = 0,
        dies: Callable[[job_pb2.JobResult], bool] = lambda _: False,
        seen: Callable[[str], bool] = lambda _: True,
        status_ms: int = 10_000,
        floating_point_profile: str = "",
        machine: Machine | None = None,
    ) -> None:
        """`dies`: the process ends, without a word, at jobs for which it is true; `status_ms` later that
        shows. Not before it is `seen` by its name, as nobody misses a process that nobody saw at work.

        `floating_point_profile` is only reported: jobs of other profiles are done as well, for the
        coordinator to refuse. `machine`: the machine that the worker enrolled as.
        """
        super().__init__(daemon=True)
        self._further_responses = further_responses
        self._machine = machine
        self._client: Any = machine.client(url) if machine else redis.Redis.from_url(url, protocol=2)
        self._alter = alter
        self.delay = delay
        """Seconds that each job takes; may be changed."""
        self._lease_ms = lease_ms
        self._dies = dies
        self._seen = seen
        self._status_ms = status_ms
        self._floating_point_profile = floating_point_profile
        self._since = time.time()
        self._stopping = threading.Event()
        own = f"worker-{os.urandom(4).hex()}"
        self.name = f"{machine.name}/{own}" if machine else own
        self.jobs_taken = 0
        self.jobs_done = 0

    def stop(self) -> None:
        self._stopping.set()
        self.join(10)
        self._client.close()

    def run(self) -> None:
        while not self._stopping.is_set():
            try:
                self._one_turn()
            except redis.RedisError:
                self._stopping.wait(0.05)

    def _tell_status(self) -> None:
        status = job_pb2.WorkerStatus(
            worker_id=self.name,
            engine=job_pb2.ENGINE_CURRENT,
            threads=1,
            started=self._since,
            floating_point_profile=self._floating_point_profile,
        )
        self._client.set(keys.WORKER_PREFIX + self.name, status.SerializeToString(), px=self._status_ms)

    def _one_turn(self) -> None:
        self._tell_status()
        if any(self._client.mget([keys.QUARANTINE_PREFIX + of for of in (self.name, machine_of(self.name))])):
            self._stopping.wait(0.05)
            return
        taken = self._client.xreadgroup(
            keys.WORKERS_GROUP, f"{self.name}/0", {keys.JOBS: ">"}, count=1, block=50
        )
        entries = taken[0][1] if taken else self._claimed()
        for entry, fields in entries:
            try:
                job = job_pb2.Job.FromString(fields[keys.JOB_FIELD])
            except (DecodeError, KeyError):
                job = job_pb2.Job()
            # Random bytes may be a job of no samples, which workers refuse.
            if job.end_sample <= job.first_sample or not job.HasField("tile"):
                self._client.xack(keys.JOBS, keys.WORKERS_GROUP, entry)
                self._client.xdel(keys.JOBS, entry)
            else:
                self._work(entry, job, fields.get(keys.LEASE_FIELD, b""))

    def _claimed(self) -> list[Any]:
        answer = self._client.xautoclaim(
            keys.JOBS, keys.WORKERS_GROUP, f"{self.name}/0", self._lease_ms, "0-0", count=1
        )
        return list(answer[1])

    def _work(self, entry: bytes, job: job_pb2.Job, lease: bytes) -> None:
        self.jobs_taken += 1
        self._stopping.wait(self.delay)
        result = simulated_result(job, self.name, self._further_responses)
        result.floating_point_profile = self._floating_point_profile
        if self._dies(result):
            self._die(entry)
            return
        results = self._alter(result)
        while not self._stopping.is_set():
            try:
                self._send(entry, results, lease)
                self.jobs_done += 1
                return
            except redis.RedisError:
                self._stopping.wait(0.05)

    def _die(self, entry: bytes) -> None:
        place = keys.JOBS, keys.WORKERS_GROUP, f"{self.name}/0"
        while not self._seen(self.name) and not self._stopping.wait(0.05):
            self._tell_status()
            # Takes it again, which renews the lease, unless it was taken off the stream: then it goes on.
            if not self._client.xclaim(*place, 0, [entry]):
                return
        self._stopping.set()

    def _send(self, entry: bytes, results: list[job_pb2.JobResult | bytes], lease: bytes) -> None:
        pipeline = self._client.pipeline(transaction=True)
        for result in results:
            data = result if isinstance(result, bytes) else result.SerializeToString()
            signed = self._machine.signed(lease, data) if self._machine else {}
            pipeline.xadd(keys.RESULTS, {keys.RESULT_FIELD: data, **signed})
        pipeline.xack(keys.JOBS, keys.WORKERS_GROUP, entry)
        pipeline.xdel(keys.JOBS, entry)
        pipeline.execute()


class Shuffled:
    """Sends every result several times, in a random order, some much later."""

    def __init__(self, seed: int, copies: int = 2) -> None:
        self._random = random.Random(seed)
        self._copies = copies
        self._kept: list[job_pb2.JobResult] = []

    def __call__(self, result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        self._kept += [result] * self._copies
        self._random.shuffle(self._kept)
        count = self._random.randint(1, 2 * self._copies - 1)
        sent, self._kept = self._kept[:count], self._kept[count:]
        return [*sent, result]
