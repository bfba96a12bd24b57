"""From the wheels alone: in an empty Debian, by other versions of Python, without compiler or network."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.installed.empty_roots import ROOT, EmptyRoot, wheels_for
from tests.system.free_ports import free_port_pair
from tests.system.images import Image, differing_values
from tests.system.renders import CORNELL
from tests.system.up import NOCTURNE

pytestmark = [pytest.mark.roots, pytest.mark.system]

_BUILT = ROOT / "build" / "dist"
_MOST_BYTES = 120e6
_DEMO = ("--width", "512", "--height", "512", "--samples", "64")


@pytest.fixture(scope="module")
def from_source(tmp_path_factory: pytest.TempPathFactory) -> Image:
    """What `nocturne demo` renders, by this checkout in one process."""
    image = tmp_path_factory.mktemp("source") / "cornell.exr"
    subprocess.run([NOCTURNE, "render", CORNELL, *_DEMO, "--output", image], check=True)
    return Image.read(image)


def test_the_wheels_are_small() -> None:
    assert sum(each.stat().st_size for each in _BUILT.glob("*.whl")) < _MOST_BYTES


@pytest.mark.parametrize("suite", ["bookworm", "trixie", "sid"])
def test_two_commands_in_an_empty_debian(suite: str, from_source: Image) -> None:
    root = EmptyRoot(suite)
    shutil.copytree(wheels_for(root.python, _BUILT), root.home / "wheels")
    said = root.run(
        "python3 -m venv here\n"
        "date +%s\n"
        "here/bin/pip install --quiet --no-index --find-links wheels 'nocturne[all]'\n"
        "date +%s\n"
        "here/bin/nocturne demo >shown\n"
        "date +%s\n"
        "here/bin/nocturne doctor >found\n"
        "here/bin/nocturne list --json >listed\n"
        "here/bin/nocturne down\n"
    )
    begun, installed, shown = map(int, said.split())
    seconds = {"install": installed - begun, "demo": shown - installed}
    print(f"{suite}, Python {root.python}: {seconds}")  # noqa: T201
    assert json.loads((root.home / "listed").read_text())["state"] == "SUCCEEDED"
    assert differing_values(Image.read(root.home / "nocturne-demo" / "cornell.exr"), from_source) == {}


@pytest.mark.parametrize("minor", [11, 12, 13, 14])
def test_every_version_of_python_at_hand(minor: int, from_source: Image, tmp_path: Path) -> None:
    environment = _installed(f"3.{minor}", tmp_path, "nocturne[all]")
    port = free_port_pair()
    data = ["--data", str(tmp_path / "data")]
    subprocess.run(
        [
            tmp_path / "here" / "bin" / "nocturne",
            "demo",
            "--port",
            str(port),
            *data,
            "-o",
            str(tmp_path / "out"),
        ],
        env=environment,
        check=True,
    )
    subprocess.run([tmp_path / "here" / "bin" / "nocturne", "down", *data], env=environment, check=True)
    assert differing_values(Image.read(tmp_path / "out" / "cornell.exr"), from_source) == {}


def test_the_client_alone_by_its_oldest_python(tmp_path: Path) -> None:
    environment = _installed("3.10", tmp_path, "nocturne")
    said = subprocess.run(
        [tmp_path / "here" / "bin" / "nocturne", "list", "--url", "http://127.0.0.1:9"],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (said.returncode, "Traceback" in said.stderr) == (3, False), said.stderr


def _installed(version: str, folder: Path, wanted: str) -> dict[str, str]:
    """An environment in `folder`/here with the wheels; gives the variables to run its programs with."""
    environment = {"HOME": str(folder), "PATH": os.defpath}
    python = _python(version)
    subprocess.run([python, "-m", "venv", folder / "here"], check=True)
    offline = ["--quiet", "--no-index", "--find-links", str(wheels_for(version, _BUILT, wanted, python))]
    pip = [str(folder / "here" / "bin" / "python"), "-m", "pip", "--disable-pip-version-check"]
    subprocess.run([*pip, "install", *offline, wanted], check=True, env=environment)
    return environment


def _python(version: str) -> str:
    """In PATH, or where pyenv keeps all. Skips where there is none."""
    kept = Path.home() / ".pyenv" / "versions"
    for found in (shutil.which(f"python{version}"), *kept.glob(f"{version}.*/bin/python{version}")):
        if found and subprocess.run([found, "-c", ""], check=False, capture_output=True).returncode == 0:
            return str(found)
    pytest.skip(f"python{version} is not here")
