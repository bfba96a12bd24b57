"""What tests of several folders share."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from tests.coordinator.service import RedisServer, Service
from tests.system.images import Image
from tests.system.renders import CORNELL, HEIGHT, SAMPLES, WIDTH
from tests.system.up import NOCTURNE, Up

# The same examples in every run (tests/fuzzing.py has others). No deadline: examples are no promise about
# time, and the first one of a process imports colour-science.
settings.register_profile("nocturne", deadline=None, derandomize=True)
settings.load_profile("nocturne")


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Up]:
    """`nocturne up` with one worker of two threads, on free ports and with a data folder of its own."""
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
    """The image of nocturne-trace, without a service: what every other way must give."""
    output = tmp_path_factory.mktemp("alone") / "image.exr"
    film = ["--width", str(WIDTH), "--height", str(HEIGHT), "--samples", str(SAMPLES)]
    subprocess.run([NOCTURNE, "render", CORNELL, "-o", Path(output), *film], check=True, capture_output=True)
    return Image.read(output)
