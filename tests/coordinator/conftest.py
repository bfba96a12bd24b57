"""A data folder of a test's own, and what the coordinator writes into it."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[DataFolder]:
    folder = DataFolder(tmp_path)
    yield folder
    folder.close()


@pytest.fixture
def ledger(folder: DataFolder) -> Iterator[Ledger]:
    ownership = Ownership(folder.root, folder.database)
    yield Ledger(folder.database, ownership)
    ownership.release()
