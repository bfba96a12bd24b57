"""The machines that work for the service; those of one owner may enrol with one token."""

import re
import secrets
import time

from nocturne_scene.errors import InputError

from nocturne_coordinator.enrolment import KEY_BYTES, NODE_SEPARATOR
from nocturne_coordinator.limits import MAX_MACHINES_OF_TOKEN
from nocturne_coordinator.store.database import Database

_NAME = re.compile(r"[A-Za-z0-9._-]{1,64}")


class Machines:
    """Those of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def enrol(self, token: str, node: str = "") -> tuple[str, bytes]:
        """Name and key of a machine, made at the first time: that of the token, or one of several that have
        it, each by the name of its node. Raises InputError."""
        name = f"{token}{NODE_SEPARATOR}{node}" if node else token
        for field, text in (("token", token), ("node", node or token)):
            if not _NAME.fullmatch(text):
                raise InputError.at(
                    field, f"{text!r} can't be a machine: expected 1 to 64 letters, digits, '.', '_' or '-'"
                )
        with self._database.transaction():
            self._make_room(token, name)
            self._database.execute(
                """INSERT INTO machine (name, key, enrolled, token) VALUES (?, ?, ?, ?)
                   ON CONFLICT (name) DO UPDATE SET enrolled = excluded.enrolled""",
                (name, secrets.token_bytes(KEY_BYTES), time.time(), token),
            )
            row = self._database.row("SELECT key FROM machine WHERE name = ?", (name,))
        assert row is not None  # noqa: S101 - it was written in the same transaction
        return name, bytes(row["key"])

    def _make_room(self, token: str, name: str) -> None:
        """Of a token's machines those go first that enrolled long ago: nodes of clouds come and go."""
        self._database.execute(
            """DELETE FROM machine WHERE token = ?1 AND name <> ?2 AND name NOT IN (
                   SELECT name FROM machine WHERE token = ?1 AND name <> ?2
                   ORDER BY enrolled DESC LIMIT ?3)""",
            (token, name, MAX_MACHINES_OF_TOKEN - 1),
        )

    def keys(self) -> dict[str, bytes]:
        """By name, of the machines whose token was not revoked."""
        rows = self._database.rows(
            """SELECT machine.name, key FROM machine JOIN token ON token.name = machine.token
               WHERE revoked = 0 ORDER BY machine.name"""
        )
        return {row["name"]: bytes(row["key"]) for row in rows}

    def lease_key(self) -> bytes:
        """The folder's secret for leases, made at the first time."""
        with self._database.transaction():
            self._database.execute(
                "INSERT INTO lease_key VALUES (1, ?) ON CONFLICT DO NOTHING",
                (secrets.token_bytes(KEY_BYTES),),
            )
            row = self._database.row("SELECT key FROM lease_key WHERE number = 1")
        assert row is not None  # noqa: S101 - it was written in the same transaction
        return bytes(row["key"])
