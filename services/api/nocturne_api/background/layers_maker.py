"""Makes the layers of renders after they were queued, so that nobody waits for them before the first tile."""

import asyncio
import json
import logging
import threading
from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial
from typing import Any

from nocturne_coordinator.errors import FilesGone, ObjectStoreUnavailable
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.layers import LayersDue
from nocturne_scene.document.read import check_document
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film

from nocturne_api.background.task import Background
from nocturne_api.compiling.pool import Abandoned, CompileLimits, layers_in_child
from nocturne_api.limits import COMPILES_AT_ONCE

_log = logging.getLogger(__name__)

_LOOK_S = 2.0
_AGAIN_S = 30.0


class LayersMaker(Background):
    """One for each API process; two may make the same file, which is one file."""

    def __init__(
        self, folder: DataFolder, in_database: Callable[..., Awaitable[Any]], compile_limits: CompileLimits
    ) -> None:
        """`in_database` runs a call where the data folder's calls run."""
        self._folder = folder
        self._in_database = in_database
        self._compile_limits = compile_limits
        self._wanted = asyncio.Event()
        self._closing = threading.Event()
        self._owners: set[str] = set()

    def wake(self) -> None:
        """A render was queued that has layers."""
        self._wanted.set()

    async def close(self) -> None:
        """What is being made is left to the next process."""
        self._closing.set()
        await super().close()

    async def _run(self) -> None:
        async with asyncio.TaskGroup() as group:
            while True:
                await self._begin(group)
                self._wanted.clear()
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._wanted.wait(), _LOOK_S)

    async def _begin(self, group: asyncio.TaskGroup) -> None:
        """The oldest of each owner that has none in hand, as far as there is room."""
        try:
            due = await self._in_database(self._folder.layers.due)
        except Exception:
            _log.exception("layers are made later")
            return
        for render_id, owner in due:
            if owner not in self._owners and len(self._owners) < COMPILES_AT_ONCE:
                self._owners.add(owner)
                group.create_task(self._take(render_id, owner))

    async def _take(self, render_id: str, owner: str) -> None:
        try:
            found = await self._in_database(self._folder.layers.get_due, render_id)
            if found is not None:
                await self._make(found)
        except (ObjectStoreUnavailable, FilesGone, OSError) as error:
            _log.warning("render=%s: its layers are made later: %s", render_id, error)
            await asyncio.sleep(_AGAIN_S)
        except Abandoned:
            return
        except Exception:
            _log.exception("render=%s: its layers are made later", render_id)
            await asyncio.sleep(_AGAIN_S)
        finally:
            self._owners.discard(owner)
            self._wanted.set()

    async def _make(self, due: LayersDue) -> None:
        layers = self._folder.layers
        try:
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
