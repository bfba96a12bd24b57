"""Redis killed, emptied, confused, full or set up wrongly: rows D of the fault matrix."""

import time
from pathlib import Path

from nocturne_coordinator.main import EXIT_UNUSABLE
from nocturne_coordinator.queue import keys

from tests.coordinator.service import RedisServer, Service, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.faults.survival import SOME_DELAY, check_resumes, check_survived, half_done
from tests.system.waiting import LIMIT_S


def test_redis_killed_and_restarted_empty(service: Service) -> None:
    """D1: after a while without it."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: half_done(service, render.id))
    service.server.kill()
    wait_until(lambda: service.folder.meters.read().get("redis_in_step") == 0.0)
    service.server.start()
    check_resumes(service, render.id, "D1")
    check_survived(service, render.id)


def test_redis_comes_late(service: Service) -> None:
    """D1: it is not there from the start."""
    service.server.kill()
    service.start()
    render = service.create(samples=10)
    # It waits for Redis before it does anything else; in memory it comes late to one that works.
    time.sleep(1.0)
    service.server.start()
    service.work(SimulatedWorker(service.server.url))
    check_survived(service, render.id)


def test_redis_emptied(service: Service) -> None:
    """D2: in mid-render; three times and more in memory."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    with service.server.client() as client:
        wait_until(lambda: half_done(service, render.id))
        client.flushall()
        check_resumes(service, render.id, "D2", 10.0)
    check_survived(service, render.id)


def test_the_consumer_group_is_destroyed(service: Service) -> None:
    """D3: with its pending list; set back to the first entry: in memory."""
    service.start()
    render = service.create(samples=100)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: half_done(service, render.id))
    with service.server.client() as client:
        client.xgroup_destroy(keys.JOBS, keys.WORKERS_GROUP)
    check_resumes(service, render.id, "D3")
    check_survived(service, render.id)


def test_redis_out_of_memory(service: Service) -> None:
    """D4: publishing stops until there is room."""
    with service.server.client() as client:
        client.config_set("maxmemory", 1)
        service.start()
        render = service.create(samples=20)
        wait_until(lambda: service.folder.meters.read().get("redis_in_step") == 0.0)
        assert service.row(render.id).ranges_done == 0
        client.config_set("maxmemory", 0)
    service.work(SimulatedWorker(service.server.url))
    check_survived(service, render.id)


def test_redis_that_forgets_is_refused(tmp_path: Path) -> None:
    """D4: an evicting policy loses jobs."""
    server = RedisServer(tmp_path, "--maxmemory-policy", "allkeys-lru")
    server.start()
    service = Service(tmp_path / "data", server)
    try:
        assert service.start().wait(LIMIT_S) == EXIT_UNUSABLE
    finally:
        service.close()
        server.kill()
