"""Finds the programs that this package starts."""

from pathlib import Path

from nocturne_scene.programs import CHECKOUT, find_program

from nocturne_client.errors import NocturneClientError

__all__ = ["CHECKOUT", "HOW_TO_GET", "find_program", "need_program"]

_OURS = "install the package nocturne-worker, or say where it is with NOCTURNE_BIN=FOLDER"
HOW_TO_GET = {
    "nocturne-worker": _OURS,
    "nocturne-trace": _OURS,
    "nocturne-grid": _OURS,
    "redis-server": "install the package nocturne-worker, or it with `sudo apt-get install redis-server`",
}


def need_program(name: str) -> Path:
    """The program; raises NocturneClientError that says how to get it."""
    found = find_program(name)
    if found is None:
        raise NocturneClientError(f"{name} is missing: {HOW_TO_GET[name]}")
    return found
