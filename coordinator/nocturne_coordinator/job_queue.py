"""Jobs out, results in: the only Redis user in Python. Redis carries messages; nothing in it is needed again.

Every method may raise QueueError, after which nothing is known of what it did; `attend` and `jobs` tell.
"""

from collections.abc import Callable, Iterable
from functools import wraps
from typing import Any, ParamSpec, TypeVar, cast

import redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from . import keys
from .errors import NocturneError, UnusableQueue

Entry = tuple[bytes, bytes]
"""An entry's id, and the one field that it should have; empty where it is missing."""

FIRST = b"0-0"
"""Before all entries."""

# Seconds. Longer than any answer of a healthy Redis, short enough that commits go on meanwhile.
_TIMEOUT = 5.0

# Results read at once: 64 x 32 KiB = 2 MiB, 4 MiB with further responses.
_BATCH = 64

# Entries named in one XDEL, jobs listed by one XRANGE.
_CHUNK = 500

_P = ParamSpec("_P")
_R = TypeVar("_R")


class QueueError(NocturneError):
    """Redis could not be reached, or refused."""


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
    """The streams of one Redis, given as `redis://host:port` or `unix:///path`."""

    def __init__(self, url: str) -> None:
        """Does not connect yet. ValueError for an address of another kind."""
        # redis-py's answers are typed as maybe-awaitable, so the client is Any, here only.
        self._client: Any = redis.Redis.from_url(
            url,
            protocol=2,
            socket_timeout=_TIMEOUT,
            socket_connect_timeout=_TIMEOUT,
            retry=Retry(NoBackoff(), 0),
        )

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
    def attend(self, session: bytes) -> bool:
        """Makes sure of the consumer group; False if Redis was not ours since the last time (see `jobs`)."""
        ours: bool = self._client.get(keys.SESSION) == session
        try:
            # From the first entry on: when the group was lost, all on the stream is to be given out again.
            self._client.xgroup_create(keys.JOBS, keys.WORKERS_GROUP, id=FIRST, mkstream=True)
        except redis.ResponseError as error:
            if not str(error).startswith("BUSYGROUP"):
                raise
        if not ours:
            self._client.set(keys.SESSION, session)
        return ours

    @_queue_errors
    def publish(self, jobs: Iterable[bytes]) -> list[bytes]:
        """Adds jobs; gives their entries."""
        pipeline = self._client.pipeline(transaction=False)
        for job in jobs:
            pipeline.xadd(keys.JOBS, {keys.JOB_FIELD: job})
        return cast(list[bytes], pipeline.execute())

    @_queue_errors
    def jobs(self) -> list[Entry]:
        """All jobs on the stream: waiting or being worked on."""
        found: list[Entry] = []
        start = FIRST
        while batch := self._client.xrange(keys.JOBS, min=start, count=_CHUNK):
            found.extend(_entry(entry, fields, keys.JOB_FIELD) for entry, fields in batch)
            start = b"(" + batch[-1][0]
        return found

    @_queue_errors
    def delete_jobs(self, entries: list[bytes]) -> None:
        """Takes jobs off the stream; who works on one may finish it."""
        self._delete(keys.JOBS, entries)

    @_queue_errors
    def results(self, after: bytes, wait_ms: int) -> list[Entry]:
        """The next results after an entry, waiting for the first one for up to wait_ms."""
        answer = self._client.xread({keys.RESULTS: after}, count=_BATCH, block=wait_ms)
        return [
            _entry(entry, fields, keys.RESULT_FIELD) for _, batch in answer or [] for entry, fields in batch
        ]

    @_queue_errors
    def delete_results(self, entries: list[bytes]) -> None:
        """Acknowledges results: to be called after their commit."""
        self._delete(keys.RESULTS, entries)

    @_queue_errors
    def workers(self) -> list[bytes]:
        """Serialised WorkerStatus of every live worker."""
        names = list(self._client.scan_iter(match=f"{keys.WORKER_PREFIX}*", count=1000))
        return [status for status in self._client.mget(names) if status is not None] if names else []

    def _delete(self, stream: str, entries: list[bytes]) -> None:
        for start in range(0, len(entries), _CHUNK):
            self._client.xdel(stream, *entries[start : start + _CHUNK])


def _entry(entry: bytes, fields: dict[bytes, bytes] | None, name: bytes) -> Entry:
    return entry, (fields or {}).get(name, b"")
