"""A service on this machine for as long as Blender runs, where there is none at the address."""

import atexit
import os
import shutil
import subprocess
import urllib.parse
from pathlib import Path

from .service import Service, ServiceError, wait_until_up

_START_S = 120.0
_STOP_S = 20.0
_HERE = ("127.0.0.1", "localhost", "::1")

_started: dict[int, "subprocess.Popen[bytes]"] = {}


def ensure(service: Service, url: str, program: str, data: Path) -> None:
    """Starts `nocturne up` unless a service answers; raises ServiceError."""
    if service.is_up():
        return
    address = urllib.parse.urlsplit(url)
    if address.hostname not in _HERE:
        raise ServiceError(f"no service answers at {url}, and it is not this machine's address")
    found = shutil.which(os.path.expanduser(program))  # noqa: PTH111 - which takes text
    if found is None:
        raise ServiceError(
            f"no service answers at {url}, and there is no program {program!r}; install Nocturne, or "
            "give the program's path in the add-on's preferences"
        )
    port = address.port or 7070
    data.mkdir(parents=True, exist_ok=True)
    with (data / "up.log").open("wb") as log:
        command = [found, "up", "--data", str(data), "--port", str(port)]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log)  # noqa: S603
    _started[process.pid] = process
    wait_until_up(service, lambda: process.poll() is None, _START_S)


def stop_all() -> None:
    """Ends the service if it was started here."""
    for process in _started.values():
        process.terminate()
    for process in _started.values():
        try:
            process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    _started.clear()


atexit.register(stop_all)
