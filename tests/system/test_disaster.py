"""The machine with Redis, coordinator and data folder is gone for good, workers included."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from nocturne_coordinator.store.checkpoint import checkpoints

from tests.pictures import samples_of
from tests.system.images import Image, differing_values
from tests.system.renders import RANGES, finished_image, submit, wait_for_more_ranges
from tests.system.service_processes import ServiceProcesses
from tests.system.up import NOCTURNE
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system


def test_another_machine_goes_on_from_the_last_checkpoint(
    tmp_path_factory: pytest.TempPathFactory, traced_alone: Image
) -> None:
    lost, safe, place = (tmp_path_factory.mktemp(name) for name in ("lost", "safe", "new"))
    service = ServiceProcesses(lost, "--checkpoints", safe, "--checkpoint-seconds", "0.2")
    try:
        service.start()
        service.have_workers(1)
        render_id = submit(service.client)
        wait_for_more_ranges(service.client, render_id, 12)
        service.pause_workers()  # Else a checkpoint that is late has the whole render.
        wait_for(lambda: _has_samples(safe, render_id), "a checkpoint")
    finally:
        service.close()
    shutil.rmtree(lost)

    words: list[str | Path] = [NOCTURNE, "restore", "--data", place / "data", "--from", safe, "--json"]
    told = json.loads(subprocess.run(words, check=True, capture_output=True).stdout)
    assert told["renders"] == 1
    assert told["missing"] == []
    assert 0 < told["open_ranges"] < RANGES
    service = ServiceProcesses(place)
    try:
        service.start()
        service.have_workers(2)
        image = finished_image(service.client, render_id)
        service.check_nothing_left()
    finally:
        service.close()
    assert differing_values(image, traced_alone) == {}


def _has_samples(safe: Path, render_id: str) -> bool:
    made = checkpoints(safe)
    return bool(made) and any(samples_of(made[0].renders.get(render_id, "")))
