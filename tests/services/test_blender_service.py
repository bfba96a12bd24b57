"""What the Blender add-on does with a service that is busy; the module needs no Blender."""

import importlib.util
import sys
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import ModuleType

import pytest

_FILE = Path(__file__).parents[2] / "services/blender/nocturne_blender/service.py"


@pytest.fixture(scope="module")
def add_on() -> ModuleType:
    spec = importlib.util.spec_from_file_location("nocturne_blender_service", _FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def busy() -> Iterator[tuple[str, list[str]]]:
    """Answers creation twice by 429, of which the second says 1 s, then as asked; and keeps who asked."""
    asked: list[str] = []

    class Busy(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            asked.append(self.path)
            self.rfile.read(int(self.headers["content-length"]))
            free = len(asked) > 2 or self.path.endswith(":cancel")
            self.send_response(200 if free else 429)
            if len(asked) == 2:
                self.send_header("Retry-After", "1")
            self.end_headers()
            self.wfile.write(b'{"id": "r-1"}' if free else b'{"detail": "the quota is used up"}')

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Busy)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}", asked
    server.shutdown()
    server.server_close()


def test_it_waits_as_long_as_the_service_says_and_shows_it(
    add_on: ModuleType, busy: tuple[str, list[str]]
) -> None:
    told: list[tuple[str, float]] = []
    service = add_on.Service(busy[0], on_wait=lambda *why: told.append(why))
    began = time.monotonic()
    render = service.create(add_on.Job("", {}, 8, 8, 1, {}))
    assert (render, len(busy[1])) == ({"id": "r-1"}, 3)
    assert time.monotonic() - began >= 1.2
    assert {why for why, _ in told} == {"the quota is used up"}
    assert max(left for _, left in told) > 0.9


def test_a_wait_ends_when_the_render_is_cancelled(add_on: ModuleType, busy: tuple[str, list[str]]) -> None:
    class Cancelled(Exception):
        pass

    def cancelled(_: str, __: float) -> None:
        raise Cancelled

    service = add_on.Service(busy[0], on_wait=cancelled)
    with pytest.raises(Cancelled):
        service.create(add_on.Job("", {}, 8, 8, 1, {}))
    # That it is told at once.
    service.cancel("r-1")
    assert busy[1] == ["/v1/renders", "/v1/renders/r-1:cancel"]
