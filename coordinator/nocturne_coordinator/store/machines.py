"""The machines that work for the service, each enrolled by a separate token."""

import re
import secrets
import time

from nocturne_scene.errors import InputError

from nocturne_coordinator.enrolment import KEY_BYTES
from nocturne_coordinator.store.database import Database

_NAME = re.compile(r"[A-Za-z0-9._-]{1,64}")


class Machines:
    """Those of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def enrol(self, name: str) -> bytes:
        """The key of the machine whose token has this name, made at the first time. Raises InputError."""
        if not _NAME.fullmatch(name):
            raise InputError.at(
                "token", f"{name!r} can't be a machine: expected 1 to 64 letters, digits, '.', '_' or '-'"
            )
        with self._database.transaction():
            self._database.execute(
                "INSERT OR IGNORE INTO machine VALUES (?, ?, ?)",
                (name, secrets.token_bytes(KEY_BYTES), time.time()),
            )
            row = self._database.row("SELECT key FROM machine WHERE name = ?", (name,))
        assert row is not None  # noqa: S101 - it was written in the same transaction
        return bytes(row["key"])

    def keys(self) -> dict[str, bytes]:
        """By name, of the machines whose token was not revoked."""
        rows = self._database.rows(
            "SELECT machine.name, key FROM machine JOIN token USING (name) WHERE revoked = 0 ORDER BY name"
        )
        return {row["name"]: bytes(row["key"]) for row in rows}

    def lease_key(self) -> bytes:
        """The folder's secret for leases, made at the first time."""
        with self._database.transaction():
            self._database.execute(
                "INSERT OR IGNORE INTO lease_key VALUES (1, ?)", (secrets.token_bytes(KEY_BYTES),)
            )
            row = self._database.row("SELECT key FROM lease_key WHERE number = 1")
        assert row is not None  # noqa: S101 - it was written in the same transaction
        return bytes(row["key"])
