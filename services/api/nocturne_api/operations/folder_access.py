"""Calls into the data folder, from the event loop, and the record of those that change something."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import ParamSpec, Self, TypeVar

from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.database import DatabaseUnavailable
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.quotas import NO_QUOTA, Quota

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.errors import FolderSlow, failure_of

_log = logging.getLogger(__name__)

BROKEN_OFF = "BROKEN_OFF"
"""How a call ended whose caller left before its end."""

_P = ParamSpec("_P")
_T = TypeVar("_T")


@dataclass
class Record:
    """What a recorded call was about; the render may be known only in the end."""

    render_id: str


class _Threads:
    """Some threads, and who waits for one; not for long, and not any more when its caller has left."""

    def __init__(self, name: str, number: int) -> None:
        self._pool = ThreadPoolExecutor(number, thread_name_prefix=name)
        self._free = asyncio.Semaphore(number)

    async def run(self, call: Callable[[], _T]) -> _T:
        """Raises FolderSlow where no thread is free for too long."""
        try:
            async with asyncio.timeout(limits.DATABASE_TURN_S):
                await self._free.acquire()
        except TimeoutError:
            raise FolderSlow("the data folder is slow, and others wait for it; try again") from None
        loop = asyncio.get_running_loop()
        running = self._pool.submit(call)
        # When the thread is free, which is later than the end of a call that was cancelled.
        running.add_done_callback(lambda _: loop.call_soon_threadsafe(self._free.release))
        return await asyncio.wrap_future(running)

    def close(self) -> None:
        self._pool.shutdown()


class FolderAccess:
    """A data folder whose database some threads read at once, and one writes.

    Compiling and file reads run elsewhere, never in front of them.
    """

    def __init__(self, folder: DataFolder, quota: Quota = NO_QUOTA) -> None:
        """`quota`: what each owner may have."""
        self.folder = folder
        folder.database.read_beside(limits.DATABASE_LOCK_S)
        self._quota = quota
        self._readers = _Threads("reads", limits.READERS)
        self._writer = _Threads("writes", 1)

    @classmethod
    async def open(cls, path: Path, objects: ObjectStore | None, quota: Quota = NO_QUOTA) -> Self:
        """Opens the data folder at `path`, making it if need be."""
        return cls(await asyncio.to_thread(DataFolder, path, objects), quota)

    @property
    def quota(self) -> Quota:
        """What the caller may have; without authentication there is nobody to share with."""
        return self._quota if CALLER.get().name else NO_QUOTA

    async def close(self) -> None:
        """Lets go of the data folder."""
        for threads in (self._readers, self._writer):
            await asyncio.to_thread(threads.close)
        self.folder.close()

    async def in_database(self, call: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
        """Runs a call that reads."""
        return await self._readers.run(partial(call, *args, **kwargs))

    async def writing(self, call: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
        """Runs a call that writes; one after the other, as SQLite lets them."""
        return await self._writer.run(partial(call, *args, **kwargs))

    @asynccontextmanager
    async def changing(self, what: str, render_id: str, request_id: str = "") -> AsyncIterator[str]:
        """For a call that changes a render, the caller's own unless it may change all; gives the whole id."""
        async with self.recorded(what, render_id, request_id) as record:
            render = await self.in_database(self.folder.renders.find, render_id, CALLER.get().sees)
            record.render_id = render.id
            CALLER.get().need_own(render.owner)
            yield render.id

    @asynccontextmanager
    async def recorded(self, what: str, render_id: str = "", request_id: str = "") -> AsyncIterator[Record]:
        """Keeps a line of a call that changes something, or tried to."""
        record = Record(render_id)
        try:
            yield record
        except asyncio.CancelledError:
            await asyncio.shield(self._keep(record, what, request_id, BROKEN_OFF))
            raise
        except (DatabaseUnavailable, FolderSlow):
            # What could not be written changed nothing, and a line of it could not be written either.
            raise
        except Exception as error:
            await self._keep(record, what, request_id, failure_of(error).kind.reason)
            raise
        await self._keep(record, what, request_id, "done")

    async def _keep(self, record: Record, what: str, request_id: str, outcome: str) -> None:
        """Not having the line is no reason to fail a call that has done its work."""
        who = CALLER.get().name
        try:
            await self.writing(
                self.folder.calls.record,
                who,
                what,
                record.render_id[: limits.RECORDED_CHARACTERS],
                request_id[: limits.RECORDED_CHARACTERS],
                outcome,
                limits.CALLS_RECORDED,
            )
        except (DatabaseUnavailable, FolderSlow) as trouble:
            _log.error("not recorded: %s of %s by %s: %s: %s", what, record.render_id, who, outcome, trouble)
