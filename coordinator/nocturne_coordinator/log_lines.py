"""Log lines of all programs look alike: time (UTC), level, `name=value` for what a line is about, and words.

The names: render, tile, range (by its index; a worker says samples=first..end), worker, thread, scene.
"""

import logging
import sys
import time


def write_log_lines(level: str, program: str) -> None:
    """Sets the process's log up: lines of `level` and above, as `logging` names them, on standard error."""
    handler = logging.StreamHandler(sys.stderr)
    formatter = logging.Formatter(
        f"%(asctime)s %(levelname)s {program} %(message)s", datefmt="%Y-%m-%dT%H:%M:%SZ"
    )
    formatter.converter = time.gmtime
    handler.setFormatter(formatter)
    logging.basicConfig(level=level.upper(), handlers=[handler])
