"""Densities on grids, as OpenVDB files."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError
from nocturne_scene.formats.reading import transforms
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.formats.reading.transforms import Matrix
from nocturne_scene.media.grid_files import UnusableGridError, create

Values = NDArray[np.float64]

NAME = "density"

# Voxels of a file that is written, and how much finer than its grid it is at most. Values are constant over a
# voxel, so that the grid ends sharply; in between they are those of a renderer that interpolates.
_MAX_VOXELS = 2**24
_FINEST = 8

# Cubes along the shortest edge of an even box, and by which part of an edge its faces may be off.
_CUBES_ALONG = 64
_OFF_ALTOGETHER = 5e-3

# By which part of a voxel the faces of a grid may be off.
_OFF = 1e-3


@dataclass(frozen=True)
class Grid:
    """Values at the middles of cells that fill a box; zero outside."""

    values: Values
    """Shape (x, y, z), not negative."""
    interpolated: bool
    """Straight lines between middles, the outer ones held up to the faces; else constant over a cell."""
    to_world: Matrix
    """From the cube [0, 1]^3."""
    fades: bool = False
    """Interpolated with zeros beyond the outer cells' middles, instead of held."""


def density(writer: SceneWriter, grid: Grid, factor: float, place: str, *, times: Grid | None = None) -> Json:
    """Write a grid and return the density that it is, multiplied with another one that fills the same box.

    Raises InputError where it has no counterpart.
    """
    if times is not None and not np.allclose(grid.to_world, times.to_world, rtol=1e-5):
        raise InputError.at(place, "grids of one medium in different boxes are not supported")
    if times is not None and times.values.size > grid.values.size:
        grid, times = times, grid
    edges = np.linalg.norm(grid.to_world[:3, :3], axis=0)
    frame = grid.to_world.copy()
    if not np.all(edges > 0):
        raise InputError.at(place, "a grid that has no volume")
    frame[:3, :3] /= edges
    if np.abs(frame[:3, :3].T @ frame[:3, :3] - np.eye(3)).max() > 1e-6:
        raise InputError.at(place, "a grid that is sheared is not supported")
    if transforms.is_mirrored(frame):
        raise InputError.at(place, "a grid that is mirrored is not supported")
    counts, voxel = cubes(edges, grid)
    if counts is None:
        raise InputError.at(place, "the cells of the grid can't be divided into cubes")
    values = sampled(grid, counts)
    if times is not None:
        values = values * sampled(times, counts)
    asset = _write(writer, values, voxel)
    placed: Json = {"asset": asset, "grid": NAME, "factor": factor, "nearest": True}
    placed["translate"] = frame[:3, 3].tolist()
    turn = transforms.rotation_of(frame[:3, :3])
    if turn is not None:
        placed["rotate"] = {"axis": turn[0], "degrees": turn[1]}
    return placed


def cubes(edges: Values, grid: Grid) -> tuple[tuple[int, ...] | None, float]:
    """How many cubes along each edge, and their size: the finest that fit and are few enough."""
    counts = np.array(grid.values.shape)
    if np.all(counts == 1):
        return _one_cell(edges)
    finest = _FINEST if grid.interpolated else 1
    axis = int(np.argmin(edges / counts))
    found: tuple[tuple[int, ...] | None, float] = (None, 0.0)
    for finer in range(1, _FINEST + 1):
        voxel = edges[axis] / (counts[axis] * finer)
        wanted = np.maximum(1, np.round(edges / voxel)).astype(int)
        fits = np.all(np.abs(wanted * voxel - edges) <= _OFF * voxel)
        # Cells that are not interpolated must not be cut.
        whole = grid.interpolated or not np.any(wanted % counts)
        if fits and whole and np.prod(wanted.astype(float)) <= _MAX_VOXELS:
            found = (tuple(int(count) for count in wanted), float(voxel))
            if finer >= finest:
                break
    return found


def _one_cell(edges: Values) -> tuple[tuple[int, ...] | None, float]:
    """The same for an even box: the fewest cubes whose faces are off by the least part of an edge."""
    best: tuple[float, tuple[int, ...] | None, float] = (_OFF_ALTOGETHER, None, 0.0)
    for finer in range(1, _CUBES_ALONG + 1):
        voxel = float(edges.min()) / finer
        wanted = np.maximum(1, np.round(edges / voxel)).astype(int)
        off = float(np.max(np.abs(wanted * voxel / edges - 1)))
        if np.prod(wanted.astype(float)) <= _MAX_VOXELS and off < best[0] - 1e-9:
            best = (off, tuple(int(count) for count in wanted), voxel)
    return best[1], best[2]


def sampled(grid: Grid, counts: tuple[int, ...]) -> Values:
    """Values at the middles of so many equal cells along each axis."""
    values = np.pad(grid.values, 1) if grid.fades else grid.values
    for axis, count in enumerate(counts):
        size = values.shape[axis]
        at = (np.arange(count) + 0.5) / count * grid.values.shape[axis] + (1 if grid.fades else 0)
        if not grid.interpolated:
            values = np.take(values, at.astype(int), axis=axis)
            continue
        at = np.clip(at - 0.5, 0, size - 1)
        low = np.minimum(at.astype(int), max(size - 2, 0))
        part = (at - low).reshape([-1 if each == axis else 1 for each in range(3)])
        high = np.take(values, np.minimum(low + 1, size - 1), axis=axis)
        values = (1 - part) * np.take(values, low, axis=axis) + part * high
    return values


def _write(writer: SceneWriter, values: Values, voxel: float) -> str:
    name = writer.unused_file("grids", "density", ".vdb")
    try:
        create(writer.folder / name, NAME, values, voxel)
    except UnusableGridError as error:
        raise InputError.at(name, str(error)) from None
    return name
