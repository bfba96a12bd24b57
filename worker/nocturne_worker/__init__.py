"""The programs of the tracer by their names: as the wheel brings them, or as the checkout has built them."""

import os
import sys
from pathlib import Path
from typing import NoReturn

_HERE = Path(__file__).resolve().parent
_BROUGHT = _HERE / "bin"
PROGRAMS = _BROUGHT if _BROUGHT.is_dir() else _HERE.parents[1] / "build" / "release" / "worker"


def _become(name: str) -> NoReturn:
    os.execv(PROGRAMS / name, [name, *sys.argv[1:]])  # noqa: S606


def worker() -> NoReturn:
    """`nocturne-worker`, in place of this process."""
    _become("nocturne-worker")


def trace() -> NoReturn:
    """`nocturne-trace`, in place of this process."""
    _become("nocturne-trace")


def grid() -> NoReturn:
    """`nocturne-grid`, in place of this process."""
    _become("nocturne-grid")
