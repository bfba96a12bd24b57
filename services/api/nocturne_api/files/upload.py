"""Writing one uploaded file, off the event loop."""

import asyncio
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack

from nocturne_scene.blobs import BlobStore

from nocturne_api.limits import WRITE_BYTES


async def store(blobs: BlobStore, sha256: str, size_bytes: int, pieces: AsyncIterator[bytes]) -> None:
    """Stores `pieces` as the blob `sha256`.

    All steps run in one thread, in order, also when the caller goes away in mid-write. Whatever goes wrong
    (digest, size, a lost connection) is raised and leaves nothing behind.
    """
    loop = asyncio.get_running_loop()
    with ThreadPoolExecutor(max_workers=1) as thread:
        stack = ExitStack()
        writer = await loop.run_in_executor(thread, stack.enter_context, blobs.writer(sha256, size_bytes))
        try:
            async for piece in _gathered(pieces):
                await loop.run_in_executor(thread, writer.write, piece)
        except BaseException as error:
            await loop.run_in_executor(thread, stack.__exit__, type(error), error, error.__traceback__)
            raise
        await loop.run_in_executor(thread, stack.close)


async def _gathered(pieces: AsyncIterator[bytes]) -> AsyncIterator[bytes]:
    """The same bytes in pieces of at least WRITE_BYTES, but for the last."""
    held = bytearray()
    async for piece in pieces:
        held += piece
        if len(held) >= WRITE_BYTES:
            yield bytes(held)
            held.clear()
    if held:
        yield bytes(held)
