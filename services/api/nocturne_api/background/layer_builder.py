"""Makes the layers of renders after they were queued, so that nobody waits for them before the first tile."""

import asyncio
import json
import logging
import threading
from collections.abc import Awaitable, Callable, Iterable
from contextlib import suppress
from functools import partial
from typing import Any

from nocturne_coordinator.errors import BlobsMissing, ObjectStoreUnavailable
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.layers import LayersDue
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film

from nocturne_api.background.space import DiskQuota
from nocturne_api.background.task import Background
from nocturne_api.compiling.pool import Abandoned, CompileLimits, layers_in_child
from nocturne_api.errors import FolderFull
from nocturne_api.limits import COMPILES_AT_ONCE

_log = logging.getLogger(__name__)

_LOOK_S = 2.0
_AGAIN_S = 30.0


class LayerBuilder(Background):
    """One for each API process; two may make the same file, which is one file."""

    def __init__(
        self,
        folder: DataFolder,
        in_database: Callable[..., Awaitable[Any]],
        compile_limits: CompileLimits,
        space: DiskQuota,
    ) -> None:
        """`in_database` runs a call where the data folder's calls run."""
        self._folder = folder
        self._in_database = in_database
        self._compile_limits = compile_limits
        self._space = space
        self._wanted = asyncio.Event()
        self._closing = threading.Event()
        self._at_work = 0
        self._owners: set[str] = set()
        """Whose layers are made, or failed a moment ago."""
        self._turns: dict[str, int] = {}
        """When each owner's were last begun, of those who have more to be made."""
        self._begun = 0

    def wake(self) -> None:
        """A render was queued that has layers."""
        self._wanted.set()

    async def close(self) -> None:
        """Layers that are being made are left to the next process."""
        self._closing.set()
        await super().close()

    async def _run(self) -> None:
        async with asyncio.TaskGroup() as group:
            while True:
                await self._begin(group)
                self._wanted.clear()
                # Not by `wait_for`, which may forget that it was cancelled if the awaited result comes then.
                with suppress(TimeoutError):
                    async with asyncio.timeout(_LOOK_S):
                        await self._wanted.wait()

    async def _begin(self, group: asyncio.TaskGroup) -> None:
        """The oldest of each owner that has none in hand, as far as there is room; in turn, so that whoever
        has many keeps no other owner's waiting."""
        try:
            due = await self._in_database(self._folder.layers.due)
        except Exception:
            _log.exception("layers are made later")
            return
        for render_id, owner in self._in_turn(due):
            if owner not in self._owners and self._at_work < COMPILES_AT_ONCE:
                self._at_work += 1
                self._begun += 1
                self._turns[owner] = self._begun
                self._owners.add(owner)
                group.create_task(self._take(render_id, owner))

    def _in_turn(self, due: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
        """Those first whose owner's turn was the longest ago; forgets who has no more."""
        found = list(due)
        self._turns = {owner: self._turns[owner] for _, owner in found if owner in self._turns}
        return sorted(found, key=lambda each: self._turns.get(each[1], 0))

    async def _take(self, render_id: str, owner: str) -> None:
        again_s = 0.0
        try:
            found = await self._in_database(self._folder.layers.get_due, render_id)
            if found is not None:
                await self._make(found)
        except (ObjectStoreUnavailable, BlobsMissing, FolderFull, OSError) as error:
            _log.warning("render=%s: its layers are made later: %s", render_id, error)
            again_s = _AGAIN_S
        except Abandoned:
            return
        except Exception:
            _log.exception("render=%s: its layers are made later", render_id)
            again_s = _AGAIN_S
        # The place is another owner's meanwhile.
        self._at_work -= 1
        self._wanted.set()
        await asyncio.sleep(again_s)
        self._owners.discard(owner)
        self._wanted.set()

    async def _make(self, due: LayersDue) -> None:
        layers = self._folder.layers
        try:
            with self._space.taken(due.size_bytes):
                sha256 = await asyncio.to_thread(self._made, due)
        except InputError as error:
            _log.error("render=%s has no layers: %s", due.render_id, error)
            await self._in_database(layers.give_up, due.render_id, f"It has no layers: {error}")
        else:
            await self._in_database(layers.made, due.render_id, sha256)

    def _made(self, due: LayersDue) -> str:
        """Its SHA-256."""
        blobs = self._folder.blobs
        document = check_document(json.loads(due.scene_document))
        film = Film(due.width, due.height, due.samples)
        make = partial(layers_in_child, document, blobs, self._compile_limits, film, due.layers)
        sha256 = make(self._closing)
        # Here too, not in the object store only.
        blobs.path(sha256)
        return sha256
