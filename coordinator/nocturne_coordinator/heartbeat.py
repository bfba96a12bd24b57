"""A file whose modification time says when a process last worked: what probes of containers look at."""

import logging
import os
import time
from pathlib import Path

_SECONDS = 1.0

_log = logging.getLogger(__name__)


class Heartbeat:
    """Call it as often as convenient; it touches the file, if there is one, once a second."""

    def __init__(self, path: Path | None = None) -> None:
        self._path = path
        self._next = 0.0

    def __call__(self) -> None:
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + _SECONDS
        self._set(time.time())

    def busy(self, seconds: float) -> None:
        """One piece of work takes so long at most: until the next call the file's time lies ahead."""
        self._next = 0.0
        self._set(time.time() + seconds)

    def _set(self, unix_time: float) -> None:
        if self._path is None:
            return
        try:
            self._path.touch()
            os.utime(self._path, (unix_time, unix_time))
        except OSError as trouble:
            # The probe then ends this process, and its log says why.
            _log.error("can't touch %s: %s", self._path, trouble)
