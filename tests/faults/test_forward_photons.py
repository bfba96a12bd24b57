"""Real workers, and forward photons, with adjoint ones and alone: the service's image is that of `nocturne
render` in every bit, whatever happens meanwhile.

Half a minute for a large film; the same with simulated workers is in tests/coordinator."""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.faults.faults import deliver_waiting_results_again, kill_worker
from tests.system.images import Image, differing_values
from tests.system.renders import has_ended
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for


@dataclass(frozen=True)
class Film:
    """A render with forward photons."""

    width: int
    height: int
    samples: int
    forward_ratio: float
    """0: they bring all light."""
    ranges: int
    """Of all tiles, and of forward photons."""


# Four tiles; six million photons.
MANY_PHOTONS = Film(64, 48, 32, 64, 4 * 4 + 4)
# As many, on a film that light falls on.
METER = Film(48, 32, 4096, 0, 10)
LARGE = Film(520, 520, 8, 1, 17 * 17 * 2 + 3)


_SCENE: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 8],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "surfaces": [
        {
            "shape": {"type": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.6},
        },
        {
            "shape": {"type": "sphere", "centre": [1.6, 0, 0.7], "radius": 0.6},
            "kernel": {"type": "conductor", "index": "Au"},
        },
        {
            "shape": {
                "type": "quad",
                "corner": [-2.3, -0.3, 3],
                "edge_u": [0, 0.6, 0],
                "edge_v": [0.6, 0, 0],
            },
            "kernel": {"type": "lambertian", "reflectance": 0.0},
            "luminaire": {"radiance": {"blackbody": 3000}},
        },
    ],
}
"""A lamp that a ball of metal mirrors onto a floor. Most of the film sees nothing, which costs little."""
_METER = {
    "type": "irradiance_meter",
    "position": [0, 0, 0.1],
    "normal": [0, 0, 1],
    "up": [0, 1, 0],
    "height": 1,
}


@pytest.fixture(scope="module", params=[MANY_PHOTONS, METER, pytest.param(LARGE, marks=pytest.mark.soak)])
def film(request: pytest.FixtureRequest) -> Film:
    found: Film = request.param
    return found


@pytest.fixture(scope="module")
def scene(film: Film, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "scene.json"
    tracing = {"direction": "both", "sharing": 1, "forward_ratio": film.forward_ratio}
    document = {**_SCENE, "tracing": tracing}
    if not film.forward_ratio:
        document |= {"sensor": _METER, "tracing": {"direction": "forward"}}
    path.write_text(json.dumps(document))
    return path


@pytest.fixture(scope="module")
def alone(scene: Path, film: Film) -> Image:
    output = scene.with_name("alone.exr")
    size = ["--width", str(film.width), "--height", str(film.height), "--samples", str(film.samples)]
    command: list[str | Path] = [
        Path(sys.executable).with_name("nocturne"),
        "render",
        scene,
        "-o",
        output,
        *size,
    ]
    subprocess.run(command, check=True, capture_output=True)
    return Image.read(output)


@pytest.fixture(scope="module")
def service(film: Film, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceProcesses]:
    del film  # a service for each, whose first render is its own
    # As often as by default: a commit of photons writes the whole film.
    running = ServiceProcesses(tmp_path_factory.mktemp("service"), "--commit-seconds", "1")
    running.start()
    yield running
    running.close()


def _finished(service: ServiceProcesses, film: Film, render_id: str, tmp_path: Path) -> Image:
    wait_for(lambda: has_ended(service.client, render_id), "the render to end")
    render = service.client.get(render_id)
    assert render.state == "SUCCEEDED"
    assert render.progress.ranges_done == render.progress.ranges_planned == film.ranges
    assert render.progress.mean_samples == film.samples
    service.check_nothing_left()
    return Image.read(service.client.download(render_id, "exr", tmp_path / "image.exr"))


def test_photon_ranges_are_merged_exactly_once(
    service: ServiceProcesses, film: Film, scene: Path, alone: Image, tmp_path: Path
) -> None:
    """S2, T3, W1, C1: results twice, a worker killed, the coordinator killed, all in one render."""
    service.have_workers(2)
    render_id = service.client.submit(scene, film.width, film.height, film.samples).id
    wait_for(lambda: service.client.get(render_id).progress.ranges_done > 0, "something to be committed")
    deliver_waiting_results_again(service, render_id)
    hit = kill_worker(service, render_id)
    service.coordinator.kill()
    service.coordinator.start()
    image = _finished(service, film, render_id, tmp_path)
    assert hit
    assert differing_values(image, alone) == {}


def test_a_replay_has_the_same_bits(
    service: ServiceProcesses, film: Film, alone: Image, tmp_path: Path
) -> None:
    """One worker, by the manifest, which counts forward photons last."""
    service.have_workers(1)
    first = next(each.id for each in service.client.list() if each.has_ended)
    replayed = service.client.replay(first, "again").id
    assert differing_values(_finished(service, film, replayed, tmp_path), alone) == {}
