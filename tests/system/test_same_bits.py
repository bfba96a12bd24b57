"""The service's image is that of nocturne-trace in every bit, whatever happens on the way."""

import random
from collections.abc import Callable, Iterator

import pytest
from nocturne_coordinator import keys

from tests.system.faults import EVERY_FAULT, flush, kill_coordinator, kill_redis, kill_worker
from tests.system.images import Image, differing_values
from tests.system.renders import RANGES, followed_render, has_ended, wait_for_more_ranges
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

Fault = Callable[[ServiceProcesses, str], bool]
Services = Callable[[int], ServiceProcesses]

# Committed before a fault, 11 % of the ranges and less of the photons: more than a start, little enough that
# much is left to be hit.
_SOME_RANGES = 12


@pytest.fixture(scope="module")
def services(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Services]:
    """Gives a running service with that many workers: the same one for all, until a test spoils it."""
    running: list[ServiceProcesses] = []

    def service(workers: int) -> ServiceProcesses:
        if not running or running[-1].spoilt:
            running.append(ServiceProcesses(tmp_path_factory.mktemp("service")))
            running[-1].start()
        running[-1].have_workers(workers)
        return running[-1]

    yield service
    for each in running:
        each.close()


@pytest.mark.parametrize("workers", [1, 3])
def test_without_faults(workers: int, services: Services, traced_alone: Image) -> None:
    with followed_render(services(workers)) as render:
        image = render.finished_image()
    assert differing_values(image, traced_alone) == {}


@pytest.mark.parametrize("fault", [kill_worker, kill_coordinator, kill_redis, flush])
def test_with_one_fault(fault: Fault, services: Services, traced_alone: Image) -> None:
    service = services(2)
    with followed_render(service) as render:
        wait_for_more_ranges(service.client, render.id, _SOME_RANGES)
        assert fault(service, render.id), "the render was over already"
        image = render.finished_image()
    assert differing_values(image, traced_alone) == {}


def test_every_result_delivered_twice(services: Services, traced_alone: Image) -> None:
    """Coordinator and workers take turns, so that no result gets by without its copy."""
    service = services(2)
    delivered = set()
    service.pause_workers()
    with followed_render(service) as render:

        def is_over() -> bool:
            return has_ended(service.client, render.id)

        while not is_over():
            wait_for(lambda: service.queue.xlen(keys.JOBS) > 0 or is_over(), "jobs")
            service.coordinator.pause()
            service.let_workers_go_on()
            wait_for(lambda: service.queue.xlen(keys.JOBS) == 0, "the workers to do all jobs")
            service.pause_workers()
            delivered |= service.deliver_again()
            service.coordinator.go_on()
            wait_for(lambda: service.queue.xlen(keys.RESULTS) == 0, "the results to be merged")
        service.let_workers_go_on()
        image = render.finished_image()
    assert len(delivered) == RANGES
    assert differing_values(image, traced_alone) == {}


def test_all_faults_in_a_random_order(services: Services, traced_alone: Image) -> None:
    service = services(2)
    order = random.Random(1).sample(EVERY_FAULT, len(EVERY_FAULT))
    hits = []
    with followed_render(service) as render:
        for fault in order:
            wait_for_more_ranges(service.client, render.id, 3)
            hits.append(fault(service, render.id))
        image = render.finished_image()
    assert hits == [True] * len(order), order
    assert differing_values(image, traced_alone) == {}
