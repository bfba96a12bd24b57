"""Finds the programs that this package starts."""

import os
import shutil
from pathlib import Path

from nocturne_client.errors import NocturneClientError

# services/client/nocturne_client/local/programs.py, four folders down from the checkout
CHECKOUT = Path(__file__).resolve().parents[4]
_BUILT = CHECKOUT / "build" / "release" / "worker"

HOW_TO_GET = {
    "nocturne-worker": "build it with `make build`, or say where it is with NOCTURNE_BIN=FOLDER",
    "nocturne-trace": "build it with `make build`, or say where it is with NOCTURNE_BIN=FOLDER",
    "nocturne-grid": "build it with `make build`, or say where it is with NOCTURNE_BIN=FOLDER",
    "redis-server": "install it with `sudo apt-get install redis-server`",
}


def find_program(name: str) -> Path | None:
    """The program, from the folder NOCTURNE_BIN, this checkout's build, or PATH; None if in none of them."""
    folders = [os.environ.get("NOCTURNE_BIN", ""), str(_BUILT), os.environ.get("PATH", os.defpath)]
    found = shutil.which(name, path=os.pathsep.join(folder for folder in folders if folder))
    return Path(found) if found else None


def need_program(name: str) -> Path:
    """The program; raises NocturneClientError that says how to get it."""
    found = find_program(name)
    if found is None:
        raise NocturneClientError(f"{name} is missing: {HOW_TO_GET[name]}")
    return found
