"""Which coordinator a data folder belongs to: one at a time, and none that was replaced may still write."""

import fcntl
import os
from pathlib import Path

from nocturne_coordinator.errors import AlreadyOwned, OwnershipLost

from .database import Database


class Ownership:
    """Holds the folder from construction to `release`, or to the end of the process."""

    def __init__(self, root: Path, database: Database) -> None:
        """Raises AlreadyOwned if a live process has the folder."""
        self._database = database
        self._lock = os.open(root / "coordinator.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.pread(self._lock, 32, 0).decode(errors="replace").strip()
            os.close(self._lock)
            raise AlreadyOwned(
                f"{root} has a coordinator already (process {owner or 'unknown'}); "
                "stop it first, or give this one another folder"
            ) from None
        os.ftruncate(self._lock, 0)
        os.pwrite(self._lock, str(os.getpid()).encode(), 0)
        with database.transaction():
            database.execute("UPDATE ownership SET epoch = epoch + 1")
            self.epoch = self._stored_epoch()
            row = database.row("SELECT folder FROM ownership")
            self.folder = str(row["folder"]) if row is not None else ""
            """Tells this data folder from others."""

    def check(self) -> None:
        """To be called inside every transaction that writes; OwnershipLost if there is a later owner.

        The lock alone is not enough: a network file system may lose it, and a copied folder has none.
        """
        if self._stored_epoch() != self.epoch:
            raise OwnershipLost("another coordinator has taken over the data folder")

    def release(self) -> None:
        os.close(self._lock)

    def _stored_epoch(self) -> int:
        row = self._database.row("SELECT epoch FROM ownership")
        return int(row["epoch"]) if row is not None else -1
