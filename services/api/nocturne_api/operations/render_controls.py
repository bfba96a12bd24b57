"""Changing renders: cancel, pause, resume, extend, priority, tags, and the region that goes first."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.dispatch.stopping import changed_conditions, ends_at_once
from nocturne_coordinator.store.rows import RenderRow
from nocturne_scene.errors import InputError

from nocturne_api.models.renders import Render
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.submission import raise_if, request_id_problems


class RenderControls:
    """Actions of a render's owner. Each call names the wanted state, so repeating it is safe."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access
        self._folder = access.folder

    async def cancel(self, render_id: str, request_id: str = "") -> Render:
        """Stops a render for good; merged samples stay. Raises NotFound."""
        async with self._access.changing("cancel", render_id, request_id) as whole_id:
            if request_id:
                raise_if(request_id_problems(request_id))
            return Render.of(await self._access.writing(self._folder.requests.cancel, whole_id))

    async def pause(self, render_id: str) -> Render:
        """Stops work on a render until it is resumed; merged samples stay. Raises NotFound, WrongState."""
        return await self._change("pause", render_id, self._folder.requests.pause)

    async def resume(self, render_id: str) -> Render:
        """Goes on with a paused render, or traces the failed tiles of a degraded one again.

        Raises NotFound, WrongState.
        """
        return await self._change("resume", render_id, self._folder.requests.resume)

    async def set_priority(self, render_id: str, priority: int) -> Render:
        """The render's weight among those of its owner, 1 to 1000. Raises NotFound, InputError."""
        return await self._change(
            "priority", render_id, lambda each: self._folder.requests.set_priority(each, priority)
        )

    async def set_tags(self, render_id: str, tags: Sequence[str]) -> Render:
        """Words to sort renders by, instead of those that it has. Raises NotFound, InputError."""
        return await self._change("tags", render_id, lambda each: self._folder.requests.set_tags(each, tags))

    async def look_first(self, render_id: str, region: Region | None) -> Render:
        """Which part of the film gets its samples first, None for all alike; the image stays the same bits.

        Raises NotFound, InputError.
        """
        return await self._change(
            "look first", render_id, lambda each: self._folder.requests.look_first(each, region)
        )

    async def extend(
        self, render_id: str, samples: int, stop: Mapping[str, Any], drop: Sequence[str] = ()
    ) -> Render:
        """More samples, 0 for as many as before; conditions that are named change or are dropped.

        Raises NotFound, InputError, WrongState, QuotaUsedUp.
        """
        async with self._access.changing("extend", render_id) as whole_id:
            before = await self._access.in_database(self._folder.renders.get, whole_id)
            now = datetime.now(UTC)
            changed = changed_conditions(before.stop, stop, drop, now)
            if samples > before.samples:
                # A manifest says which samples there are: with more of them there is another.
                changed = replace(changed, tile_samples=())
            wanted = samples or before.samples
            if (wanted, changed) != (before.samples, before.stop) and before.state.ended:
                met = ends_at_once(changed, now.timestamp(), before.ran_seconds, before.cpu_seconds)
                if met:
                    message = f"it would end at once, by {met}; give a new value, or drop the condition"
                    raise InputError.at("$.stop", message)
            return Render.of(
                await self._access.writing(
                    self._folder.requests.extend, whole_id, wanted, changed, self._access.quota
                )
            )

    async def _change(self, what: str, render_id: str, change: Callable[[str], RenderRow]) -> Render:
        async with self._access.changing(what, render_id) as whole_id:
            return Render.of(await self._access.writing(change, whole_id))
