"""Assets: files by content."""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path

from nocturne_scene.blobs import check_size
from nocturne_scene.errors import InputError, NotFound

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.background.space import DiskQuota
from nocturne_api.errors import Overloaded, RateLimited
from nocturne_api.files import upload
from nocturne_api.files.open_file import OpenFile, open_file
from nocturne_api.models.assets import Asset, BatchMissingResponse
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.submission import digest_problems, raise_if


class Assets:
    """The files of one data folder, by SHA-256."""

    def __init__(self, access: FolderAccess, space: DiskQuota) -> None:
        self._access = access
        self._space = space
        self._blobs = access.folder.blobs
        self._running: Counter[str] = Counter()

    async def missing(self, digests: list[str]) -> BatchMissingResponse:
        """Which of these files are not stored yet, in the order asked, each once. Raises InputError."""
        CALLER.get().need("submit")
        if len(digests) > limits.DIGESTS_PER_REQUEST:
            message = f"{len(digests)} digests; at most {limits.DIGESTS_PER_REQUEST} in one request"
            raise InputError.at("$.sha256", message)
        raise_if(
            problem
            for index, digest in enumerate(digests)
            for problem in digest_problems(digest, f"$.sha256[{index}]")
        )
        return BatchMissingResponse(
            sha256=await asyncio.to_thread(self._missing, list(dict.fromkeys(digests)))
        )

    def _missing(self, digests: list[str]) -> list[str]:
        for digest in digests:
            self._blobs.touch(digest)
        return self._blobs.missing(digests)

    async def store(self, sha256: str, size_bytes: int, pieces: AsyncIterator[bytes]) -> Asset:
        """Stores one file under its digest; InputError, and nothing left, where size or digest differ.

        QuotaUsedUp or FolderFull, before the first byte, where the caller or all would have too much;
        RateLimited or Overloaded where it sends, or all send, too many at once."""
        async with self._access.recorded(f"upload {sha256[: limits.RECORDED_CHARACTERS]}"):
            CALLER.get().need("submit")
            raise_if(digest_problems(sha256, "sha256"))
            check_size(size_bytes)
            if await asyncio.to_thread(self._has, sha256):
                async for _ in pieces:  # Read to the end, so that the sender is not cut off in mid-write.
                    pass
            else:
                with self._space.taken(size_bytes):
                    async with self._counted(sha256, size_bytes):
                        await upload.store(self._blobs, sha256, size_bytes, pieces)
            return await self._stored(sha256)

    def _has(self, sha256: str) -> bool:
        self._blobs.touch(sha256)
        return self._blobs.has(sha256)

    @asynccontextmanager
    async def _counted(self, sha256: str, size_bytes: int) -> AsyncIterator[None]:
        """Bounds how many are in progress."""
        owner = CALLER.get().name
        if self._running.total() >= limits.UPLOADS_AT_ONCE:
            raise Overloaded(f"{limits.UPLOADS_AT_ONCE} files are being uploaded; try again in a moment.")
        if owner and self._running[owner] >= limits.UPLOADS_OF_OWNER:
            raise RateLimited(
                f"{self._running[owner]} files of {owner} are being uploaded; send fewer at once"
            )
        self._running[owner] += 1
        try:
            async with self._charged(owner, sha256, size_bytes):
                yield
        finally:
            self._running[owner] -= 1
            self._running += Counter()

    @asynccontextmanager
    async def _charged(self, owner: str, sha256: str, size_bytes: int) -> AsyncIterator[None]:
        """Counts the file as the caller's from its first byte, so that uploads side by side pass no quota."""
        uploads = self._access.folder.uploads
        begin = (owner, sha256, size_bytes, self._access.quota)
        is_new = await self._access.writing(uploads.begin, *begin)
        try:
            yield
        except BaseException:
            if is_new:
                await asyncio.shield(self._access.writing(uploads.take_back, owner, sha256))
            raise

    async def adopt(self, files: Mapping[str, Path]) -> None:
        """Stores files that were made here for the caller, by digest; QuotaUsedUp, FolderFull."""
        for sha256, file in files.items():
            if await asyncio.to_thread(self._has, sha256):
                continue
            size = (await asyncio.to_thread(file.stat)).st_size
            with self._space.taken(size):
                async with self._charged(CALLER.get().name, sha256, size):
                    await asyncio.to_thread(self._blobs.put_file, sha256, file)

    async def get(self, sha256: str) -> Asset:
        """One stored file; raises NotFound."""
        _check(sha256)
        return await self._stored(sha256)

    async def _stored(self, sha256: str) -> Asset:
        size = await asyncio.to_thread(self._blobs.size, sha256)
        return Asset(sha256=sha256, size_bytes=size)

    async def open(self, sha256: str) -> OpenFile:
        """The bytes of an asset, a compiled scene or a packed mesh; raises NotFound."""
        _check(sha256)
        opened = await open_file(await asyncio.to_thread(self._blobs.path, sha256))
        if opened is None:
            raise NotFound(f"no asset {sha256}")
        return opened


def _check(sha256: str) -> None:
    """Callers that read, and workers, may have any file whose digest they know."""
    if "read" not in CALLER.get().scopes:
        CALLER.get().need("worker")
    raise_if(digest_problems(sha256, "sha256"))
