"""Two APIs on one data folder, with nothing in front of them, are one service: real processes."""

import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_client.local.programs import need_program
from nocturne_scene.replacing import UNFINISHED

from tests.coordinator.service import RedisServer, Service, wait_until
from tests.services.webhook_receiver import Receiver
from tests.system.free_ports import free_port_pair
from tests.system.program import Program


class Replica:
    """An API process, and a client with its own cookies that knows this one alone."""

    def __init__(self, data: Path, name: str, *words: str | Path) -> None:
        port = free_port_pair()
        self.socket = data.with_name(f"{name}.sock")
        ports = ("--port", str(port), "--grpc-port", str(port + 1), "--grpc-unix", str(self.socket))
        command = [sys.executable, "-m", "nocturne_api.main", "--data", data, *ports, *words]
        self.program = Program(command, data.with_name(f"{name}.log"))
        self.http = httpx.Client(base_url=f"http://127.0.0.1:{port}", trust_env=False, timeout=120)

    def start(self) -> None:
        self.program.start()
        wait_until(self._answers)

    def close(self) -> None:
        self.program.kill()
        self.http.close()

    def _answers(self) -> bool:
        assert self.program.is_alive(), self.program.tail()
        with suppress(httpx.TransportError):
            return self.http.get("/healthz").status_code == 200
        return False


@pytest.fixture
def farm(tmp_path: Path, redis_server: RedisServer) -> Iterator[Service]:
    """The folder, with a coordinator and simulated workers; none runs yet."""
    farm = Service(tmp_path / "data", redis_server)
    yield farm
    farm.close()


@pytest.fixture
def replicas(farm: Service, web: Path) -> Iterator[tuple[Replica, Replica]]:
    """They ask for tokens, and an owner may have two open renders."""
    words = ("--web", web, "--auth", "--owner-open-renders", "2", "--webhook-network", "127.0.0.1/32")
    both = Replica(farm.data, "a", *words), Replica(farm.data, "b", *words)
    try:
        for each in both:
            each.start()
        yield both
    finally:
        for each in both:
            each.close()


def begun(replica: Replica, secret: str) -> dict[str, str]:
    """A session's cookie, as a header."""
    answer = replica.http.post("/v1/session", headers={"Authorization": f"Bearer {secret}"})
    assert answer.status_code == 200, answer.text
    cookie = {"Cookie": f"nocturne_token={replica.http.cookies['nocturne_token']}"}
    replica.http.cookies.clear()
    return cookie


@pytest.fixture
def worker(farm: Service, replicas: tuple[Replica, Replica]) -> Iterator[Program]:
    """A real one, that gets scenes from the second; not started yet."""
    words = ("--redis", farm.server.url, "--assets", f"unix:{replicas[1].socket}", "--threads", "1")
    cache = ("--cache", farm.data.with_name("cache"))
    worker = Program([need_program("nocturne-worker"), *words, *cache], farm.data.with_name("worker.log"))
    yield worker
    worker.kill()


@pytest.mark.system
def test_two_are_one_service(
    farm: Service, worker: Program, replicas: tuple[Replica, Replica], body: dict[str, Any]
) -> None:
    secret = farm.folder.tokens.create("ann", ["submit"])
    token = {"Authorization": f"Bearer {secret}"}
    a, b = replicas

    # A session begun at one opens the other, and ends at both.
    cookie = begun(a, secret)
    assert b.http.get("/v1/session", headers=cookie).json()["name"] == "ann"
    b.http.delete("/v1/session", headers=cookie)
    assert a.http.get("/v1/renders", headers=cookie).status_code == 401

    with Receiver() as receiver:
        hook = a.http.post("/v1/webhooks", json={"url": receiver.url}, headers=token)
        assert hook.status_code == 201, hook.text
        assert [each["id"] for each in b.http.get("/v1/webhooks", headers=token).json()["webhooks"]] == [
            hook.json()["id"]
        ]

        # The same request at the other is the same render; the quota is of both together.
        made = a.http.post("/v1/renders", json=body, headers=token).json()
        assert b.http.post("/v1/renders", json=body, headers=token).json()["id"] == made["id"]
        second = b.http.post("/v1/renders", json={**body, "request_id": "second"}, headers=token)
        assert second.status_code == 201, second.text
        for each in replicas:
            refused = each.http.post("/v1/renders", json={**body, "request_id": "third"}, headers=token)
            assert (refused.status_code, "open renders" in refused.text) == (429, True)
        lists = [each.http.get("/v1/renders", headers=token).json()["renders"] for each in replicas]
        assert lists[0] == lists[1]
        assert len(lists[0]) == 2

        # One watches what the other was asked for, and what the other does with it.
        states = []
        with b.http.stream("GET", f"/v1/renders/{made['id']}/events", headers=token) as stream:
            lines = stream.iter_lines()
            while not any('"state":"QUEUED"' in line.replace(" ", "") for line in lines):
                pass
            a.http.post(f"/v1/renders/{second.json()['id']}:cancel", json={}, headers=token)
            farm.start()
            worker.start()
            states = [line for line in lines if line.startswith("data:")]
        assert '"state":"SUCCEEDED"' in states[-1].replace(" ", "")
        wait_until(lambda: farm.row(made["id"]).image_final)
        images = [each.http.get(f"/v1/renders/{made['id']}/image.exr", headers=token) for each in replicas]
        assert images[0].content == images[1].content
        assert {image.status_code for image in images} == {200}

        # Both send messages; each goes out once. What one left behind, the other does.
        wait_until(lambda: len(receiver.got) == 1)
        a.program.kill()
        deleted = b.http.delete(f"/v1/renders/{made['id']}", headers=token)
        assert deleted.status_code == 204, deleted.text
        wait_until(lambda: not farm.folder.removals.open())
        assert len(receiver.got) == 1
    assert not [path for path in farm.data.rglob(f"{UNFINISHED}*") if path.is_file()]
