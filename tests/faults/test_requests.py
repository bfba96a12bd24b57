"""Renders that are paused, extended and cancelled at any moment: row C8 of the matrix."""

import signal
import time

import numpy as np
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.queue import keys

from tests.coordinator.service import Service, check_committed, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.faults.survival import (
    SOME_DELAY,
    check_survived,
    half_done,
)


def test_changes_at_random_times_leave_the_bits(service: Service) -> None:
    """C8: paused, resumed, given another priority, extended."""
    service.start()
    render = service.create(samples=100)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    chance = np.random.default_rng(5)
    for _ in range(5):
        time.sleep(float(chance.uniform(0.0, 0.2)))
        service.folder.requests.pause(render.id)
        service.folder.requests.set_priority(render.id, int(chance.integers(1, 1000)))
        time.sleep(float(chance.uniform(0.0, 0.2)))
        service.folder.requests.resume(render.id)
    service.folder.requests.extend(render.id, 150, StopConditions())
    check_survived(service, render.id)


def test_an_extension_at_the_last_moment_is_not_lost(service: Service) -> None:
    """C8: as the last range comes."""
    service.start()
    for number in range(2):
        render = service.create(samples=8, request_id=f"{number}")
        worker = service.work(SimulatedWorker(service.server.url))
        wait_until(lambda render=render: service.row(render.id).ranges_done >= 6)  # type: ignore[misc]
        service.folder.requests.extend(render.id, 16, StopConditions())
        wait_until(lambda render=render: service.row(render.id).photons == 70 * 40 * 16)  # type: ignore[misc]
        check_survived(service, render.id)
        worker.stop()


def test_cancel_keeps_what_was_merged(service: Service) -> None:
    """C8: the image is that of the samples so far."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: half_done(service, render.id))
    assert service.folder.requests.cancel(render.id).state == "CANCELLED"
    row = service.wait_for_end(render.id)
    assert 0 < row.ranges_done < row.ranges_planned
    check_committed(service, row)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) == 0 and client.xlen(keys.RESULTS) == 0)


def test_cancel_while_no_coordinator_runs(service: Service) -> None:
    """C8: the next one writes the image."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    wait_until(lambda: half_done(service, render.id))
    service.stop(signal.SIGKILL)
    service.folder.requests.cancel(render.id)
    queued = service.create(request_id="queued")
    service.folder.requests.cancel(queued.id)
    service.start()
    row = service.wait_for_end(render.id)
    assert row.state == "CANCELLED"
    check_committed(service, row)
    assert service.wait_for_end(queued.id).photons == 0
