"""Stokes vectors of scenes exported to Mitsuba, by its polarised variant, against ours, by z-tests of tiles.

Signs are the same in both. Rough dielectrics depolarise there, and rough metals are shadowed otherwise, so
that these are left out (docs/reference/import-mitsuba.md). False alarms: 0.01 for each scene.
"""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nocturne.v1 import scene_pb2
from nocturne_client.local.compiled import compile_to
from nocturne_client.local.exporting import export_to
from nocturne_client.local.programs import CHECKOUT, need_program
from nocturne_scene.compare.images import read_picture
from nocturne_scene.film import Film
from nocturne_scene.formats.mitsuba.read.units import CANDELAS_PER_UNIT
from numpy.typing import NDArray

from bench.peer.install import install
from tests.accuracy.agreement import student_bound
from tests.mitsuba.export_scenes import _scene

Frames = NDArray[np.float64]
PYTHON = CHECKOUT / "build" / "peers" / "bin" / "python"

pytestmark = [
    pytest.mark.peers,
    pytest.mark.skipif(not PYTHON.exists(), reason=f"needs Mitsuba in {PYTHON.parents[1]}: `make peers`"),
]

_FRAMES, _WIDTH, _HEIGHT, _TILE = 24, 32, 24, 8
_CHANNELS = ("Y", "S1.Y", "S2.Y", "S3.Y")


def _ball(x: float, kernel: dict[str, Any]) -> dict[str, Any]:
    return {"shape": {"type": "sphere", "centre": [x, 0.8, 0], "radius": 0.8}, "kernel": kernel}


_METAL = {"type": "conductor", "index": {"n": 0.9, "k": 3.2}}
_OTHER_METAL = {"type": "conductor", "index": {"n": 0.2, "k": 3.9}}
_PLATE = {
    "shape": {"type": "quad", "corner": [-2, 0.01, -2], "edge_u": [0, 0, 4], "edge_v": [4, 0, 0]},
    "kernel": _METAL,
}
_SCENES = {
    "glass": _scene(
        _ball(-0.9, {"type": "dielectric", "index": 1.5}), _ball(0.9, {"type": "dielectric", "index": 1.33})
    ),
    "metal in metal": _scene(_PLATE, _ball(-0.9, _OTHER_METAL), _ball(0.9, _METAL)),
}


def _theirs(document: Path, folder: Path) -> Frames:
    exported = export_to(document, folder / "mitsuba", "mitsuba", Film(_WIDTH, _HEIGHT, 256))
    server = CHECKOUT / "bench" / "peer" / "mitsuba_stokes.py"
    found = folder / "theirs.npy"
    command: list[str | Path] = [PYTHON, server, exported.scene, "256", str(_FRAMES), found]
    environment = {**os.environ, **install().environment}
    subprocess.run(command, check=True, capture_output=True, env=environment)
    frames: Frames = np.load(found)
    return CANDELAS_PER_UNIT * frames


def _ours(document: dict[str, Any], folder: Path) -> Frames:
    path = folder / "ours.json"
    sensor = {**document["sensor"], "stokes": True}
    path.write_text(json.dumps({**document, "sensor": sensor, "tracing": {"sequence": "independent"}}))
    (folder / "compiled").mkdir()
    compiled = compile_to(path, folder / "compiled", _WIDTH, _HEIGHT, 64)
    scene = scene_pb2.CompiledScene.FromString(compiled.scene.read_bytes())
    frames = []
    for seed in range(1, _FRAMES + 1):
        scene.tracing.seed = seed
        compiled.scene.write_bytes(scene.SerializeToString(deterministic=True))
        image = folder / "image.exr"
        command: list[str | Path] = [
            need_program("nocturne-trace"),
            compiled.scene,
            "--blobs",
            compiled.blobs,
        ]
        command += ["--schedule", compiled.schedule, "-o", image, "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
        picture = read_picture(image)
        assert picture.moments is not None
        frames.append(picture.moments.mean[..., [picture.names.index(name) for name in _CHANNELS]])
    return np.stack(frames)


def _tiles(frames: Frames) -> Frames:
    """Means of tiles of each frame, shape (frames, tiles, channels)."""
    shape = (len(frames), _HEIGHT // _TILE, _TILE, _WIDTH // _TILE, _TILE, len(_CHANNELS))
    means: Frames = frames.reshape(shape).mean(axis=(2, 4)).reshape(len(frames), -1, len(_CHANNELS))
    return means


@pytest.mark.parametrize("name", _SCENES)
def test_stokes_vectors_are_mitsubas(name: str, tmp_path: Path) -> None:
    document = tmp_path / "scene.json"
    document.write_text(json.dumps(_SCENES[name]))
    ours, theirs = _tiles(_ours(_SCENES[name], tmp_path)), _tiles(_theirs(document, tmp_path))
    error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / _FRAMES)
    off = ours.mean(axis=0) - theirs.mean(axis=0)
    bound = student_bound(off.size, _FRAMES - 1)
    # Where nothing varies both are the same but for rounding: S3 of glass.
    assert (np.abs(off) <= bound * error + 1e-4 * ours[..., 0].mean()).all(), (off / error).round(1)
    polarised = np.abs(ours.mean(axis=0)).mean(axis=0)
    assert polarised[1] > 0.01 * polarised[0]
