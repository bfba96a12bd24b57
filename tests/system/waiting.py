"""Waits on conditions, never on time: limits are generous, because test machines can be slow.

Frequent questions would cost the service more than the work that they ask about, so the pause between
two questions grows: a tenth of the time waited so far, 10 to 200 ms.
"""

import time
from collections.abc import Callable
from typing import TypeVar

LIMIT_S = 120.0
_T = TypeVar("_T")


def wait_for(find: Callable[[], _T], what: str, seconds: float = LIMIT_S) -> _T:
    """The first true value that `find` gives; if there is none, fails the test with `what` in its message."""
    begun = time.monotonic()
    while True:
        found = find()
        if found:
            return found
        waited = time.monotonic() - begun
        assert waited < seconds, f"waited {seconds:g} s for {what}"
        pause(waited)


def pause(waited: float) -> None:
    """Between two questions."""
    time.sleep(min(0.2, max(0.01, waited / 10)))
