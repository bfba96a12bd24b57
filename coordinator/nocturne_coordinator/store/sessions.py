"""Sessions of the page: a cookie names one, and every process that serves the folder knows whose it is."""

import hashlib
import secrets
import time

from nocturne_scene.errors import NotFound

from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.tokens import Token, Tokens


class Sessions:
    """Those of a data folder. For many processes."""

    def __init__(self, database: Database, tokens: Tokens) -> None:
        self._database = database
        self._tokens = tokens

    def begin(self, secret: str, most: int, seconds: float) -> str:
        """The name of a new session of a token; those that began `seconds` ago end, as do the oldest of more
        than `most`. Raises NotFound where there is no such token."""
        token = self._tokens.find(secret)
        if token is None:
            raise NotFound("there is no such token")
        name, now = secrets.token_urlsafe(32), time.time()
        with self._database.transaction():
            self._database.execute("DELETE FROM session WHERE begun < ?", (now - seconds,))
            self._database.execute("INSERT INTO session VALUES (?, ?, ?)", (_hash(name), token.name, now))
            self._database.execute(
                """DELETE FROM session WHERE begun <= (
                       SELECT begun FROM session ORDER BY begun DESC LIMIT 1 OFFSET ?)""",
                (most,),
            )
        return name

    def token(self, name: str, seconds: float) -> Token | None:
        """The token that the session began with; None where that was revoked or the session is too old."""
        row = self._database.row(
            "SELECT token FROM session WHERE sha256 = ? AND begun >= ?", (_hash(name), time.time() - seconds)
        )
        return None if row is None else self._tokens.named(row["token"])

    def end(self, name: str) -> None:
        """Nobody gets in with it any more."""
        self._database.execute("DELETE FROM session WHERE sha256 = ?", (_hash(name),))


def _hash(name: str) -> str:
    return hashlib.sha256(name.encode()).hexdigest()
