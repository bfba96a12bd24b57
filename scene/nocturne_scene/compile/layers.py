"""Makes the layers of a render, once: nocturne-trace looks at what each pixel sees first.

docs/decisions/0078: a separate pass, so that images are the same in every bit with and without layers.
"""

import json
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.compile.trace_program import run_trace
from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document.model import SceneDocument, all_surfaces
from nocturne_scene.document.sensors import Panorama
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film
from nocturne_scene.layers import CHANNELS, write_layers
from nocturne_scene.photometry.glare import MAX_PIXELS
from nocturne_scene.programs import find_program

MAX_SECONDS = 300.0

_SAMPLES = 16
"""Of a pixel: edges of surfaces are smooth enough to look at, and to guide a denoiser."""

_ALL_SAMPLES = 2**26
"""Of a film: about half a minute of two processors."""

_VALUES = sum(len(channels) for channels in CHANNELS.values())
_POSITION = slice(7, 10)
_DEPTH, _NOWHERE = 6, 1e10
"""PixelLayers::kNoDepth."""


def usual_layers(document: SceneDocument, film: Film) -> tuple[str, ...]:
    """Layers that are made without being asked for, where they can be: by `emission` glare ratings know the
    luminaires in a panorama."""
    wanted = (
        isinstance(document.sensor, Panorama)
        and film.width * film.height <= MAX_PIXELS
        and any(surface.luminaire is not None for _, surface in all_surfaces(document))
    )
    return ("emission",) if wanted and find_program("nocturne-trace") is not None else ()


def check_can_make(names: Sequence[str]) -> None:
    """Raises InputError where layers are asked for and can't be made here."""
    if names and find_program("nocturne-trace") is None:
        raise InputError.at("$.layers", "can't be made, as nocturne-trace is missing here")


def make_layers(
    workspace: Workspace, scene: scene_pb2.CompiledScene, film: Film, names: Sequence[str]
) -> str:
    """Puts a file with these layers into the blob store; its SHA-256. Raises InputError."""
    program = find_program("nocturne-trace")
    assert program is not None  # noqa: S101 - see check_can_make
    samples = max(1, min(_SAMPLES, _ALL_SAMPLES // (film.width * film.height)))
    words = ["--layers", str(samples)]
    try:
        data = run_trace(program, scene, workspace.blobs.root, film, words, MAX_SECONDS)
        values = np.frombuffer(data, dtype="<f4").reshape(film.height, film.width, _VALUES).copy()
    except (OSError, subprocess.SubprocessError, ValueError) as error:
        raise InputError.at("$.layers", "can't be made, as nocturne-trace failed") from error
    # Where the document has its origin; see compile/origin.py.
    seen = values[..., _DEPTH] < _NOWHERE
    values[seen, _POSITION] -= workspace.frame.shift.astype(np.float32)
    with tempfile.TemporaryDirectory(prefix="nocturne-layers-") as folder:
        path = Path(folder) / "layers.exr"
        write_layers(path, names, values, json.dumps(workspace.objects))
        return workspace.blobs.put(path.read_bytes())
