"""Who uses what, and what it costs."""

from nocturne_coordinator.store.usage import UsageOfOwners

from nocturne_api.access import CALLER
from nocturne_api.models.usage import CoreHourPrice, OwnerUsage, Usage
from nocturne_api.operations.folder_access import FolderAccess


class Usages:
    """The usage of one data folder."""

    def __init__(self, access: FolderAccess, price: CoreHourPrice) -> None:
        self._access = access
        self._price = price
        self._rows = UsageOfOwners(access.folder.database)

    async def get(self) -> Usage:
        """Of the caller, or of everybody for who may see all renders."""
        caller = CALLER.get()
        caller.need("read")
        rows, jobs = await self._access.in_database(self._rows.read, caller.sees)
        return Usage(
            core_hour_price=self._price.price,
            currency=self._price.currency,
            owners=[OwnerUsage.of(row, jobs, self._price) for row in rows],
        )
