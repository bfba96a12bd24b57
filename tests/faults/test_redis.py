"""Redis killed, emptied, confused, full or set up wrongly: rows D of the fault matrix."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from nocturne_coordinator.main import EXIT_UNUSABLE
from nocturne_coordinator.queue import keys
from redis import Redis

from tests.coordinator.service import RedisServer, Service, wait_until
from tests.coordinator.simulated_worker import SimulatedWorker
from tests.faults.survival import SOME_DELAY, check_resumes, check_survived, half_done


def test_redis_killed_and_restarted_empty(service: Service) -> None:
    """D1: at once, and after a while without it."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    for pause in (0.0, 0.4):
        ranges = service.row(render.id).ranges_done
        wait_until(lambda ranges=ranges: service.row(render.id).ranges_done > ranges)  # type: ignore[misc]
        service.server.kill()
        time.sleep(pause)
        service.server.start()
        check_resumes(service, render.id, "D1")
    check_survived(service, render.id)


def test_redis_comes_late(service: Service) -> None:
    """D1: it is not there from the start."""
    service.server.kill()
    service.start()
    render = service.create(samples=10)
    time.sleep(0.5)
    service.server.start()
    service.work(SimulatedWorker(service.server.url))
    check_survived(service, render.id)


def test_redis_emptied(service: Service) -> None:
    """D2: three times."""
    service.start()
    render = service.create(samples=100)
    service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    with service.server.client() as client:
        for _ in range(3):
            time.sleep(0.2)
            client.flushall()
            check_resumes(service, render.id, "D2", 10.0)
    check_survived(service, render.id)


def _destroyed(client: "Redis") -> None:
    client.xgroup_destroy(keys.JOBS, keys.WORKERS_GROUP)


def _rewound(client: "Redis") -> None:
    client.xgroup_setid(keys.JOBS, keys.WORKERS_GROUP, "0")


@pytest.mark.parametrize("confuse", [_destroyed, _rewound])
def test_the_consumer_group_is_confused(service: Service, confuse: Callable[["Redis"], None]) -> None:
    """D3: destroyed with its pending list; set back to the first entry, so that jobs are given out twice."""
    service.start()
    render = service.create(samples=100)
    for _ in range(2):
        service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY))
    wait_until(lambda: half_done(service, render.id))
    with service.server.client() as client:
        confuse(client)
    check_resumes(service, render.id, f"D3 {confuse.__name__[1:]}")
    check_survived(service, render.id)


def test_redis_out_of_memory(service: Service) -> None:
    """D4: publishing stops until there is room."""
    with service.server.client() as client:
        client.config_set("maxmemory", 1)
        service.start()
        render = service.create(samples=20)
        wait_until(lambda: service.folder.meters().get("redis_in_step") == 0.0)
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
        assert service.start().wait(15) == EXIT_UNUSABLE
    finally:
        service.close()
        server.kill()
