"""The tunnel for Redis admits only clients with a certificate of the deployment's authority."""

import socket
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlencode

import pytest
import redis
import trustme
from nocturne_coordinator.errors import QueueError
from nocturne_coordinator.queue.job_queue import JobQueue

from tests.coordinator.service import RedisServer
from tests.system.free_ports import free_port_pair
from tests.system.program import Program
from tests.system.tunnel import NAME, authority_file, certificate, needs_stunnel, tunnel_end

pytestmark = needs_stunnel


@dataclass
class Tunnel:
    """The tunnel's end at Redis, and the files for an end at a worker."""

    folder: Path
    port: int
    authority: trustme.CA
    others: trustme.CA
    programs: list[Program]

    def answers(self, pair: tuple[Path, Path], authority: Path, name: str = NAME) -> bool:
        """Whether Redis answers through a client's end."""
        port = free_port_pair()
        end = tunnel_end("client", self.folder, port, f"127.0.0.1:{self.port}", pair, authority, name)
        self.programs.append(end)
        try:
            with redis.Redis(port=port, socket_timeout=10, protocol=2) as client:
                return bool(client.ping())
        except redis.ConnectionError:
            return False


@pytest.fixture
def tunnel(tmp_path: Path) -> Iterator[Tunnel]:
    server = RedisServer(tmp_path)
    server.start()
    authority = trustme.CA()
    port = free_port_pair()
    pair = certificate(authority, tmp_path, NAME, "localhost")
    end = tunnel_end(
        "server", tmp_path, port, str(tmp_path / "redis.sock"), pair, authority_file(authority, tmp_path)
    )
    tunnel = Tunnel(tmp_path, port, authority, trustme.CA(), [end])
    yield tunnel
    for program in reversed(tunnel.programs):
        program.kill()
    server.kill()


def coordinators_address(tunnel: Tunnel, pair: tuple[Path, Path], host: str = "localhost") -> str:
    """As the manifest writes it."""
    files = {"ssl_ca_certs": tunnel.folder / "authority.pem", "ssl_certfile": pair[0], "ssl_keyfile": pair[1]}
    return f"rediss://{host}:{tunnel.port}?{urlencode(files)}"


def test_the_coordinator_needs_no_end_of_its_own(tunnel: Tunnel) -> None:
    """It speaks TLS itself; Redis has to show a certificate of its name, as it has to show its own."""
    pair = certificate(tunnel.authority, tunnel.folder, "coordinator")
    with closing(JobQueue(coordinators_address(tunnel, pair))) as queue:
        queue.check_settings()
    stranger = certificate(tunnel.others, tunnel.folder, "stranger")
    for address in (
        coordinators_address(tunnel, stranger),
        coordinators_address(tunnel, pair, "127.0.0.1"),
        f"redis://localhost:{tunnel.port}",
    ):
        with closing(JobQueue(address)) as queue, pytest.raises(QueueError):
            queue.check_settings()


def test_it_carries_redis(tunnel: Tunnel) -> None:
    pair = certificate(tunnel.authority, tunnel.folder, "worker-1")
    assert tunnel.answers(pair, tunnel.folder / "authority.pem")


Change = Callable[[Tunnel], tuple[tuple[Path, Path], Path, str]]

_STRANGERS: dict[str, Change] = {
    "a worker of another authority": lambda t: (
        certificate(t.others, t.folder, "worker-2"),
        t.folder / "authority.pem",
        NAME,
    ),
    "a Redis of another authority": lambda t: (
        certificate(t.authority, t.folder, "worker-3"),
        authority_file(t.others, t.folder, "others.pem"),
        NAME,
    ),
    "a Redis of another name": lambda t: (
        certificate(t.authority, t.folder, "worker-4"),
        t.folder / "authority.pem",
        "elsewhere.example",
    ),
}


@pytest.mark.parametrize("change", _STRANGERS.values(), ids=list(_STRANGERS))
def test_strangers_do_not_get_through(tunnel: Tunnel, change: Change) -> None:
    assert not tunnel.answers(*change(tunnel))


def test_without_tls_nothing_is_said(tunnel: Tunnel) -> None:
    with socket.create_connection(("127.0.0.1", tunnel.port), timeout=10) as plain:
        plain.sendall(b"PING\r\n")
        try:
            said = plain.recv(100)
        except ConnectionError:
            said = b""
    assert b"PONG" not in said
