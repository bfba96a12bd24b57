"""A data folder is its owner's alone: in it are secrets, keys of machines, everybody's images."""

import logging
import os
import pwd
import stat
from contextlib import suppress
from pathlib import Path

from nocturne_coordinator.errors import UnusableFolder

_log = logging.getLogger(__name__)

_OTHERS = stat.S_IRWXG | stat.S_IRWXO


def make_private(path: Path) -> None:
    """Keeps other users out of an existing folder and of all files that this process writes from here on.

    Raises UnusableFolder for the folder of another user, and where its rights can't be changed.
    """
    os.umask(_OTHERS)
    me, status = os.geteuid(), path.stat()
    if me not in (0, status.st_uid):
        raise UnusableFolder(
            f"{path} belongs to {_name(status.st_uid)}, and this process runs as {_name(me)}; start it as "
            f"{_name(status.st_uid)}, or give the folder away: chown -R {_name(me)} {path}"
        )
    for each in (path, *_files_in(path)):
        _close(each)
    if path.stat().st_mode & _OTHERS:
        raise UnusableFolder(
            f"{path} has secrets in it, and its file system lets others in whatever chmod says (mode "
            f"{stat.filemode(path.stat().st_mode)}); mount that with rights for its owner alone, or choose "
            "another folder"
        )
    if status.st_mode & _OTHERS:
        mode = stat.filemode(status.st_mode)
        _log.warning("%s could be read by others (mode %s); now it is closed to them", path, mode)


def _files_in(path: Path) -> list[Path]:
    return [each for each in path.iterdir() if each.is_file() and not each.is_symlink()]


def _close(path: Path) -> None:
    with suppress(OSError):
        mode = stat.S_IMODE(path.stat().st_mode)
        if mode & _OTHERS:
            path.chmod(mode & stat.S_IRWXU)


def _name(user: int) -> str:
    try:
        return pwd.getpwuid(user).pw_name
    except KeyError:
        return f"user {user}"
