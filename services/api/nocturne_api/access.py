"""Who calls, and what that caller may do: one set of rules for REST and gRPC."""

import asyncio
import base64
import binascii
import time
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field

from nocturne_coordinator.store.tokens import Token

from nocturne_api import limits
from nocturne_api.errors import Forbidden, RateLimited, Unauthenticated

_IMPLIED: Mapping[str, frozenset[str]] = {
    "read": frozenset({"read"}),
    "submit": frozenset({"read", "submit"}),
    "worker": frozenset({"worker"}),
    "admin": frozenset({"read", "submit", "worker", "admin"}),
}


@dataclass(frozen=True)
class Caller:
    """Who makes a call."""

    name: str
    """Of the token; empty where there is no authentication."""
    scopes: frozenset[str]
    sees_all: bool = False
    """Renders of others, too."""

    @property
    def sees(self) -> str | None:
        """The owner whose renders the caller may see; None: everybody's."""
        return None if self.sees_all else self.name

    def need(self, scope: str) -> None:
        """Raises Forbidden unless the caller may do what `scope` allows."""
        if scope not in self.scopes:
            raise Forbidden(f"this token has no scope {scope!r}, only {', '.join(sorted(self.scopes))}")

    def need_own(self, owner: str) -> None:
        """Raises Forbidden unless a render of this owner is the caller's to change."""
        self.need("submit")
        if "admin" not in self.scopes and owner != self.name:
            raise Forbidden(f"the render is {owner or 'nobody'}'s; to change it takes the scope 'admin'")


ANYBODY = Caller("", _IMPLIED["admin"], sees_all=True)
"""Without authentication; only loopback and Unix sockets are served then."""

CALLER: ContextVar[Caller] = ContextVar("caller", default=ANYBODY)
"""Set by the middleware and the interceptor for the call at hand."""


def caller_of(token: Token | None) -> Caller:
    """Raises Unauthenticated where there is no such token."""
    if token is None:
        raise Unauthenticated("the token is not known, or was revoked")
    scopes = frozenset().union(*(_IMPLIED[scope] for scope in token.scopes))
    return Caller(token.name, scopes, sees_all=bool({"read", "admin"} & set(token.scopes)))


def secret_in(authorization: str) -> str:
    """The secret in an Authorization header: a Bearer's, or a Basic password, so that browsers can ask for
    it.

    Raises Unauthenticated where there is none.
    """
    scheme, _, rest = authorization.partition(" ")
    if scheme.lower() == "bearer" and rest.strip():
        return rest.strip()
    if scheme.lower() == "basic":
        try:
            _, _, password = base64.b64decode(rest, validate=True).decode().partition(":")
        except (binascii.Error, UnicodeDecodeError):
            password = ""
        if password:
            return password
    raise Unauthenticated("a token is needed: `Authorization: Bearer TOKEN`")


Identify = Callable[[str], Awaitable[Caller]]


class Authenticator:
    """Authenticates callers by their tokens; one for each transport."""

    def __init__(self, identify: Identify, identify_session: Identify | None = None) -> None:
        """They give who has a secret, and who began a session; both raise Unauthenticated."""
        self._identify = identify
        self._identify_session = identify_session
        self._pace = RateLimiter()
        self._wrong = RateLimiter(limits.WRONG_TOKENS_PER_SECOND, limits.WRONG_TOKENS_AT_ONCE)

    async def authenticate(self, secret: str, address: str) -> Caller:
        """Who has the secret.

        Raises Unauthenticated, and RateLimited for too many calls of one caller, or, after a while, for too
        many wrong tokens from one address."""
        try:
            caller = await self._identify(secret)
        except Unauthenticated:
            try:
                self._wrong.take(address)
            except RateLimited:
                await asyncio.sleep(limits.WRONG_TOKEN_DELAY_S)
                raise RateLimited(
                    "too many wrong tokens from this address; look at the one you send"
                ) from None
            raise
        self._pace.take(caller.name)
        return caller

    async def of_session(self, name: str) -> Caller:
        """Who began the session. Raises Unauthenticated, RateLimited."""
        if self._identify_session is None:
            raise Unauthenticated("there are no sessions here")
        caller = await self._identify_session(name)
        self._pace.take(caller.name)
        return caller


@dataclass
class _Bucket:
    left: float
    at: float


@dataclass
class RateLimiter:
    """How many calls each caller may make: so many a second in the long run, and at once in a burst."""

    per_second: float = field(default_factory=lambda: limits.CALLS_PER_SECOND)
    at_once: float = field(default_factory=lambda: limits.CALLS_AT_ONCE)
    _buckets: OrderedDict[str, _Bucket] = field(default_factory=OrderedDict)

    def take(self, name: str, now: float | None = None) -> None:
        """Counts a call; raises RateLimited."""
        now = time.monotonic() if now is None else now
        bucket = self._buckets.setdefault(name, _Bucket(self.at_once, now))
        self._buckets.move_to_end(name)
        if len(self._buckets) > limits.ADDRESSES_KEPT:
            self._buckets.popitem(last=False)
        bucket.left = min(self.at_once, bucket.left + (now - bucket.at) * self.per_second)
        bucket.at = now
        if bucket.left < 1.0:
            raise RateLimited(f"more than {self.per_second:g} calls a second; try again in a moment")
        bucket.left -= 1.0
