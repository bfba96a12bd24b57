"""Health: whether the data folder answers, and figures for monitoring."""

from nocturne_api.access import CALLER
from nocturne_api.background.space import Space
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.prometheus import metrics_text


class Health:
    """How the service is doing."""

    def __init__(self, access: FolderAccess, space: Space) -> None:
        self._access = access
        self._space = space

    async def metrics(self) -> bytes:
        """Counts and states in the text format of Prometheus."""
        CALLER.get().need("read")
        return await self._access.in_database(metrics_text, self._access.folder, self._space.figures())

    async def ready(self) -> bool:
        """Whether the data folder answers."""
        try:
            await self._access.in_database(self._access.folder.change_counter)
        except Exception:
            return False
        return True
