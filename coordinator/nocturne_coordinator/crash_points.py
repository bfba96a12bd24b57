"""Places where tests let the coordinator die, as if by SIGKILL.

NOCTURNE_CRASH_AT=after-commit:3 kills the process at its third passage; without a number, at its first.
"""

import os
import signal

_passages = 0


def crash_point(name: str) -> None:
    """Does nothing, unless the environment names this place."""
    global _passages
    wanted, _, count = os.environ.get("NOCTURNE_CRASH_AT", "").partition(":")
    if name != wanted:
        return
    _passages += 1
    if _passages == int(count or 1):
        os.kill(os.getpid(), signal.SIGKILL)
