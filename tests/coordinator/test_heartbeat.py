"""The file that probes look at is touched while the coordinator's loop turns, and no longer."""

import os
import time
from pathlib import Path

from nocturne_coordinator.heartbeat import Heartbeat

from tests.coordinator.service import RedisServer, Service, wait_until


def test_it_is_touched_about_once_a_second(tmp_path: Path) -> None:
    file = tmp_path / "alive"
    sign = Heartbeat(file)
    sign()
    assert file.exists()
    os.utime(file, (0.0, 0.0))
    sign()
    assert file.stat().st_mtime == 0.0


def test_long_work_is_told_of_beforehand(tmp_path: Path) -> None:
    file = tmp_path / "alive"
    sign = Heartbeat(file)
    sign()
    sign.busy(100.0)
    assert file.stat().st_mtime > time.time() + 90.0
    sign()
    assert file.stat().st_mtime < time.time() + 1.0


def test_a_folder_that_is_gone_does_not_end_the_loop(tmp_path: Path) -> None:
    Heartbeat(tmp_path / "gone" / "alive")()


def test_a_coordinator_keeps_its_file_fresh(tmp_path: Path) -> None:
    file = tmp_path / "alive"
    server = RedisServer(tmp_path)
    service = Service(tmp_path / "data", server)
    try:
        service.start("", "--alive", str(file))
        # Not before Redis has answered: it can't work yet.
        server.start()
        wait_until(file.exists)
        os.utime(file, (0.0, 0.0))
        wait_until(lambda: file.stat().st_mtime > 0.0)
    finally:
        service.close()
        server.kill()
