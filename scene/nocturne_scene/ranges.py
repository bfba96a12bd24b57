"""How a render is cut into tiles and sample ranges: a fixed function of film, samples and responses. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Self

from nocturne.v1 import job_pb2

from nocturne_scene import limits
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.responses import name_problems
from nocturne_scene.tile_sums import XYZ_SUMS, numbers_in, sums_per_pixel

TILE_SIZE = 32
"""Pixels: a result has 32 x 32 x 9 sums x 8 bytes = 72 KiB, and 3 KiB of blocks."""

_MAX_PARTIAL = 144 * 1024
"""Bytes: tiles of more sums per pixel are smaller, so that the messages of a full window fit in memory."""

FIRST_RANGE = 4
"""Samples: a first look at the whole frame after four photons per pixel."""

MAX_RANGE = 4096
"""Samples: 4 million photons per job, a few seconds of one core."""

MAX_CUT_RANGES = 2**16
"""Of a tile, in a schedule that was cut: the schedule is read often, and has four bytes for each."""

MAX_JOB = MAX_RANGE * TILE_SIZE**2
"""Photons: shortens the ranges of tiles that are larger than usual."""


@dataclass(frozen=True, slots=True)
class SampleRange:
    """Samples [first, end) of every pixel of a tile, the `index`-th range of its schedule."""

    index: int
    first: int
    end: int


def make_schedule(
    width: int,
    height: int,
    samples: int,
    further_responses: Sequence[str] = (),
    *,
    one_tile: bool = False,
    photons_per_sample: int = 1,
) -> job_pb2.RangeSchedule:
    """The schedule of a film of width x height pixels with `samples` samples per pixel.

    `further_responses` are the names of the sensor's, besides X, Y and Z. `one_tile`: the whole film is one
    tile, as a photon from a luminaire may meet any pixel. `photons_per_sample`: photons that travel together.
    Raises InputError with the places `$.width`,
    `$.height`, `$.samples`, and `$.scene` for the names.
    """
    problems = [*_edge_problems("$.width", width), *_edge_problems("$.height", height)]
    per_pixel = sums_per_pixel(len(further_responses))
    most = limits.MAX_FORWARD_PIXELS if one_tile else limits.MAX_FILM_PIXELS
    most = most * XYZ_SUMS // per_pixel
    if not problems and width * height > most:
        of = " of a scene with photons from luminaires" if one_tile else ""
        problems.append(Problem("$.width", f"the film{of} has {width * height} pixels; at most {most}"))
    problems.extend(Problem("$.scene", message) for message in name_problems(further_responses))
    if not 1 <= samples <= limits.MAX_SAMPLES:
        problems.append(Problem("$.samples", f"is {samples}; expected 1 to {limits.MAX_SAMPLES}"))
    if problems:
        raise InputError(problems)
    longest = MAX_RANGE
    if one_tile:
        longest = min(MAX_RANGE, max(FIRST_RANGE, MAX_JOB // (width * height)))
        if samples // longest > limits.MAX_FORWARD_RANGES:
            most = limits.MAX_FORWARD_RANGES * longest
            raise InputError.at(
                "$.samples", f"is {samples}; at most {most} of this film, with photons from luminaires"
            )
    schedule = job_pb2.RangeSchedule(
        width=width,
        height=height,
        tile_size=max(width, height) if one_tile else _tile_size(len(further_responses)),
        range_ends=_range_ends(samples, longest),
        further_responses=further_responses,
        photons_per_sample=photons_per_sample if photons_per_sample > 1 else 0,
    )
    planned = TileGrid.of(schedule).count * len(schedule.range_ends)
    if planned > limits.MAX_RANGES:
        raise InputError.at(
            "$.samples", f"{samples} samples of this film are {planned} jobs; at most {limits.MAX_RANGES}"
        )
    return schedule


def extended_schedule(schedule: job_pb2.RangeSchedule, samples: int) -> job_pb2.RangeSchedule:
    """A schedule of more samples that begins with all ranges of `schedule`, so that nothing is traced again.

    Its further ranges end where those of a new schedule would. Where the old one ended on such an end as
    well, as
    at every power of two, the schedule is the new schedule, and so the bits are. Raises InputError at
    `$.samples`.
    """
    before = list(schedule.range_ends)
    if samples < before[-1]:
        raise InputError.at("$.samples", f"is {samples}; a render of {before[-1]} can only get more")
    fresh = make_schedule(
        schedule.width,
        schedule.height,
        samples,
        list(schedule.further_responses),
        one_tile=schedule.tile_size >= max(schedule.width, schedule.height) > TILE_SIZE,
        photons_per_sample=schedule.photons_per_sample,
    )
    extended = job_pb2.RangeSchedule()
    extended.CopyFrom(schedule)
    del extended.range_ends[:]
    extended.range_ends.extend([*before, *(end for end in fresh.range_ends if end > before[-1])])
    return extended


def recut_schedule(
    schedule: job_pb2.RangeSchedule, completed: int, longest: int
) -> job_pb2.RangeSchedule | None:
    """The same samples in ranges of at most `longest`, but for ranges that begin before sample `completed`:
    some tile has those, and all tiles are to be cut alike.

    None where there is nothing to cut, or where there would be more ranges than MAX_CUT_RANGES.
    """
    most = min(MAX_CUT_RANGES, limits.MAX_RANGES // TileGrid.of(schedule).count)
    longest = max(longest, FIRST_RANGE)
    ends: list[int] = []
    for first, end in pairwise([0, *schedule.range_ends]):
        if first >= completed and end - first > longest:
            if len(ends) + (end - first) // longest > most:
                return None
            ends.extend(range(first + longest, end, longest))
        ends.append(end)
    if len(ends) == len(schedule.range_ends) or len(ends) > most:
        return None
    recut = job_pb2.RangeSchedule()
    recut.CopyFrom(schedule)
    recut.range_ends[:] = ends
    return recut


def _edge_problems(place: str, edge: int) -> list[Problem]:
    if 1 <= edge <= limits.MAX_FILM_EDGE:
        return []
    return [Problem(place, f"is {edge} pixels; expected 1 to {limits.MAX_FILM_EDGE}")]


def _tile_size(further: int) -> int:
    size = TILE_SIZE
    while 8 * numbers_in(size, size, further) > _MAX_PARTIAL:
        size //= 2
    return size


def _range_ends(samples: int, longest: int) -> list[int]:
    """4, 8, 16, ... doubling until a range is `longest` long, then steps of that, up to `samples`."""
    ends = []
    end = FIRST_RANGE
    while end < samples:
        ends.append(end)
        end += min(end, longest)
    return [*ends, samples]


@dataclass(frozen=True)
class TileGrid:
    """The tiles of a film, row-major."""

    width: int
    height: int
    tile_size: int

    @classmethod
    def of(cls, schedule: job_pb2.RangeSchedule) -> Self:
        return cls(schedule.width, schedule.height, schedule.tile_size)

    @cached_property
    def columns(self) -> int:
        return -(-self.width // self.tile_size)

    @cached_property
    def count(self) -> int:
        """Number of tiles."""
        return self.columns * -(-self.height // self.tile_size)

    def tile(self, index: int) -> job_pb2.Tile:
        """The rectangle of tile `index`, 0 <= index < count; the last column and row may be cut."""
        if not 0 <= index < self.count:
            raise IndexError(f"tile {index} of {self.count}")
        row, column = divmod(index, self.columns)
        x, y = column * self.tile_size, row * self.tile_size
        return job_pb2.Tile(
            x=x,
            y=y,
            width=min(self.tile_size, self.width - x),
            height=min(self.tile_size, self.height - y),
        )


class RangeList:
    """The sample ranges of a schedule, found by index or by their first sample."""

    def __init__(self, schedule: job_pb2.RangeSchedule) -> None:
        self._ends = list(schedule.range_ends)
        self._index_by_first = {first: index for index, first in enumerate([0, *self._ends[:-1]])}

    def __len__(self) -> int:
        return len(self._ends)

    def __getitem__(self, index: int) -> SampleRange:
        """Range `index`, 0 <= index < len(self)."""
        return SampleRange(index, self._ends[index - 1] if index else 0, self._ends[index])

    def find(self, first: int, end: int) -> SampleRange | None:
        """The planned range [first, end), if there is one."""
        index = self._index_by_first.get(first)
        return self[index] if index is not None and self._ends[index] == end else None

    def merged_at(self, samples: int) -> int:
        """How many ranges a tile has behind it after `samples` samples; ValueError if no range ends there."""
        if samples == self._ends[-1]:
            return len(self)
        if samples not in self._index_by_first:
            raise ValueError(f"{samples} samples are not the end of a planned range")
        return self._index_by_first[samples]
