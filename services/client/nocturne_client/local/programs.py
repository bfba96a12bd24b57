"""Finds the programs that this package starts."""

from pathlib import Path

from nocturne_scene.programs import CHECKOUT, find_program

from nocturne_client.errors import NocturneClientError

__all__ = ["CHECKOUT", "HOW_TO_GET", "find_program", "need_program"]

HOW_TO_GET = {
    "nocturne-worker": "build it with `make build`, or say where it is with NOCTURNE_BIN=FOLDER",
    "nocturne-trace": "build it with `make build`, or say where it is with NOCTURNE_BIN=FOLDER",
    "nocturne-grid": "build it with `make build`, or say where it is with NOCTURNE_BIN=FOLDER",
    "redis-server": "install it with `sudo apt-get install redis-server`",
}


def need_program(name: str) -> Path:
    """The program; raises NocturneClientError that says how to get it."""
    found = find_program(name)
    if found is None:
        raise NocturneClientError(f"{name} is missing: {HOW_TO_GET[name]}")
    return found
