"""Programs of ours, forked from a process that has imported them: most of what a start costs is imports.

What a test starts is a child of the test's process, runs `main` of the module with its own arguments,
environment and log, and can be killed like any other. `nocturne up` and the command line are started as
people start them.

    python -m tests.system.forked SOCKET_DESCRIPTOR

is the process that forks. It ends with the test's process.
"""

import atexit
import ctypes
import importlib
import json
import os
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36
_libc = ctypes.CDLL(None)
_asking = threading.Lock()


class Forked:
    """A running program; the part of subprocess.Popen that tests use."""

    def __init__(
        self, module: str, words: Sequence[str], environment: Mapping[str, str], output: int | None = None
    ) -> None:
        """`output`: file descriptor of standard output and standard error; None: those of this process."""
        asked = {
            "module": module,
            "words": list(words),
            "environment": dict(environment),
            "parent": os.getpid(),
        }
        descriptors = [1, 2] if output is None else [output, output]
        with _asking:
            connection = _forking_process()
            # Who is left alone by its parent becomes a child of this process.
            _libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
            try:
                socket.send_fds(connection, [json.dumps(asked).encode()], descriptors)
                self.pid = int(connection.recv(100))
            finally:
                _libc.prctl(_PR_SET_CHILD_SUBREAPER, 0, 0, 0, 0)
        self.returncode: int | None = None
        self._descriptor = os.pidfd_open(self.pid)

    def poll(self) -> int | None:
        """The exit code, negative for a signal; None while it runs."""
        if self.returncode is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.returncode = os.waitstatus_to_exitcode(status)
                os.close(self._descriptor)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """The exit code, when it has ended."""
        if self.returncode is None and not select.select([self._descriptor], [], [], timeout)[0]:
            raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
        code = self.poll()
        assert code is not None
        return code

    def send_signal(self, number: int) -> None:
        """Nothing happens to one that has ended."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self) -> None:
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)


@cache
def _forking_process() -> socket.socket:
    """A connection to it: one for each process that runs tests."""
    ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.system.forked", str(its.fileno())],
        pass_fds=[its.fileno()],
        stdin=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "OMP_NUM_THREADS": "1"},
    )
    its.close()

    def end() -> None:
        ours.close()
        process.wait()

    atexit.register(end)
    return ours


def _fork_on_request(connection: socket.socket) -> dict[str, Any]:
    """Answers requests by forks; in the fork, returns the request that it must carry out."""
    while True:
        text, descriptors, _, _ = socket.recv_fds(connection, 1_000_000, 2)
        if not text:
            os._exit(0)
        asked: dict[str, Any] = json.loads(text)
        importlib.import_module(asked["module"])
        between = os.fork()
        if between == 0:
            # Its end makes the program a child of the test's process.
            if os.fork():
                os._exit(0)
            for number, descriptor in enumerate(descriptors, start=1):
                os.dup2(descriptor, number)
                os.close(descriptor)
            return asked
        os.waitpid(between, 0)
        for descriptor in descriptors:
            os.close(descriptor)


def main() -> None:
    """Forks on request, and runs the requested program in each fork."""
    connection = socket.socket(fileno=int(sys.argv[1]))
    asked = _fork_on_request(connection)
    while os.getppid() != asked["parent"]:
        # The one between has not quite ended.
        os.sched_yield()
    _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    os.environ.clear()
    os.environ.update(asked["environment"])
    sys.argv = [asked["module"], *asked["words"]]
    connection.send(str(os.getpid()).encode())
    connection.close()
    sys.exit(sys.modules[asked["module"]].main())


if __name__ == "__main__":
    main()
