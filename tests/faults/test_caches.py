"""Caches of workers whose files are changed by somebody else."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.faults.test_long_jobs import QUICK, submit
from tests.system.images import Image, differing_values
from tests.system.renders import has_ended
from tests.system.service_processes import ServiceProcesses
from tests.system.waiting import wait_for

pytestmark = pytest.mark.system

_EDGE, _SAMPLES = 32, 16


@pytest.fixture
def service(tmp_path: Path) -> Iterator[ServiceProcesses]:
    running = ServiceProcesses(tmp_path)
    try:
        running.start()
        running.have_workers(2)
        yield running
    finally:
        running.close()


def _image_of(service: ServiceProcesses, scene: dict[str, Any], file: Path) -> Image:
    render = submit(service, scene, _SAMPLES, _EDGE)
    wait_for(lambda: has_ended(service.client, render), "the render to end")
    assert service.client.get(render).state == "SUCCEEDED"
    return Image.read(service.client.download(render, "exr", file))


def _flip_a_bit_of_every_file(cache: Path) -> None:
    """In place: who has one open, or mapped, has it still."""
    for file in (path for path in cache.glob("*/*") if path.is_file()):
        file.chmod(0o644)
        with file.open("r+b") as content:
            middle = file.stat().st_size // 2
            content.seek(middle)
            byte = content.read(1)
            content.seek(middle)
            content.write(bytes([byte[0] ^ 0x40]))


def test_a_bit_that_flips_in_a_cached_file(service: ServiceProcesses, tmp_path: Path) -> None:
    """P6: after the workers checked and read it, while they have it, and after they forgot it for others."""
    before = _image_of(service, QUICK, tmp_path / "before.exr")
    _flip_a_bit_of_every_file(tmp_path / "cache")
    again = _image_of(service, QUICK, tmp_path / "again.exr")
    assert differing_values(again, before) == {}
    for seed in (1, 2, 3):
        _image_of(service, {**QUICK, "tracing": {"seed": seed}}, tmp_path / "other.exr")
    after = _image_of(service, QUICK, tmp_path / "after.exr")
    assert differing_values(after, before) == {}
    assert "is damaged: fetching it again" in service.logs()
