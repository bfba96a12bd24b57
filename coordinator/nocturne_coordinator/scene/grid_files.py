"""Grids of OpenVDB files, by way of the program `nocturne-grid`."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from nocturne_coordinator.programs import find_program

PROGRAM = "nocturne-grid"

# Seconds. Reading and writing 500 MB takes a few.
_TIMEOUT = 600

_Voxel = tuple[int, int, int]
_Row = tuple[float, ...]


class UnusableGridError(Exception):
    """The grid can't be used; the message says why."""


@dataclass(frozen=True)
class GridFacts:
    """What is known of a grid without looking values up."""

    first_voxel: _Voxel
    last_voxel: _Voxel
    """The box of the voxels that hold values, both ends included."""
    minimum: float
    maximum: float
    """Of the values."""
    transform: tuple[_Row, ...]
    """Rows of the 3 x 4 matrix from voxel centres to the grid's own space."""


def convert(source: Path, grid: str, output: Path) -> GridFacts:
    """Write one grid of an OpenVDB file as NanoVDB; raises UnusableGridError."""
    program = find_program(PROGRAM)
    if program is None:
        raise UnusableGridError(f"{PROGRAM} is missing on this machine, which reads grids")
    command: list[str | Path] = [program, "convert", source, "--grid", grid, "-o", output]
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=_TIMEOUT)  # noqa: S603
    except subprocess.TimeoutExpired:
        raise UnusableGridError(f"took longer than {_TIMEOUT} s to read") from None
    if done.returncode != 0:
        words = done.stderr.decode("utf-8", "replace").strip().splitlines() or ["no reason given"]
        raise UnusableGridError(words[-1].removeprefix(f"{PROGRAM}: ")[:1000])
    return _facts(done.stdout)


def _facts(text: bytes) -> GridFacts:
    found = json.loads(text)
    box, matrix = found["index_box"], found["transform"]
    return GridFacts(
        first_voxel=tuple(box[0]),
        last_voxel=tuple(box[1]),
        minimum=found["least"],
        maximum=found["most"],
        transform=tuple(tuple(matrix[at : at + 4]) for at in (0, 4, 8)),
    )
