"""`python -m bench.fleet REDIS WORKERS JOB_S LEASE_S KILLED_S KEY`: workers that do all but trace.

Each follows coordinator/README.md with its own consumer, a status every two seconds and its own renewed
claims. It waits for the time of a job; the sums are the same for all jobs of as many samples. Prints one line
of JSON at SIGTERM. With KEY, hexadecimal or empty, all belong to machine MACHINE, and sign their results.
"""

import json
import random
import signal
import sys
import time
from collections import deque
from dataclasses import dataclass, field
from heapq import heappop, heappush
from typing import Any

import numpy as np
import redis
from nocturne.v1 import job_pb2
from nocturne_coordinator.enrolment import signature
from nocturne_coordinator.queue import keys

from tests.sums import sums_of_independent

_STATUS_S = 2.0
_LEASE_S = 10.0
_BATCH = 200
"""Commands sent at once."""
_PAUSE_S = 0.01


MACHINE = "bench"


@dataclass
class _Worker:
    """One with a single thread."""

    name: str
    job: bytes = b""
    lease: bytes = b""
    entry: bytes = b""
    since: float = 0.0
    """When it took the job."""
    due: float = 0.0
    started: float = 1.0


class ResultMaker:
    """Valid results, put together of parts: all sums of as many samples are the same."""

    def __init__(self) -> None:
        self._partials: dict[tuple[int, int], bytes] = {}

    def result(self, job_bytes: bytes, worker: str, cpu_seconds: float) -> bytes:
        """A serialised JobResult of a serialised job."""
        job = job_pb2.Job.FromString(job_bytes)
        samples, pixels = job.end_sample - job.first_sample, job.tile.width * job.tile.height
        if (samples, pixels) not in self._partials:
            # Varied like those of a picture: with a million equal numbers some steps take other branches.
            lit = np.random.default_rng(samples).uniform(0.5, 2.0, (job.tile.height, job.tile.width, 3))
            drawn = lit * samples
            sums = sums_of_independent(drawn, np.full(drawn.shape[:2], 1.5), samples).encode()
            partial = job_pb2.Partial(sums=sums, photons=pixels * samples, rays=pixels)
            self._partials[samples, pixels] = job_pb2.JobResult(partial=partial).SerializeToString()
        cpu = job_pb2.Partial(cpu_seconds=cpu_seconds)
        head = job_pb2.JobResult(job=job, worker_id=worker, partial=cpu).SerializeToString()
        # Two messages one after the other are the merged message.
        return head + self._partials[samples, pixels]


@dataclass
class Fleet:
    """Workers and their pending events; `due` in seconds of the monotonic clock."""

    client: Any
    workers: list[_Worker]
    job_s: float
    lease_s: float = _LEASE_S
    killed_s: float = 0.0
    """Mean time between two deaths of a worker; 0: they never die."""
    key: bytes = b""
    """Of the machine that they are of; empty: of none."""
    idle: deque[int] = field(default_factory=deque)
    due: list[tuple[float, int]] = field(default_factory=list)
    renewals: list[tuple[float, int]] = field(default_factory=list)
    statuses: list[tuple[float, int]] = field(default_factory=list)
    deaths: list[tuple[float, int]] = field(default_factory=list)
    done: int = 0
    died: int = 0
    next_take_over: float = 0.0
    chance: random.Random = field(default_factory=lambda: random.Random(1))  # noqa: S311 - no secrets
    worked_s: float = 0.0
    maker: ResultMaker = field(default_factory=ResultMaker)

    def start(self) -> None:
        """All come within a few seconds, in no order."""
        chance = self.chance
        now = time.monotonic()
        for index in range(len(self.workers)):
            heappush(self.statuses, (now + chance.uniform(0.0, _STATUS_S), index))
            if self.killed_s:
                heappush(self.deaths, (now + chance.expovariate(1 / self.killed_s), index))
        self.idle.extend(chance.sample(range(len(self.workers)), len(self.workers)))

    def turn(self) -> None:
        """Events that are due now; waits a little if there are none."""
        now = time.monotonic()
        self._die(now)
        sent = self._say_alive(now) + self._renew(now) + self._finish(now) + self._take(now)
        if not sent:
            time.sleep(_PAUSE_S)

    def _die(self, now: float) -> None:
        """The worker dies silently and is back at once under the same name; its job is not done."""
        for index in _due(self.deaths, now):
            heappush(self.deaths, (now + self.chance.expovariate(1 / self.killed_s), index))
            worker = self.workers[index]
            worker.started = time.time()
            self.died += 1
            if worker.entry:
                self.worked_s += now - worker.since
                worker.entry = b""
                self.idle.append(index)
                # Its process has come again before it takes another job.
                heappush(self.statuses, (now, index))

    def _say_alive(self, now: float) -> int:
        pipeline = self.client.pipeline(transaction=False)
        for index in _due(self.statuses, now):
            heappush(self.statuses, (now + _STATUS_S, index))
            name, started = self.workers[index].name, self.workers[index].started
            status = job_pb2.WorkerStatus(
                worker_id=name, engine=job_pb2.ENGINE_CURRENT, threads=1, started=started
            )
            pipeline.set(keys.WORKER_PREFIX + name, status.SerializeToString(), px=10_000)
        return _sent(pipeline)

    def _renew(self, now: float) -> int:
        pipeline = self.client.pipeline(transaction=False)
        for index in _due(self.renewals, now):
            worker = self.workers[index]
            if worker.entry:
                heappush(self.renewals, (now + self.lease_s / 3, index))
                pipeline.xclaim(
                    *(keys.JOBS, keys.WORKERS_GROUP, f"{worker.name}/0", 0, [worker.entry]), justid=True
                )
        return _sent(pipeline)

    def _finish(self, now: float) -> int:
        pipeline = self.client.pipeline(transaction=False)
        for index in _due(self.due, now):
            worker = self.workers[index]
            if not worker.entry or now < worker.due:
                # It died meanwhile.
                continue
            result = self.maker.result(worker.job, worker.name, worker.due - worker.since)
            pipeline.xadd(keys.RESULTS, {keys.RESULT_FIELD: result, **self._signed(worker, result)})
            pipeline.xack(keys.JOBS, keys.WORKERS_GROUP, worker.entry)
            pipeline.xdel(keys.JOBS, worker.entry)
            worker.entry = b""
            self.idle.append(index)
            self.done += 1
            self.worked_s += worker.due - worker.since
        return _sent(pipeline)

    def _take(self, now: float) -> int:
        asking = [self.idle.popleft() for _ in range(min(len(self.idle), _BATCH))]
        pipeline = self.client.pipeline(transaction=False)
        for index in asking:
            pipeline.xreadgroup(
                keys.WORKERS_GROUP, f"{self.workers[index].name}/0", {keys.JOBS: ">"}, count=1
            )
        taken = 0
        # Refusals among them: there is no consumer group before the coordinator has come.
        for index, answer in zip(asking, pipeline.execute(raise_on_error=False), strict=True):
            entries = [] if isinstance(answer, redis.ResponseError) or not answer else answer[0][1]
            entries = entries or self._taken_over(index, now)
            if not entries:
                self.idle.append(index)
                continue
            worker = self.workers[index]
            worker.entry, worker.job = entries[0][0], entries[0][1][keys.JOB_FIELD]
            worker.lease = entries[0][1].get(keys.LEASE_FIELD, b"")
            taken += 1
            # Some are twice as quick as others.
            worker.since, worker.due = now, now + self.job_s * self.chance.uniform(2 / 3, 4 / 3)
            heappush(self.due, (worker.due, index))
            heappush(self.renewals, (now + self.lease_s / 3, index))
        return taken

    def _taken_over(self, index: int, now: float) -> list[Any]:
        """A job whose holder let the lease run out; asked for now and then."""
        if now < self.next_take_over:
            return []
        self.next_take_over = now + self.lease_s / 10
        consumer, idle_ms = f"{self.workers[index].name}/0", int(1000 * self.lease_s)
        try:
            answer = self.client.xautoclaim(keys.JOBS, keys.WORKERS_GROUP, consumer, idle_ms, "0-0", count=1)
        except redis.ResponseError:
            return []
        return list(answer[1])

    def _signed(self, worker: _Worker, result: bytes) -> dict[bytes, bytes]:
        if not self.key:
            return {}
        signed = signature(self.key, worker.lease, result)
        return {keys.MACHINE_FIELD: MACHINE.encode(), keys.SIGNATURE_FIELD: signed}


def _due(heap: list[tuple[float, int]], now: float) -> list[int]:
    found: list[int] = []
    while heap and heap[0][0] <= now and len(found) < _BATCH:
        found.append(heappop(heap)[1])
    return found


def _sent(pipeline: Any) -> int:
    commands = len(pipeline)
    if commands:
        pipeline.execute()
    return commands


def main(
    url: str,
    workers: int,
    job_s: float,
    lease_s: float,
    killed_s: float,
    key: bytes,
) -> None:
    """Works until SIGTERM."""
    over: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _: over.append(number))
    client = redis.Redis.from_url(url, protocol=2)
    prefix = f"{MACHINE}/" if key else ""
    names = [_Worker(f"{prefix}w{index}") for index in range(workers)]
    fleet = Fleet(client, names, job_s, lease_s, killed_s, key)
    fleet.start()
    while not over:
        fleet.turn()
    in_hand = sum(time.monotonic() - worker.since for worker in fleet.workers if worker.entry)
    figures = {"done": fleet.done, "died": fleet.died, "worked_s": fleet.worked_s, "in_hand_s": in_hand}
    print(json.dumps({**figures, "cpu_s": time.process_time()}))


if __name__ == "__main__":
    _, redis_url, count, job, lease, killed, key_hex = sys.argv
    main(redis_url, int(count), float(job), float(lease), float(killed), bytes.fromhex(key_hex))
