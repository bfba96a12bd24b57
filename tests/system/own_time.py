"""Times that other programs on the machine do not lengthen, for what is promised about seconds."""

import os
import time
from pathlib import Path


class OwnTime:
    """Seconds since this was made, but for those in which threads of this process waited for a processor."""

    def __init__(self) -> None:
        self._begun = time.monotonic()
        self._waited = waited_s(os.getpid())

    def seconds(self) -> float:
        return time.monotonic() - self._begun - max(0.0, waited_s(os.getpid()) - self._waited)


def cpu_s(pid: int) -> float:
    """User and system time of a running process; see proc(5)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def waited_s(pid: int) -> float:
    """For how long the threads of a process, those that live, waited for a processor; see proc(5)."""
    waited = 0
    for thread in Path(f"/proc/{pid}/task").iterdir():
        try:
            waited += int((thread / "schedstat").read_text().split()[1])
        except OSError:
            continue
    return waited / 1e9
