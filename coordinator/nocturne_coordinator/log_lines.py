"""Log lines of all programs look alike: time (UTC), level, `name=value` for what a line is about, and words.

The names: render, tile, range (by its index; a worker says samples=first..end), worker, thread, scene. With
NOCTURNE_LOG=json in the environment each record is a line of JSON instead, and these names are members of it.
"""

import json
import logging
import os
import re
import sys
import time

_TIME = "%Y-%m-%dT%H:%M:%SZ"
_FORMAT = "NOCTURNE_LOG"
_NAMED = re.compile(
    r"(?:^|(?<=[ (]))(render|tile|range|samples|worker|thread|scene|layers)=([^\s,;)]*[^\s,;):.])"
)


class _JsonLines(logging.Formatter):
    """One object a record: time, level, program, message, what it is about, and the trace of an exception."""

    def __init__(self, program: str) -> None:
        super().__init__(datefmt=_TIME)
        self.converter = time.gmtime
        self._program = program

    def format(self, record: logging.LogRecord) -> str:
        message = record.getMessage()
        about = {
            "time": self.formatTime(record, self.datefmt),
            "level": record.levelname,
            "program": self._program,
            "message": message,
        }
        about |= dict(_NAMED.findall(message))
        if record.exc_info:
            about["exception"] = self.formatException(record.exc_info)
        return json.dumps(about)


def write_log_lines(level: str, program: str) -> None:
    """Sets the process's log up: lines of `level` and above, as `logging` names them, on standard error."""
    handler = logging.StreamHandler(sys.stderr)
    if os.environ.get(_FORMAT) == "json":
        handler.setFormatter(_JsonLines(program))
    else:
        formatter = logging.Formatter(f"%(asctime)s %(levelname)s {program} %(message)s", datefmt=_TIME)
        formatter.converter = time.gmtime
        handler.setFormatter(formatter)
    logging.basicConfig(level=level.upper(), handlers=[handler])
