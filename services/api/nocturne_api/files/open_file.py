"""A file opened once and then sent: the sent bytes belong together even when it is replaced meanwhile."""

import asyncio
import os
from collections.abc import AsyncGenerator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from nocturne_api.limits import CHUNK_BYTES


@dataclass(frozen=True)
class OpenFile:
    """An open file, its size, and a tag that changes whenever the content does.

    Close it, or read `chunks` to the end.
    """

    file: BinaryIO
    size_bytes: int
    etag: str

    async def chunks(self, part: range | None = None) -> AsyncGenerator[bytes, None]:
        """The content, or some bytes of it, in pieces of at most CHUNK_BYTES; closes the file."""
        first, end = (part.start, part.stop) if part is not None else (0, self.size_bytes)
        try:
            self.file.seek(first)
            while piece := await asyncio.to_thread(self.file.read, min(CHUNK_BYTES, end - first)):
                first += len(piece)
                yield piece
        finally:
            self.file.close()

    def close(self) -> None:
        """Lets go of the file unread."""
        self.file.close()


async def open_file(path: Path) -> OpenFile | None:
    """Opens a file that is only ever replaced as a whole; None where there is none."""
    return await asyncio.to_thread(_open, path)


def _open(path: Path) -> OpenFile | None:
    try:
        file = path.open("rb")
    except FileNotFoundError:
        return None
    status = os.fstat(file.fileno())
    # Files are replaced by renaming, so a new content is a new inode or a new time.
    return OpenFile(file, status.st_size, f'"{status.st_mtime_ns:x}-{status.st_ino:x}-{status.st_size:x}"')
