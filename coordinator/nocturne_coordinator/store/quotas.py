"""How much an owner may have in a data folder, and has; and who uploaded which file, which counts."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from nocturne_coordinator.errors import QuotaUsedUp
from nocturne_coordinator.store.database import Database


@dataclass(frozen=True, slots=True)
class Quota:
    """What one owner may have at most."""

    open_renders: float
    """Renders that are queued, running or paused."""
    open_samples: float
    """Samples of pixels that these ask for."""
    stored_bytes: float
    """Files that the owner uploaded, and what its renders take when they are done."""


NO_QUOTA = Quota(math.inf, math.inf, math.inf)


@dataclass(frozen=True, slots=True)
class Usage:
    """What one owner has; fields as in Quota."""

    open_renders: int
    open_samples: float
    stored_bytes: int


_REMEDIES = {
    "open_renders": "wait until some have ended, or cancel some",
    "open_samples": "wait until some have ended, or ask for fewer samples",
    "stored_bytes": "delete renders; files that none uses go by themselves after a while",
}


def usage(database: Database, owner: str) -> Usage:
    """What the owner has just now."""
    asked = database.row(
        """SELECT count(*) AS renders, coalesce(sum(1.0 * width * height * samples), 0.0) AS samples
           FROM render WHERE owner = ? AND state IN ('QUEUED', 'RUNNING', 'PAUSED')""",
        (owner,),
    )
    stored = database.row(
        """SELECT (SELECT coalesce(sum(stored_bytes), 0) FROM render WHERE owner = ?1)
                + (SELECT coalesce(sum(size_bytes), 0) FROM upload WHERE owner = ?1) AS bytes""",
        (owner,),
    )
    assert asked is not None  # noqa: S101 - sums are always there
    assert stored is not None  # noqa: S101
    return Usage(asked["renders"], asked["samples"], stored["bytes"])


def check_quota(database: Database, owner: str, quota: Quota, more_renders: int = 0) -> None:
    """QuotaUsedUp where the owner has too much, or would have with `more_renders`.

    To be called at the end of a transaction that gives the owner more.
    """
    if quota == NO_QUOTA:
        return
    found = usage(database, owner)
    found = replace(found, open_renders=found.open_renders + more_renders)
    for name, remedy in _REMEDIES.items():
        has, may = getattr(found, name), getattr(quota, name)
        if has > may:
            what = name.replace("_", " ")
            raise QuotaUsedUp(
                f"{owner or 'nobody'} would have {has:,.0f} {what}, and may have {may:,.0f}: {remedy}, or "
                "have who runs the service raise the quota"
            )


class Uploads:
    """The uploads of a data folder, by owner. For many processes."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def begin(self, owner: str, sha256: str, size_bytes: int, quota: Quota) -> bool:
        """Counts a file as the owner's, before its first byte; False if it was already. QuotaUsedUp."""
        with self._database.transaction():
            new = self._database.execute(
                "INSERT INTO upload VALUES (?, ?, ?) ON CONFLICT DO NOTHING", (owner, sha256, size_bytes)
            )
            if new:
                check_quota(self._database, owner, quota)
        return bool(new)

    def take_back(self, owner: str, sha256: str) -> None:
        """The upload failed."""
        self._database.execute("DELETE FROM upload WHERE owner = ? AND sha256 = ?", (owner, sha256))

    def forget(self, files: Iterable[str]) -> None:
        """These files are not there any more."""
        self._database.execute_many("DELETE FROM upload WHERE sha256 = ?", [(sha256,) for sha256 in files])
