"""Waits on conditions, never on time: limits are generous, because test machines can be slow."""

import time
from collections.abc import Callable
from typing import TypeVar

LIMIT_S = 120.0
_T = TypeVar("_T")


def wait_for(find: Callable[[], _T], what: str, seconds: float = LIMIT_S) -> _T:
    """The first true value that `find` gives; if there is none, fails the test with what was waited for."""
    deadline = time.monotonic() + seconds
    while True:
        found = find()
        if found:
            return found
        assert time.monotonic() < deadline, f"waited {seconds:g} s for {what}"
        time.sleep(0.01)
