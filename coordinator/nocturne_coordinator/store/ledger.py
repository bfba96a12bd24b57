"""What only coordinators do to the data folder; every write checks that folder and render are theirs."""

from collections.abc import Mapping

from nocturne_coordinator.store.commits import Commits
from nocturne_coordinator.store.database import Database
from nocturne_coordinator.store.leases import Leases
from nocturne_coordinator.store.meters import Meters
from nocturne_coordinator.store.open_renders import OpenRenders
from nocturne_coordinator.store.ownership import Ownership
from nocturne_coordinator.store.worker_records import WorkerRecords


class Ledger:
    """The repositories of one coordinator, all on its leases."""

    def __init__(self, database: Database, ownership: Ownership) -> None:
        self._meters = Meters(database)
        self.leases = Leases(database, ownership)
        self.renders = OpenRenders(database, self.leases)
        self.commits = Commits(database, self.leases)
        self.workers = WorkerRecords(database, self.leases)

    def write_meters(self, values: Mapping[str, float]) -> None:
        """What this coordinator counts, by name."""
        with self.leases.owned():
            self._meters.write(self.leases.number, values)
