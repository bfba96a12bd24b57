"""Density grids as Mitsuba's volumes."""

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.formats.mitsuba.read.volumes import FLOATS, HEADER
from nocturne_scene.formats.mitsuba.write.context import Context
from nocturne_scene.formats.mitsuba.write.elements import Element, matrix, plugin
from nocturne_scene.formats.reading.transforms import scaling, translation
from nocturne_scene.media.grid_files import UnusableGridError, dense

# Its grids have no empty parts: a quarter of a gigabyte, and five times as much memory in between.
_MAX_VOXELS = 2**26


def density(context: Context, grid: scene_pb2.DensityGrid, name: str, place: str) -> Element | None:
    """A grid's values, without its scale, in a file of that name; None (told) where that can't be."""
    try:
        found = dense(context.compiled.blobs.path(grid.blob.hex()), _MAX_VOXELS)
    except UnusableGridError as error:
        context.findings.lost(place, f"a density grid that can't be exported: {error}")
        return None
    if found.background > 0:
        # Its media end with their grids.
        context.findings.lost(place, "a density grid that goes on without end can't be exported")
        return None
    # Values are in the middles of cells for both. Beyond the last one there its value goes on, in all of the
    # box along the axes of the scene that holds a turned grid.
    values = np.pad(found.values, 1)
    header = HEADER.pack(b"VOL", 3, FLOATS, *values.shape, 1, 0, 0, 0, 1, 1, 1)
    content = header + np.ascontiguousarray(values.transpose(2, 1, 0)).tobytes()
    file = context.writer.file(f"{name}.vol", content)
    volume = plugin(
        "volume",
        "gridvolume",
        name="sigma_t",
        filename=file,
        filter_type="nearest" if grid.nearest else "trilinear",
    )
    corner = np.array(found.first_voxel) - 1.5
    to_voxels = translation(corner.tolist()) @ scaling([float(count) for count in values.shape])
    rows = np.eye(4)
    rows[:3] = np.array(grid.transform).reshape(3, 4)
    to_grid = np.vstack([found.transform, [0, 0, 0, 1]])
    placed = context.compiled.metre * (rows @ to_grid @ to_voxels)[:3]
    volume.append(matrix("to_world", list(placed[:, :3].T), placed[:, 3]))
    return volume
