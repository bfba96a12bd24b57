"""One program that a test may kill, pause and start again."""

import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from nocturne_client.local import die_with_parent

from tests.system.forked import Forked
from tests.system.waiting import wait_for

_LAUNCHER = [sys.executable, "-I", "-S", str(Path(die_with_parent.__file__)), str(os.getpid())]
_GRACE_S = 30.0


class Program:
    """A process with a log. It dies with this one, so a killed test run leaves nothing behind.

    `python -m` of a module is forked from a process that has imported it.
    """

    def __init__(
        self, command: Sequence[str | Path], log: Path, environment: Mapping[str, str] | None = None
    ) -> None:
        """`environment` is added to ours."""
        self.log = log
        self._command = [str(word) for word in command]
        self._environment = {**os.environ, **(environment or {})}
        self._process: subprocess.Popen[bytes] | Forked | None = None

    @property
    def pid(self) -> int:
        assert self._process is not None
        return self._process.pid

    def start(self) -> None:
        with self.log.open("ab") as log:
            if self._command[:2] == [sys.executable, "-m"]:
                module, *words = self._command[2:]
                self._process = Forked(module, words, self._environment, log.fileno())
                return
            self._process = subprocess.Popen(
                [*_LAUNCHER, *self._command],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                env=self._environment,
            )

    def is_alive(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def kill(self) -> None:
        """SIGKILL; returns when the process is gone."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    def end(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Asks it to end; gives its exit code. subprocess.TimeoutExpired if it does not."""
        assert self._process is not None
        self._process.send_signal(number)
        return self._process.wait(_GRACE_S)

    def pause(self) -> None:
        """SIGSTOP; returns when no thread of it runs."""
        os.kill(self.pid, signal.SIGSTOP)
        wait_for(lambda: self._states() <= {"T", "Z"}, f"process {self.pid} to stop")

    def go_on(self) -> None:
        os.kill(self.pid, signal.SIGCONT)

    def tail(self) -> str:
        """The end of the log."""
        if not self.log.is_file():
            return ""
        return self.log.read_bytes()[-4000:].decode(errors="replace")

    def _states(self) -> set[str]:
        """Of all threads, as letters; see proc(5)."""
        return {_state(task) for task in Path(f"/proc/{self.pid}/task").glob("*/stat")}


def _state(stat: Path) -> str:
    """One letter; Z, for a zombie, also if there is no such process or thread any more."""
    try:
        return stat.read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"


def is_running(pid: int) -> bool:
    """Whether there is such a process, zombies left out: they have ended."""
    return _state(Path(f"/proc/{pid}/stat")) != "Z"
