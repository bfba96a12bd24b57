"""How renders of daylight coefficients are cut: few pixels make a tile, as each has many numbers. Pure."""

from nocturne.v1 import job_pb2

from nocturne_scene import limits
from nocturne_scene.errors import InputError
from nocturne_scene.ranges import TILE_SIZE, ranges_planned, samples_of
from nocturne_scene.tile_sums import BLOCK

_MAX_COEFFICIENTS = 512 * 1024
"""Bytes of a tile's coefficients, unless it is a single block of pixels."""


def daylight_range_ends(samples: int) -> list[int]:
    """Of daylight coefficients: one sample, then doubling from 32 on."""
    ends, end = [1], 32
    while end < samples:
        ends.append(end)
        end *= 2
    return ends if samples == 1 else [*ends, samples]


def with_coefficients(
    schedule: job_pb2.RangeSchedule, coefficients: int, *, once: bool
) -> job_pb2.RangeSchedule:
    """The schedule of daylight coefficients of each pixel; `once`: of the first sample alone."""
    made = job_pb2.RangeSchedule()
    made.CopyFrom(schedule)
    made.coefficients = coefficients
    made.range_ends[:] = [1] if once else daylight_range_ends(samples_of(schedule))
    made.tile_size = TILE_SIZE
    while made.tile_size > BLOCK and 8 * coefficients * made.tile_size**2 > _MAX_COEFFICIENTS:
        made.tile_size //= 2
    if ranges_planned(made) > limits.MAX_RANGES:
        raise InputError.at(
            "$.sensor.instruments", f"are {ranges_planned(made)} jobs; at most {limits.MAX_RANGES}"
        )
    return made
