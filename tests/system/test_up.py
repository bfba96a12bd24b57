"""`nocturne up` and the commands that talk to it, as a user types them."""

import json
import os
import re
import signal
import subprocess
from contextlib import closing
from pathlib import Path
from typing import Any

import httpx
import pytest
from nocturne_client import Client
from nocturne_client.errors import NocturneClientError
from nocturne_coordinator.store.data_folder import DataFolder

from tests.system.images import Image, differing_values
from tests.system.program import is_running
from tests.system.renders import (
    CORNELL,
    RANGES,
    finished_image,
    submit,
    wait_for_more_ranges,
)
from tests.system.up import NOCTURNE, Up
from tests.system.waiting import LIMIT_S, wait_for

pytestmark = pytest.mark.system

_SMALL = ["--width", "40", "--height", "30", "--samples", "16"]
_ENDLESS = ["--width", "40", "--height", "30", "--samples", str(2**24)]


def _nocturne(service: Up, *words: str | Path, status: int = 0) -> str:
    """Runs the command line; gives its standard output."""
    result = subprocess.run(
        [NOCTURNE, *words, "--url", service.url], capture_output=True, text=True, timeout=LIMIT_S, check=False
    )
    assert result.returncode == status, result.stderr
    return result.stdout


def test_submit_watch_list_get(running_service: Up, tmp_path: Path) -> None:
    render_id = _nocturne(running_service, "submit", CORNELL, *_SMALL, "--name", "small", "--watch").strip()
    lines = _nocturne(running_service, "list", "--json").splitlines()
    listed: dict[str, Any] = next(each for each in map(json.loads, lines) if each["id"] == render_id)
    assert (listed["name"], listed["state"]) == ("small", "SUCCEEDED")

    exr, png = tmp_path / "image.exr", tmp_path / "image.png"
    _nocturne(running_service, "get", render_id, "--exr", exr, "--png", png)
    assert Image.read(exr).samples.tolist() == [[16] * 40] * 30
    assert png.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("more", [(), ("--layers", "albedo")])
def test_get_and_render_write_equal_files(running_service: Up, tmp_path: Path, more: tuple[str, ...]) -> None:
    """Not their pixels alone: whoever keeps images by their digest keeps one of each."""
    here, there = tmp_path / "here.exr", tmp_path / "there.exr"
    render_id = _nocturne(running_service, "submit", CORNELL, *_SMALL, *more, "--watch").strip()
    _nocturne(running_service, "get", render_id, "--exr", there)
    subprocess.run([NOCTURNE, "render", CORNELL, *_SMALL, *more, "-o", here], check=True, timeout=LIMIT_S)
    assert here.read_bytes() == there.read_bytes()


def test_cancel(running_service: Up) -> None:
    render_id = _nocturne(running_service, "submit", CORNELL, *_ENDLESS).strip()
    with Client(running_service.url) as client:
        wait_for(lambda: client.get(render_id).progress.ranges_done > 0, "the render to start")
        _nocturne(running_service, "cancel", render_id)
        # Its end is not success.
        _nocturne(running_service, "watch", render_id, status=1)
        render = client.get(render_id)
        assert (render.state, render.reason) == ("CANCELLED", "Cancelled by request.")
        assert 0 < render.progress.samples_merged < 40 * 30 * 2**24


def test_the_page_is_served(running_service: Up) -> None:
    answer = httpx.get(running_service.url, trust_env=False)
    assert answer.status_code == 200
    assert re.search(r'<script[^>]* src="/assets/', answer.text), "the page is not built"


def test_sighup_begins_logs_anew_and_ends_nothing(running_service: Up) -> None:
    """As the post-rotate script of logrotate sends it, or `systemctl reload`."""
    state = json.loads((running_service.data / "service.json").read_text())
    children = state["children"]
    os.kill(state["pid"], signal.SIGHUP)
    log, before = (
        running_service.data / "logs/coordinator.log",
        running_service.data / "logs/coordinator.log.1",
    )
    wait_for(lambda: before.exists() and "SIGHUP" in log.read_text(), "the log to be begun anew")
    assert "works on" in before.read_text()
    render_id = _nocturne(running_service, "submit", CORNELL, *_SMALL, "--watch").strip()
    assert render_id
    assert json.loads((running_service.data / "service.json").read_text()) == state
    assert all(is_running(pid) for pid in children.values())


def test_the_data_folder_is_private(running_service: Up) -> None:
    """Database, images, logs, and the cache of a program in C++."""
    rights = {
        path: path.stat().st_mode & 0o077 for path in (running_service.data, *running_service.data.rglob("*"))
    }
    assert running_service.data / "cache" in rights
    assert [path for path, others in rights.items() if others] == []


def test_doctor_finds_all_that_this_test_needs() -> None:
    result = subprocess.run([NOCTURNE, "doctor", "--json"], capture_output=True, check=False)
    findings = json.loads(result.stdout)
    assert [each for each in findings if each["needed"] and not each["ok"]] == []
    assert result.returncode == 0


def test_a_second_service_on_the_folder_refuses(running_service: Up) -> None:
    before = running_service.children()
    second = subprocess.run(
        [NOCTURNE, "up", "--data", running_service.data, "--port", "1"],
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert second.returncode == 2
    # Where the first one is.
    assert running_service.url in second.stderr
    assert running_service.children() == before


def test_tokens_ctrl_c_and_a_killed_parent(tmp_path: Path, traced_alone: Image) -> None:
    """One service through its life, as a start is what costs most."""
    # One thread, so that there is something left to do after the first commit, a second after the start.
    with Up(tmp_path, 1, 1, "--auth") as service:
        token = _the_token_shown(service)
        assert httpx.get(f"{service.url}/v1/renders", trust_env=False).status_code == 401
        with closing(Client(service.url, token=token)) as client:
            # The worker came in by the socket that is its own, and needs no token.
            render_id = submit(client)
            wait_for_more_ranges(client, render_id, 1)
            assert client.get(render_id).owner.startswith("admin-")
            _ctrl_c_stops_all(service)
            assert 0 < _committed_ranges(service.data, render_id) < RANGES, "there is nothing left to do"

            service.start()
            image = finished_image(client, render_id)
        assert differing_values(image, traced_alone) == {}
        assert service.program.log.read_text().count(token) == 1
        children = service.children()
        service.program.kill()
        wait_for(lambda: not any(is_running(pid) for pid in children.values()), "all children to end")
    # The folder is free again, although nothing was put in order.
    with Up(tmp_path, 0, 1, "--auth", "--owner-open-renders", "1", "--data-bytes", "1e9") as again:
        assert not set(again.children().values()) & set(children.values())
        _bounds_were_passed_on(again, token)
        _down_stops_it(again)


def _down_stops_it(service: Up) -> None:
    down = [str(NOCTURNE), "down", "--data", str(service.data)]
    subprocess.run(down, check=True)
    wait_for(lambda: not service.program.is_alive(), "the service to end")
    assert not (service.data / "service.json").exists()
    # Of a service that was killed there is a number, which may be another process's by now.
    (service.data / "service.json").write_text(json.dumps({"pid": os.getpid()}))
    said = subprocess.run(down, check=False, capture_output=True, text=True)
    assert said.returncode == 2
    assert f"no service runs on {service.data}" in " ".join(said.stderr.split())


def _the_token_shown(service: Up) -> str:
    def shown() -> list[str]:
        return re.findall(r"nct_[\w-]+", service.program.log.read_text())

    # It is printed when all runs.
    wait_for(lambda: bool(shown()), "the token")
    return shown()[0]


def _ctrl_c_stops_all(service: Up) -> None:
    children = service.children()
    assert set(children) == {"redis", "coordinator", "api", "worker-1"}
    assert all(is_running(pid) for pid in children.values())
    assert service.stop() == 0
    assert not any(is_running(pid) for pid in children.values())
    assert list(service.temporary.iterdir()) == []
    assert not (service.data / "service.json").exists()


def _committed_ranges(data: Path, render_id: str) -> int:
    """As the data folder has it, without a service."""
    with closing(DataFolder(data)) as folder:
        return folder.renders.get(render_id).ranges_done


def _bounds_were_passed_on(service: Up, token: str) -> None:
    """One open render for an owner, and a gigabyte for all data."""
    with closing(Client(service.url, token=token, patience_s=0.0)) as client:
        client.submit(CORNELL, 40, 30, 16)
        with pytest.raises(NocturneClientError, match="open renders") as caught:
            client.submit(CORNELL, 40, 30, 16)
        assert caught.value.status == 429
    headers = {"Authorization": f"Bearer {token}"}
    metrics = httpx.get(f"{service.url}/metrics", headers=headers, trust_env=False).text
    assert "nocturne_data_bytes_bound 1e+09" in metrics
