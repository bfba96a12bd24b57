"""The wheels alone: a service runs from them, and a machine with the client's alone uses it."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZipFile

import httpx
import pytest

from tests.system.images import Image, differing_values
from tests.system.installed import FOLDERS, ROOT, Installed, build_wheels
from tests.system.renders import CORNELL
from tests.system.up import NOCTURNE, Up

pytestmark = pytest.mark.system

_PROGRAMS = ROOT / "build" / "release" / "worker"
_SMALL = ("--width", "40", "--height", "30", "--samples", "16")


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return build_wheels(tmp_path_factory.mktemp("wheels"))


@pytest.fixture(scope="module")
def client(wheels: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return Installed(tmp_path_factory.mktemp("client"), [wheels["client"]])


@pytest.fixture(scope="module")
def whole(wheels: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Installed:
    return Installed(tmp_path_factory.mktemp("whole"), wheels.values())


@pytest.fixture(scope="module")
def service(whole: Installed) -> Iterator[Up]:
    """`nocturne up` from the wheels; it finds the C++ programs by NOCTURNE_BIN."""
    folder = Path(tempfile.mkdtemp(prefix="nw-"))
    environment = {**whole.environment, "PYTHONPATH": "", "NOCTURNE_BIN": str(_PROGRAMS)}
    with Up(folder, nocturne=whole.nocturne, environment=environment) as up:
        yield up
    shutil.rmtree(folder)


def _version() -> str:
    return str(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"])


def _contents(wheel: Path) -> set[str]:
    with ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if ".dist-info/" not in name}


def test_wheels_share_no_file_and_have_all_that_is_ours(wheels: dict[str, Path]) -> None:
    contents = {name: _contents(wheel) for name, wheel in wheels.items()}
    for name, others in (("scene", "client"), ("scene", "service"), ("client", "service")):
        assert contents[name] & contents[others] == set()
    together = set().union(*contents.values())
    sources = {
        str(path.relative_to(ROOT / folder))
        for folder in ("scene", "coordinator", "services/api", "services/client", "build/python")
        for path in (ROOT / folder).glob("nocturne*/**/*")
        if path.suffix in (".py", ".toml", ".bin", ".typed")
    }
    # Contracts without calls have no code of gRPC.
    unused = {f"nocturne/v1/{name}_pb2_grpc.py" for name in ("job", "scene", "warning")}
    assert sources - together == unused
    assert "nocturne_api/page/index.html" in contents["service"]


def test_all_are_of_one_version() -> None:
    for folder in FOLDERS.values():
        project = tomllib.loads((ROOT / folder / "pyproject.toml").read_text())["project"]
        extras = project.get("optional-dependencies", {}).values()
        wanted = [*project["dependencies"], *(each for extra in extras for each in extra)]
        ours = [each for each in wanted if each.startswith("nocturne")]
        assert all(each.endswith(f"=={_version()}") for each in ours)
    assert f"\nversion: {_version()}\n" in (ROOT / "CITATION.cff").read_text()


def test_contracts_are_not_newer_than_the_oldest_runtime_allowed() -> None:
    """Generated code refuses an older protobuf or gRPC than those that it was made for."""
    scene = (ROOT / "scene" / "pyproject.toml").read_text()
    made = (ROOT / "build" / "python" / "nocturne" / "v1" / "scene_pb2.py").read_text()
    versions = re.search(r"Protobuf Python Version: ([\d.]+)", made)
    assert versions is not None
    assert f'"protobuf>={versions[1]}"' in scene
    service = (ROOT / "services" / "api" / "pyproject.toml").read_text()
    calls = (ROOT / "build" / "python" / "nocturne" / "v1" / "render_service_pb2_grpc.py").read_text()
    generated = re.search(r"GRPC_GENERATED_VERSION = '([\d.]+)'", calls)
    assert generated is not None
    assert f'"grpcio>={generated[1]}"' in service


def test_the_scene_language_works_alone(
    wheels: dict[str, Path], tmp_path_factory: pytest.TempPathFactory
) -> None:
    alone = Installed(tmp_path_factory.mktemp("scene"), [wheels["scene"]])
    compiled = alone.python(
        "import json, pathlib, tempfile\n"
        "from nocturne_scene.blobs import BlobStore\n"
        "from nocturne_scene.compile.compiler import compile_scene\n"
        "from nocturne_scene.document.read import check_document\n"
        f"document = check_document(json.loads(pathlib.Path({str(CORNELL)!r}).read_text()))\n"
        "blobs = BlobStore(pathlib.Path(tempfile.mkdtemp()))\n"
        "print(len(compile_scene(document, blobs).scene_sha256))"
    )
    assert compiled == "64"


def test_the_client_alone_uses_the_service(client: Installed, service: Up, tmp_path: Path) -> None:
    assert client.run("--version").stdout == f"nocturne {_version()}\n"
    where = {"NOCTURNE_URL": service.url}
    submitted = client.run("submit", CORNELL, *_SMALL, "--watch", **where)
    assert submitted.returncode == 0, submitted.stderr
    render_id = submitted.stdout.strip()
    # By the beginning of its id, and found in the list by the whole one.
    shown = client.run("get", render_id[:8], "--exr", tmp_path / "image.exr", "--json", **where)
    assert json.loads(shown.stdout)["state"] == "SUCCEEDED"
    assert render_id in client.run("list", **where).stdout
    rendered = tmp_path / "rendered.exr"
    subprocess.run([NOCTURNE, "render", CORNELL, *_SMALL, "--output", rendered], check=True)
    assert differing_values(Image.read(tmp_path / "image.exr"), Image.read(rendered)) == {}


def test_the_service_of_the_wheels_serves_the_page(service: Up) -> None:
    answer = httpx.get(service.url, trust_env=False)
    script = re.search(r'<script[^>]* src="(/assets/[^"]+)"', answer.text)
    assert script is not None
    assert httpx.get(service.url + script[1], trust_env=False).status_code == 200


@pytest.mark.parametrize(
    "words",
    [
        ("up",),
        ("demo",),
        ("render", str(CORNELL), "--output", "image.exr"),
        ("import", "scene.xml", "--output", "out"),
        ("export", str(CORNELL), "--to", "pbrt", "--output", "out"),
        ("compare", "a.exr", "b.exr"),
        ("preflight", str(CORNELL)),
        ("token", "list"),
        ("doctor",),
    ],
    ids=lambda words: words[0],
)
def test_what_needs_more_than_the_client_says_so(client: Installed, words: tuple[str, ...]) -> None:
    done = client.run(*words)
    assert done.returncode == 1
    assert re.fullmatch(
        r"error: this command needs the package \w+, which is not installed; "
        r'install it with: pip install "nocturne\[(all|pixels)\]"\n',
        done.stderr,
    ), done.stderr


@pytest.mark.soak
def test_the_client_uses_nothing_newer_than_the_oldest_python_that_it_names() -> None:
    """By mypy, which knows the features of each Python; that Python itself need not be installed."""
    folder = ROOT / "services" / "client"
    project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
    oldest = project["requires-python"].removeprefix(">=")
    options = ["--python-version", oldest, "--follow-imports=skip", "--ignore-missing-imports"]
    without_ours = ["--config-file", os.devnull, "--cache-dir", os.devnull]
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", *without_ours, *options, "nocturne_client"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    # Of numpy and the like it sees nothing here, and says so, too.
    newer = [
        line
        for line in checked.stdout.splitlines()
        if re.search(r"Module .* has no attribute|\[syntax\]", line)
    ]
    assert newer == []
    assert "checked" in checked.stdout or "no issues" in checked.stdout


def test_python_of_this_test_is_no_part_of_it(whole: Installed) -> None:
    """The environments of these tests know nothing of the checkout."""
    found = whole.python("import nocturne_scene; print(nocturne_scene.__file__)")
    assert Path(found).is_relative_to(whole.folder)
    assert sys.prefix not in whole.python("import sys; print(sys.path)")
