"""Removes the files of deleted renders; what can't be removed now, a little later."""

import asyncio
import logging

from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.object_store import ObjectStoreUnavailable
from nocturne_coordinator.store.removal import sweep

from nocturne_api.background.task import Background

_log = logging.getLogger(__name__)

_AGAIN_S = 30.0


class Sweeper(Background):
    """One for each API process; they may do the same twice."""

    def __init__(self, folder: DataFolder) -> None:
        self._folder = folder

    async def sweep(self) -> None:
        """Now. What can't be done is told in the log, and tried again."""
        try:
            await asyncio.to_thread(sweep, self._folder)
        except (ObjectStoreUnavailable, OSError) as error:
            _log.warning("files of deleted renders are removed later: %s", error)
        except Exception:
            _log.exception("files of deleted renders are removed later")

    async def _run(self) -> None:
        while True:
            await self.sweep()
            await asyncio.sleep(_AGAIN_S)
