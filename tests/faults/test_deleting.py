"""Renders that are deleted in the middle of everything: row C8 of the fault matrix; Redis keeps nothing."""

import itertools
import random
import signal
import time

from nocturne.v1 import job_pb2
from nocturne_coordinator.queue import keys
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.removal import delete_render, sweep

from tests.coordinator.schema import columns_by_table
from tests.coordinator.service import Service, check_complete, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker, simulated_result
from tests.faults.survival import OVERDUE_SOON, SOME_DELAY, check_nothing_left


def cancel_and_delete(folder: DataFolder, render_id: str) -> None:
    folder.requests.cancel(render_id)
    delete_render(folder, render_id)
    sweep(folder)


def everything_in_redis(service: Service) -> bytes:
    """All names and contents."""
    found = []
    with service.server.client() as client:
        for name in client.scan_iter():
            found.append(name)
            # A dump has strings of streams as they are.
            found.append(client.dump(name) or b"")
            if client.type(name) == b"stream":
                found += [value for _, fields in client.xrange(name) for value in fields.values()]
    return b"".join(found)


def check_forgotten(service: Service, *render_ids: str) -> None:
    """Neither in Redis, nor in the database, nor in the folder; and it stays so."""
    check_nothing_left(service)
    time.sleep(1.0)
    for render_id in render_ids:
        assert render_id.encode() not in everything_in_redis(service)
        for name in columns_by_table():
            rows = service.folder.database.rows(f'SELECT * FROM "{name}"')  # noqa: S608
            assert not any(render_id in [*row] for row in rows), name
        assert [path for path in service.data.rglob("*") if render_id in path.name] == []


def test_what_is_looked_for_is_there_before(service: Service) -> None:
    """C8: jobs of a running render are found by the search that must not find them after the deletion."""
    service.start()
    render = service.create()
    wait_until(lambda: render.id.encode() in everything_in_redis(service))


def test_deleted_while_workers_die(service: Service) -> None:
    """C8: renders are cancelled and deleted in mid-work, while workers die with their jobs in hand."""
    chance = random.Random(1)
    service.start("", *OVERDUE_SOON)

    def come() -> SimulatedWorker:
        jobs, last = itertools.count(1), chance.randint(1, 4)
        return service.work(
            SimulatedWorker(
                service.server.url, delay=SOME_DELAY, dies=lambda _: next(jobs) == last, status_ms=1500
            )
        )

    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    fleet = [come() for _ in range(3)]
    deleted = []
    kept = service.create(request_id="kept", samples=400)
    for number in range(3):
        render = service.create(request_id=f"{number}", samples=200)
        wanted = chance.randint(0, 8)
        wait_until(lambda render=render, wanted=wanted: service.row(render.id).ranges_done >= wanted)  # type: ignore[misc]
        # The others work on, so there are jobs until one dies.
        wait_until(lambda fleet=fleet: not all(worker.is_alive() for worker in fleet))  # type: ignore[misc]
        cancel_and_delete(service.folder, render.id)
        deleted.append(render.id)
        fleet = [worker for worker in fleet if worker.is_alive()]
        while len(fleet) < 3:
            fleet.append(come())
    wait_until(lambda: service.row(kept.id).state.ended)
    # Some of its jobs may have killed three workers, as they are meant to.
    if service.row(kept.id).state == "SUCCEEDED":
        check_complete(service, kept.id)
    check_forgotten(service, *deleted)


def test_deleted_between_a_result_and_its_commit(service: Service) -> None:
    """C8: the coordinator stands still with merged sums and jobs out, and finds the render gone."""
    process = service.start()
    render = service.create(samples=2000)
    worker = service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).ranges_done > 3)
    process.send_signal(signal.SIGSTOP)
    worker.stop()
    cancel_and_delete(service.folder, render.id)
    process.send_signal(signal.SIGCONT)
    # Without any worker that would do the jobs that are out.
    wait_until(lambda: render.id.encode() not in everything_in_redis(service))
    service.work(SimulatedWorker(service.server.url))
    other = service.create(request_id="b", samples=100)
    check_complete(service, other.id)
    check_forgotten(service, render.id)
    assert process.poll() is None


def test_deleted_while_no_coordinator_is_there(service: Service) -> None:
    """C8: jobs and results that are on the streams then are taken off by the next one."""
    service.start()
    render = service.create(samples=400)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).ranges_done > 3)
    service.stop(signal.SIGKILL)
    cancel_and_delete(service.folder, render.id)
    service.start()
    check_forgotten(service, render.id)


def test_a_late_result_of_a_deleted_render_is_dropped(service: Service) -> None:
    """C8: of one that had ended well, days ago; it counts as nobody's fault."""
    late: list[job_pb2.JobResult] = []

    def keeping(result: job_pb2.JobResult) -> list[job_pb2.JobResult | bytes]:
        late.append(result)
        return [result]

    service.start()
    service.work(SimulatedWorker(service.server.url, keeping))
    render = service.create(samples=20)
    service.wait_for_end(render.id)
    delete_render(service.folder, render.id)
    sweep(service.folder)
    with service.server.client() as client:
        for result in (*late, simulated_result(late[0].job)):
            client.xadd(keys.RESULTS, {keys.RESULT_FIELD: result.SerializeToString()})
    check_forgotten(service, render.id)
    assert service.folder.workers.in_quarantine() == {}
    assert service.folder.meters.read()["results_refused"] == 0.0
    other = service.create(request_id="b", samples=20)
    check_complete(service, other.id)
