"""Who joined and left, and what all workers did, as the data folder keeps it."""

from nocturne_coordinator.dispatch.records import WorkerRow
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.rows import NewRender
from nocturne_scene.ranges import make_schedule


def _worker(name: str, rate: float = 5.0) -> WorkerRow:
    return WorkerRow(name, 1, 2, 10, 20, rate / 2, 0, 0.0, 0.0)


def test_worker_events(folder: DataFolder, ledger: Ledger) -> None:
    new = NewRender("q", "", "5c" * 32, "{}", 32, 32, 8, make_schedule(32, 32, 8))
    render = folder.renders.create(new).id
    ledger.workers.mirror([_worker("a"), _worker("b")], [(render, 3, "b"), ("deleted", 1, "a")], 1.0)
    assert folder.tiles.at_work(render) == [(3, "b")]
    assert folder.tiles.at_work("deleted") == []
    ledger.workers.mirror([_worker("b")], [(render, 3, "b"), (render, 5, "b")], 1.5)
    # Since the oldest of its tiles.
    assert folder.tiles.work_of_workers(None) == [("b", render, "", 2, 1.0)]
    assert folder.tiles.work_of_workers("somebody") == []
    ledger.workers.mirror([_worker("b")], [], 2.0)
    ledger.workers.quarantine("b", "lies", 3.0)
    ledger.workers.quarantine("b", "lies again", 4.0)
    folder.workers.release("b")
    events, _ = folder.workers.history(10)
    told = [(event.worker_id, event.what, event.reason) for event in reversed(events)]
    assert told == [
        ("a", "joined", ""),
        ("b", "joined", ""),
        ("a", "left", ""),
        ("b", "quarantined", "lies"),
        ("b", "released", ""),
    ]
    assert folder.tiles.at_work(render) == []


def test_rates_are_kept_by_the_minute_for_two_days(folder: DataFolder, ledger: Ledger) -> None:
    for second in (0.0, 30.0, 61.0, 100.0, 130.0, 61.0 + 2 * 86400.0):
        ledger.workers.mirror([_worker("a", second), _worker("b", 1.0)], [], second)
    _, rates = folder.workers.history(1)
    assert [(rate.unix_time, rate.threads, rate.rays_per_second) for rate in rates] == [
        (61.0, 4, 62.0),
        (130.0, 4, 131.0),
        (61.0 + 2 * 86400.0, 4, 62.0 + 2 * 86400.0),
    ]
