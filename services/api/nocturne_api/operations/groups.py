"""Groups of renders."""

from nocturne_coordinator.store.groups import Groups as GroupRows

from nocturne_api.access import CALLER
from nocturne_api.models.groups import Group
from nocturne_api.operations.folder_access import FolderAccess


class Groups:
    """The groups of one data folder that callers may see."""

    def __init__(self, access: FolderAccess) -> None:
        self._access = access
        self._rows = GroupRows(access.folder.database)

    async def get(self, name: str) -> Group:
        """One group; raises NotFound."""
        caller = CALLER.get()
        caller.need("read")
        return Group.of(await self._access.in_database(self._rows.get, name, caller.sees))
