"""A night at the coordinator: renders stop, pause, go on and share; workers lie, die and dawdle; the bits
stay."""

import time
from pathlib import Path

import pytest
from nocturne_coordinator.dispatch.stopping import StopConditions
from nocturne_coordinator.main import EXIT_ALREADY_OWNED, EXIT_OWNERSHIP_LOST
from nocturne_coordinator.queue import keys

from tests.coordinator.service import (
    RedisServer,
    Service,
    check_committed,
    check_complete,
    read_exr,
    read_manifest,
    wait_until,
)
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.pictures import samples_of
from tests.system.waiting import LIMIT_S

SOME_DELAY = 0.02
"""Seconds per job."""


def some_done(service: Service, render_id: str, part: float = 0.3) -> None:
    wait_until(lambda: service.row(render_id).ranges_done >= part * service.row(render_id).ranges_planned)


def test_two_renders_share_the_workers(service: Service) -> None:
    service.start()
    renders = [service.create(request_id=name, samples=20 + index) for index, name in enumerate("ab")]
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url))
    for render in renders:
        check_complete(service, render.id)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.RESULTS) == 0 and client.xlen(keys.JOBS) == 0)
    assert service.folder.renders.error_history(renders[0].id)
    wait_until(lambda: len(service.folder.workers.alive()) == 2)
    assert service.stop() == 0


# --- stop, pause, extend ---


def test_a_time_stops_a_render_and_its_manifest_replays_it(service: Service) -> None:
    service.start()
    wait_until(lambda: service.folder.meters.read().get("redis_in_step") == 1.0)
    # So long that a busy machine has planned it and done something by then, of jobs for half a minute.
    until = StopConditions(until=time.time() + 4.0, until_text="in four seconds")
    render = service.create(samples=4000, stop=until)
    service.work(SimulatedWorker(service.server.url, delay=0.5))
    row = service.wait_for_end(render.id)
    assert (row.state, row.reason) == ("STOPPED_EARLY", "Stopped at in four seconds, as asked.")
    assert 0 < row.ranges_done < row.ranges_planned
    # A round of the loop and a commit, and room for a busy machine.
    assert until.until <= row.ended < until.until + 3.0
    check_committed(service, row)
    manifest = service.folder.tiles.manifest(render.id)
    assert samples_of(read_manifest(service.folder.image_path(render.id))) == list(manifest)

    replay = service.folder.requests.replay(render.id, "replay")
    assert service.folder.requests.replay(render.id, "replay").id == replay.id
    service.work(SimulatedWorker(service.server.url))
    assert service.wait_for_end(replay.id).state == "SUCCEEDED"
    original, copy = (service.folder.image_path(each).read_bytes() for each in (render.id, replay.id))
    assert copy == original


@pytest.mark.parametrize(
    ("stop", "reason"),
    [
        (StopConditions(wall_seconds=0.5), "Stopped after 0.5 s of running, as asked."),
        (StopConditions(cpu_seconds=0.0195), "of 0.0195 s of processor time, as asked."),
    ],
)
def test_time_spent_stops_a_render(service: Service, stop: StopConditions, reason: str) -> None:
    service.start()
    render = service.create(samples=4000, stop=stop)
    # Each of its jobs says that it took a millisecond of processor time.
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    row = service.wait_for_end(render.id)
    assert row.state == "STOPPED_EARLY"
    assert row.reason.endswith(reason)
    if stop.cpu_seconds:
        assert stop.cpu_seconds <= row.cpu_seconds < 2 * stop.cpu_seconds
    check_committed(service, row)


def test_the_error_of_tiles_stops_them_alike_for_any_workers(tmp_path: Path) -> None:
    """The simulated sums have the same error for any samples, so the target lies between those of two
    tiles."""
    manifests, images = [], []
    for index, workers in enumerate((1, 3)):
        (tmp_path / str(index)).mkdir()
        server = RedisServer(tmp_path / str(index))
        server.start()
        service = Service(tmp_path / str(index) / "data", server)
        try:
            service.start()
            render = service.create(samples=300, stop=StopConditions(tile_relative_error=0.09))
            for _ in range(workers):
                service.work(SimulatedWorker(server.url, delay=0.002 * index))
            row = service.wait_for_end(render.id)
            assert row.state == "SUCCEEDED"
            assert row.tiles_done == row.tiles == 6
            assert row.predicted_end == 0.0
            check_committed(service, row)
            manifests.append(service.folder.tiles.manifest(render.id))
            images.append(service.folder.image_path(render.id).read_bytes())
        finally:
            service.close()
            server.kill()
    assert manifests[0] == manifests[1]
    assert images[0] == images[1]
    assert set(manifests[0]) <= {64, 128, 256, 300}
    assert min(manifests[0]) < 300


def test_a_forecast_is_made(service: Service) -> None:
    service.start()
    render = service.create(samples=4000)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).predicted_end > 0.0)
    row = service.row(render.id)
    assert row.predicted_end > time.time()
    assert row.predicted_cpu_seconds > row.cpu_seconds > 0.0
    service.folder.requests.cancel(render.id)


def test_a_paused_render_goes_on_where_it_was(service: Service) -> None:
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=0.05))
    some_done(service, render.id)
    assert service.folder.requests.pause(render.id).state == "PAUSED"
    row = service.wait_for_end(render.id)
    assert row.state == "PAUSED"
    check_committed(service, row)
    with service.server.client() as client:
        wait_until(lambda: client.xlen(keys.JOBS) == 0)
    time.sleep(0.3)
    assert service.row(render.id).photons == row.photons
    assert service.folder.requests.resume(render.id).state in ("QUEUED", "RUNNING")
    wait_until(lambda: service.row(render.id).state == "SUCCEEDED")
    check_complete(service, render.id)
    assert service.row(render.id).cpu_seconds < 1.3 * 0.001 * row.ranges_planned


@pytest.mark.parametrize("samples", [64, 50])
def test_an_extended_render_traces_only_what_is_new(service: Service, samples: int) -> None:
    service.start()
    render = service.create(samples=samples)
    worker = service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)
    done = worker.jobs_done
    service.folder.requests.extend(render.id, 200, StopConditions())
    wait_until(lambda: service.row(render.id).state == "SUCCEEDED")
    check_complete(service, render.id)
    ends = service.folder.renders.schedule(render.id).range_ends
    new = 6 * sum(end > samples for end in ends)
    # With a single worker there are no audits; a copy of a slow job may be done twice.
    assert new <= worker.jobs_done - done <= new + 2
    if samples == 64:
        fresh = service.create(samples=200, request_id="fresh")
        check_complete(service, fresh.id)
        paths = [service.folder.image_path(each) for each in (render.id, fresh.id)]
        assert paths[0].read_bytes() == paths[1].read_bytes()


def test_a_running_render_can_be_extended(service: Service) -> None:
    service.start()
    render = service.create(samples=64)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    some_done(service, render.id)
    assert service.folder.requests.extend(render.id, 128, StopConditions()).state == "RUNNING"
    check_complete(service, render.id)
    assert service.row(render.id).samples == 128


def test_a_render_whose_time_comes_in_the_queue_never_starts(service: Service) -> None:
    render = service.create(stop=StopConditions(until=time.time() - 1.0, until_text="07:00Z"))
    service.start()
    wait_until(lambda: service.row(render.id).state == "STOPPED_EARLY")
    assert "07:00Z came before" in service.row(render.id).reason


# --- coordinators ---


def test_two_data_folders_can_not_share_a_redis(service: Service, tmp_path: Path) -> None:
    service.start()
    render = service.create(samples=200_000)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: service.row(render.id).ranges_done > 5)
    other = Service(tmp_path / "other", service.server)
    try:
        assert other.start().wait(LIMIT_S) == EXIT_ALREADY_OWNED
    finally:
        other.close()
    assert service.row(render.id).state == "RUNNING"
    service.folder.requests.cancel(render.id)
    # Stopped in order, it leaves the lease to the next.
    assert service.stop() == 0
    third = Service(tmp_path / "third", service.server)
    try:
        third.start()
        check_complete(third, third.create(samples=8).id)
    finally:
        third.close()


def test_a_later_coordinator_of_the_folder_takes_the_lease(service: Service) -> None:
    first = service.start()
    wait_until(lambda: service.folder.meters.read().get("redis_in_step") == 1.0)
    with service.server.client() as client:
        held = client.get(keys.SESSION)
        assert isinstance(held, bytes)
        folder = held.split(b":")[0]
        client.set(keys.SESSION, folder + b":99:other")
    assert first.wait(LIMIT_S) == EXIT_OWNERSHIP_LOST


def test_exr_of_a_complete_render_has_no_manifest(service: Service) -> None:
    service.start()
    render = service.create(samples=4)
    service.work(SimulatedWorker(service.server.url))
    check_complete(service, render.id)
    assert read_manifest(service.folder.image_path(render.id)) == ""
    assert read_exr(service.folder.image_path(render.id))[2].min() == 4


def test_the_first_light_is_committed_at_once(service: Service) -> None:
    """A user waits for the first light; later results wait for the next commit."""
    service.start("", "--commit-seconds", "60")
    # Some ten seconds.
    render = service.create(samples=50_000).id
    service.work(SimulatedWorker(service.server.url, delay=0.15))
    wait_until(lambda: service.row(render).ranges_done > 0)
    first = service.row(render).ranges_done
    time.sleep(1.0)
    assert service.row(render).ranges_done == first
