"""`nocturne up` as a real process."""

import json
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

import httpx

from tests.system.free_ports import free_port_pair
from tests.system.program import Program
from tests.system.waiting import wait_for

NOCTURNE = Path(sys.executable).with_name("nocturne")


class Up:
    """The whole service on free ports; its data folder outlives it. Use it as a context manager."""

    def __init__(
        self,
        folder: Path,
        workers: int = 1,
        threads: int = 2,
        *words: str,
        nocturne: Path = NOCTURNE,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        """`folder` holds data, temporary files and the log; its path must be short, for Unix sockets.

        `words`: further options. `nocturne`: the command line; `environment` is added to ours.
        """
        self.data = folder / "data"
        self.temporary = folder / "tmp"
        self.temporary.mkdir(parents=True, exist_ok=True)
        self._port = free_port_pair()
        self.url = f"http://127.0.0.1:{self._port}"
        self.grpc = f"127.0.0.1:{self._port + 1}"
        command = [str(nocturne), "up", "--data", str(self.data), "--port", str(self._port)]
        fleet = ["--workers", str(workers), "--threads", str(threads)]
        settings = {**(environment or {}), "TMPDIR": str(self.temporary)}
        self.program = Program([*command, *fleet, *words], folder / "up.log", settings)

    def __enter__(self) -> Self:
        try:
            self.start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is not None:
            # For the report of the test that failed.
            sys.stderr.write(self.program.tail())
        self.close()

    def start(self) -> None:
        """Returns when everything runs."""
        self.program.start()
        self.wait_until_up()

    def wait_until_up(self) -> None:
        """Until its API answers, also one that was started again."""
        wait_for(self._is_up, "`nocturne up` to be up")

    def stop(self) -> int:
        """Ctrl-C; gives the exit code."""
        return self.program.end(signal.SIGINT)

    def close(self) -> None:
        """Ends it, whatever state it is in: children die with their parent."""
        if self.program.is_alive():
            try:
                self.stop()
            except subprocess.TimeoutExpired:
                self.program.kill()
        shutil.rmtree(self.temporary, ignore_errors=True)

    def children(self) -> dict[str, int]:
        """Process ids by name."""
        children: dict[str, int] = self._said()["children"]
        return children

    def _said(self) -> dict[str, Any]:
        """The service's description for other programs; empty until it is written."""
        try:
            said: dict[str, Any] = json.loads((self.data / "service.json").read_text())
        except FileNotFoundError:
            return {}
        return said

    def _is_up(self) -> bool:
        assert self.program.is_alive(), f"`nocturne up` ended: {self.program.tail()}"
        if self._said().get("pid") != self.program.pid:
            return False
        try:
            return httpx.get(f"{self.url}/readyz", trust_env=False, verify=False).status_code == 200  # noqa: S501
        except httpx.TransportError:
            return False
