"""Makes a year of daylight of renders of its coefficients: the job on standard input, the year as text in the
answer on standard output, both JSON.

The renders are read from the data folder's database, by this process alone: coefficients may be gigabytes.
"""

import base64
import json
import os
import resource
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.store.databases import open_database
from nocturne_coordinator.store.object_store import ObjectStore
from nocturne_coordinator.store.tiles import Tiles
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.daylight_coefficients import layout_of, points_of, weather_of
from nocturne_scene.daylight.coefficients import Coefficients
from nocturne_scene.daylight.plain_year import as_text
from nocturne_scene.daylight.points import Points
from nocturne_scene.daylight.year_of_light import Traces, counting_of, measure
from nocturne_scene.daylight.year_of_skies import skies_of
from nocturne_scene.document.daylight import YearOfDaylight
from nocturne_scene.document.read import check_document
from nocturne_scene.document.sensors import Meters
from nocturne_scene.errors import InputError, NotFound
from nocturne_scene.ranges import TileGrid
from nocturne_scene.spectra.published import Floats
from nocturne_scene.tile_sums import decode

_TILES_AT_ONCE = 64
_SURE = 1.0
"""Here nothing stops by it."""


def main() -> None:
    """Reads the job, answers it."""
    job = json.load(sys.stdin)
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (job["memory_bytes"], job["memory_bytes"]))
    answer: dict[str, Any]
    try:
        answer = {"year": year_of(job)}
    except InputError as error:
        answer = {"problems": [[each.place, each.message] for each in error.problems]}
    except (NotFound, MemoryError) as error:
        answer = {"failed": str(error) or "the coefficients need more memory than there is for them"}
    json.dump(answer, sys.stdout)


def year_of(job: Mapping[str, Any]) -> str:
    """The year as JSON. Raises InputError and NotFound."""
    blobs = BlobStore(Path(job["blobs"]), ObjectStore(job["objects"]) if job["objects"] else None)
    sensor = check_document(job["scene"]).sensor
    assert isinstance(sensor, Meters)  # noqa: S101 - the caller looked
    assert sensor.daylight is not None  # noqa: S101
    layout, points = layout_of(sensor.daylight), points_of(sensor)
    weather = weather_of(sensor.daylight, blobs)
    skies = skies_of(weather, layout.sky, job["ground"])
    counting = counting_of(weather, skies, job["hours"], job["lux"])
    films = Films(Tiles(open_database(Path(job["folder"]))), points, sensor.daylight)
    states = [[films.coefficients(state) for state in of_seen] for of_seen in job["renders"]]
    seen = [Traces(each[0], each[1] if len(each) > 1 else None) for each in states]
    traces = replace(seen[0], melanopic=seen[1] if len(seen) > 1 else None)
    return as_text(measure(weather, points, skies, layout, counting, traces, _SURE, None, job["eyes"]))


class Films:
    """The committed coefficients of renders."""

    def __init__(self, tiles: Tiles, points: Points, year: YearOfDaylight) -> None:
        self._tiles, self._points, self._batches = tiles, points, year.batches

    def coefficients(self, renders: Mapping[str, Any]) -> Coefficients:
        """Of one state of the room, by what renders are of. Raises NotFound where samples are missing."""
        sky, samples = self._film(renders["sky"])
        reflected, of_suns = self._film(renders["sun_reflected"])
        if of_suns != samples:
            reflected *= samples / of_suns
        straight, once = self._film(renders["sun_straight"])
        if once != 1:
            straight /= once
        return Coefficients(
            sky, reflected, np.ascontiguousarray(straight[..., :-1]), straight[..., -1].copy(), samples
        )

    def _film(self, render: Mapping[str, Any]) -> tuple[Floats, int]:
        """By batch, point and coefficient, and of how many samples of each batch."""
        schedule = job_pb2.RangeSchedule.FromString(base64.b64decode(render["schedule"]))
        grid, further = TileGrid.of(schedule), len(schedule.further_responses)
        film = np.zeros((schedule.height, schedule.width, schedule.coefficients))
        samples, known = set[int](), 0
        for first in range(0, grid.count, _TILES_AT_ONCE):
            for change, sums in self._tiles.between(render["id"], first, first + _TILES_AT_ONCE):
                tile = grid.tile(change.tile_index)
                area = np.s_[tile.y : tile.y + tile.height, tile.x : tile.x + tile.width]
                film[area] = decode(sums, tile.width, tile.height, further).coefficients
                samples.add(change.samples)
                known += 1
        if known != grid.count or len(samples) != 1:
            raise NotFound(
                f"render {render['id']} has not as many samples of all meters yet; wait for its end"
            )
        of_batches = film.reshape(self._batches, -1, schedule.coefficients)
        return np.ascontiguousarray(of_batches[:, self._points.pixels]), samples.pop()


if __name__ == "__main__":
    main()
