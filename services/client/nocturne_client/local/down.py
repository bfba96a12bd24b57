"""`nocturne down`: ends the service that runs on a data folder."""

import fcntl
import json
import os
import signal
import time
from pathlib import Path

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.up import LOCK

# Children have five seconds each to finish or hand back their work.
_PATIENCE_S = 60.0
_LOOK_S = 0.1


def run_down(data: Path) -> None:
    """Asks the service to stop, and waits. NocturneClientError if none runs, or it does not stop."""
    if not _runs(data):
        raise NocturneClientError(f"no service runs on {data}; another data folder is named with --data")
    pid = int(json.loads((data / "service.json").read_text())["pid"])
    os.kill(pid, signal.SIGTERM)
    end = time.monotonic() + _PATIENCE_S
    while _runs(data):
        if time.monotonic() > end:
            raise NocturneClientError(f"the service (process {pid}) goes on; its log is in {data / 'logs'}")
        time.sleep(_LOOK_S)


def _runs(data: Path) -> bool:
    """Whether a process holds the folder: one that was killed leaves its number, which may be another's."""
    try:
        with (data / LOCK).open("r+") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except BlockingIOError:
        return (data / "service.json").exists()
    return False
