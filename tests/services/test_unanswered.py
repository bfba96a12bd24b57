"""A submission whose answer does not come may have been made: the error tells its sender how to find out."""

import json
import re
import subprocess
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any

import pytest

from tests.system.up import NOCTURNE


class Silent(HTTPServer):
    """Takes submissions, and breaks the connection off."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Taking)
        self.taken: list[dict[str, Any]] = []


class _Taking(BaseHTTPRequestHandler):
    def do_POST(self) -> None:
        assert isinstance(self.server, Silent)
        self.server.taken.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.close_connection = True

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the name in the base class
        """Says nothing."""


@pytest.fixture
def silent() -> Iterator[Silent]:
    with Silent() as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True).start()
        yield server
        server.shutdown()


def test_the_command_line_tells_how_to_ask_for_the_same_render(
    silent: Silent, scene: dict[str, Any], tmp_path: Path
) -> None:
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene))
    url = f"http://127.0.0.1:{silent.server_port}"
    done = subprocess.run(
        [NOCTURNE, "submit", file, "--url", url], capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    told = re.search(
        r"Submit it again with --request-id (\S+): if it was made, you get its id\.", done.stderr
    )
    assert told is not None, done.stderr
    assert {each["request_id"] for each in silent.taken} == {told[1]}
