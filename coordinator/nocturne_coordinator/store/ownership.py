"""Which coordinators work on a data folder: one, or several that share it; none that was replaced."""

import time
from pathlib import Path

from nocturne_coordinator.errors import AlreadyOwned, OwnershipLost
from nocturne_coordinator.store.database import Database

LEASE_SECONDS = 10.0
"""How long a coordinator's renders are its own without a sign of life. After it, another may take them."""


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
        self._lock = database.lock()
        try:
            # A coordinator that is to share is alone with the folder until its row is there. Another one that
            # comes just then has to wait for it, not to be refused.
            with self._lock.starting():
                self._enter(root)
        except BaseException:
            self._lock.close()
            raise

    def _enter(self, root: Path) -> None:
        """The lock first, then the row that says so. Nobody else may come in between."""
        alone = self._lock.take(alone=True)
        if not alone and not (self.shared and self._lock.take(alone=False)):
            raise AlreadyOwned(
                f"{root} has a coordinator already ({self._lock.owner() or 'process unknown'}); "
                "stop it first, give this one another folder, or start both with --shared"
            )
        self._register(alone, time.time())
        if alone and self.shared:
            self._lock.share()

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
        """Another coordinator may come."""
        self._lock.close()

    def _stored_epoch(self) -> int:
        row = self._database.row("SELECT epoch FROM ownership")
        return int(row["epoch"]) if row is not None else -1
