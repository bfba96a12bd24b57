"""How a render is cut into tiles and sample ranges: a fixed function of film and sample count. Pure."""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

from nocturne.v1 import job_pb2

from . import limits
from .errors import InputError, Problem

TILE_SIZE = 32
"""Pixels: 32 x 32 x 4 sums x 8 bytes = 32 KiB, half of the entry size at which Redis streams get slow."""

FIRST_RANGE = 4
"""Samples: a first look at the whole frame after four photons per pixel."""

LONGEST_RANGE = 4096
"""Samples: 4 million photons per job, a few seconds of one core."""


@dataclass(frozen=True, slots=True)
class SampleRange:
    """Samples [first, end) of every pixel of a tile, the `index`-th range of its plan."""

    index: int
    first: int
    end: int


def make_plan(width: int, height: int, samples: int) -> job_pb2.RenderPlan:
    """The plan of a film of width x height pixels with `samples` samples per pixel.

    Raises InputError with the places `$.width`, `$.height`, `$.samples`.
    """
    problems = [*_edge_problems("$.width", width), *_edge_problems("$.height", height)]
    if not problems and width * height > limits.MAXIMUM_FILM_PIXELS:
        problems.append(
            Problem("$.width", f"the film has {width * height} pixels; at most {limits.MAXIMUM_FILM_PIXELS}")
        )
    if not 1 <= samples <= limits.MAXIMUM_SAMPLES:
        problems.append(Problem("$.samples", f"is {samples}; expected 1 to {limits.MAXIMUM_SAMPLES}"))
    if problems:
        raise InputError(problems)
    plan = job_pb2.RenderPlan(
        width=width, height=height, tile_size=TILE_SIZE, range_ends=_range_ends(samples)
    )
    planned = TileGrid.of(plan).count * len(plan.range_ends)
    if planned > limits.MAXIMUM_RANGES:
        raise InputError.at(
            "$.samples", f"{samples} samples of this film are {planned} jobs; at most {limits.MAXIMUM_RANGES}"
        )
    return plan


def _edge_problems(place: str, edge: int) -> list[Problem]:
    if 1 <= edge <= limits.MAXIMUM_FILM_EDGE:
        return []
    return [Problem(place, f"is {edge} pixels; expected 1 to {limits.MAXIMUM_FILM_EDGE}")]


def _range_ends(samples: int) -> list[int]:
    """4, 8, 16, ... doubling until a range is LONGEST_RANGE long, then steps of that, up to `samples`."""
    ends = []
    end = FIRST_RANGE
    while end < samples:
        ends.append(end)
        end += min(end, LONGEST_RANGE)
    return [*ends, samples]


@dataclass(frozen=True)
class TileGrid:
    """The tiles of a film, row-major."""

    width: int
    height: int
    tile_size: int

    @classmethod
    def of(cls, plan: job_pb2.RenderPlan) -> Self:
        return cls(plan.width, plan.height, plan.tile_size)

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
    """The sample ranges of a plan, found by index or by their first sample."""

    def __init__(self, plan: job_pb2.RenderPlan) -> None:
        self._ends = list(plan.range_ends)
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
