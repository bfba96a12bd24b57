"""Which coordinators work on a data folder: one, or several that share it; none that was replaced."""

import contextlib
import fcntl
import os
import time
from collections.abc import Iterator
from pathlib import Path

from nocturne_coordinator.errors import AlreadyOwned, OwnershipLost
from nocturne_coordinator.store.database import Database

LEASE_SECONDS = 10.0
"""How long a coordinator's renders are its own without a sign of life. After it, another may take them."""


@contextlib.contextmanager
def _one_at_a_time(path: Path) -> Iterator[None]:
    """Other processes wait for these locks, which are held for milliseconds.

    A coordinator that is to share is alone with the folder until its row is there. Another one that comes
    just then has to wait for it, not to be refused.
    """
    lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
    finally:
        os.close(lock)


class Ownership:
    """Holds the folder, or a part in it, from construction to `release` or to the end of the process."""

    def __init__(
        self, root: Path, database: Database, shared: bool = False, lease_seconds: float = LEASE_SECONDS
    ) -> None:
        """`shared`: others that share may work on the folder too.

        Raises AlreadyOwned if a live process has the folder and one of the two does not share.
        """
        self._database = database
        self.lease_seconds = lease_seconds
        self.shared = shared
        with _one_at_a_time(root / "coordinator.starting"):
            self._lock = os.open(root / "coordinator.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
            self._enter(root)

    def _enter(self, root: Path) -> None:
        """The lock first, then the row that says so. Nobody else may come in between."""
        alone = self._locked(fcntl.LOCK_EX)
        if not alone and not (self.shared and self._locked(fcntl.LOCK_SH)):
            owner = os.pread(self._lock, 32, 0).decode(errors="replace").strip()
            os.close(self._lock)
            raise AlreadyOwned(
                f"{root} has a coordinator already (process {owner or 'unknown'}); "
                "stop it first, give this one another folder, or start both with --shared"
            )
        os.ftruncate(self._lock, 0)
        os.pwrite(self._lock, str(os.getpid()).encode(), 0)
        self._register(alone, time.time())
        if alone and self.shared:
            # Not atomic: the exclusive lock is given back first.
            self._locked(fcntl.LOCK_SH)

    def _register(self, alone: bool, now: float) -> None:
        database = self._database
        with database.transaction():
            if alone:
                # No other coordinator lives, so no other's lease counts.
                database.execute("UPDATE ownership SET epoch = epoch + 1")
                database.execute("DELETE FROM coordinator")
                database.execute("DELETE FROM meter")
            row = database.row(
                "INSERT INTO coordinator (until) VALUES (?) RETURNING number",
                (now + self.lease_seconds,),
            )
            assert row is not None  # noqa: S101 - it gives what it put in
            self.number = int(row["number"])
            """Of this run; no other one ever has it."""
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

    def _locked(self, how: int) -> bool:
        try:
            fcntl.flock(self._lock, how | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def _stored_epoch(self) -> int:
        row = self._database.row("SELECT epoch FROM ownership")
        return int(row["epoch"]) if row is not None else -1
