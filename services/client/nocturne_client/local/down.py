"""`nocturne down`: ends the service that runs on a data folder."""

import json
import os
import signal
import time
from pathlib import Path

from nocturne_client.errors import NocturneClientError

# Children have five seconds each to finish or hand back their work.
_PATIENCE_S = 60.0
_LOOK_S = 0.1


def run_down(data: Path) -> None:
    """Asks the service to stop, and waits. NocturneClientError if none runs, or it does not stop."""
    file = data / "service.json"
    try:
        pid = int(json.loads(file.read_text())["pid"])
        os.kill(pid, signal.SIGTERM)
    except (OSError, ValueError, KeyError):
        raise NocturneClientError(
            f"no service runs on {data}; another data folder is named with --data"
        ) from None
    end = time.monotonic() + _PATIENCE_S
    # The service removes it last.
    while file.exists():
        if time.monotonic() > end:
            raise NocturneClientError(f"the service (process {pid}) goes on; its log is in {data / 'logs'}")
        time.sleep(_LOOK_S)
