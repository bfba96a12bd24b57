"""The compose file on a real engine: built, brought up, its parts killed in turn, taken down."""

import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pytest
from nocturne_client import Client

from tests.containers.engine import Engine, engine
from tests.system.free_ports import free_port_pair
from tests.system.images import Image, differing_values
from tests.system.renders import CORNELL
from tests.system.up import NOCTURNE
from tests.system.waiting import wait_for

pytestmark = pytest.mark.containers

WORKERS = 3
# With a third of a processor for each worker a minute and more on any machine: enough for all faults.
_SIZE = (200, 150, 2048)
_UP_S = 600.0
_RENDER_S = 3600.0


@dataclass
class Stack:
    """All containers, and a client with a token."""

    engine: Engine
    url: str
    token: str

    def client(self) -> Client:
        return Client(self.url, token=self.token)

    def is_healthy(self, container: str) -> bool:
        state = self.engine.inspect(container)["State"]
        return bool(state["Running"]) and state["Health"]["Status"] == "healthy"

    def wait_for_health(self, container: str) -> None:
        wait_for(lambda: self.is_healthy(container), "the container to be healthy", _UP_S)

    def kill(self, container: str) -> None:
        """SIGKILL from outside, so that the engine takes it for a crash, and starts it again by itself."""
        before = self.engine.inspect(container)
        os.kill(before["State"]["Pid"], signal.SIGKILL)
        wait_for(
            lambda: self.engine.inspect(container)["RestartCount"] > before["RestartCount"],
            "the engine to notice",
        )
        self.wait_for_health(container)


def _timed(what: str, call: Callable[[], object]) -> None:
    begun = time.monotonic()
    call()
    print(f"{what}: {time.monotonic() - begun:.0f} s", flush=True)  # noqa: T201 - the record of this run


@pytest.fixture(scope="module")
def stack() -> Iterator[Stack]:
    with engine() as found:
        print(f"\n{found.versions()}", flush=True)  # noqa: T201
        port = free_port_pair()
        found.environment |= {
            "NOCTURNE_PORT": str(port),
            "NOCTURNE_GRPC_PORT": str(port + 1),
            "NOCTURNE_THREADS": "1",
            "NOCTURNE_WORKER_CPUS": "0.3",
        }
        found.compose("down", "--volumes")
        _timed("build", lambda: found.compose("build"))
        try:
            _timed("up", lambda: found.compose("up", "--detach", "--scale", f"worker={WORKERS}"))
            made = Stack(found, f"http://127.0.0.1:{port}", "")
            for service in ("redis", "coordinator", "api"):
                made.wait_for_health(found.container(service))
            for number in range(1, WORKERS + 1):
                made.wait_for_health(found.container("worker", number))
            made.token = found.exec(
                found.container("api"), "cat", "/secrets/token-admin/token"
            ).stdout.strip()
            yield made
        except BaseException:
            print(found.compose("logs", "--tail", "40"), flush=True)  # noqa: T201
            raise
        finally:
            found.compose("down", "--volumes", "--timeout", "40")
        left = found.docker(
            "ps", "--all", "--quiet", "--filter=label=com.docker.compose.project=nocturne-check"
        )
        assert left == ""
        assert found.docker("volume", "ls", "--quiet", "--filter=name=nocturne-check") == ""


def _is_further(client: Client, render_id: str, ranges: int) -> bool:
    return client.get(render_id).progress.ranges_done > ranges


def test_all_parts_may_die_and_the_image_is_the_same(stack: Stack, tmp_path: Path) -> None:
    width, height, samples = _SIZE
    with stack.client() as client:
        wait_for(lambda: len(client.workers()) == WORKERS, "all workers to be known")
        begun = time.monotonic()
        render_id = client.submit(CORNELL, width, height, samples).id

        for service, number in (("worker", 2), ("redis", 1), ("coordinator", 1), ("api", 1)):
            before = client.get(render_id).progress.ranges_done
            wait_for(partial(_is_further, client, render_id, before), "the render to go on")
            assert client.get(render_id).state == "RUNNING"
            container = stack.engine.container(service, number)
            _timed(f"{service} killed, healthy again", partial(stack.kill, container))
        wait_for(lambda: client.get(render_id).has_ended, "the render to end", _RENDER_S)
        ended = client.get(render_id)
        assert ended.state == "SUCCEEDED", ended.reason
        print(f"render with four faults: {time.monotonic() - begun:.0f} s", flush=True)  # noqa: T201
        client.download(render_id, "exr", tmp_path / "service.exr")
    film = ["--width", str(width), "--height", str(height), "--samples", str(samples)]
    here = tmp_path / "here.exr"
    _timed(
        "nocturne render",
        lambda: subprocess.run([NOCTURNE, "render", CORNELL, *film, "-o", here], check=True),
    )
    assert differing_values(Image.read(tmp_path / "service.exr"), Image.read(here)) == {}


_ASK = r"""
exec 3<>/dev/tcp/api/7070
printf 'GET /v1/renders HTTP/1.1\r\nHost: api\r\n%s\r\nConnection: close\r\n\r\n' "$1" >&3
head -n 1 <&3
"""


def _first_line(stack: Stack, container: str, header: str) -> str:
    """Of the API's answer to a call from there."""
    return stack.engine.exec(container, "bash", "-c", _ASK, "ask", header).stdout


def test_a_worker_has_its_own_secrets_only(stack: Stack) -> None:
    worker = stack.engine.container("worker")
    assert stack.engine.exec(worker, "ls", "/secrets").stdout.split() == ["token-worker"]
    token = stack.engine.exec(worker, "cat", "/secrets/token-worker/token").stdout.strip()
    # The API takes its token for assets, and nothing without one.
    assert " 401 " in _first_line(stack, worker, "X-Nobody: yes")
    assert " 403 " in _first_line(stack, worker, f"Authorization: Bearer {token}")
    # Nobody but the API is there to listen besides Redis.
    refused = stack.engine.exec(worker, "bash", "-c", "exec 3<>/dev/tcp/coordinator/7070")
    assert refused.returncode != 0


def test_no_secret_stands_in_the_settings_of_a_container(stack: Stack) -> None:
    secrets = {
        stack.engine.exec(stack.engine.container(service), "cat", f"/secrets/{name}").stdout.strip()
        for service, name in (
            ("redis", "redis-coordinator/password"),
            ("worker", "token-worker/token"),
            ("api", "token-admin/token"),
        )
    }
    assert len(secrets) == 3
    assert all(len(secret) >= 43 for secret in secrets)
    for service in ("redis", "coordinator", "api", "worker"):
        settings = json.dumps(stack.engine.inspect(stack.engine.container(service)))
        assert not any(secret in settings for secret in secrets), service


def test_containers_have_limits(stack: Stack) -> None:
    for service in ("redis", "coordinator", "api", "worker"):
        limits = stack.engine.inspect(stack.engine.container(service))["HostConfig"]
        assert limits["Memory"] > 0, service
        assert limits["PidsLimit"] > 0, service
        assert limits["NanoCpus"] > 0 or service == "worker", service
        assert limits["ReadonlyRootfs"], service
