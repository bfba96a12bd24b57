"""Streams of render states: one render to its end, some of them, or the newest.

Each is a context: what refuses a stream is raised when it is entered, before the first byte of an answer.
"""

from collections.abc import AsyncIterator, Set
from contextlib import asynccontextmanager

from nocturne_scene.errors import NotFound

from nocturne_api.access import CALLER
from nocturne_api.models.renders import Render
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders
from nocturne_api.operations.watchers import Watchers, states

States = AsyncIterator[Render]


class RenderStreams:
    """States of renders, now and after every change. A slow reader gets the newest state, never a backlog.

    All raise Overloaded; a stream whose token is revoked raises Unauthenticated within a second.
    """

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._renders = renders
        self._watchers = Watchers(_Folder(access, renders))

    async def close(self) -> None:
        """Ends all streams after the states at hand."""
        await self._watchers.close()

    @asynccontextmanager
    async def one(self, render_id: str, last_sequence: int = -1) -> AsyncIterator[States]:
        """One render until it has ended, without states up to `last_sequence`. Raises NotFound."""
        whole_id = (await self._renders.get(render_id)).id
        with self._watchers.watching(frozenset({whole_id}), CALLER.get()) as watcher:
            watcher.already_has(whole_id, last_sequence)
            render = await self._renders.get(whole_id)
            watcher.offer(render)
            if render.has_ended and render.sequence <= last_sequence:
                watcher.close()
            yield states(watcher, to_the_end=True)

    @asynccontextmanager
    async def some(self, render_ids: frozenset[str]) -> AsyncIterator[States]:
        """These renders, also after their ends. Raises NotFound."""
        whole_ids = frozenset([(await self._renders.get(render_id)).id for render_id in render_ids])
        with self._watchers.watching(whole_ids, CALLER.get()) as watcher:
            for render_id in sorted(whole_ids):
                watcher.offer(await self._renders.get(render_id))
            yield states(watcher)

    @asynccontextmanager
    async def newest(self) -> AsyncIterator[States]:
        """The newest page of renders that the caller may see, oldest of them first, then each after every
        change."""
        caller = CALLER.get()
        caller.need("read")
        with self._watchers.watching(None, caller) as watcher:
            for render in reversed(await self._renders.newest(caller.sees)):
                watcher.offer(render)
            yield states(watcher)


class _Folder:
    """The data folder as watchers see it; who may see which renders was decided when a stream began."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._access = access
        self._renders = renders

    async def change_counter(self) -> int:
        return await self._access.in_database(self._access.folder.change_counter)

    async def get(self, render_id: str) -> Render | None:
        try:
            return Render.of(await self._access.in_database(self._access.folder.renders.get, render_id))
        except NotFound:
            return None

    async def newest(self, owner: str | None) -> list[Render]:
        return [*await self._renders.newest(owner)]

    async def revoked(self, names: Set[str]) -> Set[str]:
        return await self._access.in_database(self._access.folder.tokens.revoked, names)
