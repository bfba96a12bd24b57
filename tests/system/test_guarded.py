"""A night among strangers: Redis behind a tunnel with a user for each role, TLS and tokens everywhere."""

import os
import ssl
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import trustme
from nocturne_client import Client
from nocturne_client.local.programs import need_program
from nocturne_coordinator.store.data_folder import DataFolder

from tests.system.free_ports import free_port_pair
from tests.system.images import Image, differing_values
from tests.system.program import Program
from tests.system.renders import BRIEF_SAMPLES, finished_image, submit
from tests.system.tunnel import NAME, authority_file, certificate, needs_stunnel, tunnel_end
from tests.system.waiting import wait_for

pytestmark = [pytest.mark.system, needs_stunnel]

_START_REDIS = Path(__file__).parents[2] / "deploy" / "redis" / "start.sh"
_COORDINATOR = "word of the coordinator"


class GuardedService:
    """All that deploy/kubernetes starts for one service, here."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.authority = trustme.CA()
        self.trusted = authority_file(self.authority, folder)
        self.port = free_port_pair()
        self.url = f"https://127.0.0.1:{self.port}"
        data = DataFolder(folder / "data")
        self.tokens = {scope: data.tokens.create(scope, [scope]) for scope in ("submit", "worker", "read")}
        data.close()
        self.programs: list[Program] = []
        self._start_redis()
        certificate_file, key = certificate(self.authority, folder, "127.0.0.1", "localhost")
        python, data_words = (sys.executable, "-m"), ("--data", folder / "data")
        self._start(
            "coordinator",
            *(*python, "nocturne_coordinator.main", *data_words, "--redis", f"unix://{folder}/redis.sock"),
            "--enrolled",
            NOCTURNE_REDIS_USER="coordinator",
            NOCTURNE_REDIS_PASSWORD=_COORDINATOR,
        )
        self._start(
            "api",
            *(*python, "nocturne_api.main", *data_words, "--auth"),
            *("--port", str(self.port), "--grpc-port", str(self.port + 1)),
            *("--tls-certificate", certificate_file, "--tls-key", key),
        )
        os.environ["NOCTURNE_CA"] = str(self.trusted)
        try:
            self.client = Client(self.url, token=self.tokens["submit"])
        finally:
            del os.environ["NOCTURNE_CA"]
        wait_for(self.client.is_ready, "the API")

    def start_worker(self, name: str, token: str, authority: Path) -> Program:
        return self._start(
            name,
            *(need_program("nocturne-worker"), "--id", name, "--threads", "1"),
            *("--redis", f"tcp://127.0.0.1:{self.tunnel_port}"),
            *("--assets", f"localhost:{self.port + 1}", "--assets-ca", authority),
            *("--cache", self.folder / f"cache-{name}", "--enrol"),
            NOCTURNE_TOKEN=token,
        )

    def close(self) -> None:
        for program in reversed(self.programs):
            program.kill()
        self.client.close()

    def _start_redis(self) -> None:
        """With both ends of its tunnel."""
        socket_path = self.folder / "redis.sock"
        self._start(
            "redis",
            *(_START_REDIS, "--port", "0", "--unixsocket", socket_path, "--dir", self.folder),
            NOCTURNE_REDIS_COORDINATOR_PASSWORD=_COORDINATOR,
        )
        wait_for(socket_path.exists, "redis-server")
        outside, self.tunnel_port = free_port_pair(), free_port_pair()
        for end, accept, connect, name in (
            ("server", outside, str(socket_path), NAME),
            ("client", self.tunnel_port, f"127.0.0.1:{outside}", "worker"),
        ):
            pair = certificate(self.authority, self.folder, name)
            self.programs.append(tunnel_end(end, self.folder, accept, connect, pair, self.trusted))

    def _start(self, name: str, *command: str | Path, **environment: str) -> Program:
        program = Program(command, self.folder / f"{name}.log", environment)
        program.start()
        self.programs.append(program)
        return program


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[GuardedService]:
    running = GuardedService(tmp_path_factory.mktemp("g"))
    yield running
    running.close()


def test_the_image_is_that_of_a_run_alone(service: GuardedService, traced_alone_briefly: Image) -> None:
    render_id = submit(service.client, BRIEF_SAMPLES)
    # Who has no token, the wrong one, or another authority gets no scene, and says so.
    others = authority_file(trustme.CA(), service.folder, "others.pem")
    strangers = {
        "not known, or was revoked": service.start_worker("stranger", "nct_wrong", service.trusted),
        "a token is needed": service.start_worker("nobody", "", service.trusted),
        "(gRPC status 14)": service.start_worker("deceived", service.tokens["worker"], others),
    }
    for words, stranger in strangers.items():
        wait_for(lambda stranger=stranger, words=words: words in stranger.tail(), words)  # type: ignore[misc]
        assert "loaded" not in stranger.tail()
        stranger.kill()
    assert service.client.get(render_id).progress.ranges_done == 0
    worker = service.start_worker("enrolled", service.tokens["worker"], service.trusted)
    image = finished_image(service.client, render_id, BRIEF_SAMPLES)
    assert differing_values(image, traced_alone_briefly) == {}
    # Redis may not know the machine for the first second.
    assert [
        line for line in worker.tail().splitlines() if "WARNING" in line and "WRONGPASS" not in line
    ] == []
    assert worker.end() == 0


def test_the_endpoints_speak_tls_to_those_with_tokens_only(service: GuardedService) -> None:
    with pytest.raises(httpx.ConnectError):
        httpx.get(f"{service.url}/v1/renders", trust_env=False)
    with pytest.raises(httpx.TransportError):
        httpx.get(f"http://127.0.0.1:{service.port}/v1/renders", trust_env=False)
    trusting = ssl.create_default_context(cafile=service.trusted)
    answer = httpx.get(f"{service.url}/v1/renders", verify=trusting, trust_env=False)
    assert answer.status_code == 401


def test_a_worker_that_can_not_enrol_ends_when_it_is_told(service: GuardedService) -> None:
    waiting = service.start_worker("waiting", "nct_wrong", service.trusted)
    wait_for(lambda: "can't enrol" in waiting.tail(), "the worker to wait")
    began = time.monotonic()
    assert waiting.end() == 0
    assert time.monotonic() - began < 3.0


def test_an_authority_that_is_none_is_named(tmp_path: Path) -> None:
    (tmp_path / "no.pem").write_text("no certificate")
    said = subprocess.run(
        [
            *(need_program("nocturne-worker"), "--redis", "tcp://127.0.0.1:1", "--assets", "localhost:1"),
            *("--cache", tmp_path, "--assets-ca", tmp_path / "no.pem"),
        ],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert said.returncode == 1
    assert "no.pem: has no certificate in PEM" in said.stderr
