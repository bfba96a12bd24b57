"""The service put together by hand, so that tests can kill each part of it."""

import sqlite3
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import redis
from nocturne.v1 import job_pb2
from nocturne_client import Client
from nocturne_client.local.programs import need_program
from nocturne_coordinator.queue import keys

from tests.system.free_ports import free_port_pair
from tests.system.program import Program
from tests.system.waiting import wait_for

# Short, so that tests do not wait long for what a killed worker had in hand.
LEASE_MS = 1000


class ServiceProcesses:
    """redis-server, coordinator, API, and workers of one thread each."""

    def __init__(
        self, folder: Path, *coordinator_words: str | Path, coordinator_port: int = 0, worker_port: int = 0
    ) -> None:
        """`folder` holds everything; its path must be short, for Unix sockets.

        Ports, where they are given, are how coordinator and workers reach Redis' socket, `folder`/redis.sock.
        """
        self.spoilt = False
        """A test failed with it: nothing is known of its state."""
        self.workers: dict[str, Program] = {}
        self._past_workers: list[Program] = []
        self._folder = folder
        self._socket = folder / "redis.sock"
        here = f"unix://{self._socket}"
        coordinators = f"redis://127.0.0.1:{coordinator_port}" if coordinator_port else here
        self._workers_redis = f"tcp://127.0.0.1:{worker_port}" if worker_port else here
        port = free_port_pair()
        self.url = f"http://127.0.0.1:{port}"
        self.client = Client(self.url)
        self.redis_server = self._program("redis", need_program("redis-server"), *self._redis_words())
        self.coordinator = self._python(
            # Often, so that a test sees soon that a render is in mid-work.
            *("nocturne_coordinator.main", "--redis", coordinators, "--commit-seconds", "0.1"),
            *coordinator_words,
        )
        self._api = self._python(
            *("nocturne_api.main", "--port", str(port), "--grpc-port", str(port + 1)),
            *("--grpc-unix", folder / "grpc.sock"),
        )
        # redis-py's answers are typed as maybe-awaitable.
        self.queue: Any = redis.Redis.from_url(f"unix://{self._socket}", protocol=2)

    def start(self) -> None:
        """Starts all but workers."""
        self.start_redis()
        self.coordinator.start()
        self._api.start()
        wait_for(self._api_answers, "the API")

    def close(self) -> None:
        """Ends all processes at once: nothing in them is worth keeping."""
        for program in reversed(self._programs()):
            program.kill()
        self.queue.close()
        self.client.close()

    def logs(self) -> str:
        """The end of each."""
        return "\n".join(f"--- {program.log.name}\n{program.tail()}" for program in self._programs())

    # Workers

    def have_workers(self, count: int) -> None:
        """Starts or ends some, so that there are that many."""
        while len(self.workers) > count:
            self.end_worker(next(reversed(self.workers)))
        while len(self.workers) < count:
            self.start_worker()

    def start_worker(
        self, cache: Path | None = None, environment: Mapping[str, str] | None = None
    ) -> Program:
        """One more, under a new name; `cache`: not the one that all share; `environment` is added to ours."""
        name = f"w{len(self.workers) + len(self._past_workers) + 1}"
        worker = self._program(
            name,
            need_program("nocturne-worker"),
            *("--redis", self._workers_redis, "--assets", f"unix:{self._folder / 'grpc.sock'}"),
            *("--cache", cache or self._folder / "cache", "--threads", "1", "--id", name),
            *("--lease-ms", str(LEASE_MS)),
            environment=environment,
        )
        worker.start()
        self.workers[name] = worker
        return worker

    def wait_for_workers(self) -> None:
        """Until the service has seen each of these, and not only others that have just ended."""
        wait_for(
            lambda: set(self.workers) <= {each.id for each in self.client.workers()}, "all workers to be seen"
        )

    def end_worker(self, name: str) -> None:
        """SIGTERM; it finishes its job, or hands it back, and ends in order."""
        worker = self.workers.pop(name)
        self._past_workers.append(worker)
        # What starts it, a Python program, would die of the signal.
        wait_for(lambda: b" starts," in worker.log.read_bytes(), f"{name} to start")
        assert worker.end() == 0, worker.tail()

    def kill_worker(self, name: str) -> None:
        self.workers[name].kill()
        self._past_workers.append(self.workers.pop(name))

    def pause_workers(self) -> None:
        for worker in self.workers.values():
            worker.pause()

    def let_workers_go_on(self) -> None:
        for worker in self.workers.values():
            worker.go_on()

    def contributors(self, render_id: str) -> set[str]:
        """Workers whose work is in the render's sums."""
        with closing(sqlite3.connect(self._folder / "data" / "nocturne.db")) as database:
            rows = database.execute("SELECT worker_id FROM contribution WHERE render_id = ?", (render_id,))
            return {row[0] for row in rows}

    # Queue

    def start_redis(self) -> None:
        """Empty, as it keeps nothing on disk."""
        self._socket.unlink(missing_ok=True)
        self.redis_server.start()
        wait_for(self._redis_answers, "redis-server")

    def dispatch_in(self, order: Callable[[Sequence[Any]], Sequence[Any]]) -> int:
        """Puts the jobs that nobody has taken back on the stream in another order; gives how many they are.

        Coordinator and workers must stand still.
        """
        entries = self.queue.xrange(keys.JOBS)
        with self.queue.pipeline(transaction=True) as transaction:
            for _, fields in order(entries):
                transaction.xadd(keys.JOBS, fields)
            for entry, _ in entries:
                transaction.xdel(keys.JOBS, entry)
            transaction.execute()
        return len(entries)

    def jobs_held_by(self, worker: str, idle_ms: int | None = None) -> list[bytes]:
        """Entries that the worker has taken and not yet acknowledged, after all that it has sent.

        `idle_ms`: only those that nobody has taken or extended for so long.
        """
        self.queue.ping()
        try:
            pending = self.queue.xpending_range(keys.JOBS, keys.WORKERS_GROUP, "-", "+", 1000, idle=idle_ms)
        except redis.ResponseError:
            # Redis lost all, and the coordinator has not made the group again yet.
            return []
        return [each["message_id"] for each in pending if each["consumer"].startswith(f"{worker}/".encode())]

    def jobs_given_back_by(self, worker: str) -> list[bytes]:
        """Entries of it that any worker may take over, and none has yet."""
        return self.jobs_held_by(worker, LEASE_MS)

    def deliver_again(self) -> set[tuple[int, int]]:
        """Copies all that waits on the result stream, in reverse; gives tile and first sample of each."""
        copied = set()
        for _, fields in self.queue.xrevrange(keys.RESULTS):
            self.queue.xadd(keys.RESULTS, fields)
            job = job_pb2.JobResult.FromString(fields[keys.RESULT_FIELD]).job
            copied.add((job.tile_index, job.first_sample))
        return copied

    def check_nothing_left(self) -> None:
        """No job, result or claim outlives the renders."""
        for what, count in (
            ("jobs to go", lambda: self.queue.xlen(keys.JOBS)),
            ("results to go", lambda: self.queue.xlen(keys.RESULTS)),
            ("claims to go", lambda: self.queue.xpending(keys.JOBS, keys.WORKERS_GROUP)["pending"]),
        ):
            wait_for(_is_zero(count), what)
        known = {keys.JOBS, keys.QUICK_JOBS, keys.RESULTS, keys.SESSION}
        names = {name.decode() for name in self.queue.keys("*")}
        lapsing = (keys.WORKER_PREFIX, keys.RUN_PREFIX, keys.QUARANTINE_PREFIX, keys.WITHDRAWN_PREFIX)
        assert {name for name in names - known if not name.startswith(lapsing)} == set()

    # Inside

    def _programs(self) -> list[Program]:
        return [self.redis_server, self.coordinator, self._api, *self.workers.values(), *self._past_workers]

    def _program(
        self, name: str, *command: str | Path, environment: Mapping[str, str] | None = None
    ) -> Program:
        return Program(command, self._folder / f"{name}.log", environment)

    def _python(self, module: str, *words: str | Path) -> Program:
        return self._program(module, sys.executable, "-m", module, "--data", self._folder / "data", *words)

    def _redis_words(self) -> list[str | Path]:
        return ["--port", "0", "--unixsocket", self._socket, "--save", "", "--dir", self._folder]

    def _redis_answers(self) -> bool:
        assert self.redis_server.is_alive(), self.redis_server.tail()
        try:
            return bool(self.queue.ping())
        except redis.RedisError:
            return False

    def _api_answers(self) -> bool:
        assert self._api.is_alive(), self._api.tail()
        return self.client.is_ready()


def _is_zero(count: Callable[[], int]) -> Callable[[], bool]:
    return lambda: count() == 0
