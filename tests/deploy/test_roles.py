"""Redis users: each role can do its part, and nothing else."""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import redis
from nocturne_coordinator.errors import QueueError
from nocturne_coordinator.queue import keys
from nocturne_coordinator.queue.guard import Guard
from nocturne_coordinator.queue.job_queue import JobQueue, Session
from redis.exceptions import AuthenticationError, NoPermissionError

from tests.coordinator.service import wait_until
from tests.coordinator.simulated_worker import Machine

ROOT = Path(__file__).parents[2]
START = ROOT / "deploy" / "redis" / "start.sh"
_COORDINATOR = "the first/word&"
_MACHINE = Machine("m", b"k" * 32)
_ENVIRONMENT = {
    "NOCTURNE_REDIS_COORDINATOR_PASSWORD": _COORDINATOR,
    "PATH": "/usr/bin:/bin",
}


class Guarded:
    """redis-server as deploy/redis/start.sh starts it, with a machine that enrolled."""

    def __init__(self, folder: Path) -> None:
        self.url = f"unix://{folder / 'redis.sock'}"
        self.process = subprocess.Popen(
            [START, "--port", "0", "--unixsocket", str(folder / "redis.sock"), "--dir", str(folder)],
            env={**_ENVIRONMENT, "TMPDIR": str(folder)},
            stdout=subprocess.DEVNULL,
        )
        wait_until(self._answers)
        with self.as_("coordinator") as client:
            Guard(b"", {_MACHINE.name: _MACHINE.key}).admit(client)

    def as_(self, role: str | None) -> Any:
        if role == "worker":
            return _MACHINE.client(self.url)
        word = _COORDINATOR if role else None
        return redis.Redis.from_url(self.url, protocol=2, username=role, password=word)

    def _answers(self) -> bool:
        assert self.process.poll() is None
        try:
            with self.as_("coordinator") as client:
                return bool(client.ping())
        except redis.RedisError:
            return False


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarded]:
    guarded = Guarded(tmp_path_factory.mktemp("redis"))
    yield guarded
    guarded.process.kill()
    guarded.process.wait()


@pytest.fixture
def queue(server: Guarded, monkeypatch: pytest.MonkeyPatch) -> Iterator[JobQueue]:
    monkeypatch.setenv("NOCTURNE_REDIS_USER", "coordinator")
    monkeypatch.setenv("NOCTURNE_REDIS_PASSWORD", _COORDINATOR)
    queue = JobQueue(server.url)
    yield queue
    queue.close()


# As worker/src/queue/job_queue.cpp sends them.
_WORKERS_PART: list[list[str]] = [
    ["XREADGROUP", "GROUP", keys.WORKERS_GROUP, "w/0", "COUNT", "1", "STREAMS", keys.JOBS, ">"],
    ["XAUTOCLAIM", keys.JOBS, keys.WORKERS_GROUP, "w/0", "1000", "0-0", "COUNT", "1"],
    ["XCLAIM", keys.JOBS, keys.WORKERS_GROUP, "w/0", "0", "1-1", "IDLE", "5", "JUSTID"],
    ["XPENDING", keys.JOBS, keys.WORKERS_GROUP, "1-1", "1-1", "1", "w/0"],
    ["MULTI"],
    ["XADD", keys.RESULTS, "*", keys.RESULT_FIELD.decode(), "sums"],
    ["XACK", keys.JOBS, keys.WORKERS_GROUP, "1-1"],
    ["XDEL", keys.JOBS, "1-1"],
    ["EXEC"],
    ["MGET", f"{keys.QUARANTINE_PREFIX}w", f"{keys.QUARANTINE_PREFIX}"],
    ["MGET", f"{keys.WITHDRAWN_PREFIX}1-1"],
    ["SET", f"{keys.WORKER_PREFIX}m/w", "status", "EX", "10"],
    ["DEL", f"{keys.WORKER_PREFIX}m/w"],
    ["PING"],
]


def test_the_coordinator_can_do_its_part(queue: JobQueue) -> None:
    queue.check_settings()
    session = Session("folder", 1, "nonce")
    for name, method in sorted(vars(JobQueue).items()):
        if name.startswith("_") or name in ("close", "check_settings"):
            continue
        arguments: dict[str, tuple[object, ...]] = {
            "attend": (session,),
            "check_lease": (session,),
            "give_up_session": (session,),
            "publish": ([b"job"],),
            "delete_jobs": ([b"1-1"],),
            "results": (b"0-0", 1),
            "delete_results": ([b"1-1"],),
            "keep_in_quarantine": ({"w": "lied"},),
            "stop_jobs": ([b"1-1"],),
        }
        if name in ("holders",):
            queue.attend(session)
        method(queue, *arguments.get(name, ()))


def test_a_worker_can_do_its_part(server: Guarded, queue: JobQueue) -> None:
    queue.attend(Session("folder", 1, "nonce"))
    queue.publish([b"job"])
    with server.as_("worker") as worker:
        # Answers as they are: some of these commands are not called as redis-py would.
        worker.response_callbacks.clear()
        for words in _WORKERS_PART:
            worker.execute_command(*words)


@pytest.mark.parametrize(
    "words",
    [
        ["GET", keys.SESSION],
        ["SET", keys.SESSION, "mine"],
        ["DEL", keys.SESSION],
        ["DEL", keys.JOBS],
        ["DEL", keys.RESULTS],
        ["DEL", f"{keys.QUARANTINE_PREFIX}w"],
        ["SET", f"{keys.QUARANTINE_PREFIX}w", ""],
        ["GET", f"{keys.WORKER_PREFIX}w"],
        ["SET", f"{keys.WORKER_PREFIX}m/w", "x", "GET"],
        ["SET", f"{keys.WORKER_PREFIX}other/w", "x"],
        ["SET", f"{keys.WORKER_PREFIX}m", "x"],
        ["DEL", f"{keys.WORKER_PREFIX}other/w"],
        ["ACL", "SETUSER", "machine-m", "+@all"],
        ["ACL", "USERS"],
        ["SET", "anything", "x"],
        ["XADD", keys.JOBS, "*", "job", "mine"],
        ["XDEL", keys.RESULTS, "1-1"],
        ["XTRIM", keys.RESULTS, "MAXLEN", "0"],
        ["XRANGE", keys.RESULTS, "-", "+"],
        ["XREAD", "STREAMS", keys.RESULTS, "0"],
        ["XREADGROUP", "GROUP", "g", "c", "STREAMS", keys.RESULTS, ">"],
        ["XGROUP", "DESTROY", keys.JOBS, keys.WORKERS_GROUP],
        ["KEYS", "*"],
        ["SCAN", "0"],
        ["FLUSHALL"],
        ["PUBLISH", "channel", "x"],
        ["INFO"],
    ],
    ids=lambda words: "-".join(words[:2]),
)
def test_a_worker_can_do_nothing_else(server: Guarded, words: list[str]) -> None:
    with server.as_("worker") as worker, pytest.raises(NoPermissionError):
        worker.execute_command(*words)


# Forbidden by kind, not by key: scripts, administration, and commands that Redis itself calls dangerous.
_NOBODYS = (
    ["EVAL", "return 1", "0"],
    ["FUNCTION", "LIST"],
    ["SCRIPT", "FLUSH"],
    ["FLUSHALL"],
    ["FLUSHDB"],
    ["CONFIG", "GET", "*"],
    ["CONFIG", "SET", "maxmemory", "1"],
    ["ACL", "LIST"],
    ["SHUTDOWN"],
    ["REPLICAOF", "NO", "ONE"],
    ["MONITOR"],
    ["MODULE", "LIST"],
    ["CLIENT", "KILL", "ID", "1"],
    ["MIGRATE", "h", "1", "k", "0", "1"],
    ["KEYS", "*"],
    ["SWAPDB", "0", "1"],
)


@pytest.mark.parametrize("role", ["worker", "coordinator"])
@pytest.mark.parametrize("words", _NOBODYS, ids=lambda words: "-".join(words[:2]))
def test_nobody_has_scripts_or_administration(server: Guarded, role: str, words: list[str]) -> None:
    with server.as_(role) as client, pytest.raises(NoPermissionError):
        client.execute_command(*words)


def test_the_coordinator_has_our_keys_only(server: Guarded) -> None:
    with server.as_("coordinator") as client, pytest.raises(NoPermissionError):
        client.set("somebody's", "else")


@pytest.mark.parametrize("words", [*_NOBODYS, ["PING"], ["EXISTS", keys.SESSION], ["INFO"]], ids=" ".join)
def test_nobody_does_anything_without_a_password(server: Guarded, words: list[str]) -> None:
    with server.as_(None) as client, pytest.raises(AuthenticationError):
        client.execute_command(*words)


def test_wrong_words_are_refused(server: Guarded, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NOCTURNE_REDIS_USER", "coordinator")
    monkeypatch.setenv("NOCTURNE_REDIS_PASSWORD", "wrong")
    queue = JobQueue(server.url)
    with pytest.raises(QueueError, match="Authentication"):
        queue.results_waiting()
    queue.close()


def test_it_does_not_start_without_a_password() -> None:
    environment = {"PATH": _ENVIRONMENT["PATH"]}
    started = subprocess.run(
        [START], env=environment, capture_output=True, text=True, timeout=20, check=False
    )
    assert started.returncode != 0
    assert "NOCTURNE_REDIS_COORDINATOR_PASSWORD: is not set" in started.stderr


def test_a_machine_that_is_not_enrolled_any_more_is_gone_at_once(server: Guarded) -> None:
    other = Machine("other", b"o" * 32)
    with server.as_("coordinator") as coordinator, other.client(server.url) as client:
        guard = Guard(b"", {each.name: each.key for each in (_MACHINE, other)})
        guard.admit(coordinator)
        assert client.ping()
        guard.machines = {_MACHINE.name: _MACHINE.key}
        guard.admit(coordinator)
        with pytest.raises(redis.RedisError):
            client.ping()
    with server.as_("worker") as client:
        assert client.ping()
