"""The queue of tests in memory does what Redis does: each test here runs on both.

Long: the whole contract stands together."""

import time
from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Any

import pytest
import redis
from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.quick_entries import QUICK, is_quick
from nocturne_coordinator.errors import OwnershipLost, QueueInUse
from nocturne_coordinator.queue import keys
from nocturne_coordinator.queue.job_queue import FIRST, SESSION_SECONDS, JobQueue, Session

from tests.coordinator.memory_queue import MemoryQueue, VirtualClock
from tests.coordinator.service import RedisServer

LEASE = 0.2
"""Seconds after which a job is somebody else's."""

SESSION = Session("folder", 1, "first")


class Both(ABC):
    """A queue, and what workers and fate do to it."""

    queue: JobQueue

    @abstractmethod
    def pass_time(self, seconds: float) -> None: ...

    @abstractmethod
    def take(self, worker: str, quick: bool = False) -> tuple[bytes, bytes] | None:
        """As a worker: a new job, or one of which the lease has run out; of quick copies, if it is for
        those."""

    @abstractmethod
    def complete(self, entry: bytes | None, *results: bytes) -> None: ...

    @abstractmethod
    def tell_status(self, worker: str, status: bytes, seconds: float) -> None: ...

    @abstractmethod
    def gets_jobs(self, worker: str) -> bool: ...

    @abstractmethod
    def is_to_stop(self, entry: bytes) -> bool: ...

    @abstractmethod
    def expire_session(self) -> None:
        """Its ten seconds have passed."""

    @abstractmethod
    def flush(self) -> None: ...


class InMemory(Both):
    def __init__(self) -> None:
        self._clock = VirtualClock(1)
        self.queue: MemoryQueue = MemoryQueue(self._clock)

    def pass_time(self, seconds: float) -> None:
        self._clock.wait(seconds)

    def take(self, worker: str, quick: bool = False) -> tuple[bytes, bytes] | None:
        return self.queue.take(worker, LEASE, quick)

    def complete(self, entry: bytes | None, *results: bytes) -> None:
        self.queue.complete(entry, results)

    def tell_status(self, worker: str, status: bytes, seconds: float) -> None:
        self.queue.statuses[worker] = status, self._clock.now + seconds

    def gets_jobs(self, worker: str) -> bool:
        return self.queue.without_jobs.get(worker, 0.0) <= self._clock.now

    def is_to_stop(self, entry: bytes) -> bool:
        return entry in self.queue.stopped

    def expire_session(self) -> None:
        self.pass_time(SESSION_SECONDS)

    def flush(self) -> None:
        self.queue.flush()


class OnRedis(Both):
    def __init__(self, server: RedisServer) -> None:
        self.queue = JobQueue(server.url)
        self._client: Any = redis.Redis.from_url(server.url, protocol=2)

    def close(self) -> None:
        self.queue.close()
        self._client.close()

    def pass_time(self, seconds: float) -> None:
        time.sleep(seconds)

    def take(self, worker: str, quick: bool = False) -> tuple[bytes, bytes] | None:
        group, consumer = keys.WORKERS_GROUP, f"{worker}/0"
        stream, prefix = (keys.QUICK_JOBS, QUICK) if quick else (keys.JOBS, b"")
        found = self._client.xreadgroup(group, consumer, {stream: ">"}, count=1)
        if found:
            entries = found[0][1]
        else:
            idle = int(1000 * LEASE)
            entries = self._client.xautoclaim(stream, group, consumer, idle, FIRST, count=1)[1]
        return (prefix + entries[0][0], entries[0][1][keys.JOB_FIELD]) if entries else None

    def complete(self, entry: bytes | None, *results: bytes) -> None:
        pipeline = self._client.pipeline(transaction=True)
        for result in results:
            pipeline.xadd(keys.RESULTS, {keys.RESULT_FIELD: result})
        if entry is not None:
            pipeline.xack(keys.JOBS, keys.WORKERS_GROUP, entry)
            pipeline.xdel(keys.JOBS, entry)
        pipeline.execute()

    def tell_status(self, worker: str, status: bytes, seconds: float) -> None:
        self._client.set(keys.WORKER_PREFIX + worker, status, px=int(1000 * seconds))

    def gets_jobs(self, worker: str) -> bool:
        return not self._client.exists(keys.QUARANTINE_PREFIX + worker)

    def is_to_stop(self, entry: bytes) -> bool:
        return bool(self._client.exists(keys.WITHDRAWN_PREFIX + entry.decode()))

    def expire_session(self) -> None:
        assert 0 < self._client.pttl(keys.SESSION) <= 1000 * SESSION_SECONDS
        self._client.pexpire(keys.SESSION, 0)

    def flush(self) -> None:
        self._client.flushall()


@pytest.fixture(params=["memory", "redis"])
def both(request: pytest.FixtureRequest) -> Iterator[Both]:
    if request.param == "memory":
        yield InMemory()
        return
    on_redis = OnRedis(request.getfixturevalue("redis_server"))
    yield on_redis
    on_redis.close()


@pytest.fixture
def ready(both: Both) -> Both:
    """With the group of workers, which `attend` makes."""
    both.queue.attend(SESSION)
    return both


def test_a_run_is_known_once_it_attended(both: Both) -> None:
    assert [both.queue.attend(SESSION) for _ in range(3)] == [False, True, True]
    other = Session("folder", 1, "second", shared=True)
    assert [both.queue.attend(other) for _ in range(2)] == [False, True]
    assert both.queue.attend(SESSION)


def test_an_emptied_redis_knows_nobody(ready: Both) -> None:
    ready.queue.publish([b"a"])
    ready.tell_status("w", b"status", 10.0)
    ready.complete(None, b"result")
    ready.queue.keep_in_quarantine({"bad": "why"})
    ready.flush()
    assert not ready.queue.attend(SESSION)
    assert (ready.queue.jobs(), ready.queue.results(FIRST, 0), ready.queue.workers()) == ([], [], [])
    assert (ready.queue.jobs_waiting(), ready.queue.results_waiting(), ready.queue.holders()) == (0, 0, [])
    assert ready.take("w") is None
    assert ready.gets_jobs("bad")


def test_another_folder_is_refused(ready: Both) -> None:
    with pytest.raises(QueueInUse):
        ready.queue.attend(Session("other", 1, "x"))
    assert ready.queue.attend(SESSION)


def test_a_later_coordinator_replaces_an_earlier_one(ready: Both) -> None:
    assert not ready.queue.attend(Session("folder", 2, "later"))
    with pytest.raises(OwnershipLost):
        ready.queue.attend(SESSION)


def test_a_session_that_was_given_up_is_free(ready: Both) -> None:
    ready.queue.give_up_session(SESSION)
    assert not ready.queue.attend(Session("other", 1, "x"))


def test_a_shared_session_is_kept_for_the_others(both: Both) -> None:
    both.queue.attend(Session("folder", 1, "a", shared=True))
    both.queue.give_up_session(Session("folder", 1, "a", shared=True))
    with pytest.raises(QueueInUse):
        both.queue.attend(Session("other", 1, "x"))


def test_a_session_that_is_not_renewed_is_free(ready: Both) -> None:
    ready.expire_session()
    assert not ready.queue.attend(Session("other", 1, "x"))


def test_jobs_are_on_the_stream_in_order(ready: Both) -> None:
    entries = ready.queue.publish([b"a", b"b"]) + ready.queue.publish([b"c"])
    assert ready.queue.jobs() == list(zip(entries, [b"a", b"b", b"c"], strict=True))
    assert len(set(entries)) == ready.queue.jobs_waiting() == 3
    assert ready.queue.publish([]) == []


def test_deleted_jobs_are_gone(ready: Both) -> None:
    first, second = ready.queue.publish([b"a", b"b"])
    ready.queue.delete_jobs([first, b"1-1"])
    assert ready.queue.jobs() == [(second, b"b")]
    assert ready.take("w") == (second, b"b")
    assert ready.take("w") is None


def test_quick_copies_are_on_a_stream_of_their_own(ready: Both) -> None:
    """The name of an entry says on which; all else is as of any job."""
    (job,) = ready.queue.publish([b"a"])
    first, second = ready.queue.publish([b"a", b"b"], quick=True)
    assert [is_quick(each) for each in (job, first, second)] == [False, True, True]
    assert ready.queue.jobs() == [(job, b"a"), (first, b"a"), (second, b"b")]
    assert ready.queue.jobs_waiting() == 1
    assert [ready.take("w", quick=True), ready.take("w"), ready.take("w")] == [
        (first, b"a"),
        (job, b"a"),
        None,
    ]
    assert set(ready.queue.holders()) == {Holder(job, "w"), Holder(first, "w")}
    ready.queue.stop_jobs([first])
    assert ready.is_to_stop(first)
    assert not ready.is_to_stop(first.removeprefix(QUICK))
    ready.queue.delete_jobs([first, second, b"1-1"])
    assert ready.queue.jobs() == [(job, b"a")]


def test_a_job_is_given_to_one(ready: Both) -> None:
    entries = ready.queue.publish([b"a", b"b"])
    assert [ready.take("v"), ready.take("w"), ready.take("v")] == [
        (entries[0], b"a"),
        (entries[1], b"b"),
        None,
    ]
    assert ready.queue.holders() == [Holder(entries[0], "v"), Holder(entries[1], "w")]
    # Who works on it does not take it off the stream.
    assert ready.queue.jobs_waiting() == 2


def test_a_job_of_before_the_group_is_given_out(both: Both) -> None:
    (entry,) = both.queue.publish([b"a"])
    both.queue.attend(SESSION)
    assert both.take("w") == (entry, b"a")


def test_a_job_of_a_dead_worker_is_given_to_another(ready: Both) -> None:
    (entry,) = ready.queue.publish([b"a"])
    ready.take("dead")
    ready.pass_time(1.5 * LEASE)
    assert ready.take("w") == (entry, b"a")
    assert ready.queue.holders() == [Holder(entry, "w")]
    assert ready.take("v") is None


def test_new_jobs_go_before_those_of_the_dead(ready: Both) -> None:
    (old,) = ready.queue.publish([b"a"])
    ready.take("dead")
    ready.pass_time(1.5 * LEASE)
    (new,) = ready.queue.publish([b"b"])
    assert [ready.take("w"), ready.take("w")] == [(new, b"b"), (old, b"a")]


def test_a_withdrawn_job_is_given_to_nobody_else(ready: Both) -> None:
    (entry,) = ready.queue.publish([b"a"])
    ready.take("dead")
    ready.queue.delete_jobs([entry])
    # Whoever has it, has it still.
    assert ready.queue.holders() == [Holder(entry, "dead")]
    ready.pass_time(1.5 * LEASE)
    assert ready.take("w") is None
    assert ready.queue.holders() == []


def test_a_result_takes_its_job_off_the_stream(ready: Both) -> None:
    (entry,) = ready.queue.publish([b"a"])
    ready.take("w")
    ready.complete(entry, b"result")
    assert (ready.queue.jobs(), ready.queue.holders()) == ([], [])
    assert [each.data for each in ready.queue.results(FIRST, 0)] == [b"result"]


def test_a_late_result_comes_as_well(ready: Both) -> None:
    (entry,) = ready.queue.publish([b"a"])
    ready.take("slow")
    ready.pass_time(1.5 * LEASE)
    ready.take("w")
    ready.complete(entry, b"of w")
    ready.complete(entry, b"of slow")
    assert [each.data for each in ready.queue.results(FIRST, 0)] == [b"of w", b"of slow"]
    assert ready.queue.results_waiting() == 2


def test_a_result_of_a_withdrawn_job_comes(ready: Both) -> None:
    (entry,) = ready.queue.publish([b"a"])
    ready.take("w")
    ready.queue.delete_jobs([entry])
    ready.complete(entry, b"result")
    assert ready.queue.holders() == []
    assert ready.queue.results_waiting() == 1


def test_results_come_after_an_entry_and_in_order(ready: Both) -> None:
    for number in range(5):
        ready.complete(None, b"%d" % number)
    found = ready.queue.results(FIRST, 0)
    assert [each.data for each in found] == [b"0", b"1", b"2", b"3", b"4"]
    assert ready.queue.results(found[2].entry, 0) == found[3:]
    assert ready.queue.results(found[4].entry, 0) == []
    # Reading takes nothing away.
    assert ready.queue.results(FIRST, 0) == found
    assert ready.queue.results_waiting() == 5


def test_deleted_results_do_not_come_again(ready: Both) -> None:
    for number in range(3):
        ready.complete(None, b"%d" % number)
    found = ready.queue.results(FIRST, 0)
    ready.queue.delete_results([found[0].entry, found[2].entry, b"1-1"])
    assert ready.queue.results(FIRST, 0) == [found[1]]
    assert ready.queue.results_waiting() == 1


def test_what_comes_later_has_later_entries(ready: Both) -> None:
    ready.complete(None, b"first")
    (first,) = ready.queue.results(FIRST, 0)
    ready.queue.delete_results([first.entry])
    ready.complete(None, b"second")
    assert [each.data for each in ready.queue.results(first.entry, 0)] == [b"second"]


def test_nothing_comes_while_nothing_is_there(ready: Both) -> None:
    assert ready.queue.results(FIRST, 20) == []


def test_a_status_holds_for_its_time(ready: Both) -> None:
    ready.tell_status("w", b"status", 0.3)
    ready.tell_status("v", b"other", 10.0)
    statuses = {name: (status, left) for name, status, left in ready.queue.workers()}
    assert {name: status for name, (status, _) in statuses.items()} == {"w": b"status", "v": b"other"}
    assert 0 < statuses["w"][1] <= 300
    assert 9_000 < statuses["v"][1] <= 10_000
    ready.pass_time(0.4)
    assert [name for name, _, _ in ready.queue.workers()] == ["v"]


def test_who_is_in_quarantine_is_told(ready: Both) -> None:
    ready.queue.keep_in_quarantine({"bad": "It lied."})
    ready.queue.keep_in_quarantine({})
    assert (ready.gets_jobs("bad"), ready.gets_jobs("good")) == (False, True)


def test_who_works_for_nothing_is_told(ready: Both) -> None:
    first, second = ready.queue.publish([b"a", b"b"])
    ready.queue.stop_jobs([first])
    assert (ready.is_to_stop(first), ready.is_to_stop(second)) == (True, False)
    # It is on the stream until it is deleted.
    assert ready.queue.jobs_waiting() == 2
