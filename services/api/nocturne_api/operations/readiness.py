"""Whether the service works: reads, writes, takes renders, and has a coordinator that merges."""

import asyncio
import time
from collections.abc import Awaitable, Callable, Collection, Mapping

from nocturne_coordinator.store.database import DatabaseTrouble
from nocturne_scene.errors import NocturneError

from nocturne_api import limits
from nocturne_api.models.health import CHECKS, Check, CheckName
from nocturne_api.models.health import Readiness as Found
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders
from nocturne_api.operations.status_reason import coordinator_trouble


class Readiness:
    """The answer is kept for a moment: everybody may ask, as often as they like."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._access = access
        self._renders = renders
        self._looking = asyncio.Lock()
        self._found: Mapping[CheckName, Check] = {}
        self._until = 0.0
        self._checks: Mapping[CheckName, Callable[[], Awaitable[str]]] = {
            "reading": self._reading,
            "writing": self._writing,
            "admission": self._admission,
            "merging": self._merging,
        }

    async def look(self, leave_out: Collection[CheckName] = ()) -> Found:
        """All checks but those left out."""
        async with self._looking:
            if time.monotonic() >= self._until:
                checks = await asyncio.gather(*(self._check(name) for name in CHECKS))
                self._found = dict(zip(CHECKS, checks, strict=True))
                self._until = time.monotonic() + limits.READY_KEPT_S
        wanted = [check for name, check in self._found.items() if name not in leave_out]
        return Found(ready=all(check.ok for check in wanted), checks=wanted)

    async def _check(self, name: CheckName) -> Check:
        try:
            async with asyncio.timeout(2 * limits.READY_WAIT_S):
                trouble = await self._checks[name]()
        except TimeoutError:
            trouble = f"There was no answer in {2 * limits.READY_WAIT_S:g} s."
        except (NocturneError, DatabaseTrouble, OSError) as error:
            trouble = str(error)
        return Check(name=name, ok=not trouble, trouble=trouble)

    async def _reading(self) -> str:
        self._access.folder.check_place()
        await self._access.in_database(self._access.folder.change_counter)
        return ""

    async def _writing(self) -> str:
        # In no thread of the database: those may be the ones that don't answer.
        await asyncio.to_thread(self._access.folder.database.check_writing, limits.READY_WAIT_S)
        return ""

    async def _admission(self) -> str:
        self._renders.check_room()
        return ""

    async def _merging(self) -> str:
        meters = await self._access.in_database(self._access.folder.meters.read)
        return coordinator_trouble(meters, time.time(), limits.COORDINATOR_SILENT_S)
