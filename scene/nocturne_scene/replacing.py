"""Write, then rename: a file that others read is the old one or the new one, never a part."""

import os
import secrets
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path

UNFINISHED = ".unfinished-"
"""Beginning of the names of files that are being written; those a crash leaves behind may be removed."""


def sync(path: Path) -> None:
    """What a file holds, or the names in a folder, survives a power cut from here on."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def replacing(
    path: Path,
    durable: bool = False,
    folder: Path | None = None,
    within: AbstractContextManager[object] | None = None,
) -> Iterator[Path]:
    """An empty file to write to, which becomes `path` at the end of `with`, and is gone after an error.

    `durable`: its content is on the disk before it is seen, and its name at the end. It lies in `folder`, of
    the same file system; without one, next to `path`. The renaming alone happens inside `within`, which may
    refuse it by an error.
    """
    unfinished = (folder or path.parent) / f"{UNFINISHED}{secrets.token_hex(8)}{path.suffix}"
    # With the rights that the umask gives; a file of mkstemp would be its owner's alone.
    unfinished.touch(exist_ok=False)
    try:
        yield unfinished
        if durable:
            sync(unfinished)
        with within or nullcontext():
            unfinished.replace(path)
        if durable:
            sync(path.parent)
    finally:
        unfinished.unlink(missing_ok=True)
