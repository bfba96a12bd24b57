"""All programs write lines that one rule can read."""

import json
import os
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


def test_a_record_is_a_line_of_json_where_that_is_asked_for() -> None:
    program = (
        _PROGRAM
        + """
try:
    raise ValueError("no\\nline")
except ValueError:
    logging.getLogger("any").exception('said "no",\\nas scene=5c5c: was gone')
"""
    )
    environment = os.environ | {"NOCTURNE_LOG": "json"}
    done = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True, env=environment
    )
    first, second = map(json.loads, done.stderr.splitlines())
    time = first.pop("time")
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", time)
    assert first == {
        "level": "INFO",
        "program": "coordinator",
        "message": "render=r tile=3 range=1 failed at worker=w: no scene",
        "render": "r",
        "tile": "3",
        "range": "1",
        "worker": "w",
    }
    assert (second["level"], second["scene"]) == ("ERROR", "5c5c")
    assert second["message"] == 'said "no",\nas scene=5c5c: was gone'
    assert second["exception"].endswith("ValueError: no\nline")
