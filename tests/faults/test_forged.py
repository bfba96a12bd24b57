"""Redis with users, machines that enrolled, and one of them that is not honest: rows P3 to P5, P15."""

import os
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import redis
from nocturne.v1 import job_pb2
from nocturne_coordinator.queue import keys
from nocturne_coordinator.queue.worker_status import worker_row
from nocturne_scene.tile_sums import split

from tests.coordinator.service import RedisServer, Service, wait_until
from tests.coordinator.simulated_worker import Machine, SimulatedWorker, simulated_result
from tests.faults.survival import OVERDUE_SOON, SOME_DELAY, check_survived
from tests.system.waiting import LIMIT_S

_START = Path(__file__).parents[2] / "deploy" / "redis" / "start.sh"
_COORDINATOR = "a word"


class GuardedRedis(RedisServer):
    """As deploy/redis/start.sh starts it; its client is the coordinator's."""

    def start(self) -> None:
        words = {"NOCTURNE_REDIS_COORDINATOR_PASSWORD": _COORDINATOR}
        folder = str(self._socket.parent)
        self._process = subprocess.Popen(
            [_START, "--port", "0", "--unixsocket", str(self._socket), "--dir", folder],
            env={**os.environ, **words, "TMPDIR": folder},
            stdout=subprocess.DEVNULL,
        )
        wait_until(self._answers)

    def client(self) -> "redis.Redis":
        return redis.Redis.from_url(self.url, protocol=2, username="coordinator", password=_COORDINATOR)


class Farm(Service):
    """A service whose machines enrol."""

    def enrol(self, name: str, node: str = "") -> Machine:
        """Makes its token, if there is none, and waits until Redis knows it."""
        if all(token.name != name for token in self.folder.tokens.list()):
            self.folder.tokens.create(name, ["worker"])
        machine = Machine(*self.folder.machines.enrol(name, node))
        wait_until(lambda: _answers(machine, self.server.url))
        return machine

    def honest(self, name: str, **words: Any) -> SimulatedWorker:
        """A machine with one worker that does its work."""
        machine = self.enrol(name)
        worker = self.work(SimulatedWorker(self.server.url, delay=SOME_DELAY, machine=machine, **words))
        wait_until(lambda: any(row.id == worker.name for row in self.folder.workers.alive()))
        return worker


def _answers(machine: Machine, url: str) -> bool:
    try:
        with machine.client(url) as client:
            return bool(client.ping())
    except redis.RedisError:
        return False


@pytest.fixture
def farm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Farm]:
    monkeypatch.setenv("NOCTURNE_REDIS_USER", "coordinator")
    monkeypatch.setenv("NOCTURNE_REDIS_PASSWORD", _COORDINATOR)
    server = GuardedRedis(tmp_path)
    server.start()
    running = Farm(tmp_path / "data", server)
    running.start("", "--enrolled", "--audit-share", "0.2", "--audit-share-new", "0.5", *OVERDUE_SOON)
    yield running
    running.close()
    server.kill()


def wrong(job: job_pb2.Job, worker: str) -> job_pb2.JobResult:
    """Ten times as bright as it is."""
    result = simulated_result(job, worker)
    numbers = np.frombuffer(result.partial.sums, dtype="<f8") * 100.0
    split(numbers, job.tile.width, job.tile.height, 0).pixels[..., :3] /= 10.0
    result.partial.sums = numbers.tobytes()
    return result


def failed(job: job_pb2.Job, worker: str) -> job_pb2.JobResult:
    return job_pb2.JobResult(job=job, worker_id=worker, failure="segmentation fault, honest")


class Liar:
    """A machine that enrolled, and misuses its credentials."""

    def __init__(self, farm: Farm, name: str = "liar") -> None:
        self.machine = farm.enrol(name)
        self._client: Any = self.machine.client(farm.server.url)

    def take(self) -> tuple[bytes, job_pb2.Job, bytes] | None:
        """A job, and its lease."""
        found = self._client.xreadgroup(
            keys.WORKERS_GROUP, f"{self.machine.name}/x/0", {keys.JOBS: ">"}, count=1, block=100
        )
        if not found:
            return None
        entry, fields = found[0][1][0]
        return entry, job_pb2.Job.FromString(fields[keys.JOB_FIELD]), fields[keys.LEASE_FIELD]

    def first(self) -> tuple[bytes, job_pb2.Job, bytes]:
        """The same, as soon as the coordinator has published one."""
        deadline = time.monotonic() + LIMIT_S
        while (taken := self.take()) is None:
            assert time.monotonic() < deadline
        return taken

    def send(self, result: job_pb2.JobResult, lease: bytes, **beside: bytes) -> None:
        data = result.SerializeToString()
        fields = {
            **self.machine.signed(lease, data),
            **{name.encode(): each for name, each in beside.items()},
        }
        self._client.xadd(keys.RESULTS, {keys.RESULT_FIELD: data, **fields})

    def say(self, worker: str, **status: Any) -> None:
        """The status of a worker."""
        told = job_pb2.WorkerStatus(worker_id=worker, engine=job_pb2.ENGINE_CURRENT, started=1.0, **status)
        self._client.set(keys.WORKER_PREFIX + worker, told.SerializeToString(), px=10_000)

    def answer_all(self, make: Callable[[job_pb2.Job, str], job_pb2.JobResult], *names: str) -> int:
        """Takes all available jobs, and answers each in all those names; returns the number of jobs."""
        count = 0
        while taken := self.take():
            entry, job, lease = taken
            for name in names:
                self.send(make(job, f"{self.machine.name}/{name}"), lease)
            self.done(entry)
            count += 1
        return count

    def done(self, entry: bytes) -> None:
        """Takes a job off the stream."""
        self._client.xack(keys.JOBS, keys.WORKERS_GROUP, entry)
        self._client.xdel(keys.JOBS, entry)


def test_results_of_ranges_that_were_never_leased(farm: Farm) -> None:
    """P3: in an invented name, in that of another machine, and in its own with a lease of another range."""
    render = farm.create(samples=200)
    liar = Liar(farm)
    _, mine, lease = liar.first()
    with farm.server.client() as client:
        others = [job_pb2.Job.FromString(fields[keys.JOB_FIELD]) for _, fields in client.xrange(keys.JOBS)]
    others = [job for job in others if job.tile_index != mine.tile_index]
    assert len(others) >= 5
    for job in others:
        liar.send(wrong(job, "somebody-else"), lease)
        liar.send(wrong(job, "somebody-else"), lease, machine=b"somebody-else")
        liar.send(wrong(job, "liar/x"), lease)
        liar.send(wrong(job, "liar/x"), b"")
    wait_until(lambda: _results_waiting(farm) == 0)
    assert farm.row(render.id).photons == 0
    farm.honest("honest-1")
    check_survived(farm, render.id)


def test_a_result_in_the_name_of_another(farm: Farm) -> None:
    """P3: signed by a machine that had the job, for another's worker."""
    farm.create(samples=8)
    liar = Liar(farm)
    _, job, lease = liar.first()
    liar.send(wrong(job, "honest-1/w"), lease)
    wait_until(lambda: _results_waiting(farm) == 0)
    assert farm.row(job.render_id).photons == 0


def test_one_machine_under_two_names_does_not_outvote_another(farm: Farm) -> None:
    """P4: audits count machines, so there is nobody to say which of two is right."""
    liar = Liar(farm)
    farm.honest("honest-1")
    farm.create(samples=3000)
    _lie_until(liar, lambda: farm.folder.meters.read().get("audits_differing", 0.0) >= 1.0)
    # Long enough for the second name to be counted, if it were.
    until = time.monotonic() + 5.0
    _lie_until(liar, lambda: time.monotonic() > until)
    assert farm.folder.workers.in_quarantine() == {}


def test_two_honest_machines_find_one_under_two_names(farm: Farm) -> None:
    """P4: and its work is done again."""
    liar = Liar(farm)
    farm.honest("honest-1")
    farm.honest("honest-2")
    render = farm.create(samples=2000)
    _lie_until(liar, lambda: bool(farm.folder.workers.in_quarantine()))
    assert farm.folder.workers.in_quarantine().keys() == {"liar"}
    check_survived(farm, render.id, redone=True)
    assert farm.folder.workers.in_quarantine().keys() == {"liar"}


def _lie_until(liar: Liar, enough: Callable[[], bool]) -> None:
    deadline = time.monotonic() + LIMIT_S
    while not enough():
        assert time.monotonic() < deadline
        for name in ("a", "b"):
            liar.say(f"liar/{name}", threads=1)
        if taken := liar.take():
            entry, job, lease = taken
            for name in ("a", "b"):
                liar.send(wrong(job, f"liar/{name}"), lease)
            liar.done(entry)


def test_failed_in_three_names_is_one_machine(farm: Farm) -> None:
    """P5: no tile fails, and the render ends as it should."""
    liar = Liar(farm)
    farm.honest("honest-1")
    render = farm.create(samples=100)
    for _ in range(20):
        liar.say("liar/a", threads=1)
        liar.answer_all(failed, "a", "b", "c")
    check_survived(farm, render.id)
    assert farm.row(render.id).tiles_failed == 0


def test_a_forged_status_moves_only_its_own_worker(farm: Farm) -> None:
    """P5: an absurd number of threads, another floating-point profile, and a status for another machine's
    worker."""
    honest = farm.honest("honest-1", floating_point_profile="a" * 16)
    # The render must run all the time, beyond the seconds after which the majority of machines decides.
    honest.delay = 0.4
    render = farm.create(samples=3000)
    wait_until(lambda: farm.row(render.id).ranges_done > 3)
    liar = Liar(farm)
    with pytest.raises(redis.exceptions.NoPermissionError):
        liar.say(honest.name, threads=1)
    before = farm.row(render.id).ranges_done
    for _ in range(15):
        for name in ("a", "b", "c"):
            liar.say(f"liar/{name}", threads=4_000_000_000, floating_point_profile="b" * 16)
        time.sleep(1.0)
        after = farm.row(render.id)
        assert after.ranges_done >= before
        before = after.ranges_done
        assert honest.name not in farm.folder.workers.incompatible()
        assert farm.folder.workers.in_quarantine() == {}
    assert after.state == "RUNNING"
    honest.delay = SOME_DELAY
    check_survived(farm, render.id)
    assert farm.row(render.id).floating_point_profile == "a" * 16


def test_a_status_in_a_name_that_is_not_its_keys(farm: Farm) -> None:
    """P5: a status counts only for the worker whose key it has."""
    honest = farm.honest("honest-1")
    liar = Liar(farm)
    told = job_pb2.WorkerStatus(
        worker_id=honest.name, engine=job_pb2.ENGINE_1, threads=1, started=time.time()
    )
    with liar.machine.client(farm.server.url) as client:
        client.set(f"{keys.WORKER_PREFIX}liar/x", told.SerializeToString(), px=10_000)
    assert worker_row("liar/x", told.SerializeToString(), 0.0) is None
    time.sleep(2.0)
    assert {row.engine for row in farm.folder.workers.alive() if row.id == honest.name} <= {
        int(job_pb2.ENGINE_CURRENT)
    }


def test_pods_of_one_token_audit_each_other(farm: Farm) -> None:
    """P15: each node is a machine."""
    for node in ("node-1", "node-2"):
        machine = farm.enrol("pool", node)
        farm.work(SimulatedWorker(farm.server.url, delay=SOME_DELAY, machine=machine))
    wait_until(lambda: len(farm.folder.workers.alive()) == 2)
    render = farm.create(samples=200)
    check_survived(farm, render.id)
    assert farm.row(render.id).audited > 0
    # Revoked, all of them are out.
    farm.folder.tokens.revoke("pool")
    wait_until(lambda: not _answers(machine, farm.server.url))


def test_a_machine_is_revoked_while_it_runs(farm: Farm) -> None:
    """P3: its connections end, its last results do not count, and the others continue."""
    render = farm.create(samples=400)
    liar = Liar(farm)
    taken = liar.first()
    farm.honest("honest-1")
    farm.folder.tokens.revoke("liar")
    wait_until(lambda: not _answers(liar.machine, farm.server.url))
    with pytest.raises(redis.RedisError):
        liar.send(wrong(taken[1], "liar/x"), taken[2])
    check_survived(farm, render.id)


def test_machines_are_known_again_after_redis_lost_all(farm: Farm) -> None:
    """P3: their users are created again, and they continue by themselves."""
    render = farm.create(samples=400)
    farm.honest("honest-1")
    wait_until(lambda: farm.row(render.id).ranges_done > 3)
    farm.server.kill()
    farm.server.start()
    check_survived(farm, render.id)


def _results_waiting(farm: Farm) -> int:
    with farm.server.client() as client:
        return int(client.xlen(keys.RESULTS))
