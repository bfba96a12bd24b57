"""Millions of instanced triangles in little memory."""

import json
import runpy
import subprocess
import time
from pathlib import Path

import pytest
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.programs import CHECKOUT, need_program

from tests.system.images import Image

pytestmark = pytest.mark.system

_MOST = 512 << 20
"""Bytes that a thousand trees may take; their triangles alone, each stored, would take 3 GB."""


_LEAST = 20 << 20
"""Memory that any scene takes: smaller values were not measured."""


def test_a_thousand_trees_take_little_memory(tmp_path: Path) -> None:
    """The scene `forest` with a third of its trees and without smoke: instances of instances, 93 million
    triangles, of which a hundred thousand are stored."""
    script = runpy.run_path(str(CHECKOUT / "examples" / "forest" / "make_forest.py"))
    meshes = script["write_meshes"](tmp_path)
    document = script["scene"](script["tree_places"](1000))
    document["surfaces"] = [each for each in document["surfaces"] if each["name"] != "smoke"]
    document["media"] = {}
    members = [sum("group" in member for member in document["groups"][f"spruce {kind}"]) for kind in range(3)]
    assert 1000 * min(members) * len(meshes["branch"].faces) > 10_000_000
    (tmp_path / "scene.json").write_text(json.dumps(document))
    compiled = compile_to(tmp_path / "scene.json", tmp_path, 64, 36, 4)
    image = tmp_path / "image.exr"
    command: list[str | Path] = [need_program("nocturne-trace"), compiled.scene, "-o", image, "--quiet"]
    command += ["--schedule", compiled.schedule, "--blobs", compiled.blobs]
    most = 0
    with subprocess.Popen(command) as process:
        while process.poll() is None:
            most = _most_resident(process.pid) or most
            time.sleep(0.001)
    assert process.returncode == 0
    assert _LEAST < most < _MOST
    y = Image.read(image).y
    # Sky, and trees in front of it.
    assert y[:6].mean() > 500.0
    assert (y > 0.0).mean() > 0.8


def _most_resident(pid: int) -> int:
    """Bytes, 0 if it has ended. Usage as wait4 tells it counts what this process had when it forked."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM")), 0)
