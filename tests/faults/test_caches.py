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


def test_a_bit_that_flips_in_a_cached_file(service: ServiceProcesses, tmp_path: Path) -> None:
    """P6: after the workers checked and read it, and forgot the scene for others that came between."""
    before = _image_of(service, QUICK, tmp_path / "before.exr")
    for seed in (1, 2, 3):
        _image_of(service, {**QUICK, "tracing": {"seed": seed}}, tmp_path / "other.exr")
    files = [path for path in (tmp_path / "cache").glob("*/*") if path.is_file()]
    assert len(files) >= 4
    for file in files:
        content = bytearray(file.read_bytes())
        content[len(content) // 2] ^= 0x40
        file.chmod(0o644)
        file.write_bytes(content)
    after = _image_of(service, QUICK, tmp_path / "after.exr")
    assert differing_values(after, before) == {}
    assert "is damaged: fetching it again" in service.logs()
