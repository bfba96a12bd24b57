"""Jobs out, results in: the only Redis user in Python. Redis carries messages; nothing in it is needed again.

Every method may raise QueueError, after which its effect is unknown; `attend` and `jobs` show it.
"""

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import wraps
from typing import Any, NamedTuple, ParamSpec, TypeVar

import redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from nocturne_coordinator.dispatch.liveness import Holder
from nocturne_coordinator.dispatch.quick_entries import QUICK, is_quick
from nocturne_coordinator.errors import OwnershipLost, QueueError, QueueInUse, UnusableQueue
from nocturne_coordinator.queue import keys
from nocturne_coordinator.queue.guard import Guard

Entry = tuple[bytes, bytes]
"""An entry's id, and the one field that it should have; empty where it is missing."""


class ResultEntry(NamedTuple):
    """An entry of the results."""

    entry: bytes
    data: bytes
    """Empty where there are none."""
    machine: bytes = b""
    """Whose it is said to be."""
    signature: bytes = b""


FIRST = b"0-0"
"""Before all entries."""

SESSION_SECONDS = 10.0
"""How long the lease on Redis holds without a renewal, which comes every second."""

_RUN_SECONDS = 60.0
"""How long a run leaves its mark on Redis: longer than it ever takes from one renewal to the next."""

_WITHDRAWN_SECONDS = 60.0
"""How long workers are notified of a job that nobody needs; they ask twice a second."""

_RENEWALS = 5
"""Attempts, as other coordinators of the folder renew the same lease."""

# Seconds. Longer than any answer of a healthy Redis, short enough that commits go on meanwhile.
_TIMEOUT = 5.0

# Results read at once: so many that their number costs little, and as many bytes, going by those before them.
_FIRST_BATCH, _MAX_BATCH = 16, 256
_BATCH_BYTES = 8 * 2**20
_READ_BYTES = 2**18
"""From the socket at once: results are some 80 kB; by 64 KiB, as is usual, reading takes a tenth longer."""

# Entries named in one XDEL, jobs listed by one XRANGE.
_CHUNK = 500

_STREAMS, _PREFIXES = (keys.JOBS, keys.QUICK_JOBS), (b"", QUICK)
"""Of jobs, and what the names of their entries begin with here."""

_P = ParamSpec("_P")
_R = TypeVar("_R")


@dataclass(frozen=True, slots=True)
class Session:
    """A coordinator's run: its data folder, the folder's epoch, and what tells it from all other runs."""

    folder: str
    epoch: int
    nonce: str
    shared: bool = False
    """Other coordinators of the folder may be there."""

    @property
    def text(self) -> bytes:
        return f"{self.folder}:{self.epoch}".encode()

    @property
    def run_key(self) -> str:
        return keys.RUN_PREFIX + self.nonce

    def check(self, found: bytes | None) -> None:
        """Whether this run may take the lease from who is found to have it."""
        if found is None or found == self.text:
            return
        folder, _, rest = found.decode(errors="replace").partition(":")
        epoch, _, _ = rest.partition(":")
        if folder != self.folder or not epoch.isdecimal():
            raise QueueInUse(
                "this Redis serves the coordinator of another data folder; give each a Redis of its own"
            )
        # The folder has one owner at a time, so a lease of an earlier epoch is that of a run that is over.
        if int(epoch) > self.epoch:
            raise OwnershipLost("a later coordinator of this data folder has the lease on Redis")


def _worker_of(consumer: bytes) -> str:
    """A consumer is `<worker id>/<thread>`."""
    return consumer.decode(errors="replace").rpartition("/")[0]


def _queue_errors(method: Callable[_P, _R]) -> Callable[_P, _R]:
    """Turns redis-py's errors into QueueError."""

    @wraps(method)
    def guarded(*arguments: _P.args, **named: _P.kwargs) -> _R:
        try:
            return method(*arguments, **named)
        except redis.RedisError as error:
            raise QueueError(f"{type(error).__name__}: {error}") from error

    return guarded


class JobQueue:
    """The streams of one Redis, given as `redis://host:port`, `unix:///path`, or for TLS `rediss://host:port`.

    Files of certificates are parameters of the address: ssl_ca_certs, ssl_certfile, ssl_keyfile.
    """

    def __init__(self, url: str) -> None:
        """Does not connect yet. ValueError for an address of another kind."""
        # redis-py's answers are typed as maybe-awaitable, so the client is Any, here only.
        self._client: Any = redis.Redis.from_url(
            url,
            protocol=2,
            # As for workers, so that no password stands on a command line.
            username=os.environ.get("NOCTURNE_REDIS_USER") or None,
            password=os.environ.get("NOCTURNE_REDIS_PASSWORD") or None,
            socket_timeout=_TIMEOUT,
            socket_connect_timeout=_TIMEOUT,
            retry=Retry(NoBackoff(), 0),
            socket_read_size=_READ_BYTES,
        )
        self._batch = _FIRST_BATCH
        self.guard: Guard | None = None
        """Where workers enrol."""

    def close(self) -> None:
        self._client.close()

    @_queue_errors
    def check_settings(self) -> None:
        """UnusableQueue if Redis may throw messages away to save memory."""
        policy = self._client.info("memory").get("maxmemory_policy", "noeviction")
        if policy != "noeviction":
            raise UnusableQueue(
                f"Redis has maxmemory-policy {policy}, which loses jobs and results; set it to noeviction"
            )

    @_queue_errors
    def attend(self, session: Session) -> bool:
        """Renews the lease and makes sure of the consumer group; False if Redis lost its contents (see
        `jobs`).

        Raises QueueInUse while the coordinator of another data folder has the lease, OwnershipLost where a
        later one of the same folder has it.
        """
        ours = self._renew(session)
        for stream in _STREAMS:
            try:
                # From the first entry on: when the group was lost, all there is to be given out again.
                self._client.xgroup_create(stream, keys.WORKERS_GROUP, id=FIRST, mkstream=True)
            except redis.ResponseError as error:
                if not str(error).startswith("BUSYGROUP"):
                    raise
        return ours

    def _renew(self, session: Session) -> bool:
        """Compares and sets in one transaction, so that of two who find the lease free one gets it."""
        for _ in range(_RENEWALS):
            with self._client.pipeline(transaction=True) as pipeline:
                pipeline.watch(keys.SESSION)
                session.check(pipeline.get(keys.SESSION))
                known: int = pipeline.exists(session.run_key)
                pipeline.multi()
                pipeline.set(keys.SESSION, session.text, px=int(1000 * SESSION_SECONDS))
                pipeline.set(session.run_key, b"", px=int(1000 * _RUN_SECONDS))
                try:
                    pipeline.execute()
                except redis.WatchError:
                    continue
            return known == 1
        raise QueueError("other coordinators take the lease all the time")

    @_queue_errors
    def check_lease(self, session: Session) -> None:
        """Raises QueueInUse or OwnershipLost, as `attend`; takes nothing."""
        session.check(self._client.get(keys.SESSION))

    @_queue_errors
    def lease_left(self) -> int:
        """Milliseconds until the lease, whoever has it, ends unless it is renewed."""
        return max(0, int(self._client.pttl(keys.SESSION)))

    @_queue_errors
    def give_up_session(self, session: Session) -> None:
        """Ends the lease, so that another coordinator need not wait for it."""
        self._client.delete(session.run_key)
        if session.shared:
            # It runs out by itself when the last one has left.
            return
        with self._client.pipeline(transaction=True) as pipeline:
            pipeline.watch(keys.SESSION)
            if pipeline.get(keys.SESSION) == session.text:
                pipeline.multi()
                pipeline.delete(keys.SESSION)
                pipeline.execute()

    @_queue_errors
    def publish(self, jobs: Iterable[bytes], quick: bool = False) -> list[bytes]:
        """Adds jobs, `quick`: to the stream of quick copies; gives their entries."""
        stream, prefix = _STREAMS[quick], _PREFIXES[quick]
        pipeline = self._client.pipeline(transaction=False)
        for job in jobs:
            lease = {keys.LEASE_FIELD: self.guard.lease(job)} if self.guard else {}
            pipeline.xadd(stream, {keys.JOB_FIELD: job, **lease})
        return [prefix + entry for entry in pipeline.execute()]

    @_queue_errors
    def jobs(self) -> list[Entry]:
        """All jobs on both streams: waiting or being worked on."""
        found: list[Entry] = []
        for stream, prefix in zip(_STREAMS, _PREFIXES, strict=True):
            start = FIRST
            while batch := self._client.xrange(stream, min=start, count=_CHUNK):
                found.extend(_entry(prefix + entry, fields, keys.JOB_FIELD) for entry, fields in batch)
                start = b"(" + batch[-1][0]
        return found

    @_queue_errors
    def delete_jobs(self, entries: list[bytes]) -> None:
        """Takes jobs off the stream; who works on one may finish it."""
        self._delete(keys.JOBS, [entry for entry in entries if not is_quick(entry)])
        self._delete(keys.QUICK_JOBS, [entry.removeprefix(QUICK) for entry in entries if is_quick(entry)])

    @_queue_errors
    def stop_jobs(self, entries: list[bytes]) -> None:
        """Tells who works on one of these that nobody needs it any more."""
        pipeline = self._client.pipeline(transaction=False)
        for entry in entries:
            pipeline.set(keys.WITHDRAWN_PREFIX + entry.decode(), b"", px=int(1000 * _WITHDRAWN_SECONDS))
        pipeline.execute()

    @_queue_errors
    def results(self, after: bytes, wait_ms: int) -> list[ResultEntry]:
        """The next results after an entry, waiting for the first one for up to wait_ms; 0: not at all."""
        answer = self._client.xread({keys.RESULTS: after}, count=self._batch, block=wait_ms or None)
        entries = [_result(entry, fields or {}) for _, batch in answer or [] for entry, fields in batch]
        if entries:
            largest = max(len(each.data) for each in entries)
            self._batch = max(1, min(_MAX_BATCH, _BATCH_BYTES // max(1, largest)))
        return entries

    @_queue_errors
    def jobs_waiting(self) -> int:
        """Jobs on the stream, those that somebody works on included; no quick copies."""
        return int(self._client.xlen(keys.JOBS))

    @_queue_errors
    def results_waiting(self) -> int:
        """Results that are not deleted yet."""
        return int(self._client.xlen(keys.RESULTS))

    @_queue_errors
    def delete_results(self, entries: list[bytes]) -> None:
        """Acknowledges results: to be called after their commit."""
        self._delete(keys.RESULTS, entries)

    @_queue_errors
    def workers(self) -> list[tuple[str, bytes, int]]:
        """Name and serialised WorkerStatus of every live worker, and how many milliseconds it holds without
        another."""
        names = list(self._client.scan_iter(match=f"{keys.WORKER_PREFIX}*", count=1000))
        found: list[tuple[str, bytes, int]] = []
        for start in range(0, len(names), _CHUNK):
            chunk = names[start : start + _CHUNK]
            pipeline = self._client.pipeline(transaction=False)
            pipeline.mget(chunk)
            for name in chunk:
                pipeline.pttl(name)
            statuses, *left = pipeline.execute()
            found += [
                (name.decode(errors="replace").removeprefix(keys.WORKER_PREFIX), status, milliseconds)
                for name, status, milliseconds in zip(chunk, statuses, left, strict=True)
                if status is not None
            ]
        return found

    @_queue_errors
    def holders(self) -> list[Holder]:
        """Who works on what."""
        found: list[Holder] = []
        for stream, prefix in zip(_STREAMS, _PREFIXES, strict=True):
            start = b"-"
            while batch := self._client.xpending_range(stream, keys.WORKERS_GROUP, start, b"+", _CHUNK):
                found.extend(
                    Holder(prefix + each["message_id"], _worker_of(each["consumer"])) for each in batch
                )
                start = b"(" + batch[-1]["message_id"]
        return found

    @_queue_errors
    def keep_in_quarantine(self, workers: Mapping[str, str]) -> None:
        """Tells workers, with the reason, for the next seconds that they are to take no jobs."""
        pipeline = self._client.pipeline(transaction=False)
        for worker, reason in workers.items():
            pipeline.set(keys.QUARANTINE_PREFIX + worker, reason, px=int(1000 * SESSION_SECONDS))
        pipeline.execute()

    @_queue_errors
    def admit_machines(self) -> None:
        """Lets the machines sign on that are enrolled now, and no others."""
        if self.guard is not None:
            self.guard.admit(self._client)

    def _delete(self, stream: str, entries: list[bytes]) -> None:
        for start in range(0, len(entries), _CHUNK):
            self._client.xdel(stream, *entries[start : start + _CHUNK])


def _result(entry: bytes, fields: Mapping[bytes, bytes]) -> ResultEntry:
    data, machine = fields.get(keys.RESULT_FIELD, b""), fields.get(keys.MACHINE_FIELD, b"")
    return ResultEntry(entry, data, machine, fields.get(keys.SIGNATURE_FIELD, b""))


def _entry(entry: bytes, fields: dict[bytes, bytes] | None, name: bytes) -> Entry:
    return entry, (fields or {}).get(name, b"")
