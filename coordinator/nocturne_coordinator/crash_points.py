"""Places where tests let the coordinator die, as if by SIGKILL.

NOCTURNE_CRASH_AT=after-commit:3 kills the process at its third passage; without a number, at its first.
"""

import os
import signal

_WANTED, _, _COUNT = os.environ.get("NOCTURNE_CRASH_AT", "").partition(":")
_passages_left = int(_COUNT or 1)


def crash_point(name: str) -> None:
    """Does nothing, unless the environment names this place."""
    global _passages_left
    if name != _WANTED:
        return
    _passages_left -= 1
    if _passages_left == 0:
        os.kill(os.getpid(), signal.SIGKILL)
