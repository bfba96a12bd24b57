"""Scene documents through the compiler and nocturne-trace.

Tests name samples for the errors that `make accuracy` notices. `make test` takes a quarter of them if
a reading is compared within a bound that follows from its scatter: false alarms are as rare, and an error
has to be twice as large to be noticed.
"""

import json
import os
import subprocess
from pathlib import Path
from typing import Any, Literal

from nocturne_client.local.compiled import CompiledFolder, compile_to
from nocturne_client.local.programs import CHECKOUT, need_program

from tests.system.images import Image

Document = dict[str, Any]
Method = Literal["adjoint", "path"]

_SHARE = float(os.environ.get("NOCTURNE_ACCURACY", "0.25"))
"""Of the samples that tests name."""

IN_FULL = _SHARE >= 1.0
"""Else a test of many combinations may leave some out."""


def part_of(samples: int) -> int:
    """As many as are taken."""
    return max(1, round(samples * _SHARE))


def trace(
    document: Document, folder: Path, edge: int | tuple[int, int], samples: int, method: Method = "adjoint"
) -> Image:
    """The image of a scene, edge x edge or (width, height) pixels; `folder` is for files in between."""
    width, height = edge if isinstance(edge, tuple) else (edge, edge)
    compiled = compile_to(write(document, folder), folder, width, height, samples)
    return run(compiled, folder, method)[0]


def write(document: Document, folder: Path) -> Path:
    """The document as a file."""
    scene = folder / "scene.json"
    scene.write_text(json.dumps(document))
    return scene


def run(compiled: CompiledFolder, folder: Path, method: Method = "adjoint") -> tuple[Image, dict[str, Any]]:
    """Traces into `folder`; the image, and what the program counted: no photon was invalid_samples."""
    if method == "path":
        program = CHECKOUT / "build" / "release" / "bench" / "nocturne-baseline"
        _trace(compiled, folder, "image.exr", "--method", "path", program=program)
    else:
        _trace(compiled, folder, "image.exr")
    return _result(folder, "image.exr")


def run_seeds(compiled: CompiledFolder, folder: Path, seeds: int) -> list[tuple[Image, dict[str, Any]]]:
    """The same by each of the seeds from 1, all by one process."""
    _trace(compiled, folder, "{seed}.exr", "--seeds", str(seeds))
    return [_result(folder, f"{seed}.exr") for seed in range(1, seeds + 1)]


def _trace(
    compiled: CompiledFolder, folder: Path, image: str, *options: str, program: Path | None = None
) -> None:
    output = folder / image
    command: list[str | Path] = [
        program or need_program("nocturne-trace"),
        compiled.scene,
        "-o",
        output,
        "--quiet",
    ]
    command += ["--schedule", compiled.schedule, "--blobs", compiled.blobs, *options]
    subprocess.run([*command, "--statistics", output.with_suffix(".json")], check=True)


def _result(folder: Path, image: str) -> tuple[Image, dict[str, Any]]:
    statistics: dict[str, Any] = json.loads((folder / image).with_suffix(".json").read_text())
    assert statistics["invalid_samples"] == 0
    return Image.read(folder / image), statistics
