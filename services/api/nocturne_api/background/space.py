"""How large the data folder is, measured now and then; bounds it, and warns before."""

import asyncio
import logging
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from nocturne_api import limits
from nocturne_api.background.task import Background
from nocturne_api.errors import FolderFull

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class StorageLimits:
    """Bounds of the data folder: how long unused files stay, and how large it may be."""

    unused_seconds: float = limits.UNUSED_SECONDS
    """How long files stay that no render uses."""
    data_bytes: float = 0.0
    """Size of the data folder at which it takes no more; 0: none."""


class DiskQuota(Background):
    """One for each API process. Files being stored, or stored since the last look, count as there."""

    def __init__(self, root: Path, most_bytes: float) -> None:
        """`most_bytes`: size at which nothing more is admitted; 0: none."""
        self._root = root
        self._most_bytes = most_bytes
        self._measured = _size(root)
        self._coming = self._came = 0
        self._warned = False
        self._warn()

    def figures(self) -> dict[str, float]:
        """For monitoring."""
        free = shutil.disk_usage(self._root).free
        return {"data_bytes": self._bytes, "data_bytes_bound": self._most_bytes, "disk_free_bytes": free}

    def check(self, more_bytes: int = 0) -> None:
        """Raises FolderFull where there is no room, or none for so many bytes."""
        if self._most_bytes and self._bytes + more_bytes >= self._most_bytes:
            raise FolderFull(
                f"{self._has()}; delete renders, or have who runs the service raise --data-bytes"
            )

    @contextmanager
    def taken(self, more_bytes: int) -> Iterator[None]:
        """Counts bytes that are being stored, unless that fails; raises FolderFull."""
        self.check(more_bytes)
        self._coming += more_bytes
        try:
            yield
            self._came += more_bytes
        finally:
            self._coming -= more_bytes

    @property
    def _bytes(self) -> int:
        return self._measured + self._coming + self._came

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(limits.MEASURE_S)
            self._came = 0
            self._measured = await asyncio.to_thread(_size, self._root)
            self._warn()

    def _warn(self) -> None:
        """Once, and again when it was better in between."""
        why = self._trouble()
        if why and not self._warned:
            _log.warning("%s; delete renders, or make room", why)
        self._warned = bool(why)

    def _has(self) -> str:
        has, may = f"{self._bytes:,.0f}", f"{self._most_bytes:,.0f}"
        return f"the data folder has {has} bytes of the {may} that it may have"

    def _trouble(self) -> str:
        if self._most_bytes and self._bytes >= limits.NEARLY_FULL * self._most_bytes:
            return self._has()
        disk = shutil.disk_usage(self._root)
        if disk.free < (1.0 - limits.NEARLY_FULL) * disk.total:
            return f"the disk of the data folder has only {disk.free:,} bytes free of {disk.total:,}"
        return ""


def _size(root: Path) -> int:
    """Bytes of all files, as they count on the disk."""
    found = 0
    for folder, _, names in os.walk(root):
        for name in names:
            try:
                found += 512 * os.lstat(Path(folder) / name).st_blocks
            except OSError:
                continue  # It went meanwhile.
    return found
