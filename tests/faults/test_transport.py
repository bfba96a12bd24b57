"""Slow, cut, silent and lossy networks between Redis and its users, results that come often: rows T of the
fault matrix. The image stays the same in every bit, and work goes on soon after."""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest

from tests.coordinator.service import Service
from tests.coordinator.simulated_worker import Shuffled, SimulatedWorker
from tests.faults.survival import check_survived, note
from tests.faults.wire import Weather, Wire
from tests.system.images import Image, differing_values
from tests.system.renders import RANGES, followed_render, has_ended, is_in_mid_work, wait_for_more_ranges
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

# How long a network is spoilt: five leases of the workers, which have one second here.
SPOILT_S = float(os.environ.get("NOCTURNE_SPOILT_SECONDS", "5"))
# From the mending to the next commit: the longest time that anybody waits for an answer on a connection that
# is dead (5 s), or for a connection (5 s), the longest pause before another try (2 s), a lease (1 s), and as
# much again as all that for a job and a commit on a machine that has other things to do.
BOUND_S = 2.0 * (5.0 + 5.0 + 2.0 + 1.0)
_SOME_RANGES = 8


@dataclass(frozen=True)
class Network:
    """A service whose coordinator and workers connect to Redis by separate wires."""

    service: ServiceProcesses
    coordinator: Wire
    worker: Wire


@pytest.fixture(scope="module")
def network(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Network]:
    folder = tmp_path_factory.mktemp("net")
    with Wire(folder / "redis.sock", 1) as coordinator, Wire(folder / "redis.sock", 2) as worker:
        service = ServiceProcesses(folder, coordinator_port=coordinator.port, worker_port=worker.port)
        service.start()
        service.have_workers(2)
        yield Network(service, coordinator, worker)
        service.close()


def _cut(wire: Wire) -> None:
    wire.cut()


def _silent(wire: Wire) -> None:
    wire.fall_silent()


def _slow(wire: Wire) -> None:
    wire.weather = Weather(delay_s=0.25, loss=0.05)


Fault = Callable[[Wire], None]
WIRES = ("worker", "coordinator", "both")


def _wires(network: Network, which: str) -> list[Wire]:
    found = {"worker": [network.worker], "coordinator": [network.coordinator]}
    return found.get(which, [network.worker, network.coordinator])


@pytest.mark.system
@pytest.mark.parametrize(
    ("fault", "which"),
    [
        (_cut, "worker"),
        (_silent, "coordinator"),
        pytest.param(_cut, "coordinator", marks=pytest.mark.soak),
        pytest.param(_silent, "worker", marks=pytest.mark.soak),
        *(pytest.param(fault, "both", marks=pytest.mark.soak) for fault in (_cut, _silent)),
        *(pytest.param(_slow, which, marks=pytest.mark.soak) for which in WIRES),
    ],
)
def test_a_spoilt_network(fault: Fault, which: str, network: Network, traced_alone: Image) -> None:
    """T1: cut, silent or slow for five leases."""
    service = network.service
    with followed_render(service) as render:
        wait_for_more_ranges(service.client, render.id, _SOME_RANGES)
        assert is_in_mid_work(service.client, render.id)
        for wire in _wires(network, which):
            assert wire.connections > 0
            fault(wire)
        time.sleep(SPOILT_S)
        before = service.client.get(render.id).progress.ranges_done
        assert before < RANGES, "the render was over before the network was mended"
        mended = time.monotonic()
        for wire in _wires(network, which):
            wire.mend()
        wait_for(
            lambda: service.client.get(render.id).progress.ranges_done > before, "progress", seconds=BOUND_S
        )
        resumed = time.monotonic() - mended
        image = render.finished_image()
    assert differing_values(image, traced_alone) == {}
    note(f"{fault.__name__[1:]} {which}", resumed_s=resumed)


@pytest.mark.system
@pytest.mark.soak
def test_work_goes_on_while_a_network_is_slow(network: Network, traced_alone: Image) -> None:
    """T1: 500 ms there and back, every twentieth packet lost: slower, and no slower than that explains."""
    service = network.service
    with followed_render(service) as render:
        wait_for_more_ranges(service.client, render.id, 1)
        network.worker.weather = network.coordinator.weather = Weather(delay_s=0.25, loss=0.05)
        begun, before = time.monotonic(), service.client.get(render.id).progress.ranges_done
        wait_for_more_ranges(service.client, render.id, _SOME_RANGES)
        took = time.monotonic() - begun
        done = service.client.get(render.id).progress.ranges_done - before
        network.worker.mend()
        network.coordinator.mend()
        image = render.finished_image()
    assert differing_values(image, traced_alone) == {}
    note("slow both, while it lasts", seconds_per_range=took / done)


@pytest.mark.system
@pytest.mark.parametrize(
    ("which", "share"),
    [("both", 0.02), *(pytest.param(each, 0.1, marks=pytest.mark.soak) for each in WIRES)],
)
def test_answers_that_are_lost(which: str, share: float, network: Network, traced_alone: Image) -> None:
    """T2: a share of all calls is executed without an answer; each takes effect once."""
    service = network.service
    lost = [wire.lost for wire in _wires(network, which)]
    begun = time.monotonic()
    with followed_render(service) as render:
        for wire in _wires(network, which):
            wire.weather = Weather(lost_answers=share)
        # The worst case: a coordinator makes a dozen calls before it is in step, and starts over after any
        # loss.
        wait_for(lambda: has_ended(service.client, render.id), "the render to end", seconds=400.0)
        took = time.monotonic() - begun
        for wire in _wires(network, which):
            wire.mend()
        image = render.finished_image()
    assert differing_values(image, traced_alone) == {}
    now = [wire.lost for wire in _wires(network, which)]
    assert all(after > before for before, after in zip(lost, now, strict=True))
    note(f"lost answers {which} {share:g}", lost=float(sum(now) - sum(lost)), took_s=took)


@pytest.mark.parametrize(("seed", "copies"), [(3, 10)])
def test_results_come_often_and_shuffled(service: Service, seed: int, copies: int) -> None:
    """T3: each twice, or ten times, in any order, some much later."""
    service.start()
    render = service.create()
    for offset in range(2):
        service.work(SimulatedWorker(service.server.url, Shuffled(seed + 10 * offset, copies)))
    check_survived(service, render.id)
