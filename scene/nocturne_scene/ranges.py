"""How a render is cut into tiles and sample ranges: a fixed function of film, samples and responses. Pure."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import pairwise
from typing import Self

from nocturne.v1 import job_pb2

from nocturne_scene import limits
from nocturne_scene.errors import InputError, Problem
from nocturne_scene.responses import name_problems
from nocturne_scene.tile_sums import PRODUCTS, XYZ_SUMS, numbers_in, products_of_tile, sums_per_pixel

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

PHOTON_BUNDLE = 2**14
"""Forward photons, by which ranges of them are counted; as in worker/src/tile/photon_range.h."""

FIRST_PHOTON_RANGE = 2**6
"""Bundles, at most: a million photons. A result is as large as the film, so many short ranges would be much
traffic."""

MAX_PHOTON_RANGE = 2**11
"""Bundles: 34 million photons are about half a minute where a photon takes 1 us, and a result for a film of
two million pixels is then below 1 MB for each second of tracing. Where it takes longer, ranges are cut."""

MAX_RANGE_OF_FEW_PIXELS = 2**8
"""Bundles, the same of small films, whose results are small: as many photons as the longest range of a tile
has, so that many threads have work. Between both films the longest range grows with the pixels."""


class ForwardPhotons(Enum):
    """How photons from luminaires take part in a film."""

    NONE = "none"
    ALONE = "alone"
    """They bring all light; tiles have no ranges."""
    BESIDE = "beside"
    """With adjoint photons, which have those of tiles."""


@dataclass(frozen=True, slots=True)
class SampleRange:
    """Samples [first, end) of every pixel of a tile, or bundles of forward photons of the film; the
    `index`-th range of its schedule."""

    index: int
    first: int
    end: int


def make_schedule(
    width: int,
    height: int,
    samples: int,
    further_responses: Sequence[str] = (),
    *,
    forward_photons: ForwardPhotons = ForwardPhotons.NONE,
    photons_per_sample: int = 1,
    forward_ratio: float = 0.0,
) -> job_pb2.RangeSchedule:
    """The schedule of a film of width x height pixels with `samples` samples per pixel.

    `further_responses` are the names of the sensor's, besides X, Y and Z. `photons_per_sample`: photons that
    travel together. `forward_ratio`: photons from the luminaires for each from a pixel, where both directions
    are traced; 0: 1. Raises InputError with the places `$.width`, `$.height`, `$.samples`, and `$.scene` for
    the names.
    """
    further = len(further_responses)
    problems = [*_edge_problems("$.width", width), *_edge_problems("$.height", height)]
    if not problems:
        problems.extend(_size_problems(width, height, forward_photons, further))
    problems.extend(Problem("$.scene", message) for message in name_problems(further_responses))
    if not 1 <= samples <= limits.MAX_SAMPLES:
        problems.append(Problem("$.samples", f"is {samples}; expected 1 to {limits.MAX_SAMPLES}"))
    if problems:
        raise InputError(problems)
    has_ratio = forward_photons is ForwardPhotons.BESIDE and forward_ratio not in (0.0, 1.0)
    schedule = job_pb2.RangeSchedule(
        width=width,
        height=height,
        tile_size=_tile_size(further),
        range_ends=() if forward_photons is ForwardPhotons.ALONE else _range_ends(samples, MAX_RANGE),
        further_responses=further_responses,
        photons_per_sample=photons_per_sample if photons_per_sample > 1 else 0,
        forward_ratio=forward_ratio if has_ratio else 0.0,
    )
    if forward_photons is not ForwardPhotons.NONE:
        schedule.photon_range_ends.extend(_photon_range_ends(schedule, samples))
    planned = ranges_planned(schedule)
    if planned > limits.MAX_RANGES:
        raise InputError.at(
            "$.samples", f"{samples} samples of this film are {planned} jobs; at most {limits.MAX_RANGES}"
        )
    return schedule


def _photon_range_ends(schedule: job_pb2.RangeSchedule, samples: int) -> list[int]:
    pixels = schedule.width * schedule.height
    of_sample = pixels * ratio_of(schedule)
    bundles = math.ceil(of_sample * samples / PHOTON_BUNDLE)
    longest = min(MAX_PHOTON_RANGE, max(MAX_RANGE_OF_FEW_PIXELS, _power_of_two(pixels / 2**10)))
    if bundles // longest > limits.MAX_FORWARD_RANGES:
        most = int(limits.MAX_FORWARD_RANGES * longest * PHOTON_BUNDLE / of_sample)
        raise InputError.at(
            "$.samples", f"is {samples}; at most {most} of this film, with photons from luminaires"
        )
    first = min(FIRST_PHOTON_RANGE, _power_of_two(FIRST_RANGE * of_sample / PHOTON_BUNDLE))
    return _range_ends(bundles, longest, first)


def extended_schedule(schedule: job_pb2.RangeSchedule, samples: int) -> job_pb2.RangeSchedule:
    """A schedule of more samples that begins with all ranges of `schedule`, so that nothing is traced again.

    Its further ranges end where those of a new schedule would. Where the old one ended on such an end as
    well, as
    at every power of two, the schedule is the new schedule, and so the bits are. Raises InputError at
    `$.samples`.
    """
    fresh = make_schedule(
        schedule.width,
        schedule.height,
        samples,
        list(schedule.further_responses),
        forward_photons=_forward_photons_of(schedule),
        photons_per_sample=schedule.photons_per_sample,
        forward_ratio=schedule.forward_ratio,
    )
    if _last(fresh) < _last(schedule):
        more = f"is {samples}; a render of {samples_of(schedule)} can only get more"
        raise InputError.at("$.samples", more)
    extended = job_pb2.RangeSchedule()
    extended.CopyFrom(schedule)
    extended.range_ends[:] = _continued(schedule.range_ends, fresh.range_ends)
    extended.photon_range_ends[:] = _continued(schedule.photon_range_ends, fresh.photon_range_ends)
    return extended


def _last(schedule: job_pb2.RangeSchedule) -> int:
    return (schedule.range_ends or schedule.photon_range_ends)[-1]


def _continued(before: Sequence[int], fresh: Iterable[int]) -> list[int]:
    return [*before, *(end for end in fresh if end > before[-1])]


def _forward_photons_of(schedule: job_pb2.RangeSchedule) -> ForwardPhotons:
    if not schedule.photon_range_ends:
        return ForwardPhotons.NONE
    return ForwardPhotons.BESIDE if schedule.range_ends else ForwardPhotons.ALONE


def samples_of(schedule: job_pb2.RangeSchedule) -> int:
    """Of each pixel, in the whole render."""
    return sample_ends(schedule)[-1]


def sample_ends(schedule: job_pb2.RangeSchedule) -> Sequence[int]:
    """The samples that each pixel has at the ends of ranges."""
    pixels = schedule.width * schedule.height
    return schedule.range_ends or [samples_by(bundles, pixels) for bundles in schedule.photon_range_ends]


def samples_by(bundles: int, pixels: int) -> int:
    """Of how many samples of each pixel an image by so many bundles of forward photons alone is; as
    worker/src/tracer/trace_film.cpp has it."""
    return max(1, bundles * PHOTON_BUNDLE // pixels)


def ratio_of(schedule: job_pb2.RangeSchedule) -> float:
    """Photons from the luminaires for each from a pixel, where both directions are traced."""
    return schedule.forward_ratio or 1.0


def entries_of(schedule: job_pb2.RangeSchedule) -> int:
    """Of a manifest: its tiles, and one more for forward photons."""
    return TileGrid.of(schedule).count + bool(schedule.photon_range_ends)


def manifest_of(schedule: job_pb2.RangeSchedule, samples: Iterable[tuple[int, int]]) -> list[int]:
    """A manifest, from what is known of some entries. Samples of a tile to which forward photons bring all
    light are those of the image, and none of its own."""
    found = [0] * entries_of(schedule)
    photons = TileGrid.of(schedule).count
    for index, count in samples:
        if schedule.range_ends or index == photons:
            found[index] = count
    return found


def ranges_planned(schedule: job_pb2.RangeSchedule) -> int:
    """Of all tiles, and of forward photons."""
    return TileGrid.of(schedule).count * len(schedule.range_ends) + len(schedule.photon_range_ends)


def recut_schedule(
    schedule: job_pb2.RangeSchedule, completed: int, longest: int, *, forward_photons: bool = False
) -> job_pb2.RangeSchedule | None:
    """The same samples in ranges of at most `longest`, but for ranges that begin before sample `completed`:
    some tile has those, and all tiles are to be cut alike. `forward_photons`: ranges of these, in bundles.

    None where there is nothing to cut, or where there would be more ranges than MAX_CUT_RANGES.
    """
    tiles = 1 if forward_photons else TileGrid.of(schedule).count
    before = schedule.photon_range_ends if forward_photons else schedule.range_ends
    most = min(MAX_CUT_RANGES, limits.MAX_RANGES // tiles)
    longest = max(longest, FIRST_RANGE)
    ends: list[int] = []
    for first, end in pairwise([0, *before]):
        if first >= completed and end - first > longest:
            if len(ends) + (end - first) // longest > most:
                return None
            ends.extend(range(first + longest, end, longest))
        ends.append(end)
    if len(ends) == len(before) or len(ends) > most:
        return None
    recut = job_pb2.RangeSchedule()
    recut.CopyFrom(schedule)
    (recut.photon_range_ends if forward_photons else recut.range_ends)[:] = ends
    return recut


def _size_problems(
    width: int, height: int, forward_photons: ForwardPhotons, further: int
) -> Iterator[Problem]:
    most, of = limits.MAX_FILM_PIXELS, ""
    if forward_photons is not ForwardPhotons.NONE:
        most, of = limits.MAX_FORWARD_PIXELS, " of a scene with photons from luminaires"
    most = most * XYZ_SUMS // sums_per_pixel(further)
    if width * height > most:
        yield Problem("$.width", f"the film{of} has {width * height} pixels; at most {most}")


def _edge_problems(place: str, edge: int) -> list[Problem]:
    if 1 <= edge <= limits.MAX_FILM_EDGE:
        return []
    return [Problem(place, f"is {edge} pixels; expected 1 to {limits.MAX_FILM_EDGE}")]


def _tile_size(further: int) -> int:
    size = TILE_SIZE
    while 8 * (numbers_in(size, size, further) - products_of_tile(further) + PRODUCTS) > _MAX_PARTIAL:
        size //= 2
    return size


def _power_of_two(least: float) -> int:
    """The first one from `least` and 1 on."""
    return 1 << max(0, math.ceil(math.log2(least)))


def _range_ends(samples: int, longest: int, first: int = FIRST_RANGE) -> list[int]:
    """`first`, then doubling until a range is `longest` long, then steps of that, up to `samples`."""
    ends = []
    end = first
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
    """Ranges of a schedule, found by index or by their first sample; there may be none."""

    def __init__(self, ends: Sequence[int]) -> None:
        self.ends = list(ends)
        self._index_by_first = {first: index for index, first in enumerate([0, *self.ends[:-1]])}

    def __len__(self) -> int:
        return len(self.ends)

    def __getitem__(self, index: int) -> SampleRange:
        """Range `index`, 0 <= index < len(self)."""
        return SampleRange(index, self.end_of(index), self.ends[index])

    @property
    def end(self) -> int:
        """Of the last one."""
        return self.end_of(len(self))

    def end_of(self, ranges: int) -> int:
        """Where so many ranges end; 0: none."""
        return self.ends[ranges - 1] if ranges > 0 else 0

    def find(self, first: int, end: int) -> SampleRange | None:
        """The planned range [first, end), if there is one."""
        index = self._index_by_first.get(first)
        return self[index] if self.ends and index is not None and self.ends[index] == end else None

    def merged_at(self, samples: int) -> int:
        """How many ranges a tile has behind it after `samples` samples; ValueError if no range ends there."""
        if samples == self.end:
            return len(self)
        if samples not in self._index_by_first:
            raise ValueError(f"{samples} samples are not the end of a planned range")
        return self._index_by_first[samples]
