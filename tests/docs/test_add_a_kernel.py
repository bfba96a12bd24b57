"""docs/how-to/add-a-kernel.md adds a kernel, word for word, to a copy of the repository.

What Python does of it is tried in `make test`; the C++ is built, tested and traced in `make soak` (minutes).
"""

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from nocturne_client.local.programs import CHECKOUT

from tests.system.images import Image

_PAGE = CHECKOUT / "docs" / "how-to" / "add-a-kernel.md"
_NEW_FILE = "worker/src/kernels/velvet.h"
_TINT = 0.6
_COMPILE = """
import sys
from pathlib import Path
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to
compiled = compile_to(Path(sys.argv[1]), Path(sys.argv[2]), 16, 16, 256)
scene = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes())
(kernel,) = scene.kernels
print(kernel.WhichOneof("model"), *scene.spectra[kernel.velvet.tint.spectrum].values)
"""


def _blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", _PAGE.read_text(), re.MULTILINE | re.DOTALL)


def _patched(folder: Path) -> Path:
    """A copy of the repository, with the page's file and patches."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=CHECKOUT, check=True, capture_output=True).stdout
    names = [name for name in listed.decode().split("\0") if name and (CHECKOUT / name).is_file()]
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes((CHECKOUT / name).read_bytes())
        (folder / name).chmod((CHECKOUT / name).stat().st_mode)
    (file,) = _blocks("cpp")
    assert not (folder / _NEW_FILE).exists()
    (folder / _NEW_FILE).write_text(file)
    for patch in _blocks("diff"):
        subprocess.run(
            ["patch", "-p1", "--fuzz=0", "--forward"], cwd=folder, input=patch, text=True, check=True
        )
    return folder


def _compiled(tree: Path, folder: Path, scene: dict[str, Any]) -> str:
    """Compiles a scene into the folder by the Python code of the copy; returns the compiled scene."""
    contracts = tree / "build" / "python"
    if not contracts.exists():
        contracts.mkdir(parents=True)
        protos = sorted((tree / "proto" / "nocturne" / "v1").glob("*.proto"))
        made = [f"--python_out={contracts}", f"--grpc_python_out={contracts}"]
        protoc: list[str | Path] = [sys.executable, "-m", "grpc_tools.protoc", "-I", tree / "proto"]
        subprocess.run([*protoc, *made, *protos], check=True)
    folder.mkdir()
    (folder / "scene.json").write_text(json.dumps(scene))
    of_the_copy = [contracts, tree / "scene", tree / "services" / "client"]
    compiled = subprocess.run(
        [sys.executable, "-c", _COMPILE, folder / "scene.json", folder],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, of_the_copy))},
        check=True,
        capture_output=True,
        text=True,
    )
    return compiled.stdout


def _under_a_sky(degrees: float) -> dict[str, Any]:
    """All of the film is velvet, seen at an angle to its normal, under a uniform sky of luminance 1."""
    angle = math.radians(degrees)
    return {
        "nocturne": 1,
        "kernels": {"cloth": {"type": "velvet", "tint": _TINT}},
        "sensor": {
            "type": "orthographic",
            "position": [0, 5 * math.sin(angle), 5 * math.cos(angle)],
            "look_at": [0, 0, 0],
            "height": 1,
        },
        "surfaces": [
            {
                "shape": {"type": "quad", "corner": [-9, -9, 0], "edge_u": [18, 0, 0], "edge_v": [0, 18, 0]},
                "kernel": "cloth",
            }
        ],
        "environment": {"radiance": {"illuminant": "E", "luminance": 1}},
    }


def test_the_page_gives_whole_patches_that_compile_a_scene(tmp_path: Path) -> None:
    said = _compiled(_patched(tmp_path / "tree"), tmp_path / "scene", _under_a_sky(0)).split()
    assert said[0] == "velvet"
    assert [float(value) for value in said[1:]] == pytest.approx([_TINT] * (len(said) - 1))
    assert len(said) > 1


@pytest.mark.soak
def test_what_the_page_adds_is_built_and_traced(tmp_path: Path) -> None:
    """Radiance is that of the sky times the albedo, tint (1 - 2/3 cos). False alarms: 1 in 8,000."""
    tree = _patched(tmp_path / "tree")
    subprocess.run(["cmake", "--preset", "release", "--log-level=WARNING"], cwd=tree / "worker", check=True)
    targets = ["nocturne-trace", "kernels_test"]
    build = tree / "build" / "release"
    subprocess.run(["cmake", "--build", build, "--target", *targets, "--", "--quiet"], check=True)
    subprocess.run([build / "tests" / "kernels_test"], check=True, stdout=subprocess.DEVNULL)
    for degrees in (0.0, 60.0):
        folder = tmp_path / f"seen at {degrees:g} degrees"
        _compiled(tree, folder, _under_a_sky(degrees))
        command: list[str | Path] = [build / "worker" / "nocturne-trace", folder / "scene.pb", "--quiet"]
        command += ["-o", folder / "image.exr", "--schedule", folder / "schedule.pb"]
        subprocess.run([*command, "--blobs", folder / "blobs"], check=True)
        image = Image.read(folder / "image.exr")
        error = math.sqrt(float((image.y_error.astype(float) ** 2).sum())) / image.y.size
        expected = _TINT * (1 - 2 / 3 * math.cos(math.radians(degrees)))
        assert image.y.mean() == pytest.approx(expected, abs=4 * error)
