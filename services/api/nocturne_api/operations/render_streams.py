"""Streams of render states: one render to its end, some of them, or the newest."""

from collections.abc import AsyncGenerator

from nocturne_coordinator.limits import MAX_PAGE
from nocturne_scene.errors import NotFound

from nocturne_api.access import CALLER
from nocturne_api.models.renders import Render
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders
from nocturne_api.operations.watchers import Watchers, states


class RenderStreams:
    """States of renders, now and after every change. A slow reader gets the newest state, never a backlog."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._renders = renders
        self._watchers = Watchers(
            lambda: access.in_database(access.folder.change_counter), self._find, self._newest
        )

    async def close(self) -> None:
        """Ends all streams after the states at hand."""
        await self._watchers.close()

    async def one(self, render_id: str, last_sequence: int = -1) -> AsyncGenerator[Render, None]:
        """One render until it has ended, without states up to `last_sequence`. Raises NotFound."""
        whole_id = (await self._renders.get(render_id)).id
        with self._watchers.watching(frozenset({whole_id})) as watcher:
            watcher.already_has(whole_id, last_sequence)
            render = await self._renders.get(whole_id)
            watcher.offer(render)
            if render.has_ended and render.sequence <= last_sequence:
                return
            async for state in states(watcher, to_the_end=True):
                yield state

    async def some(self, render_ids: frozenset[str]) -> AsyncGenerator[Render, None]:
        """These renders, also after their ends. Raises NotFound."""
        whole_ids = frozenset([(await self._renders.get(render_id)).id for render_id in render_ids])
        with self._watchers.watching(whole_ids) as watcher:
            for render_id in sorted(whole_ids):
                watcher.offer(await self._renders.get(render_id))
            async for state in states(watcher):
                yield state

    async def newest(self) -> AsyncGenerator[Render, None]:
        """The newest page of renders, oldest of them first, then each after every change."""
        CALLER.get().need("read")
        with self._watchers.watching(None) as watcher:
            for render in reversed(await self._newest()):
                watcher.offer(render)
            async for state in states(watcher):
                yield state

    async def _find(self, render_id: str) -> Render | None:
        try:
            return await self._renders.get(render_id)
        except NotFound:
            return None

    async def _newest(self) -> list[Render]:
        return (await self._renders.list(MAX_PAGE)).renders
