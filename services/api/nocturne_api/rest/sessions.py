"""Sessions of the page: a cookie names one, and only this process knows whose it is.

They go with the process; the page then asks for the token again.
"""

import secrets
import time
from collections import OrderedDict

from nocturne_api import limits
from nocturne_api.errors import Unauthenticated


class Sessions:
    """Tokens by the name of a session."""

    def __init__(self) -> None:
        self._begun: OrderedDict[str, tuple[str, float]] = OrderedDict()

    def begin(self, secret: str) -> str:
        """The new session's name; the oldest goes where there are too many."""
        name = secrets.token_urlsafe(32)
        self._begun[name] = secret, time.monotonic()
        if len(self._begun) > limits.SESSIONS:
            self._begun.popitem(last=False)
        return name

    def secret(self, name: str) -> str:
        """The token that the session began with. Raises Unauthenticated where it has ended."""
        secret, begun = self._begun.get(name, ("", 0.0))
        if not secret or time.monotonic() - begun > limits.SESSION_SECONDS:
            self._begun.pop(name, None)
            raise Unauthenticated("the session has ended; give the token again")
        return secret

    def end(self, name: str) -> None:
        """Nobody gets in with it any more."""
        self._begun.pop(name, None)
