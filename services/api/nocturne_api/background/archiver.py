"""Copies finished images into the object store, and gets back those that are missing here."""

import asyncio
import hashlib
import logging
import os
import tempfile
from collections.abc import Awaitable, Callable
from contextlib import suppress
from pathlib import Path

from nocturne_coordinator.errors import ObjectStoreUnavailable
from nocturne_coordinator.store.archive import Archived
from nocturne_coordinator.store.data_folder import DataFolder, make_folders
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_scene.errors import NotFound

from nocturne_api.background.task import Background

_log = logging.getLogger(__name__)

_LOOK_S = 2.0
# Longer than copying takes; when it is over, another process, or this one, tries again.
_LEASE_S = 600.0


class Archiver(Background):
    """One for each API process with an object store; they share the work."""

    def __init__(
        self, folder: DataFolder, in_database: Callable[..., Awaitable[object]], objects: ObjectStore
    ) -> None:
        """`in_database` runs a call where the data folder's calls run."""
        self._folder = folder
        self._in_database = in_database
        self._objects = objects

    async def fetch(self, render_id: str, file: Path) -> None:
        """Gets a file back that is missing here, if it is in the object store. Raises
        ObjectStoreUnavailable."""
        found = await self._in_database(self._folder.archive.file, render_id, file.name)
        if isinstance(found, Archived):
            await asyncio.to_thread(make_folders, file)
            name = found.name(render_id, file.name)
            with suppress(NotFound):
                await asyncio.to_thread(self._objects.get, name, file, found.sha256, found.size_bytes)

    async def _run(self) -> None:
        while True:
            try:
                while render_id := await self._in_database(self._folder.archive.take_due, _LEASE_S):
                    await self._copy(str(render_id))
            except (ObjectStoreUnavailable, OSError) as error:
                _log.warning("images are copied later: %s", error)
            except Exception:
                _log.exception("images are copied later")
            await asyncio.sleep(_LOOK_S)

    async def _copy(self, render_id: str) -> None:
        files = {}
        try:
            paths = (self._folder.image_path(render_id), self._folder.preview_path(render_id))
        except NotFound:
            return
        for path in paths:
            archived = await asyncio.to_thread(self._put, render_id, path)
            if archived is not None:
                files[path.name] = archived
        if not await self._in_database(self._folder.archive.copied, render_id, files):
            await asyncio.to_thread(self._objects.delete_all, f"images/{render_id}")
            return
        _log.info("render=%s: %d images are in the object store", render_id, len(files))

    def _put(self, render_id: str, path: Path) -> Archived | None:
        """Digest of the copied file; None where there is no such file."""
        with tempfile.TemporaryDirectory(dir=self._folder.root, prefix=".archive-") as folder:
            # The file that is there now, even if it is replaced in the meantime.
            same = Path(folder) / path.name
            try:
                os.link(path, same)
            except FileNotFoundError:
                return None
            with same.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256")
            archived = Archived(digest.hexdigest(), same.stat().st_size)
            self._objects.put(archived.name(render_id, path.name), same)
            return archived
