"""Places where tests let the coordinator die, as if by SIGKILL.

NOCTURNE_CRASH_AT=after-commit:3 kills the process at its third passage; without a number, at its first.
"""

import os
import signal
from functools import cache

_passages = 0


def crash_point(name: str) -> None:
    """Does nothing, unless the environment names this place."""
    global _passages
    wanted, passage = _wanted()
    if name != wanted:
        return
    _passages += 1
    if _passages == passage:
        os.kill(os.getpid(), signal.SIGKILL)


@cache
def _wanted() -> tuple[str, int]:
    """Place and passage. Not read before the first one: a process that is forked gets its environment after
    its imports."""
    place, _, count = os.environ.get("NOCTURNE_CRASH_AT", "").partition(":")
    return place, int(count or 1)
