"""One nocturne-trace for many scenes: it takes 0.3 s to start, and most scenes take a hundredth to trace."""

import atexit
import os
import resource
import subprocess
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import IO

from nocturne_client.local.programs import need_program

CPU_LIMIT_S = 120
"""Of a command; most take a tenth of a second."""
_TICKS = os.sysconf("SC_CLK_TCK")
_TIMES = slice(11, 13)
"""User's and system's, of the words after the program's name in /proc/<id>/stat, see proc(5)."""


class Failed(Exception):
    """The tracer ended without an image, or counted invalid samples."""


class Program:
    """It is started again where it ended: by a crash, or by the limit of processor time."""

    def __init__(self) -> None:
        self._running: _Running | None = None

    def run(self, words: Sequence[object]) -> None:
        """Runs a command line without the program's name. Raises Failed with the program's message."""
        if self._running is None:
            self._running = _Running()
        status, said = self._running.answer("\t".join(map(str, words)))
        if status is None:
            status = self.close()
        if status != 0:
            raise Failed(f"status {status}: {said.strip()[-300:]}")

    def close(self) -> int:
        """Ends it, if it runs; its own status."""
        running, self._running = self._running, None
        return running.close() if running is not None else 0


class _Running:
    def __init__(self) -> None:
        self._messages: IO[str] = tempfile.TemporaryFile("w+")  # noqa: SIM115 - as long as the program
        command = [str(need_program("nocturne-trace")), "--commands"]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=self._messages, text=True)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._commands: IO[str] = self._process.stdin
        self._answers: IO[str] = self._process.stdout

    def answer(self, command: str) -> tuple[int | None, str]:
        """The command's status, None if the program has ended, and its message."""
        before = self._messages.seek(0, os.SEEK_END)
        limit = int(_cpu_seconds(self._process.pid)) + CPU_LIMIT_S
        resource.prlimit(self._process.pid, resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
        self._commands.write(f"{command}\n")
        self._commands.flush()
        status = self._answers.readline().strip()
        self._messages.seek(before)
        return int(status) if status else None, self._messages.read()

    def close(self) -> int:
        with suppress(BrokenPipeError):
            self._commands.close()
        self._answers.close()
        self._messages.close()
        return self._process.wait()


def _cpu_seconds(process: int) -> float:
    words = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, words[_TIMES])) / _TICKS


@cache
def program() -> Program:
    """Of this process, for all its scenes."""
    made = Program()
    atexit.register(made.close)
    return made
