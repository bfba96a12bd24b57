"""A coordinator's lock on a data folder, by the locks of its file system: for one machine."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from nocturne_coordinator.store.database import FolderLock

_FLAGS = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC


class FileLock(FolderLock):
    """Holds `coordinator.lock`, in which the process number of the last one stands."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._lock = os.open(root / "coordinator.lock", _FLAGS, 0o600)

    @contextmanager
    def starting(self) -> Iterator[None]:
        lock = os.open(self._root / "coordinator.starting", _FLAGS, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield
        finally:
            os.close(lock)

    def take(self, alone: bool) -> bool:
        try:
            fcntl.flock(self._lock, (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        os.ftruncate(self._lock, 0)
        os.pwrite(self._lock, str(os.getpid()).encode(), 0)
        return True

    def share(self) -> None:
        # Not atomic: the exclusive lock is given back first.
        self.take(alone=False)

    def owner(self) -> str:
        number = os.pread(self._lock, 32, 0).decode(errors="replace").strip()
        return f"process {number}" if number else ""

    def close(self) -> None:
        os.close(self._lock)
