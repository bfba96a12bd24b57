"""What regions of renders show, in numbers, with their errors."""

import asyncio
import math

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.region import Region
from nocturne_coordinator.store.rows import TileChange
from nocturne_scene.errors import NotFound
from nocturne_scene.quantities import quantity_named
from nocturne_scene.ranges import TileGrid
from nocturne_scene.tile_sums import TileSums, decode
from nocturne_scene.uncertainty import RegionReading, RegionSums, moments_of

from nocturne_api.models import renders as models
from nocturne_api.operations.folder_access import FolderAccess
from nocturne_api.operations.renders import Renders


class Readings:
    """Numbers of renders as they are now."""

    def __init__(self, access: FolderAccess, renders: Renders) -> None:
        self._access = access
        self._renders = renders

    async def read(self, render_id: str, region: Region | None) -> models.Reading:
        """Of all pixels where there is no region; raises NotFound, also where nothing is rendered yet, and
        InputError."""
        render = await self._renders.get(render_id)
        wanted = region or Region(0, 0, render.width, render.height)
        wanted.check(render.width, render.height)
        schedule = await self._access.in_database(self._access.folder.renders.schedule, render.id)
        grid, names = TileGrid.of(schedule), ["X", "Y", "Z", *schedule.further_responses]
        sums, invalid_samples = RegionSums(len(names)), 0
        # A row of tiles after the other: the whole film may be gigabytes.
        for row in _rows(wanted, grid):
            tiles = await self._access.in_database(
                self._access.folder.tiles.between, render.id, row.start, row.stop
            )
            await asyncio.to_thread(_add, sums, tiles, wanted, schedule)
            invalid_samples += sum(change.invalid_samples for change, _ in tiles)
        found = sums.reading()
        if found is None:
            raise NotFound(f"{render.id} has no samples there yet")
        return _answer(found, wanted, render.quantity, names, invalid_samples)


def _rows(region: Region, grid: TileGrid) -> list[range]:
    """Indices of the tiles that a region touches, row by row."""
    size = grid.tile_size
    first, last = region.x // size, (region.x + region.width - 1) // size
    rows = range(region.y // size, (region.y + region.height - 1) // size + 1)
    return [range(row * grid.columns + first, row * grid.columns + last + 1) for row in rows]


def _add(
    sums: RegionSums,
    tiles: list[tuple[TileChange, bytes]],
    region: Region,
    schedule: job_pb2.RangeSchedule,
) -> None:
    """Adds what a row of tiles has of a region; side by side, so that all of them are one array."""
    if not tiles:
        return
    grid, further = TileGrid.of(schedule), len(schedule.further_responses)
    places = [grid.tile(change.tile_index) for change, _ in tiles]
    decoded: list[TileSums] = [
        decode(data, tile.width, tile.height, further) for tile, (_, data) in zip(places, tiles, strict=True)
    ]
    counts = [
        np.full((tile.height, tile.width), change.samples, dtype=np.uint32)
        for tile, (change, _) in zip(places, tiles, strict=True)
    ]
    moments = moments_of(
        np.concatenate([each.pixels for each in decoded], axis=1),
        np.concatenate(counts, axis=1),
        np.concatenate([each.block_squares for each in decoded], axis=1),
        np.concatenate([each.tile_squares for each in decoded])[None],
        grid.tile_size,
    )
    y = np.arange(places[0].y, places[0].y + places[0].height)
    x = np.concatenate([np.arange(tile.x, tile.x + tile.width) for tile in places])
    within_y = (y >= region.y) & (y < region.y + region.height)
    within_x = (x >= region.x) & (x < region.x + region.width)
    sums.add(moments, within_y[:, None] & within_x)


def _answer(
    found: RegionReading, region: Region, quantity_name: str, names: list[str], invalid_samples: int
) -> models.Reading:
    quantity = quantity_named(quantity_name)
    values = zip(names, found.mean, found.error, strict=True)
    u, v = map(_known, found.chromaticity)
    u_error, v_error = map(_known, found.chromaticity_error)
    return models.Reading(
        region=models.Region(x=region.x, y=region.y, width=region.width, height=region.height),
        quantity=quantity.name,
        unit=quantity.unit,
        response_unit=quantity.response_unit,
        values=[
            models.ReadValue(name=name, mean=mean, standard_error=_known(error))
            for name, mean, error in values
        ],
        u_prime=u,
        v_prime=v,
        u_prime_error=u_error,
        v_prime_error=v_error,
        correlation=found.correlation,
        pixels=found.pixels,
        unseen_pixels=found.unseen_pixels,
        samples=found.samples,
        fewest_samples=found.samples_per_pixel[0],
        most_samples=found.samples_per_pixel[1],
        invalid_samples=invalid_samples,
    )


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
