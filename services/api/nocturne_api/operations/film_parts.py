"""The committed image of a render, a row of tiles after the other: the whole film may be gigabytes."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.store.rows import TileChange
from nocturne_scene.ranges import TileGrid
from nocturne_scene.tile_sums import TileSums, decode
from nocturne_scene.uncertainty import ImageMoments, moments_of

from nocturne_api.operations.folder_access import FolderAccess


@dataclass(frozen=True, slots=True, eq=False)
class FilmPart:
    """Neighbouring tiles of one row."""

    image: ImageMoments
    left: int
    """Where its upper left pixel is in the film."""
    top: int
    invalid_samples: int


def names_of(schedule: job_pb2.RangeSchedule) -> list[str]:
    """Names of a pixel's values: X, Y, Z and the sensor's further responses."""
    return ["X", "Y", "Z", *schedule.further_responses]


async def film_parts(
    access: FolderAccess, render_id: str, schedule: job_pb2.RangeSchedule, region: Region
) -> AsyncIterator[FilmPart]:
    """The tiles that a region touches, as far as they have samples; where one has none, a row comes in
    parts."""
    grid = TileGrid.of(schedule)
    for row in _rows(region, grid):
        tiles = await access.in_database(access.folder.tiles.between, render_id, row.start, row.stop)
        for run in _runs(tiles):
            yield await asyncio.to_thread(_part, run, grid, schedule.further_responses)


def _rows(region: Region, grid: TileGrid) -> list[range]:
    """Indices of the tiles that a region touches, row by row."""
    size = grid.tile_size
    first, last = region.x // size, (region.x + region.width - 1) // size
    rows = range(region.y // size, (region.y + region.height - 1) // size + 1)
    return [range(row * grid.columns + first, row * grid.columns + last + 1) for row in rows]


def _runs(tiles: list[tuple[TileChange, bytes]]) -> list[list[tuple[TileChange, bytes]]]:
    """Tiles without a gap between them."""
    runs: list[list[tuple[TileChange, bytes]]] = []
    for tile in tiles:
        if not runs or runs[-1][-1][0].tile_index + 1 != tile[0].tile_index:
            runs.append([])
        runs[-1].append(tile)
    return runs


def _part(
    tiles: list[tuple[TileChange, bytes]], grid: TileGrid, further_responses: Sequence[str]
) -> FilmPart:
    """Side by side, so that all of them are one array."""
    places = [grid.tile(change.tile_index) for change, _ in tiles]
    decoded: list[TileSums] = [
        decode(data, tile.width, tile.height, len(further_responses))
        for tile, (_, data) in zip(places, tiles, strict=True)
    ]
    counts = [
        np.full((tile.height, tile.width), change.samples, dtype=np.uint32)
        for tile, (change, _) in zip(places, tiles, strict=True)
    ]
    moments = moments_of(
        np.concatenate([each.pixels for each in decoded], axis=1),
        np.concatenate(counts, axis=1),
        np.concatenate([each.block_products for each in decoded], axis=1),
        np.concatenate([each.tile_products for each in decoded])[None],
        grid.tile_size,
        further_responses,
    )
    return FilmPart(moments, places[0].x, places[0].y, sum(change.invalid_samples for change, _ in tiles))
