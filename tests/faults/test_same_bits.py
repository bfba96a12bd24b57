"""Real workers: the service's image is that of nocturne-trace in every bit, whatever happens meanwhile."""

import random
import resource
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from nocturne_coordinator.queue import keys

from tests.faults.faults import (
    EVERY_FAULT,
    end_worker,
    flush,
    kill_coordinator,
    kill_redis,
    kill_worker,
    stop_worker_for_three_leases,
)
from tests.faults.survival import BOUND_S, note
from tests.system.images import Image, differing_values
from tests.system.program import Program
from tests.system.renders import (
    BRIEF_SAMPLES,
    RANGES,
    followed_render,
    has_ended,
    is_in_mid_work,
    submit,
    wait_for_more_ranges,
)
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

Fault = Callable[[ServiceProcesses, str], bool]
Services = Callable[[int], ServiceProcesses]

# Committed before a fault, a sixth of the ranges and less of the photons: more than a start, little enough
# that much is left to be hit.
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
def test_without_faults(workers: int, services: Services, traced_alone_briefly: Image) -> None:
    """S2: one and three workers."""
    with followed_render(services(workers), BRIEF_SAMPLES) as render:
        image = render.finished_image()
    assert differing_values(image, traced_alone_briefly) == {}


@pytest.mark.soak
@pytest.mark.parametrize(
    "fault", [kill_worker, kill_coordinator, stop_worker_for_three_leases, end_worker, kill_redis, flush]
)
def test_with_one_fault(fault: Fault, services: Services, traced_alone: Image) -> None:
    """W1, W4, W10, C1, D1, D2: once, in mid-work; all of them in one render are below."""
    service = services(2)
    with followed_render(service) as render:
        wait_for_more_ranges(service.client, render.id, _SOME_RANGES)
        assert fault(service, render.id), "the render was over already"
        before, begun = service.client.get(render.id).progress.ranges_done, time.monotonic()
        wait_for_more_ranges(service.client, render.id, 1, BOUND_S)
        note(f"real {fault.__name__}", resumed_s=time.monotonic() - begun)
        image = render.finished_image()
        assert before < RANGES
        assert service.client.get(render.id).progress.refused == 0
    assert differing_values(image, traced_alone) == {}


def _image_in_turns(
    service: ServiceProcesses,
    before_workers: Callable[[], None] = lambda: None,
    after_workers: Callable[[], None] = lambda: None,
) -> Image:
    """Of a render during which either the coordinator works or the workers do."""
    service.pause_workers()
    with followed_render(service) as render:

        def is_over() -> bool:
            return has_ended(service.client, render.id)

        while not is_over():
            wait_for(lambda: service.queue.xlen(keys.JOBS) > 0 or is_over(), "jobs")
            service.coordinator.pause()
            before_workers()
            service.let_workers_go_on()
            wait_for(lambda: service.queue.xlen(keys.JOBS) == 0, "the workers to do all jobs")
            service.pause_workers()
            after_workers()
            service.coordinator.go_on()
            wait_for(lambda: service.queue.xlen(keys.RESULTS) == 0, "the results to be merged")
        service.let_workers_go_on()
        return render.finished_image()


@pytest.mark.soak
def test_every_result_delivered_twice(services: Services, traced_alone: Image) -> None:
    """T3: coordinator and workers take turns, so that no result gets by without its copy."""
    service = services(2)
    delivered = set()

    def deliver_again() -> None:
        delivered.update(service.deliver_again())

    image = _image_in_turns(service, after_workers=deliver_again)
    assert len(delivered) == RANGES
    assert differing_values(image, traced_alone) == {}


def test_all_faults_in_a_random_order(services: Services, traced_alone: Image) -> None:
    """S3, W1, W4, W10, C1, D1, D2: each once in one render, by a seed."""
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


@pytest.mark.soak
@pytest.mark.parametrize("order", ["reversed", "random"])
def test_jobs_dispatched_in_another_order(order: str, services: Services, traced_alone: Image) -> None:
    """S2: whatever is on the stream is taken from its end, or in a random order."""
    service, chance = services(2), random.Random(5)
    moved = 0

    def changed(jobs: Sequence[Any]) -> Sequence[Any]:
        return jobs[::-1] if order == "reversed" else chance.sample(jobs, len(jobs))

    def dispatch() -> None:
        nonlocal moved
        moved += service.dispatch_in(changed)

    image = _image_in_turns(service, before_workers=dispatch)
    assert moved >= RANGES
    assert differing_values(image, traced_alone) == {}


@pytest.fixture
def rounds_otherwise(tmp_path: Path) -> dict[str, str]:
    """The environment of a program in which tiny numbers become zero: an empty library does that to every
    process that loads it, if it was linked with fast mathematics."""
    library = tmp_path / "libfast.so"
    subprocess.run(["gcc", "-shared", "-ffast-math", "-x", "c", "/dev/null", "-o", library], check=True)
    return {"LD_PRELOAD": str(library)}


def test_a_worker_that_rounds_otherwise(
    services: Services, traced_alone: Image, rounds_otherwise: dict[str, str]
) -> None:
    """W8: it has another floating-point profile, and gets no jobs."""
    service = services(2)
    service.start_worker(environment=rounds_otherwise)
    odd = next(reversed(service.workers))
    service.wait_for_workers()
    endless = submit(service.client, 2**20)
    wait_for(
        lambda: any(each.incompatible for each in service.client.workers()), "a worker to be incompatible"
    )
    classes = {each.id: each.floating_point_profile for each in service.client.workers()}
    reasons = {each.id: each.incompatible for each in service.client.workers() if each.incompatible}
    service.client.cancel(endless)
    with followed_render(service) as render:
        image = render.finished_image()
    others = {floating_point_profile for name, floating_point_profile in classes.items() if name != odd}
    assert len(others) == 1
    assert others == {service.client.get(render.id).floating_point_profile}
    assert classes[odd] not in others
    assert reasons == {
        odd: f"It rounds otherwise: floating-point profile {classes[odd]}; "
        f"the open renders have {others.pop()}."
    }
    assert odd not in service.contributors(render.id)
    assert all(each.quarantine == "" for each in service.client.workers())
    service.end_worker(odd)
    assert differing_values(image, traced_alone) == {}


def test_the_c_library_does_not_matter(services: Services) -> None:
    """W8: without its fused multiply-adds, as on a processor that has none, its functions differ in the last
    bit here and there; the worker has the profile of others."""
    service = services(1)
    service.start_worker(environment={"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2"})
    odd = next(reversed(service.workers))
    service.wait_for_workers()
    assert len({each.floating_point_profile for each in service.client.workers()}) == 1
    service.end_worker(odd)


Mend = Callable[[], object]


def _full_disk(worker: Program, _: Path) -> Mend:
    """No file of it can grow. SIGXFSZ, which no full disk sends, is ignored by what starts it."""
    soft, hard = resource.prlimit(worker.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(worker.pid, resource.RLIMIT_FSIZE, (0, hard))
    return lambda: resource.prlimit(worker.pid, resource.RLIMIT_FSIZE, (soft, hard))


def _folder_that_can_not_be_written(_: Program, cache: Path) -> Mend:
    """A file is in its place, which stops root as well."""
    shutil.rmtree(cache)
    cache.touch()
    return cache.unlink


@pytest.mark.parametrize(
    "trouble", [_full_disk, pytest.param(_folder_that_can_not_be_written, marks=pytest.mark.soak)]
)
def test_a_worker_that_can_not_keep_the_scene(
    trouble: Callable[[Program, Path], Mend],
    services: Services,
    tmp_path: Path,
    traced_alone: Image,
) -> None:
    """W9: it hands its jobs back, which is no failure, until it can."""
    service = services(1)
    (healthy,) = service.workers
    cache = tmp_path / "cache"
    worker = service.start_worker(cache)
    name = next(reversed(service.workers))
    service.wait_for_workers()
    mend = trouble(worker, cache)
    # It goes on when there is a job for it to take over, or it could have done them all by then.
    service.workers[healthy].pause()
    with followed_render(service) as render:
        wait_for(lambda: service.jobs_given_back_by(name), f"{name} to hand a job back")
        given_back = set(service.jobs_given_back_by(name))
        service.workers[healthy].go_on()
        wait_for(lambda: not given_back <= set(service.jobs_held_by(name)), "the other to take it over")
        wait_for_more_ranges(service.client, render.id, _SOME_RANGES)
        assert not (cache.is_dir() and [path for path in cache.rglob("*") if path.is_file()])
        service.end_worker(healthy)
        assert is_in_mid_work(service.client, render.id)
        mend()
        begun = time.monotonic()
        wait_for_more_ranges(service.client, render.id, 1, BOUND_S)
        note(f"W9 {trouble.__name__[1:]}", resumed_s=time.monotonic() - begun)
        image = render.finished_image()
        assert service.client.get(render.id).progress.refused == 0
    assert differing_values(image, traced_alone) == {}
