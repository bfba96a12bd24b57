"""Every tutorial works: its commands run, in order, in an empty folder."""

import os
import signal
import subprocess
from contextlib import suppress
from pathlib import Path

import platformdirs
import pytest
from nocturne_client.local.programs import CHECKOUT

from tests.docs.tutorial import script_of
from tests.system.free_ports import free_port_pair
from tests.system.up import NOCTURNE

TUTORIALS = CHECKOUT / "docs" / "tutorials"

_LIMIT_S = 400.0


_IN_EVERY_RUN = "first-render"
"""The others take half a minute; `make docs` runs them as well."""


@pytest.mark.system
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name == _IN_EVERY_RUN else pytest.mark.soak)
        for name in sorted(page.stem for page in TUTORIALS.glob("*.md"))
    ],
)
def test_commands_of_a_tutorial_run(name: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("t")
    for part in (".venv", "examples", "services"):
        (folder / part).symlink_to(CHECKOUT / part)
    api, redis = free_port_pair(), free_port_pair()
    ports = {"7070": str(api), "7071": str(api + 1), "6390": str(redis)}
    script = script_of((TUTORIALS / f"{name}.md").read_text(encoding="utf-8"), ports)
    output = folder / "output.txt"
    with output.open("wb") as log:
        process = subprocess.Popen(
            ["bash", "-c", script],
            cwd=folder,
            env=_environment(folder, api),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
        try:
            status = process.wait(_LIMIT_S)
        except subprocess.TimeoutExpired:
            pytest.fail(f"not over after {_LIMIT_S:g} s\n{_told(folder)}")
        finally:
            _end(process)
    assert status == 0, _told(folder)


def _environment(folder: Path, port: int) -> dict[str, str]:
    """As a login shell has it: whoever wants the programs of the checkout types so. A home that is empty but
    for the cache of tables, whose making takes half a minute; the service on a port that is free."""
    ours = str(NOCTURNE.parent)
    path = os.pathsep.join(each for each in os.environ["PATH"].split(os.pathsep) if each != ours)
    return {
        **os.environ,
        "PATH": path,
        "HOME": str(folder),
        "XDG_CACHE_HOME": platformdirs.user_cache_dir(),
        "TMPDIR": str(folder),
        "NOCTURNE_URL": f"http://127.0.0.1:{port}",
        "TERM": "dumb",
    }


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends the processes of a script that took too long; a script that finished has ended its own."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def _told(folder: Path) -> str:
    logs = [folder / "output.txt", *folder.glob("*.log"), *folder.glob("*/logs/*.log")]
    return "\n".join(f"--- {log.name}\n{log.read_text(errors='replace')[-3000:]}" for log in logs)


def test_a_script_has_the_blocks_of_its_page_in_order() -> None:
    page = """Text.
```sh
first
```
```sh background shop
serve --port 7070
```
<!-- run: stop shop -->
```sh skip
never
```
```python
never
```
"""
    script = script_of(page, {"7070": "12345"})
    told = ["first", "exec serve --port 12345)", "wait_for_port 12345", 'kill -INT "$shop"']
    places = [script.index(each) for each in told]
    assert places == sorted(places)
    assert "never" not in script
    assert "7070" not in script


def test_a_block_with_words_that_mean_nothing_is_refused() -> None:
    with pytest.raises(AssertionError, match="mean nothing"):
        script_of("```sh backgruond\nserve\n```\n", {})
