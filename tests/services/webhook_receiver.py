"""A receiver of webhooks, and the sender that it hears."""

import asyncio
import ipaddress
import ssl
import threading
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer

from nocturne_api.webhooks.sender import WebhookSender
from nocturne_api.webhooks.targets import TargetRules
from nocturne_coordinator.store.data_folder import DataFolder

HOME = ipaddress.ip_network("127.0.0.1/32")


class Receiver(HTTPServer):
    """Takes messages; answers with `statuses` one after the other, then with 204."""

    def __init__(self, tls: ssl.SSLContext | None = None, *statuses: int) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        if tls is not None:
            self.socket = tls.wrap_socket(self.socket, server_side=True)
        self.statuses = list(statuses)
        self.got: list[tuple[str, dict[str, str], bytes]] = []
        self.location = ""
        self._thread = threading.Thread(
            target=self.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True
        )

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/hook?key=abc"

    def __enter__(self) -> "Receiver":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()
        self.server_close()

    def handle_error(self, *_: object) -> None:
        """A caller that goes away is no news."""


class _Handler(BaseHTTPRequestHandler):
    def do_POST(self) -> None:
        receiver = self.server
        assert isinstance(receiver, Receiver)
        body = self.rfile.read(int(self.headers["Content-Length"]))
        receiver.got.append((self.path, dict(self.headers.items()), body))
        self.send_response(receiver.statuses.pop(0) if receiver.statuses else 204)
        if receiver.location:
            self.send_header("Location", receiver.location)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        pass


async def until_true(true: Callable[[], bool], seconds: float = 15.0) -> None:
    deadline = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < deadline, "did not happen in time"
        await asyncio.sleep(0.02)


async def until(receiver: Receiver, count: int) -> None:
    await until_true(lambda: len(receiver.got) >= count)


def make_render(folder: DataFolder, render_id: str, owner: str = "") -> None:
    folder.database.execute(
        """INSERT INTO render (id, request_id, request_digest, name, state, width, height, samples,
               scene_sha256, engine, created, ranges_planned, schedule, scene_document, owner)
           VALUES (?, ?, '', 'night', 'RUNNING', 8, 8, 4, '', 3, 1.0, 1, ?, '{}', ?)""",
        (render_id, render_id, b"", owner),
    )


def end(folder: DataFolder, render_id: str, state: str, reason: str = "") -> None:
    folder.database.execute(
        "UPDATE render SET state = ?, reason = ?, ended = 1e9 WHERE id = ?", (state, reason, render_id)
    )


@asynccontextmanager
async def sending(
    folder: DataFolder,
    rules: TargetRules,
    pauses_s: tuple[float, ...] = (0.05, 0.05),
    verify: ssl.SSLContext | bool = True,
) -> AsyncIterator[None]:
    sender = WebhookSender(folder.webhooks, asyncio.to_thread, rules, pauses_s, verify)
    sender.start()
    try:
        yield
    finally:
        await sender.close()
