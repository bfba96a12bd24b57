"""How much memory this process and its children may use: that of the machine, or of the container."""

import os
from contextlib import suppress
from pathlib import Path

_CGROUPS = Path("/sys/fs/cgroup")
_OWN = Path("/proc/self/cgroup")


def memory_bytes(cgroups: Path = _CGROUPS, own: Path = _OWN) -> int:
    """The lowest bound that holds here."""
    bounds = [os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")]
    try:
        lines = own.read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        # Version 2 is "0::/path"; in version 1 each controller has a tree of its own.
        _, controllers, path = line.split(":", 2)
        if not controllers:
            bounds += _bounds(cgroups, path, "memory.max")
        elif "memory" in controllers.split(","):
            bounds += _bounds(cgroups / "memory", path, "memory.limit_in_bytes")
    return min(bounds)


def _bounds(root: Path, path: str, name: str) -> list[int]:
    """Of a group and of all that it is in; a container sees its own as the root."""
    found = []
    place = root / path.strip("/")
    for folder in [place, *place.parents]:
        # There may be none, or "max".
        with suppress(OSError, ValueError):
            found.append(int((folder / name).read_text()))
        if folder == root:
            break
    return found
