"""One owner who does all at once that kept others waiting before, until stopped."""

import json
import random
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

import grpc
import httpx
from nocturne.v1 import render_service_pb2, render_service_pb2_grpc

SCENE: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "surfaces": [
        {
            "shape": {"type": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.5},
            "luminaire": {"radiance": {"blackbody": 3000}},
        }
    ],
}
ENDLESS = {**SCENE, "media": {"m": {"scattering": 1e6}}, "unbounded_media": ["m"]}
"""A million collisions for every metre."""

_PNG = b"\x89PNG\r\n\x1a\n"


class Trickster:
    """An owner with the scope submit, who knows each place where others once waited for somebody."""

    def __init__(self, url: str, grpc_address: str, token: str, seed: int) -> None:
        self._url, self._grpc, self._token = url, grpc_address, token
        self._chance = random.Random(seed)
        self._over = threading.Event()
        self._hole = socket.socket()
        self._hole.bind(("127.0.0.1", 0))
        self._hole.listen(500)
        self.done: dict[str, int] = {}
        """How often each trick was played."""

    @contextmanager
    def at_work(self) -> Iterator[None]:
        """All tricks at once."""
        threads = [threading.Thread(target=self._again, args=(trick,)) for trick in self._tricks()]
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self._over.set()
            for thread in threads:
                thread.join()
            self._hole.close()

    def _tricks(self) -> list[Callable[[httpx.Client], None]]:
        return [
            *(self.a_film_as_large_as_all_memory, self.a_flood_of_small_films, self.work_without_end),
            *(self.an_idle_render_and_then_work, self.creates_that_leave, self.scenes_that_compile_long),
            *(self.watchers_that_never_read, self.messages_to_a_hole, self.pictures, self.changes_of_mind),
        ]

    def _again(self, trick: Callable[[httpx.Client], None]) -> None:
        headers = {"Authorization": f"Bearer {self._token}"}
        with httpx.Client(base_url=self._url, headers=headers, timeout=60, trust_env=False) as client:
            while not self._over.is_set():
                # What the service refuses, or answers late, is as good for a trick.
                with suppress(httpx.HTTPError, grpc.RpcError, OSError, KeyError):
                    trick(client)
                self.done[trick.__name__] = self.done.get(trick.__name__, 0) + 1
                self._over.wait(0.5)

    def _create(self, client: httpx.Client, scene: Any = SCENE, width: int = 8, samples: int = 1) -> str:
        number = self._chance.randrange(2**62)
        body = {"request_id": f"t{number}", "scene": scene, "width": width, "height": width}
        return str(client.post("/v1/renders", json={**body, "samples": samples}).json()["id"])

    def a_film_as_large_as_all_memory(self, client: httpx.Client) -> None:
        render = self._create(client, width=8192)
        self._over.wait(self._chance.uniform(2.0, 40.0))
        client.post(f"/v1/renders/{render}:cancel")

    def a_flood_of_small_films(self, client: httpx.Client) -> None:
        for _ in range(40):
            self._create(client)

    def work_without_end(self, client: httpx.Client) -> None:
        render = self._create(client, ENDLESS, 64, 1000)
        self._over.wait(20.0)
        client.post(f"/v1/renders/{render}:cancel")

    def an_idle_render_and_then_work(self, client: httpx.Client) -> None:
        renders = [self._create(client, ENDLESS, 32, 4)]
        self._over.wait(15.0)
        renders += [self._create(client, width=512, samples=200_000) for _ in range(4)]
        self._over.wait(20.0)
        for render in renders:
            client.post(f"/v1/renders/{render}:cancel")

    def creates_that_leave(self, client: httpx.Client) -> None:
        del client
        with grpc.insecure_channel(self._grpc) as channel:
            stub = render_service_pb2_grpc.RenderServiceStub(channel)
            for _ in range(8):
                number = self._chance.randrange(2**40)
                request = render_service_pb2.CreateRenderRequest(
                    request_id=f"g{number}",
                    scene_json=json.dumps(compiles_long(number)),
                    width=8,
                    height=8,
                    samples=1,
                )
                with suppress(grpc.RpcError):
                    metadata = (("authorization", f"Bearer {self._token}"),)
                    stub.CreateRender(request, timeout=0.3, metadata=metadata)

    def scenes_that_compile_long(self, client: httpx.Client) -> None:
        self._create(client, compiles_long(self._chance.randrange(2**40)))

    def watchers_that_never_read(self, client: httpx.Client) -> None:
        address = client.base_url
        sockets = []
        for _ in range(80):
            watcher = socket.create_connection((address.host, address.port), timeout=10)
            sockets.append(watcher)
            request = f"GET /v1/events HTTP/1.1\r\nHost: x\r\nAuthorization: Bearer {self._token}\r\n\r\n"
            watcher.sendall(request.encode())
        self._over.wait(20.0)
        for watcher in sockets:
            watcher.close()

    def messages_to_a_hole(self, client: httpx.Client) -> None:
        port = self._hole.getsockname()[1]
        for number in range(20):
            client.post("/v1/webhooks", json={"url": f"http://127.0.0.1:{port}/{number}"})
        self._over.wait(30.0)

    def pictures(self, client: httpx.Client) -> None:
        renders = client.get("/v1/renders", params={"page_size": 20}).json()["renders"]
        for render in renders:
            for name in ("image.exr", "denoised.exr", "denoised.png", "preview.png"):
                client.get(f"/v1/renders/{render['id']}/{name}")
        client.put("/v1/pictures", content=_PNG + bytes(10_000_000))

    def changes_of_mind(self, client: httpx.Client) -> None:
        for render in client.get("/v1/renders", params={"page_size": 50}).json()["renders"]:
            address = f"/v1/renders/{render['id']}"
            change = self._chance.randrange(5)
            if change == 0:
                client.post(f"{address}:pause")
                client.post(f"{address}:resume")
            elif change == 1:
                client.post(f"{address}:setPriority", json={"priority": self._chance.randint(1, 1000)})
            elif change == 2:
                client.post(f"{address}:extend", json={"samples": render["samples"] + 10})
            elif change == 3:
                client.get("/v1/renders", params={"search": "a " * 90})
            else:
                client.delete(address)


def compiles_long(number: int) -> Any:
    """Seconds of a processor: Mie's theory for droplets that nobody has asked about."""
    fog = {
        f"m{medium}": {
            "droplets": {
                "mode_radius": 1e-5 + (10 * (number % 10**6) + medium) * 1.1e-12,
                "alpha": 6.0,
                "gamma": 1.0,
                "number": 1e8,
            }
        }
        for medium in range(6)
    }
    return {**SCENE, "name": f"v{number}", "media": fog, "unbounded_media": [*fog]}


class Waits(NamedTuple):
    """What a small render's time was made of, seconds."""

    all: float
    for_processor: float
    """In which API, until it was made, and coordinator, after that, were ready to run and others had the
    processor: other programs of the machine, and the service's own."""


def seconds_of_a_small_render(client: httpx.Client, number: int, patience_s: float = 120.0) -> float:
    """From asking for 8 x 8 to hearing that it has ended."""
    return waits_of_a_small_render(client, number, {}, patience_s).all


def waits_of_a_small_render(
    client: httpx.Client, number: int, children: Mapping[str, int], patience_s: float = 120.0
) -> Waits:
    """The same, and how long the processes that have it in hand waited for a processor."""
    begun = time.monotonic()
    waited = -_seconds_ready(children.get("api"))
    body = {"request_id": f"b{number}", "scene": SCENE, "width": 8, "height": 8, "samples": 1}
    answer = client.post("/v1/renders", json=body)
    assert answer.status_code == 201, answer.text
    waited += _seconds_ready(children.get("api")) - _seconds_ready(children.get("coordinator"))
    address = f"/v1/renders/{answer.json()['id']}"
    while client.get(address).json()["state"] in ("QUEUED", "RUNNING"):
        assert time.monotonic() < begun + patience_s
        time.sleep(0.1)
    waited += _seconds_ready(children.get("coordinator"))
    return Waits(time.monotonic() - begun, waited)


def _seconds_ready(pid: int | None) -> float:
    """That the first thread of a process was ready to run since its start, and did not."""
    return float(Path(f"/proc/{pid}/schedstat").read_text().split()[1]) / 1e9 if pid else 0.0
