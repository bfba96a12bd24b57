"""When a render without a service ends: asked after each range of samples, by the service's rules."""

import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nocturne.v1 import job_pb2
from nocturne_coordinator.dispatch.error_estimate import Squares, estimate_error
from nocturne_coordinator.dispatch.trust import RangeEnd, confirmed
from nocturne_scene.pixel_errors import pixel_variance
from nocturne_scene.ranges import TileGrid, sample_ends
from nocturne_scene.tile_sums import PIXEL_SQUARES, Counts, TileSums, Values, split

# Places among a pixel's sums.
_Y = 1
_YY = PIXEL_SQUARES[_Y]


class LocalStop:
    """Conditions of one render, by the service's names: relative_error, wall_seconds; and angle_error, which
    no pixel's standard error is to exceed, as a part of the largest pixel."""

    def __init__(self, asked: Mapping[str, Any], schedule: job_pb2.RangeSchedule) -> None:
        self._error = float(asked.get("relative_error", 0.0))
        self._angle_error = float(asked.get("angle_error", 0.0))
        self._seconds = float(asked.get("wall_seconds", 0.0))
        self._schedule = schedule
        self._started = time.monotonic()
        self._before = RangeEnd()
        self._angle_error_before = math.inf

    def is_met(self, samples: int, sums_file: Path) -> bool:
        """Whether the image is to end with so many samples of each pixel, whose sums the file has."""
        met = self._has_error(samples, sums_file) if self._error else False
        met = met or (self._has_angle_error(samples, sums_file) if self._angle_error else False)
        return met or self._is_late(samples)

    def _has_angle_error(self, samples: int, sums_file: Path) -> bool:
        pixels = self._sums(sums_file).pixels
        found = largest_error(pixels, np.full(pixels.shape[:2], samples, dtype=np.uint32))
        before, self._angle_error_before = self._angle_error_before, found
        # Twice, as an error from few samples is itself uncertain.
        return max(before, found) <= self._angle_error

    def _sums(self, sums_file: Path) -> TileSums:
        schedule = self._schedule
        further, tiles = len(schedule.further_responses), TileGrid.of(schedule).count
        numbers = np.fromfile(sums_file, dtype="<f8")
        return split(numbers, schedule.width, schedule.height, further, tiles)

    def _has_error(self, samples: int, sums_file: Path) -> bool:
        schedule, sums = self._schedule, self._sums(sums_file)
        width, height, grid = schedule.width, schedule.height, TileGrid.of(schedule)
        of_tiles = sums.tile_products.reshape(-1, grid.columns, sums.tile_products.shape[-1])
        squares = Squares(sums.block_products, of_tiles, grid.tile_size)
        counts = np.full((height, width), samples, dtype=np.uint32)
        now = RangeEnd.of(estimate_error(sums.pixels, counts, squares))
        met = confirmed(self._before, now, self._error)
        self._before = now
        return met

    def _is_late(self, samples: int) -> bool:
        """Whether the next range would end after the time, at the rate so far."""
        if not self._seconds:
            return False
        elapsed = time.monotonic() - self._started
        return elapsed * _next_end(sample_ends(self._schedule), samples) / samples > self._seconds


def largest_error(sums: Values, counts: Counts) -> float:
    """The largest standard error of Y of a pixel, as a part of the largest pixel; infinite in the dark."""
    most = float((sums[..., _Y] / counts).max())
    error = float(np.sqrt(pixel_variance(sums[..., _Y], sums[..., _YY], counts)).max())
    return error / most if most > 0.0 else math.inf


def _next_end(ends: Sequence[int], samples: int) -> int:
    return next(end for end in ends if end > samples)
