"""Logs of `nocturne up`: those of the last starts are kept, and one that grows large is begun anew."""

import shutil
from pathlib import Path

KEPT = 4
"""Besides the one that is written: of earlier starts, or of before."""
MAX_BYTES = 64 * 2**20


def begin(log: Path) -> None:
    """Keeps what an earlier service wrote; what went wrong with that is asked after the next start."""
    if log.exists() and log.stat().st_size:
        _make_way(log)
        log.replace(_kept(log, 1))


def bound(log: Path, max_bytes: int | None = None) -> None:
    """Keeps a copy of one that has grown larger (than MAX_BYTES), and empties it: its writers append, and go
    on in it."""
    if log.exists() and log.stat().st_size > (MAX_BYTES if max_bytes is None else max_bytes):
        _make_way(log)
        shutil.copyfile(log, _kept(log, 1))
        with log.open("r+b") as file:
            file.truncate()


def _make_way(log: Path) -> None:
    for number in range(KEPT - 1, 0, -1):
        if _kept(log, number).exists():
            _kept(log, number).replace(_kept(log, number + 1))


def _kept(log: Path, number: int) -> Path:
    return log.with_name(f"{log.name}.{number}")
