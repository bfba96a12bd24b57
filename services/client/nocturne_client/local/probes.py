"""Whether children of `nocturne up` still answer: a process that hangs is there and does nothing."""

import http.client
import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path

from nocturne_coordinator.queue.keys import WORKER_PREFIX

_LOOK_S = 1.0
_PATIENCE_S = 2.0
_FRESH_S = 10.0


class Watch:
    """Asks one child again and again, in a separate thread, for an answer may be long in coming."""

    def __init__(self, answers: Callable[[], bool]) -> None:
        self._answers = answers
        self._last = time.monotonic()
        self._has_answered = False
        self._end = threading.Event()
        self._thread: threading.Thread | None = None

    def begin(self) -> None:
        """The child was started just now."""
        self._last = time.monotonic()
        self._has_answered = False
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, daemon=True)
            self._thread.start()

    @property
    def has_answered(self) -> bool:
        """Whether an answer has come since the start."""
        return self._has_answered

    def silent_s(self) -> float:
        """Seconds since the last answer, or since the start."""
        return time.monotonic() - self._last

    def close(self) -> None:
        self._end.set()

    def _run(self) -> None:
        while not self._end.wait(_LOOK_S):
            if self._answers():
                self._last = time.monotonic()
                self._has_answered = True


def redis_answers(redis: Path) -> bool:
    """Whether Redis does."""
    return _asked(redis, b"PING\r\n").startswith(b"+PONG")


def worker_is_heard_of(redis: Path, worker: str) -> bool:
    """Whether the worker has said lately that it is there. Without Redis it can't, and is not at fault."""
    answer = _asked(redis, f"EXISTS {WORKER_PREFIX}{worker}\r\n".encode())
    return answer.startswith(b":1") or not answer


def api_answers(port: int, path: str = "/healthz") -> bool:
    """Whether the API says that it is alive, or with /readyz that its data folder answers too."""
    # A client of httpx costs 60 ms of processor to make.
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=_PATIENCE_S)
    try:
        connection.request("GET", path)
        return connection.getresponse().status == 200
    except (OSError, http.client.HTTPException):
        return False
    finally:
        connection.close()


def is_fresh(file: Path) -> bool:
    """Whether a process that touches the file every second did so lately."""
    try:
        return time.time() - file.stat().st_mtime < _FRESH_S
    except OSError:
        return False


def _asked(redis: Path, command: bytes) -> bytes:
    """The beginning of the answer; empty where there is none."""
    try:
        with socket.socket(socket.AF_UNIX) as connection:
            connection.settimeout(_PATIENCE_S)
            connection.connect(str(redis))
            connection.sendall(command)
            return connection.recv(16)
    except OSError:
        return b""
