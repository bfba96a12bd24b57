"""All programs write lines that one rule can read."""

import re
import subprocess
import sys

_LINE = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ (DEBUG|INFO|WARNING|ERROR) [a-z]+ (\w+=\S+ )*\S.*")
_PROGRAM = """
import logging
from nocturne_coordinator.log_lines import write_log_lines
from nocturne_coordinator.dispatch.scheduler import JobKey
write_log_lines("info", "coordinator")
logging.getLogger("any").info("%s failed at worker=%s: %s", JobKey("r", 3, 1), "w", "no scene")
logging.getLogger("any").debug("nothing")
"""


def test_a_line_says_when_how_bad_who_and_what_it_is_about() -> None:
    done = subprocess.run([sys.executable, "-c", _PROGRAM], check=True, capture_output=True, text=True)
    (line,) = done.stderr.splitlines()
    assert _LINE.fullmatch(line)
    assert line.endswith("Z INFO coordinator render=r tile=3 range=1 failed at worker=w: no scene")
