"""Everything at once, and fleets of every size: rows S of the fault matrix.

Its other tests: `test_every_interleaving.py`, `test_soak.py`, and with real workers `test_same_bits.py`."""

import random
import signal
from collections.abc import Callable
from itertools import permutations
from pathlib import Path

from tests.coordinator.service import RedisServer, Service, wait_until
from tests.coordinator.simulated_worker import Shuffled, SimulatedWorker, unaltered
from tests.faults.survival import SOME_DELAY, check_resumes, check_survived


def test_everything_is_killed_at_once_and_comes_back_in_any_order(service: Service) -> None:
    """S1: Redis, coordinator and workers; two of the six orders, all of them in memory."""
    workers: list[SimulatedWorker] = []

    def workers_come() -> None:
        workers[:] = [service.work(SimulatedWorker(service.server.url, delay=SOME_DELAY)) for _ in range(2)]

    parts: tuple[Callable[[], object], ...] = (service.server.start, service.start, workers_come)
    service.start()
    render = service.create(width=160, height=120, samples=20_000)
    workers_come()
    wait_until(lambda: service.row(render.id).ranges_done > 0)
    for order in random.Random(1).sample(list(permutations(parts)), 2):
        service.server.kill()
        service.stop(signal.SIGKILL)
        for worker in workers:
            worker.stop()
        for start in order:
            start()
        check_resumes(service, render.id, "S1")
    check_survived(service, render.id)


def test_fleets_of_any_size_give_the_same_file(tmp_path: Path) -> None:
    """S2: 1 and 7 workers, results in order and in any order, with and without time for a job; 2 and 3 in
    memory.

    Threads of a worker, and tiles in any order: `bits_test.cpp`.
    """
    files = set()
    for number, workers in enumerate((1, 7)):
        place = tmp_path / str(number)
        place.mkdir()
        server = RedisServer(place)
        server.start()
        service = Service(place / "data", server)
        try:
            service.start()
            render = service.create(samples=60)
            for each in range(workers):
                alter = Shuffled(each) if number % 2 else unaltered
                service.work(SimulatedWorker(server.url, alter, delay=0.003 * (each % 3)))
            check_survived(service, render.id)
            files.add(service.folder.image_path(render.id).read_bytes())
        finally:
            service.close()
            server.kill()
    assert len(files) == 1
