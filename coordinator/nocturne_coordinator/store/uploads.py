"""Who uploaded which file: each owner's uploads count towards its quota."""

from collections.abc import Iterable

from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.quotas import Quota, check_quota


class Uploads:
    """The uploads of a data folder, by owner. For many processes."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def begin(self, owner: str, sha256: str, size_bytes: int, quota: Quota) -> bool:
        """Counts a file as the owner's, before its first byte; False if it was already. QuotaUsedUp."""
        with self._database.transaction():
            new = self._database.execute(
                "INSERT OR IGNORE INTO upload VALUES (?, ?, ?)", (owner, sha256, size_bytes)
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
