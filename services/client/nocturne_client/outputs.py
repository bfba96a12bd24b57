"""Files that commands write: whole or not at all; devices and links stay as they are."""

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from nocturne_client.errors import NocturneClientError

_NEW = 0o644


def check_output(path: Path) -> None:
    """Raise NocturneClientError where a file can't be written, before there is anything to write."""
    try:
        if _is_special(path):
            return
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise NocturneClientError(f"{path} is a folder; expected the name of a file in it")
        if not target.parent.is_dir():
            raise NocturneClientError(f"{target.parent}: no such folder")
        with tempfile.NamedTemporaryFile(dir=target.parent, prefix=".nocturne-"):
            pass
    except OSError as error:
        raise NocturneClientError(f"{path} can't be written: {error.strerror or error}") from error


@contextmanager
def written(path: Path) -> Iterator[IO[bytes]]:
    """A file to write to, which is seen at `path` at the end of `with`, and gone after an error.

    The file behind a link is replaced, and the link stays. A device or a pipe is written to. Raises OSError.
    """
    if _is_special(path):
        with path.open("wb") as file:
            yield file
        return
    target = Path(os.path.realpath(path))
    # Not by nocturne_scene.replacing: the client is installed without the scene language.
    descriptor, name = tempfile.mkstemp(dir=target.parent, prefix=".nocturne-")
    temporary = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as file:
            yield file
        temporary.chmod(stat.S_IMODE(target.stat().st_mode) if target.exists() else _NEW)
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def put(made: Path, path: Path) -> None:
    """Writes to `path` what `made` holds, as `written` does. Raises OSError."""
    with written(path) as file, made.open("rb") as source:
        shutil.copyfileobj(source, file)


def is_standard_output(path: Path) -> bool:
    """Whether text written there goes where this program's lines go."""
    try:
        return os.path.samestat(path.stat(), os.fstat(1))
    except OSError:
        return False


def _is_special(path: Path) -> bool:
    """Whether something is there that is neither a file nor a folder: a device, a pipe, a socket."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))
