"""The EXR of the committed sums of a render not yet ended: the coordinator writes one at the end only."""

from pathlib import Path

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.error_estimate import Squares
from nocturne_coordinator.output.images import Provenance, manifest_text, write_image
from nocturne_coordinator.output.pictures import schedule_json
from nocturne_coordinator.store.data_folder import DataFolder
from nocturne_coordinator.store.rows import RenderRow, TileChange
from nocturne_scene.errors import NotFound
from nocturne_scene.layers import NO_LAYERS, Layers
from nocturne_scene.ranges import TileGrid
from nocturne_scene.render_warnings import from_messages
from nocturne_scene.scene_ranges import wavelengths_of
from nocturne_scene.tile_sums import (
    BLOCK,
    PRODUCTS,
    blocks_in,
    decode,
    products_of_tile,
    sums_per_pixel,
)

MAX_PIXELS = 2**24
"""Of a film of this size the sums are 1.2 GB."""

_Tiles = list[tuple[TileChange, bytes]]


def read_current(folder: DataFolder, render_id: str) -> tuple[RenderRow, job_pb2.RangeSchedule, int, _Tiles]:
    """What of the database such an image is made of. Raises NotFound, also where nothing is committed yet."""
    row = folder.renders.get(render_id)
    if row.width * row.height > MAX_PIXELS:
        raise NotFound(f"an image of {row.width} x {row.height} pixels is written when its render ends")
    tiles = folder.tiles.between(render_id, 0, row.tiles)
    if not tiles:
        raise NotFound("no image yet")
    return row, folder.renders.schedule(render_id), folder.renders.engine(render_id), tiles


def write_current(
    path: Path,
    row: RenderRow,
    schedule: job_pb2.RangeSchedule,
    engine: int,
    tiles: _Tiles,
    layers: Layers = NO_LAYERS,
) -> None:
    """Writes the EXR, in the same form as a final one. Raises OSError."""
    grid, further = TileGrid.of(schedule), len(schedule.further_responses)
    height, width = row.height, row.width
    sums = np.zeros((height, width, sums_per_pixel(further)))
    counts = np.zeros((height, width), dtype=np.uint32)
    blocks = np.zeros((blocks_in(height), blocks_in(width), PRODUCTS))
    whole, samples = np.zeros((grid.count, products_of_tile(further))), [0] * grid.count
    for change, data in tiles:
        tile = grid.tile(change.tile_index)
        found = decode(data, tile.width, tile.height, further)
        area = np.s_[tile.y : tile.y + tile.height, tile.x : tile.x + tile.width]
        sums[area], counts[area] = found.pixels, change.samples
        y, x = tile.y // BLOCK, tile.x // BLOCK
        down, across, _ = found.block_products.shape
        blocks[y : y + down, x : x + across] = found.block_products
        whole[change.tile_index], samples[change.tile_index] = found.tile_products[0], change.samples
    provenance = Provenance(
        row.scene_sha256,
        schedule_json(schedule),
        engine,
        manifest_text(samples),
        row.floating_point_profile,
        row.quantity,
        row.error_warning,
        row.truncated_paths,
        schedule.way,
        from_messages(schedule.warnings),
        wavelengths_of(schedule),
        schedule.instruments,
    )
    of_tiles = whole.reshape(-1, grid.columns, whole.shape[-1])
    write_image(
        path,
        sums,
        counts,
        Squares(blocks, of_tiles, grid.tile_size),
        provenance,
        [*schedule.further_responses],
        layers,
    )
