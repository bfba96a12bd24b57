"""Calls into the data folder, from the event loop, and the record of those that change something."""

import asyncio
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import ParamSpec, Self, TypeVar

from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.quotas import NO_QUOTA, Quota

from nocturne_api import limits
from nocturne_api.access import CALLER
from nocturne_api.errors import failure_of

_P = ParamSpec("_P")
_T = TypeVar("_T")


@dataclass
class Record:
    """What a recorded call was about; the render may be known only in the end."""

    render_id: str


class FolderAccess:
    """A data folder whose database is used by one thread, so that calls follow each other and block no one.

    Compiling and file reads run elsewhere, never in front of them.
    """

    def __init__(self, folder: DataFolder, database: ThreadPoolExecutor, quota: Quota = NO_QUOTA) -> None:
        """`quota`: what each owner may have."""
        self.folder = folder
        self._quota = quota
        self._database = database

    @classmethod
    async def open(cls, path: Path, objects: ObjectStore | None, quota: Quota = NO_QUOTA) -> Self:
        """Opens the data folder at `path`, making it if need be."""
        database = ThreadPoolExecutor(max_workers=1, thread_name_prefix="data-folder")
        folder = await asyncio.get_running_loop().run_in_executor(database, DataFolder, path, objects)
        return cls(folder, database, quota)

    @property
    def quota(self) -> Quota:
        """What the caller may have; without authentication there is nobody to share with."""
        return self._quota if CALLER.get().name else NO_QUOTA

    async def close(self) -> None:
        """Lets go of the data folder."""
        await self.in_database(self.folder.close)
        self._database.shutdown()

    async def in_database(self, call: Callable[_P, _T], *args: _P.args, **kwargs: _P.kwargs) -> _T:
        """Runs a call in the thread of the database."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._database, partial(call, *args, **kwargs))

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
        outcome = "done"
        try:
            yield record
        except Exception as error:
            outcome = failure_of(error).kind.reason
            raise
        finally:
            await self.in_database(
                self.folder.calls.record,
                CALLER.get().name,
                what,
                record.render_id[: limits.RECORDED_CHARACTERS],
                request_id[: limits.RECORDED_CHARACTERS],
                outcome,
                limits.CALLS_RECORDED,
            )
