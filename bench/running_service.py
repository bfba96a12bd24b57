"""`nocturne up` as a child, for as long as a bench needs it."""

import json
import sys
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from nocturne_client import Client
from nocturne_client.local.children import Child
from nocturne_coordinator.store.data_folder import DataFolder

from bench.programs import running_cpu_s
from tests.system.free_ports import free_port_pair

_START_S = 60.0
_STOP_S = 30.0


@dataclass(frozen=True)
class RunningService:
    """Where it is, and its processes by name."""

    url: str
    data: Path
    pids: dict[str, int]
    token: str = ""
    """An admin's, where callers need one."""

    def cpu_s(self) -> dict[str, float]:
        """User and system time so far, seconds, by process."""
        return {name: running_cpu_s(pid) for name, pid in self.pids.items()}


@contextmanager
def running_service(workers: int, threads: int, auth: bool = False) -> Iterator[RunningService]:
    """Starts it on a new data folder; stops it and removes the folder at the end."""
    with tempfile.TemporaryDirectory(prefix="nocturne-bench-") as folder:
        data = Path(folder) / "data"
        place = ["--data", str(data), "--port", str(free_port_pair())]
        fleet = ["--workers", str(workers), "--threads", str(threads)]
        token = _admin(data) if auth else ""
        up = [sys.executable, "-m", "nocturne_client", "up", *place, *fleet, *(["--auth"] if auth else [])]
        child = Child("nocturne up", up, Path(folder) / "up.log")
        child.start()
        try:
            # It writes this file when all of its children run.
            child.wait_until((data / "service.json").exists, _START_S)
            said = json.loads((data / "service.json").read_text())
            with Client(said["url"], token=token) as client:
                child.wait_until(lambda: bool(client.workers()), _START_S)
            yield RunningService(said["url"], data, {"up": child.pid, **said["children"]}, token)
        finally:
            child.stop(_STOP_S)


def _admin(data: Path) -> str:
    """A token in a new data folder."""
    with closing(DataFolder(data)) as folder:
        return folder.tokens.create("bench", ["admin"])
