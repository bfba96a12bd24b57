"""Grids of OpenVDB files, read and written by the program `nocturne-grid`."""

import hashlib
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.library_words import without_paths
from nocturne_scene.programs import find_program

PROGRAM = "nocturne-grid"

# Seconds. Reading and writing 500 MB takes a few.
_TIMEOUT = 600

_Voxel = tuple[int, int, int]
_Row = tuple[float, ...]


class UnusableGridError(Exception):
    """The grid can't be used; the message says why."""


@dataclass(frozen=True)
class GridFacts:
    """Facts about a grid, without its values."""

    first_voxel: _Voxel
    last_voxel: _Voxel
    """The box of the voxels that hold values, both ends included."""
    minimum: float
    maximum: float
    """Of the values."""
    transform: tuple[_Row, ...]
    """Rows of the 3 x 4 matrix from voxel centres to the grid's own space."""


@dataclass(frozen=True)
class DenseGrid:
    """All values of a grid."""

    values: NDArray[np.float32]
    """By x, y, z."""
    first_voxel: _Voxel
    background: float
    """The value beyond them."""
    transform: NDArray[np.float64]
    """The 3 x 4 matrix from voxel centres to the grid's own space."""


def convert(source: Path, grid: str, output: Path) -> str:
    """Write one grid of an OpenVDB file as NanoVDB; return text for `facts_in`. Raises UnusableGridError."""
    return _run("convert", source, "--grid", grid, "-o", output).decode()


def facts_in(text: str) -> GridFacts:
    """Return what `convert` found; ValueError, LookupError or TypeError for any other text."""
    found = json.loads(text)
    box, matrix = found["index_box"], found["transform"]
    return GridFacts(
        first_voxel=tuple(box[0]),
        last_voxel=tuple(box[1]),
        minimum=found["least"],
        maximum=found["most"],
        transform=tuple(tuple(matrix[at : at + 4]) for at in (0, 4, 8)),
    )


def dense(source: Path, most_voxels: int) -> DenseGrid:
    """Return the values in a file of `convert`. Raises UnusableGridError, also where it has more voxels."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "values.f32"
        found = json.loads(_run("values", source, "--max-voxels", str(most_voxels), "-o", output))
        values = np.fromfile(output, "<f4").reshape(found["dims"])
    return DenseGrid(
        values,
        tuple(found["first_voxel"]),
        found["background"],
        np.array(found["transform"]).reshape(3, 4),
    )


def program_digest() -> str:
    """Return the SHA-256 of the program, on which all that it writes depends; raises UnusableGridError."""
    return hashlib.sha256(_program().read_bytes()).hexdigest()


def create(output: Path, grid: str, values: NDArray[np.float64], voxel: float) -> None:
    """Write an OpenVDB file of one grid: values, shape (x, y, z), of cubes with edges of `voxel` metres, the
    first with a corner at 0. Raises UnusableGridError.
    """
    with tempfile.TemporaryDirectory() as folder:
        values.astype("<f4").tofile(Path(folder) / "values.f32")
        description = {
            "dims": values.shape,
            "voxel_size": voxel,
            "origin": [voxel / 2] * 3,
            "grids": [{"name": grid, "file": "values.f32"}],
        }
        asked = Path(folder) / "grid.json"
        asked.write_text(json.dumps(description))
        _run("create", asked, "-o", output)


def _program() -> Path:
    program = find_program(PROGRAM)
    if program is None:
        raise UnusableGridError(f"{PROGRAM} is missing on this machine, which reads and writes grids")
    return program


def _run(*words: str | Path) -> bytes:
    command: list[str | Path] = [_program(), *words]
    try:
        done = subprocess.run(command, capture_output=True, check=False, timeout=_TIMEOUT)  # noqa: S603
    except subprocess.TimeoutExpired:
        raise UnusableGridError(f"took longer than {_TIMEOUT} s") from None
    if done.returncode != 0:
        said = done.stderr.decode("utf-8", "replace").strip().splitlines() or ["no reason given"]
        raise UnusableGridError(without_paths(said[-1].removeprefix(f"{PROGRAM}: "), 1000))
    return done.stdout
