"""The programs of the tracer, as the wheel brings them: from `PROGRAMS`, or by their names."""

import os
import sys
from pathlib import Path
from typing import NoReturn

PROGRAMS = Path(__file__).parent / "bin"


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
