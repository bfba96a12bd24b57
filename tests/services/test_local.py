"""What `nocturne up` and its neighbours do on this machine, without a whole service."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from nocturne_client import NocturneClientError
from nocturne_client.cli import local_commands
from nocturne_client.cli.output import print_error
from nocturne_client.errors import Problem
from nocturne_client.local import children, programs, up
from nocturne_client.local.children import Child
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.doctor import examine
from nocturne_scene.blobs import BlobStore

SLEEP = "/bin/sleep"


def _wait(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + 5
    while not condition():
        assert time.monotonic() < end, "took too long"
        time.sleep(0.01)


def _is_running(pid: int) -> bool:
    """Zombies have ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_child_that_dies_is_started_again_after_a_pause(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(children, "_FIRST_DELAY_S", 0.05)
    said: list[str] = []
    child = Child("sleeper", [SLEEP, "60"], tmp_path / "log")
    child.start()
    first = child.pid
    assert child.supervise(said.append) is False
    os.kill(first, signal.SIGKILL)
    _wait(lambda: child.supervise(said.append))
    assert child.pid not in (0, first)
    assert ["SIGKILL" in text for text in said] == [True]
    child.stop(5)
    assert child.pid == 0


def test_a_child_that_cannot_start_shows_its_log(tmp_path: Path) -> None:
    child = Child("copy", ["/bin/cp", "/nonexistent", "/tmp"], tmp_path / "log")  # noqa: S108
    child.start()
    with pytest.raises(NocturneClientError, match=r"copy did not start.*nonexistent"):
        child.wait_until(lambda: False, 5)


def test_children_die_with_their_parent_even_when_it_is_killed() -> None:
    code = (
        "import subprocess, sys, os\n"
        "from nocturne_client.local.children import _LAUNCHER\n"
        "start = [sys.executable, '-I', '-S', str(_LAUNCHER), str(os.getpid())]\n"
        f"child = subprocess.Popen([*start, {SLEEP!r}, '60'])\n"
        "print(child.pid, flush=True)\n"
        "child.wait()\n"
    )
    parent = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    pid = int(parent.stdout.readline())
    _wait(lambda: Path(f"/proc/{pid}/comm").read_text() == "sleep\n")
    parent.kill()
    parent.communicate()
    _wait(lambda: not _is_running(pid))


def test_a_folder_has_one_service_only(tmp_path: Path) -> None:
    (tmp_path / "service.json").write_text(json.dumps({"url": "http://127.0.0.1:1234"}))
    with (
        up.only_one_service(tmp_path),
        pytest.raises(NocturneClientError, match="1234"),
        up.only_one_service(tmp_path),
    ):
        pass
    with up.only_one_service(tmp_path):
        pass


def test_a_taken_port_is_named() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(NocturneClientError, match=f"port {port} is taken"):
            up._check_ports(port)


def test_a_missing_program_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(NocturneClientError, match="apt-get install redis-server"):
        programs.need_program("redis-server")
    assert next(finding for finding in examine() if finding.name == "redis-server").ok is False


def test_compile_writes_what_the_tracer_takes(scene: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    compiled = compile_to(path, tmp_path / "out", 64, 48, 32)
    assert BlobStore(compiled.blobs).path(compiled.scene_sha256).read_bytes() == compiled.scene.read_bytes()
    assert compiled.schedule.stat().st_size > 0


def test_compile_says_what_it_left_out(
    scene: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """And how the scene is traced. To standard error: standard output is for programs."""
    scene["spectra"] = {**scene.get("spectra", {}), "spare": 0.5}
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    local_commands.compile_scene(path, tmp_path / "out")
    said = capsys.readouterr()
    left_out, way = said.err.splitlines()
    assert left_out == "left out: $.spectra.spare: nothing uses it"
    assert way.startswith("traced by photons from the sensor: no other way was found better")
    assert len(said.out.strip()) == 64


def test_no_problem_is_told_twice(capsys: pytest.CaptureFixture[str]) -> None:
    problems = [Problem("$.width", "is 0"), Problem("$.samples", "is 0")]
    print_error(NocturneClientError("$.width: is 0; $.samples: is 0", problems=problems))
    assert capsys.readouterr().err.splitlines() == ["error: $.width: is 0", "$.samples: is 0"]
    print_error(NocturneClientError("room.json can't be rendered", problems=problems))
    assert capsys.readouterr().err.splitlines()[1:] == ["  $.width: is 0", "  $.samples: is 0"]


def test_compile_names_all_problems(scene: dict[str, Any], tmp_path: Path) -> None:
    scene["surfaces"][0]["colour"] = "red"
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    with pytest.raises(NocturneClientError) as caught:
        compile_to(path, tmp_path / "out", 64, 48, 32)
    assert [problem.place for problem in caught.value.problems] == ["$.surfaces[0].colour"]


def test_a_terminal_without_letters_shows_numbers() -> None:
    """As under LC_ALL=POSIX, where Python is told to use neither UTF-8 nor another locale."""
    posix = {"LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    show = "from nocturne_client.cli.app import main; from nocturne_client.console import CONSOLE; import sys"
    said = subprocess.run(
        [
            sys.executable,
            "-c",
            f"{show}; sys.argv[1:] = ['--version']\ntry: main()\nexcept SystemExit: pass\n"
            "CONSOLE.print('\\xfc')",
        ],
        env={**os.environ, **posix},
        capture_output=True,
        text=True,
        check=False,
    )
    assert said.returncode == 0, said.stderr
    assert said.stdout.endswith("\\xfc\n")
