"""Real workers: images that stop at an error or a time have the same bits whoever traced them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.coordinator.service import read_manifest
from tests.pictures import samples_of
from tests.system.images import Image, differing_values
from tests.system.renders import CORNELL, HEIGHT, WIDTH
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

_MANY = 100_000
"""Samples per pixel: hours."""


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceProcesses]:
    running = ServiceProcesses(tmp_path_factory.mktemp("night"))
    running.start()
    yield running
    running.close()


def ended(service: ServiceProcesses, render_id: str, folder: Path) -> tuple[str, bytes, Path]:
    """Waits for the end; gives the state, the image's bytes and its path."""
    wait_for(lambda: service.client.get(render_id).has_ended, "the render to end")
    path = service.client.download(render_id, "exr", folder / f"{render_id}.exr")
    return service.client.get(render_id).state, path.read_bytes(), path


def _is_foreseen(service: ServiceProcesses, render_id: str) -> bool:
    """Its end is forecast, or it has come: on a busy machine."""
    render = service.client.get(render_id)
    return render.progress.predicted_end > 0.0 or render.has_ended


def test_tiles_that_stop_at_their_own_error(service: ServiceProcesses, tmp_path: Path) -> None:
    images = []
    for workers in (1, 3):
        service.have_workers(workers)
        render = service.client.submit(CORNELL, WIDTH, HEIGHT, 256, stop={"tile_relative_error": 0.2})
        state, image, path = ended(service, render.id, tmp_path)
        assert state == "SUCCEEDED"
        images.append(image)
    assert images[0] == images[1]
    samples = samples_of(read_manifest(path))
    # 9 tiles, some of which are noisier than others.
    assert len(samples) == 9
    assert len(set(samples)) > 1
    assert min(samples) < max(samples) <= 256
    service.check_nothing_left()


def test_a_time_stops_it_and_a_replay_gives_the_bits(service: ServiceProcesses, tmp_path: Path) -> None:
    service.have_workers(3)
    render = service.client.submit(CORNELL, WIDTH, HEIGHT, _MANY, stop={"wall_seconds": 1.0})
    wait_for(lambda: _is_foreseen(service, render.id), "a forecast, or the end")
    # One leaves in order, in the middle of a job: it finishes or hands it back, and nothing fails. Two stay:
    # nobody could check the results of one alone.
    service.have_workers(2)
    state, image, path = ended(service, render.id, tmp_path)
    assert state == "STOPPED_EARLY"
    assert service.client.get(render.id).progress.refused == 0
    samples = Image.read(path).samples
    assert 0 < samples.min() < _MANY
    replay = service.client.replay(render.id)
    state, again, replayed = ended(service, replay.id, tmp_path)
    assert state == "SUCCEEDED"
    assert differing_values(Image.read(replayed), Image.read(path)) == {}
    assert again == image
    # An extension keeps the samples of the render: it traces only the rays of new ones.
    extended = service.client.extend(
        render.id,
        stop={"cpu_seconds": service.client.get(render.id).progress.cpu_seconds + 1.0},
        drop=["wall_seconds"],
    )
    assert not extended.has_ended
    state, _, longer = ended(service, render.id, tmp_path)
    assert state == "STOPPED_EARLY"
    assert np.all(Image.read(longer).samples >= samples)
    service.check_nothing_left()
