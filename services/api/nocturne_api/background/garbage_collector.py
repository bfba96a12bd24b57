"""Removes the files of deleted renders, if need be a little later, and files that no render
uses."""

import asyncio
import logging
import time

from nocturne_coordinator.errors import ObjectStoreUnavailable
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.removal import sweep, sweep_unused

from nocturne_api.background.task import Background

_log = logging.getLogger(__name__)

_AGAIN_S = 30.0
_UNUSED_AGAIN_S = 3600.0


class GarbageCollector(Background):
    """One for each API process; they may do the same twice."""

    def __init__(self, folder: DataFolder, unused_seconds: float) -> None:
        """`unused_seconds`: how long files stay that no render uses."""
        self._folder = folder
        self._unused_seconds = unused_seconds
        self._next_unused = 0.0

    async def sweep(self) -> None:
        """Sweeps now. Failures go to the log, and are tried again."""
        try:
            await asyncio.to_thread(sweep, self._folder)
        except (ObjectStoreUnavailable, OSError) as error:
            _log.warning("files of deleted renders are removed later: %s", error)
        except Exception:
            _log.exception("files of deleted renders are removed later")

    async def _sweep_unused(self) -> None:
        now = time.monotonic()
        if now < self._next_unused:
            return
        self._next_unused = now + min(_UNUSED_AGAIN_S, self._unused_seconds)
        try:
            gone = await asyncio.to_thread(sweep_unused, self._folder, self._unused_seconds)
        except (ObjectStoreUnavailable, OSError) as error:
            _log.warning("files that no render uses are removed later: %s", error)
        except Exception:
            _log.exception("files that no render uses are removed later")
        else:
            if gone:
                _log.info("%d files were removed that no render used", len(gone))

    async def _run(self) -> None:
        while True:
            await self.sweep()
            await self._sweep_unused()
            await asyncio.sleep(min(_AGAIN_S, self._unused_seconds))
