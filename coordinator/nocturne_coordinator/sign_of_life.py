"""A file whose modification time says when a process last worked: what probes of containers look at."""

import logging
import time
from pathlib import Path

_SECONDS = 1.0

_log = logging.getLogger(__name__)


class SignOfLife:
    """Call it as often as convenient; it touches the file once a second."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._next = 0.0

    def __call__(self) -> None:
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + _SECONDS
        try:
            self._path.touch()
        except OSError as trouble:
            # The probe then ends this process, and its log says why.
            _log.error("can't touch %s: %s", self._path, trouble)
