"""Redis and workers in memory, by a virtual clock; `test_queue_contract.py` compares it with the real one."""

import random
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from nocturne.v1 import job_pb2
from nocturne_coordinator.clock import Clock
from nocturne_coordinator.dispatch.events import Moment
from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.quick_entries import QUICK, is_quick
from nocturne_coordinator.enrolment import machine_of
from nocturne_coordinator.errors import QueueError
from nocturne_coordinator.limits import QUICK_CPU_SECONDS
from nocturne_coordinator.queue.job_queue import SESSION_SECONDS, Entry, JobQueue, ResultEntry, Session

from tests.coordinator.simulated_worker import Alter, simulated_result, unaltered

STATUS_SECONDS = 10.0
"""A worker's status holds so long, and is renewed every two seconds."""


class VirtualClock(Clock):
    """Time goes on when somebody waits, and the workers work meanwhile."""

    def __init__(self, seed: int) -> None:
        super().__init__()
        self.now = 1000.0
        self._draws = random.Random(seed)
        self.workers: list[Worker] = []
        self.told_to_stop = False

    def moment(self) -> Moment:
        return Moment(self.now, 1.7e9 + self.now)

    def wait(self, seconds: float) -> None:
        self.advance(self.now + seconds, lambda: False)

    def advance(self, until: float, enough: Callable[[], bool]) -> None:
        """Until then, or until it is enough."""
        while not enough():
            following = min(self.workers, key=lambda worker: worker.next_at, default=None)
            if following is None or following.next_at > until:
                self.now = max(self.now, until)
                return
            self.now = max(self.now, following.next_at)
            following.step()

    @property
    def stopping(self) -> bool:
        return self.told_to_stop

    def random(self) -> float:
        return self._draws.random()


@dataclass
class Delivery:
    """A job that a worker has."""

    worker: str
    renewed: float


class MemoryQueue(JobQueue):
    """Both streams, and the faults that can happen to them."""

    def __init__(self, clock: VirtualClock) -> None:
        self._clock = clock
        self.guard = None
        self.job_stream: dict[bytes, bytes] = {}
        self.result_stream: dict[bytes, bytes] = {}
        self.pending: dict[bytes, Delivery] = {}
        self.delivered: set[bytes] = set()
        self.stopped: set[bytes] = set()
        self.statuses: dict[str, tuple[bytes, float]] = {}
        self.without_jobs: dict[str, float] = {}
        self.runs: set[str] = set()
        self.session = b"", 0.0
        self.is_down = False
        self.lost_answers: Callable[[], bool] = lambda: False
        """Whether a call of the coordinator happens and its answer is lost."""
        self._numbers = 0
        self.most = 0
        """Jobs on the stream."""

    def flush(self) -> None:
        """FLUSHALL, or a restart without files."""
        for each in (self.job_stream, self.result_stream, self.pending, self.statuses, self.without_jobs):
            each.clear()
        self.delivered.clear()
        self.runs.clear()
        self.session = b"", 0.0

    def check_up(self) -> None:
        if self.is_down:
            raise QueueError("there is no answer")

    def _answered(self) -> None:
        if self.lost_answers():
            raise QueueError("the answer is lost")

    def new_entry(self) -> bytes:
        self._numbers += 1
        return f"{int(1000 * self._clock.moment().unix)}-{self._numbers}".encode()

    # --- as the coordinator sees it ---

    def attend(self, session: Session) -> bool:
        self.check_up()
        now = self._clock.now
        session.check(self.session[0] if self.session[1] > now else None)
        self.session = session.text, now + SESSION_SECONDS
        known = session.nonce in self.runs
        self.runs.add(session.nonce)
        self._answered()
        return known

    def give_up_session(self, session: Session) -> None:
        self.check_up()
        self.runs.discard(session.nonce)
        if not session.shared and self.session[0] == session.text:
            self.session = b"", 0.0

    def publish(self, jobs: Iterable[bytes], quick: bool = False) -> list[bytes]:
        self.check_up()
        entries = []
        for job in jobs:
            entries.append(QUICK * quick + self.new_entry())
            self.job_stream[entries[-1]] = job
        self.most = max(self.most, self.jobs_waiting())
        self._answered()
        return entries

    def jobs(self) -> list[Entry]:
        self.check_up()
        return list(self.job_stream.items())

    def delete_jobs(self, entries: list[bytes]) -> None:
        self.check_up()
        for entry in entries:
            self.job_stream.pop(entry, None)
            if entry not in self.pending:
                self.delivered.discard(entry)
        self._answered()

    def stop_jobs(self, entries: list[bytes]) -> None:
        self.check_up()
        self.stopped.update(entries)
        self._answered()

    def results(self, after: bytes, wait_ms: int) -> list[ResultEntry]:
        self.check_up()

        def found() -> list[ResultEntry]:
            later = [each for each in self.result_stream.items() if _place(each[0]) > _place(after)]
            return [ResultEntry(*each) for each in later[:64]]

        if wait_ms and not found():
            self._clock.advance(self._clock.now + wait_ms / 1000, lambda: bool(found()))
        self._answered()
        return found()

    def jobs_waiting(self) -> int:
        return sum(not is_quick(entry) for entry in self.job_stream)

    def results_waiting(self) -> int:
        return len(self.result_stream)

    def delete_results(self, entries: list[bytes]) -> None:
        self.check_up()
        for entry in entries:
            self.result_stream.pop(entry, None)
        self._answered()

    def workers(self) -> list[tuple[str, bytes, int]]:
        self.check_up()
        now = self._clock.now
        self.statuses = {name: each for name, each in self.statuses.items() if each[1] > now}
        return [(name, status, int(1000 * (until - now))) for name, (status, until) in self.statuses.items()]

    def holders(self) -> list[Holder]:
        return [Holder(entry, delivery.worker) for entry, delivery in self.pending.items()]

    def keep_in_quarantine(self, workers: Mapping[str, str]) -> None:
        self.check_up()
        for worker in workers:
            self.without_jobs[worker] = self._clock.now + SESSION_SECONDS

    # --- as workers see it ---

    def take(self, worker: str, lease: float, quick: bool = False) -> tuple[bytes, bytes] | None:
        """XREADGROUP, then XAUTOCLAIM, on one of the streams."""
        for entry, data in self.job_stream.items():
            if entry not in self.delivered and is_quick(entry) == quick:
                self.delivered.add(entry)
                self.pending[entry] = Delivery(worker, self._clock.now)
                return entry, data
        for entry, delivery in list(self.pending.items()):
            if delivery.renewed < self._clock.now - lease and is_quick(entry) == quick:
                if entry not in self.job_stream:
                    del self.pending[entry]
                    continue
                self.pending[entry] = Delivery(worker, self._clock.now)
                return entry, self.job_stream[entry]
        return None

    def complete(self, entry: bytes | None, results: Iterable[bytes]) -> None:
        """XADD, XACK and XDEL in one transaction; without an entry, the results alone."""
        for result in results:
            self.result_stream[self.new_entry()] = result
        if entry is not None:
            self.pending.pop(entry, None)
            self.job_stream.pop(entry, None)


def _place(entry: bytes) -> tuple[int, int]:
    milliseconds, _, number = entry.partition(b"-")
    return int(milliseconds), int(number)


class _Thread:
    """One job at a time."""

    def __init__(self, quick: bool) -> None:
        self.quick = quick
        """Takes quick copies only."""
        self.job: tuple[bytes, bytes] | None = None
        self.done_at = 0.0


class Worker:
    """Everything but tracing; see SimulatedWorker, which is this one on a real Redis."""

    def __init__(
        self,
        name: str,
        queue: MemoryQueue,
        clock: VirtualClock,
        alter: Alter = unaltered,
        delay: float = 0.02,
        lease: float = 1.0,
        dies: Callable[[job_pb2.JobResult], bool] = lambda _: False,
        profile: str = "",
        quick: bool = True,
    ) -> None:
        """`quick`: it has the further threads for quick copies."""
        self.name = name
        self.jobs_done = self.quick_done = 0
        self._queue, self._clock = queue, clock
        self._alter, self.delay, self._lease, self._dies, self._profile = alter, delay, lease, dies, profile
        self._started = clock.moment().unix
        self._threads = [_Thread(False), *(_Thread(True) for _ in range(2 * quick))]
        self._is_alive = True
        self.next_at = clock.now
        clock.workers.append(self)

    def seconds_of(self, job: job_pb2.Job) -> float:
        """That it takes for a job."""
        del job
        return self.delay

    @property
    def has_job(self) -> bool:
        return self._threads[0].job is not None

    def die(self) -> None:
        """SIGKILL."""
        self.next_at = float("inf")
        self._is_alive = False
        self._clock.workers.remove(self)

    def stand_still(self, seconds: float) -> None:
        """SIGSTOP, and SIGCONT after that."""
        self.next_at = self._clock.now + seconds
        for thread in self._threads:
            thread.done_at = max(thread.done_at, self.next_at)

    def leave(self) -> None:
        """SIGTERM: jobs are handed back, the status deleted."""
        self._queue.statuses.pop(self.name, None)
        for thread in self._threads:
            if thread.job is not None and thread.job[0] in self._queue.pending:
                self._queue.pending[thread.job[0]].renewed = -1.0
        self.die()

    def step(self) -> None:
        now = self._clock.now
        self.next_at = now + 0.05
        if self._queue.is_down:
            return
        status = job_pb2.WorkerStatus(
            worker_id=self.name,
            engine=job_pb2.ENGINE_CURRENT,
            threads=1,
            started=self._started,
            floating_point_profile=self._profile,
        )
        self._queue.statuses[self.name] = status.SerializeToString(), now + STATUS_SECONDS
        for thread in self._threads:
            if self._is_alive:
                self._step(thread, now)

    def _step(self, thread: _Thread, now: float) -> None:
        if thread.job is None:
            names = (self.name, machine_of(self.name))
            if any(self._queue.without_jobs.get(name, 0.0) > now for name in names):
                return
            thread.job = self._queue.take(self.name, self._lease, thread.quick)
            if thread.job is not None:
                takes = self.seconds_of(job_pb2.Job.FromString(thread.job[1]))
                thread.done_at = now + (min(takes, QUICK_CPU_SECONDS) if thread.quick else takes)
        elif now >= thread.done_at:
            self._finish(*thread.job, thread.quick)
            thread.job = None
        if thread.job is not None and self._is_alive:
            delivery = self._queue.pending.get(thread.job[0])
            if delivery is not None and delivery.worker == self.name:
                delivery.renewed = now
            following = min(now + self._lease / 3, max(thread.done_at, now + 1e-3))
            self.next_at = min(self.next_at, following) if thread.quick else following

    def _finish(self, entry: bytes, data: bytes, quick: bool = False) -> None:
        job = job_pb2.Job.FromString(data)
        result = simulated_result(job, self.name)
        result.floating_point_profile = self._profile
        if self._dies(result):
            self.die()
            return
        sent: list[job_pb2.JobResult | bytes] = [result]
        if quick and self.seconds_of(job) > QUICK_CPU_SECONDS:
            result.failure, result.stopped_too_long = "it was stopped", True
        else:
            sent = self._alter(result)
        self._queue.complete(
            entry, [each if isinstance(each, bytes) else each.SerializeToString() for each in sent]
        )
        self.jobs_done += 1
        self.quick_done += quick
