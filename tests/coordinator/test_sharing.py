"""Several coordinators on one data folder: each render is one's, and who lost it can't write."""

import os
import signal
import sqlite3
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from nocturne_coordinator.dispatch.records import (
    ErrorPoint,
    OpenRender,
    RenderCommit,
    RenderState,
    TileRow,
    Totals,
)
from nocturne_coordinator.errors import AlreadyOwned, LeaseLost
from nocturne_coordinator.main import EXIT_ALREADY_OWNED
from nocturne_coordinator.queue import keys
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.ledger import Ledger
from nocturne_coordinator.store.ownership import Ownership

from tests.coordinator.service import Service, check_complete, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.system.forked import Forked
from tests.system.waiting import LIMIT_S

SHARED = ("--shared", "--lease-seconds", "1.5")
SOME_DELAY = 0.05
"""Seconds per job."""


def holder(service: Service, render_id: str) -> tuple[int, int]:
    """Number of the coordinator that has a render, and the fence."""
    row = service.folder.database.row("SELECT * FROM lease WHERE render_id = ?", (render_id,))
    return (0, 0) if row is None else (row["coordinator"], row["fence"])


# --- the ledger alone ---


class Pen:
    """A coordinator as the ledger knows it."""

    def __init__(self, folder: DataFolder) -> None:
        self.ownership = Ownership(folder.root, folder.database, shared=True, lease_seconds=60.0)
        self.ledger = Ledger(folder.database, self.ownership)

    def take(self, render_id: str) -> OpenRender:
        taken = self.ledger.renders.take(render_id)
        assert taken is not None
        return taken


def commit_of(render: OpenRender, samples: int) -> RenderCommit:
    tile = TileRow(0, samples, bytes([samples]) * 32 * 32 * 32)
    return RenderCommit(render.id, render.fence, [tile], Totals(1, samples * 1024, 5, 0, 0.5), 10.0)


def test_who_lost_a_render_can_write_nothing_of_it(service: Service) -> None:
    folder, render = service.folder, service.create()
    slow, quick = Pen(folder), Pen(folder)
    held = slow.take(render.id)
    assert quick.ledger.renders.take(render.id) is None
    assert slow.ledger.commits.start(render.id, held.fence, 1.0)
    assert slow.ledger.commits.commit([commit_of(held, 4)]) == []
    # Its lease runs out.
    folder.database.execute("UPDATE coordinator SET until = 1 WHERE number = ?", (slow.ledger.leases.number,))
    taken = quick.take(render.id)
    assert taken.fence == held.fence + 1
    assert taken.totals.photons == 4 * 1024
    assert quick.ledger.commits.commit([commit_of(taken, 8)]) == []
    before = dict(_rows(folder))

    assert slow.ledger.leases.lost({render.id: held.fence}) == [render.id]
    assert quick.ledger.leases.lost({render.id: taken.fence}) == []
    assert slow.ledger.commits.commit([commit_of(held, 4)]) == [render.id]
    for attempt in (
        lambda: slow.ledger.commits.start(render.id, held.fence, 2.0),
        lambda: slow.ledger.commits.end(held, RenderState.FAILED, "", 2.0),
        lambda: slow.ledger.commits.images_written(render.id, held.fence),
        lambda: slow.ledger.commits.record_preview(render.id, held.fence, ErrorPoint(1.0, 1, 1.0, 0.5), True),
    ):
        with pytest.raises(LeaseLost, match=render.id):
            attempt()
    slow.ledger.leases.let_go(render.id, held.fence)
    assert dict(_rows(folder)) == before
    # A sign of life later, it is one of two again; the render stays where it is.
    assert slow.ledger.leases.renew(time.time()) == 2
    assert slow.ledger.renders.take(render.id) is None
    quick.ledger.leases.resign()
    assert slow.take(render.id).fence == taken.fence + 1


def _rows(folder: DataFolder) -> list[tuple[str, object]]:
    queries = [
        *("SELECT * FROM render", "SELECT * FROM tile", "SELECT * FROM lease", "SELECT * FROM error_point"),
        "SELECT * FROM failed_tile",
    ]
    return [(query, [tuple(row) for row in folder.database.rows(query)]) for query in queries]


def test_tiles_that_are_thrown_away_are_lost_to_who_has_them(service: Service) -> None:
    render, pen, other = service.create(), Pen(service.folder), Pen(service.folder)
    held = pen.take(render.id)
    pen.ledger.commits.start(render.id, held.fence, 1.0)
    service.folder.database.execute("INSERT INTO contribution VALUES (?, 0, 'faulty')", (render.id,))
    assert pen.ledger.commits.commit([commit_of(held, 4)]) == []
    assert other.ledger.workers.quarantine("faulty", "It lied.", 1.0, mismatched=True) == [render.id]
    assert pen.ledger.commits.commit([commit_of(held, 8)]) == [render.id]
    assert pen.take(render.id).fence > held.fence


def test_one_that_shares_and_one_that_does_not_refuse_each_other(service: Service) -> None:
    root, database = service.folder.root, service.folder.database
    alone = Ownership(root, database)
    with pytest.raises(AlreadyOwned, match="--shared"):
        Ownership(root, database, shared=True)
    alone.release()
    first, second = (Ownership(root, database, shared=True) for _ in range(2))
    assert (second.epoch, second.number) == (first.epoch, first.number + 1)
    with pytest.raises(AlreadyOwned):
        Ownership(root, database)
    first.release()
    second.release()
    assert Ownership(root, database).epoch == second.epoch + 1


def test_those_that_share_may_come_at_once(service: Service) -> None:
    root = service.folder.root
    folders = [DataFolder(root) for _ in range(6)]
    for _ in range(20):
        at_once = threading.Barrier(len(folders))

        def come(folder: DataFolder, at_once: threading.Barrier = at_once) -> Ownership:
            at_once.wait()
            return Ownership(root, folder.database, shared=True)

        with ThreadPoolExecutor(len(folders)) as pool:
            owners = list(pool.map(come, folders))
        assert len({owner.number for owner in owners}) == len(folders)
        assert len({owner.epoch for owner in owners}) == 1
        for owner in owners:
            owner.check()
            owner.release()


# --- processes ---


def test_two_coordinators_share_the_renders(service: Service) -> None:
    for _ in range(2):
        service.start("", *SHARED)
    # Who comes first decides whether the folder is shared.
    wait_until(lambda: len(service.folder.database.rows("SELECT * FROM coordinator")) == 2)
    assert service.start().wait(LIMIT_S) == EXIT_ALREADY_OWNED
    renders = [service.create(request_id=name, samples=100).id for name in "abcd"]
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=0.005))
    wait_until(lambda: len({holder(service, each)[0] for each in renders} - {0}) == 2)
    for render in renders:
        check_complete(service, render)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) == 0 and client.xlen(keys.RESULTS) == 0)


def test_a_newcomer_gets_its_part_of_what_runs(service: Service) -> None:
    service.start("", *SHARED)
    renders = [service.create(request_id=name, samples=150).id for name in "ab"]
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: all(service.row(each).ranges_done > 5 for each in renders))
    # No render ends before the newcomer is there, however long it takes to start.
    service.stop_workers()
    service.start("", *SHARED)
    wait_until(lambda: len({holder(service, each)[0] for each in renders} - {0}) == 2)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    for render in renders:
        check_complete(service, render)


def test_a_killed_coordinators_render_goes_to_the_other(service: Service) -> None:
    first = service.start("", *SHARED)
    render = service.create(samples=150).id
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render).ranges_done > 5)
    service.start("", *SHARED)
    first.kill()
    before = holder(service, render)
    wait_until(lambda: holder(service, render)[1] > before[1])
    check_complete(service, render)


def test_one_that_was_stopped_beyond_its_lease_merges_nothing_twice(service: Service, tmp_path: Path) -> None:
    """Its commits are rare, so that it stands still with merged ranges that it has not committed."""
    stopped = service.start("", *SHARED, "--commit-seconds", "1.0", "--log-level", "info")
    # 126 ranges, some ten seconds.
    render = service.create(samples=50_000).id
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=0.15))
    wait_until(lambda: holder(service, render)[0] == 1)
    service.start("", *SHARED)
    wait_until(lambda: len(service.folder.database.rows("SELECT * FROM coordinator")) == 2)
    wait_until(lambda: service.row(render).ranges_done > 5)
    time.sleep(0.5)
    stop_between_transactions(stopped, tmp_path / "data" / "nocturne.db")
    number, fence = holder(service, render)
    wait_until(lambda: holder(service, render)[1] > fence)
    taken_over = service.row(render).ranges_done
    wait_until(lambda: service.row(render).ranges_done > taken_over)
    assert service.row(render).state == "RUNNING"
    stopped.send_signal(signal.SIGCONT)
    check_complete(service, render)
    assert holder(service, render)[1] == fence + 1
    assert number == 1
    assert stopped.poll() is None
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) == 0 and client.xlen(keys.RESULTS) == 0)


def stop_between_transactions(process: Forked, database: Path) -> None:
    """One that stands still within a transaction keeps everybody from writing, as long as it does."""
    while True:
        process.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)
        connection = sqlite3.connect(database, timeout=0.0, isolation_level=None)
        try:
            connection.execute("BEGIN IMMEDIATE")
            connection.execute("ROLLBACK")
            return
        except sqlite3.OperationalError:
            process.send_signal(signal.SIGCONT)
            time.sleep(0.01)
        finally:
            connection.close()
