"""What tests of several folders share."""

import fcntl
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

from tests.coordinator.service import RedisServer, Service
from tests.system.images import Image
from tests.system.renders import BRIEF_SAMPLES, CORNELL, HEIGHT, SAMPLES, WIDTH
from tests.system.up import NOCTURNE, Up

# The same examples in every run (tests/fuzzing.py has others). No deadline: examples are no promise about
# time, and the first one of a process imports colour-science.
settings.register_profile("nocturne", deadline=None, derandomize=True)
settings.load_profile("nocturne")


class _Scheduling(LoadScopeScheduling):  # type: ignore[misc]  # pytest-xdist's class is not typed
    """Files whose tests share a service, or wait most of the time, stay whole and come first.

    Other tests go one by one to whoever is free.
    """

    def _split_scope(self, nodeid: str) -> str:
        path = nodeid.partition("::")[0]
        return path if path.startswith(_WHOLE) else nodeid


_WHOLE = (
    "tests/system/",
    "tests/faults/",
    "tests/accuracy/test_cornell.py",
    "tests/accuracy/test_error_bars.py",
)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Where several processes run the tests."""
    return _Scheduling(config, log)


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Up]:
    """`nocturne up` with one worker of two threads, on free ports and with its own data folder."""
    with Up(tmp_path_factory.mktemp("up")) as service:
        yield service


@pytest.fixture
def redis_server(tmp_path: Path) -> Iterator[RedisServer]:
    """On a Unix socket."""
    server = RedisServer(tmp_path)
    server.start()
    yield server
    server.kill()


@pytest.fixture
def service(tmp_path: Path, redis_server: RedisServer) -> Iterator[Service]:
    """A data folder, the coordinator as a process, simulated workers; none runs yet."""
    service = Service(tmp_path / "data", redis_server)
    yield service
    service.close()


@pytest.fixture(scope="session")
def traced_alone(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """The image of nocturne-trace, without a service: the reference for all other images."""
    return _traced_alone(tmp_path_factory, SAMPLES)


@pytest.fixture(scope="session")
def traced_alone_briefly(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """The same with BRIEF_SAMPLES."""
    return _traced_alone(tmp_path_factory, BRIEF_SAMPLES)


def _traced_alone(tmp_path_factory: pytest.TempPathFactory, samples: int) -> Image:
    """The first of the processes that run tests makes it."""
    ours = tmp_path_factory.getbasetemp()
    folder = ours.parent if "PYTEST_XDIST_WORKER" in os.environ else ours
    output = folder / f"alone-{samples}.exr"
    with output.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not output.exists():
            film = ["--width", str(WIDTH), "--height", str(HEIGHT), "--samples", str(samples)]
            made = output.with_suffix(".part.exr")
            subprocess.run([NOCTURNE, "render", CORNELL, "-o", made, *film], check=True, capture_output=True)
            made.rename(output)
    return Image.read(output)
