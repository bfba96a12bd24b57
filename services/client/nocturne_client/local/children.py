"""Child processes of `nocturne up`: started so that they die with us, started again when they die alone."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from nocturne_client.errors import NocturneClientError
from nocturne_client.local.probes import Watch

_LAUNCHER = Path(__file__).with_name("die_with_parent.py")
_FIRST_DELAY_S = 0.5
_MAX_DELAY_S = 30.0
# A child that lived this long was healthy: its next death is a new matter.
_HEALTHY_S = 60.0
_TAIL_BYTES = 2000
# Ten times what a busy machine takes for an answer, and less than a render is missed for.
_SILENT_S = 20.0
# A machine with many times more to do than it can takes half a minute to load a program. One that is ended
# while it loads never comes up.
_LOADS_S = 60.0


class Child:
    """One program with its log file; `start` it, look after it with `supervise`, `stop` it."""

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        log: Path,
        answers: Callable[[], bool] | None = None,
        silent_s: float = _SILENT_S,
        loads_s: float = _LOADS_S,
    ) -> None:
        """`answers`: whether it serves its purpose; not for `silent_s` seconds, or `loads_s` after
        its start, and it is ended and started again."""
        self.name = name
        self._watch = None if answers is None else Watch(answers)
        self._silent_s, self._loads_s = silent_s, loads_s
        self._command = command
        self._log = log
        self._process: subprocess.Popen[bytes] | None = None
        self._started = 0.0
        self._restart_at: float | None = None
        self._delay = _FIRST_DELAY_S

    @property
    def pid(self) -> int:
        """Process id; 0 while it does not run."""
        return self._process.pid if self._process is not None and self.is_alive() else 0

    def is_alive(self) -> bool:
        """Whether the process runs."""
        return self._process is not None and self._process.poll() is None

    def send_signal(self, number: signal.Signals) -> None:
        """Where it runs."""
        if self._process is not None and self.is_alive():
            self._process.send_signal(number)

    def start(self) -> None:
        """Starts the process in a separate group, so that Ctrl-C reaches only us and we stop in order."""
        launcher = [sys.executable, "-I", "-S", str(_LAUNCHER), str(os.getpid())]
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(  # noqa: S603 - fixed programs, no shell
                [*launcher, *self._command],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                process_group=0,
            )
        self._started = time.monotonic()
        self._restart_at = None
        if self._watch is not None:
            self._watch.begin()

    def supervise(self, say: Callable[[str], None]) -> bool:
        """Starts the process again when it has died, or hangs, after a pause that doubles; whether it did so
        now."""
        if self._process is None:
            return False
        if (
            self.is_alive()
            and self._watch is not None
            and self._watch.silent_s() > (patience := self._patience_s())
        ):
            say(f"{self.name} has not answered for {patience:g} s; ending it. {self.tail()}")
            self._process.kill()
            self._process.wait()
        if self.is_alive():
            return False
        now = time.monotonic()
        if self._restart_at is None:
            if now - self._started > _HEALTHY_S:
                self._delay = _FIRST_DELAY_S
            self._restart_at = now + self._delay
            say(
                f"{self.name} {_death(self._process.returncode)}; starting it again in {self._delay:g} s. "
                f"{self.tail()}"
            )
            self._delay = min(2 * self._delay, _MAX_DELAY_S)
        if now < self._restart_at:
            return False
        try:
            self.start()
        except OSError as error:
            self._restart_at = now + self._delay
            say(f"{self.name} can't be started: {error}; trying again in {self._delay:g} s")
            return False
        return True

    def _patience_s(self) -> float:
        return self._silent_s if self._watch is None or self._watch.has_answered else self._loads_s

    def wait_until(self, ready: Callable[[], bool], timeout_s: float) -> None:
        """Waits for `ready`; NocturneClientError with the end of the log if the process dies or is slow."""
        end = time.monotonic() + timeout_s
        while not ready():
            if not self.is_alive():
                raise NocturneClientError(f"{self.name} did not start. {self.tail()}")
            if time.monotonic() > end:
                raise NocturneClientError(f"{self.name} was not ready after {timeout_s:g} s. {self.tail()}")
            time.sleep(0.02)

    def stop(self, grace_s: float) -> None:
        """Asks the process to end, and kills it after `grace_s` seconds."""
        if self._watch is not None:
            self._watch.close()
        process, self._process = self._process, None
        if process is None:
            return
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(grace_s)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def tail(self) -> str:
        """The last line of the log and where the rest is."""
        try:
            text = self._log.read_bytes()[-_TAIL_BYTES:].decode(errors="replace").strip()
        except OSError:
            text = ""
        last = text.splitlines()[-1] if text else "it said nothing, perhaps as its disk is full"
        return f"Its last line: {last} (all of it: {self._log})"


def _death(return_code: int) -> str:
    if return_code < 0:
        return f"was ended by {signal.Signals(-return_code).name}"
    return f"ended with status {return_code}"
