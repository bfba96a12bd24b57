"""Real workers and scenes that would hold them: no job keeps a thread."""

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_coordinator.queue import keys

from bench.programs import children_cpu_s, running_cpu_s
from tests.system.renders import has_ended, wait_for_more_ranges
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

FREE_S = 2.0
"""The promised time from the answer to a call until no thread has a job of the render.

Measured in the processor time that a worker of one thread still takes: other programs do not lengthen that.
"""

_PANEL = {
    "shape": {"type": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
    "kernel": {"type": "lambertian", "reflectance": 0.5},
    "luminaire": {"radiance": {"blackbody": 3000}},
}
_CAMERA = {
    "type": "pinhole",
    "position": [0, 0, 4],
    "look_at": [0, 0, 0],
    "vertical_field_of_view_degrees": 40,
}
QUICK: dict[str, Any] = {"nocturne": 1, "sensor": _CAMERA, "surfaces": [_PANEL]}
ENDLESS = {**QUICK, "media": {"fog": {"scattering": 1e6}}, "unbounded_media": ["fog"]}
"""A million collisions for every metre: what starts at the camera never gets anywhere."""

SLOW = {**QUICK, "media": {"fog": {"scattering": 1e3, "absorption": 1.0}}, "unbounded_media": ["fog"]}
"""Some tenths of a millisecond for a sample: a thousand collisions, and hardly ever many times as many."""


@pytest.fixture
def service(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[ServiceProcesses]:
    """Two workers, and a coordinator that wants jobs of a second, or of what a test says."""
    running = ServiceProcesses(tmp_path, "--job-seconds", getattr(request, "param", "1"))
    try:
        running.start()
        running.have_workers(2)
        yield running
    finally:
        running.close()


def submit(service: ServiceProcesses, scene: dict[str, Any], samples: int, edge: int = 64) -> str:
    """Gives its id."""
    asked = {"scene": scene, "width": edge, "height": edge, "samples": samples}
    asked["request_id"] = f"{time.time()}"
    answer = httpx.post(f"{service.url}/v1/renders", json=asked, timeout=300)
    assert answer.is_success, answer.text
    return str(answer.json()["id"])


def _held(service: ServiceProcesses) -> list[bytes]:
    return [entry for worker in service.workers for entry in service.jobs_held_by(worker)]


def _all_threads_are_held(service: ServiceProcesses) -> bool:
    return all(service.jobs_held_by(worker) for worker in service.workers)


@pytest.mark.parametrize("verb", ["cancel", "pause"])
def test_a_render_that_is_let_go_frees_its_threads(verb: str, service: ServiceProcesses) -> None:
    """P2: cancelled or paused, in the middle of photons that would never end."""
    hostile = submit(service, ENDLESS, 4)
    wait_for(lambda: _all_threads_are_held(service), "all threads to be held")
    httpx.post(f"{service.url}/v1/renders/{hostile}:{verb}", json={}).raise_for_status()
    before = [running_cpu_s(worker.pid) for worker in service.workers.values()]
    wait_for(lambda: not _held(service), "the threads to be free")
    after = [running_cpu_s(worker.pid) for worker in service.workers.values()]
    assert all(b - a < FREE_S for a, b in zip(before, after, strict=True))
    good = submit(service, QUICK, 4, 32)
    wait_for(lambda: has_ended(service.client, good), "another render to end")
    assert service.client.get(good).state == "SUCCEEDED"


def test_a_worker_told_to_end_frees_its_threads(service: ServiceProcesses) -> None:
    """P2: SIGTERM in the middle of photons that would never end; the jobs are handed back."""
    submit(service, ENDLESS, 4)
    wait_for(lambda: _all_threads_are_held(service), "all threads to be held")
    name = next(iter(service.workers))
    # Of its whole life, when it has ended.
    before = running_cpu_s(service.workers[name].pid) + children_cpu_s()
    service.end_worker(name)
    assert children_cpu_s() - before < FREE_S


@pytest.mark.parametrize("service", ["0.1"], indirect=True)
def test_a_job_beyond_its_processor_time_fails_and_says_so(service: ServiceProcesses) -> None:
    """P2: nobody cancels it; its first ranges can't be cut any smaller."""
    hostile = submit(service, ENDLESS, 4, 32)
    wait_for(lambda: has_ended(service.client, hostile), "the hostile render to end")
    render = service.client.get(hostile)
    assert render.state == "FAILED"
    assert "of processor time" in render.reason
    good = submit(service, QUICK, 4, 32)
    wait_for(lambda: has_ended(service.client, good), "another render to end")
    assert service.client.get(good).state == "SUCCEEDED"


@pytest.mark.parametrize("service", ["0.3"], indirect=True)
def test_ranges_are_cut_by_what_earlier_ones_took(service: ServiceProcesses) -> None:
    """P2: jobs of a slow scene take about as long as they should, and its threads do other work between."""
    slow = submit(service, SLOW, 2048, 8)
    # Ten: 4, 4, 8, 16, up to 1024 samples, for as long as nobody knows how slow they are.
    wait_for(lambda: service.client.get(slow).progress.ranges_planned > 10, "the ranges to be cut")
    wait_for_more_ranges(service.client, slow, 3)
    assert service.client.get(slow).progress.refused == 0
    service.client.cancel(slow)


def test_photons_that_are_ended_are_told(tmp_path: Path) -> None:
    """P2: a limit of interactions is bias: render and image say how many photons it ended, here all:
    four of its pixel, and those that they sent towards the light."""
    service = ServiceProcesses(tmp_path)
    try:
        service.start()
        service.have_workers(1)
        render = submit(service, ENDLESS, 1, 1)
        wait_for(lambda: has_ended(service.client, render), "the render to end")
        told = service.client.get(render)
        assert told.state == "SUCCEEDED"
        assert told.progress.truncated_paths >= 4
        image = service.client.download(render, "exr", tmp_path / "image.exr")
        assert b"nocturne:truncatedPaths" in image.read_bytes()
        assert service.queue.xlen(keys.RESULTS) == 0
    finally:
        service.close()
