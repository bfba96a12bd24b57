"""A service for a night among strangers: Redis behind a tunnel, a user for each role, TLS, tokens."""

import os
import sys
from pathlib import Path

import trustme
from nocturne_client import Client
from nocturne_client.local.programs import need_program
from nocturne_coordinator.store.data_folder import DataFolder

from tests.system.free_ports import free_port_pair
from tests.system.program import Program
from tests.system.tunnel import NAME, authority_file, certificate, tunnel_end
from tests.system.waiting import wait_for

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
        self.tunnel_entrance, self.tunnel_port = free_port_pair(), free_port_pair()
        for end, accept, connect, name in (
            ("server", self.tunnel_entrance, str(socket_path), NAME),
            ("client", self.tunnel_port, f"127.0.0.1:{self.tunnel_entrance}", "worker"),
        ):
            pair = certificate(self.authority, self.folder, name)
            self.programs.append(tunnel_end(end, self.folder, accept, connect, pair, self.trusted))

    def _start(self, name: str, *command: str | Path, **environment: str) -> Program:
        program = Program(command, self.folder / f"{name}.log", environment)
        program.start()
        self.programs.append(program)
        return program
