"""Who may do what: API tokens, kept as hashes. Each is a user; its renders carry its name."""

import hashlib
import secrets
import time
from collections.abc import Iterable, Set
from dataclasses import dataclass

from nocturne_scene.errors import InputError, NotFound

from nocturne_coordinator.errors import Conflict
from nocturne_coordinator.limits import DEFAULT_PRIORITY, MAX_NAME, MAX_PRIORITY
from nocturne_coordinator.store.database import Database

SCOPES = ("read", "submit", "worker", "admin")
"""read: see everybody's renders. submit: upload, make renders, see and change one's own. worker: fetch
assets. admin: all. A token may have several."""

PREFIX = "nct_"
"""So that a token that got somewhere by mistake is recognized as a token."""


@dataclass(frozen=True, slots=True)
class Token:
    """The stored facts about a token, without its secret."""

    name: str
    scopes: tuple[str, ...]
    weight: int
    """Share of the workers among those who submit."""
    created: float
    revoked: float
    """Unix times; 0: not revoked."""


class Tokens:
    """The tokens of a data folder."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def create(self, name: str, scopes: Iterable[str], weight: int = DEFAULT_PRIORITY) -> str:
        """Makes a token and gives its secret, which can't be had again. Raises InputError, Conflict."""
        wanted = tuple(dict.fromkeys(scopes))
        unknown = [scope for scope in wanted if scope not in SCOPES]
        if unknown or not wanted:
            raise InputError.at("scopes", f"expected some of {', '.join(SCOPES)}")
        if not 1 <= len(name) <= MAX_NAME or not name.isprintable():
            raise InputError.at("name", f"expected 1 to {MAX_NAME} printable characters")
        if not 1 <= weight <= MAX_PRIORITY:
            raise InputError.at("weight", f"is {weight}; expected 1 to {MAX_PRIORITY}")
        secret = PREFIX + secrets.token_urlsafe(32)
        with self._database.transaction():
            if self._database.row("SELECT 1 FROM token WHERE name = ?", (name,)):
                raise Conflict(f"there is, or was, a token {name!r}: its renders have its name")
            self._database.execute(
                "INSERT INTO token (name, sha256, scopes, weight, created) VALUES (?, ?, ?, ?, ?)",
                (name, _hash(secret), " ".join(wanted), weight, time.time()),
            )
        return secret

    def find(self, secret: str) -> Token | None:
        """The token with this secret, unless it was revoked."""
        row = self._database.row(
            f"{_SELECT} WHERE sha256 = ? AND revoked = 0",
            (_hash(secret),),
        )
        return None if row is None else _token(dict(row))

    def named(self, name: str) -> Token | None:
        """The token of this name, unless it was revoked."""
        row = self._database.row(f"{_SELECT} WHERE name = ? AND revoked = 0", (name,))
        return None if row is None else _token(dict(row))

    def list(self) -> "list[Token]":
        """All, oldest first."""
        return [_token(dict(row)) for row in self._database.rows(f"{_SELECT} ORDER BY created")]

    def revoked(self, names: Set[str]) -> Set[str]:
        """Those of the tokens, by name, that let nobody in."""
        rows = self._database.rows("SELECT name FROM token WHERE revoked = 0")
        return names - {str(row["name"]) for row in rows}

    def revoke(self, name: str) -> None:
        """From now on nobody gets in with it. Raises NotFound."""
        done = self._database.execute(
            "UPDATE token SET revoked = ? WHERE name = ? AND revoked = 0", (time.time(), name)
        )
        if not done:
            raise NotFound(f"there is no token {name!r} that could be revoked")


_SELECT = "SELECT name, scopes, weight, created, revoked FROM token"


def _token(row: dict[str, object]) -> Token:
    return Token(**{**row, "scopes": tuple(str(row["scopes"]).split())})  # type: ignore[arg-type]


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
