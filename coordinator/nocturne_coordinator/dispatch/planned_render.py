"""A render as the coordinator schedules it, and the check that a result belongs to it. Pure."""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import takewhile

import numpy as np
from google.protobuf.message import DecodeError
from nocturne.v1 import job_pb2
from nocturne_scene.photon_sums import PackedPhotons
from nocturne_scene.ranges import PHOTON_BUNDLE, RangeList, SampleRange, TileGrid, entries_of, ratio_of
from nocturne_scene.responses import is_signed
from nocturne_scene.tile_sums import (
    BLOCK,
    PIXEL_SQUARES,
    PRODUCTS,
    XYZ_SUMS,
    TileSums,
    blocks_in,
    decode,
    factors_of_tile,
    numbers_in,
)

from nocturne_coordinator.dispatch.merge import Sums
from nocturne_coordinator.limits import MAX_RAYS_PER_PHOTON

_BEYOND_PHYSICS = 1e150
"""No sum in cd/m2 comes near; squares of smaller numbers are finite."""
_PHOTON_SLACK = 0.01
"""Squares of photons lose up to 1/256 to rounding."""


class RejectedResult(Exception):
    """A result must not touch an accumulator; says why."""


@dataclass(frozen=True)
class PlannedRender:
    """What every job of a render has in common."""

    id: str
    schedule: job_pb2.RangeSchedule
    scene: bytes
    """SHA-256 of the compiled scene, 32 bytes."""
    engine: "job_pb2.Engine.ValueType"

    @cached_property
    def grid(self) -> TileGrid:
        return TileGrid.of(self.schedule)

    @cached_property
    def ranges(self) -> RangeList:
        """Of tiles; none where forward photons bring all light."""
        return RangeList(self.schedule.range_ends)

    @cached_property
    def photon_ranges(self) -> RangeList:
        """Of forward photons."""
        return RangeList(self.schedule.photon_range_ends)

    def kept_in(self, schedule: job_pb2.RangeSchedule) -> list[int]:
        """Per queue, how many of its first ranges another schedule of the render has, too."""
        if schedule == self.schedule:
            of_photons = [len(self.photon_ranges)] * (self.queues - self.grid.count)
            return [len(self.ranges)] * self.grid.count + of_photons
        of_tiles = _same(self.schedule.range_ends, schedule.range_ends)
        photons = [_same(self.schedule.photon_range_ends, schedule.photon_range_ends)]
        return [of_tiles] * self.grid.count + photons * (self.queues - self.grid.count)

    @cached_property
    def photon_index(self) -> int:
        """Index of the queue of forward photons, after those of tiles."""
        return self.grid.count

    def ranges_of(self, index: int) -> RangeList:
        """Of a queue."""
        return self.photon_ranges if index == self.photon_index else self.ranges

    def turns_of(self, index: int) -> list[int] | None:
        """Of each range of forward photons, that of tiles whose samples begin as late: both kinds go on
        together. None: of a tile, or tiles have none."""
        if index != self.photon_index or not self.ranges:
            return None
        of_sample = self.pixels * ratio_of(self.schedule)
        firsts = [0, *self.photon_ranges.ends[:-1]]
        return [bisect_right(self.ranges.ends, first * PHOTON_BUNDLE / of_sample) for first in firsts]

    @cached_property
    def queues(self) -> int:
        """Of ranges: one for each tile, and one for forward photons."""
        return entries_of(self.schedule)

    @property
    def pixels(self) -> int:
        return self.schedule.width * self.schedule.height

    def photons_in(self, index: int, planned: SampleRange) -> int:
        """That a range of a queue takes."""
        size = PHOTON_BUNDLE
        if index < self.photon_index:
            tile = self.grid.tile(index)
            size = tile.width * tile.height
        return (planned.end - planned.first) * size * self.photons_per_sample

    @property
    def photons_per_sample(self) -> int:
        return max(1, self.schedule.photons_per_sample)

    @property
    def further(self) -> int:
        """Number of further responses."""
        return len(self.schedule.further_responses)

    @property
    def signed(self) -> list[bool]:
        """Of further responses: whether they may be negative."""
        return [is_signed(name) for name in self.schedule.further_responses]

    def job(self, index: int, planned: SampleRange) -> job_pb2.Job:
        forward = index == self.photon_index
        film = job_pb2.Tile(width=self.schedule.width, height=self.schedule.height)
        return job_pb2.Job(
            render_id=self.id,
            tile_index=index,
            tile=film if forward else self.grid.tile(index),
            photons_by_tiles_of=self.schedule.tile_size if forward else 0,
            first_sample=planned.first,
            end_sample=planned.end,
            scene=self.scene,
            film_width=self.schedule.width,
            film_height=self.schedule.height,
            engine=self.engine,
        )

    def find(self, job: job_pb2.Job) -> SampleRange:
        """The range that the job is for; RejectedResult unless it is, in every field, a job of this render.

        But for the floating-point profile, of which the first jobs of a render have none (results tell their
        own), the bound on processor time, which follows the render's measured costs, and whether it is a
        quick copy.
        """
        if job.tile_index >= self.queues:
            raise RejectedResult(f"tile {job.tile_index} of {self.queues}")
        planned = self.ranges_of(job.tile_index).find(job.first_sample, job.end_sample)
        if planned is None:
            raise RejectedResult(f"samples [{job.first_sample}, {job.end_sample}) are not a planned range")
        asked = self.job(job.tile_index, planned)
        asked.floating_point_profile = job.floating_point_profile
        asked.max_cpu_seconds = job.max_cpu_seconds
        asked.quick = job.quick
        if job != asked:
            raise RejectedResult("tile, scene, film or engine differ from the schedule")
        return planned

    def check_partial(self, partial: job_pb2.Partial, job: job_pb2.Job) -> TileSums | PackedPhotons:
        """The sums of a partial result of a job that was found; RejectedResult if they can't be."""
        if job.photons_by_tiles_of:
            return self._check_photons(partial, job)
        coefficients = self.schedule.coefficients
        return check_partial(partial, job, self.further, self.photons_per_sample, self.signed, coefficients)

    def _check_photons(self, partial: job_pb2.Partial, job: job_pb2.Job) -> PackedPhotons:
        photons = (job.end_sample - job.first_sample) * PHOTON_BUNDLE
        _check_counts(partial, photons * self.photons_per_sample)
        schedule = self.schedule
        sums = PackedPhotons(partial.sums, schedule.width, schedule.height, self.further, self.grid.count)
        try:
            check_photon_sums(sums.unpacked(), photons)
        except ValueError as error:
            raise RejectedResult(str(error)) from None
        return sums


def _same(ends: Iterable[int], others: Iterable[int]) -> int:
    """How many of the first are equal."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(ends, others, strict=False)))


def render_of(data: bytes) -> str:
    """Of what render a serialised JobResult is; empty if it is none."""
    try:
        return job_pb2.JobResult.FromString(data).job.render_id
    except DecodeError:
        return ""


def check_partial(
    partial: job_pb2.Partial,
    job: job_pb2.Job,
    further: int,
    photons_per_sample: int = 1,
    signed: Sequence[bool] = (),
    coefficients: int = 0,
) -> TileSums:
    """The sums of a partial result of a job; RejectedResult if they can't be."""
    pixels = job.tile.width * job.tile.height
    samples = job.end_sample - job.first_sample
    _check_counts(partial, pixels * samples * photons_per_sample)
    expected = 8 * (numbers_in(job.tile.width, job.tile.height, further) + coefficients * pixels)
    # Each time that it is asked for is a copy.
    encoded = partial.sums
    if len(encoded) != expected:
        raise RejectedResult(f"sums of {len(encoded)} bytes; expected {expected}")
    sums = decode(encoded, job.tile.width, job.tile.height, further)
    check_sums(sums, samples, signed)
    if sums.coefficients.size:
        _check_range(sums.coefficients)
    return sums


def check_sums(sums: TileSums, samples: int, signed: Sequence[bool] = ()) -> None:
    """RejectedResult if no samples have such sums. `signed`: which further responses may be negative."""
    height, width = sums.pixels.shape[:2]
    of_pixels = sums.pixels.reshape(height * width, -1)
    of_blocks = sums.block_products.reshape(-1, PRODUCTS)
    pixels, blocks = len(of_pixels), len(of_blocks)
    # One row for each quantity, Y, X, Z, YY, XX, ZZ, XY, XZ, YZ, with a column for each pixel, each block and
    # the tile: each step of numpy's then does for all of them, in memory that lies together.
    table = np.empty((XYZ_SUMS, pixels + blocks + 1))
    table[0, :pixels], table[1, :pixels] = of_pixels[:, 1], of_pixels[:, 0]
    table[2:, :pixels] = of_pixels[:, 2:XYZ_SUMS].T
    table[:3, pixels:] = 0.0
    table[3:, pixels:-1] = of_blocks.T
    table[3:, -1] = sums.tile_products[0, :PRODUCTS]
    further = of_pixels[:, XYZ_SUMS:]
    _check_range(table)
    if further.size:
        _check_further(further, sums.tile_products, signed)
    if count := further.shape[-1] // 2:
        _check_products(further[:, :count] ** 2, further[:, count:], samples)
    film = table[:, :pixels].reshape(-1, height, width)
    pixels_of_blocks = (_blocks_of(height) @ film @ _blocks_of(width).T).reshape(XYZ_SUMS, -1)
    table[:3, pixels:-1] = pixels_of_blocks[:3]
    firsts, squares, mixed = table[:3, :-1], table[3:6], table[6:]
    _check_products(firsts * firsts, squares[:, :-1], samples)
    # Of YY, XX, ZZ the first two and the last two go with XY and XZ, the outer two with YZ. Their squares are
    # compared, which takes no roots.
    bounds = np.empty_like(mixed)
    np.multiply(squares[:2], squares[1:], out=bounds[:2])
    np.multiply(squares[0], squares[2], out=bounds[2])
    _check_products(mixed * mixed, bounds, slack=2e-9, least=1e-300)
    # Values are never negative: products of the totals of n are at least the sum of the n products.
    together = table[3:, pixels:]
    apart = np.empty_like(together)
    apart[:, :-1] = pixels_of_blocks[3:]
    together[:, :-1].sum(axis=1, out=apart[:, -1])
    _check_products(apart, together)
    # And squares are at most n times that.
    many = np.full(blocks + 1, float(BLOCK**2))
    many[-1] = blocks
    _check_products(together[:3], apart[:3] * many)


def check_photon_sums(sums: TileSums, photons: int) -> None:
    """RejectedResult if no photons bring such sums of a film; squares are known to eight bits."""
    pixels = sums.pixels
    for numbers in (pixels, sums.block_products, sums.tile_products):
        _check_range(numbers)
    further = (pixels.shape[-1] - XYZ_SUMS) // 2
    values = [0, 1, 2, *range(XYZ_SUMS, XYZ_SUMS + further)]
    squares = [*PIXEL_SQUARES, *range(XYZ_SUMS + further, XYZ_SUMS + 2 * further)]
    for value, square in zip(values, squares, strict=True):
        one = pixels[..., value]
        _check_products(one * one, pixels[..., square], photons, slack=_PHOTON_SLACK)


@cache
def _blocks_of(edge: int) -> Sums:
    """A row for each block along an edge, with 1 for each of its pixels."""
    pixels = np.arange(edge) // BLOCK
    return np.asarray(pixels == np.arange(blocks_in(edge))[:, None], dtype=np.float64)


def _check_range(numbers: Sums) -> None:
    """Sums are 0 or more, and of this world."""
    # With a NaN inside, minimum and maximum are NaN, and compare false.
    if not (numbers.min() >= 0.0 and numbers.max() < _BEYOND_PHYSICS):
        raise RejectedResult("sums that are negative, not finite or beyond all physics")


def _check_further(further: Sums, products: Sums, signed: Sequence[bool]) -> None:
    """The same of further responses and of tiles' products, some of which may be negative."""
    if not any(signed):
        _check_range(further)
        _check_range(products)
        return
    values = np.array([False] * len("XYZ") + [*signed])
    first, second = (np.array(factors) for factors in factors_of_tile(len(signed)))
    mixed = (values[first] | values[second]) & (first != second)
    negative = np.concatenate([values[len("XYZ") :], np.zeros(len(signed), dtype=bool)])
    _check_range(np.where(negative, np.abs(further), further))
    _check_range(np.where(mixed, np.abs(products), products))


def _check_counts(partial: job_pb2.Partial, photons: int) -> None:
    if partial.photons != photons:
        raise RejectedResult(f"{partial.photons} photons; expected {photons}")
    if partial.invalid_samples > photons:
        raise RejectedResult(f"{partial.invalid_samples} invalid_samples of {photons} photons")
    if partial.truncated_paths > partial.rays:
        raise RejectedResult(f"{partial.truncated_paths} truncated_paths of {partial.rays} rays")
    if partial.rays > photons * MAX_RAYS_PER_PHOTON:
        raise RejectedResult(f"{partial.rays} rays for {photons} photons")
    if not 0.0 <= partial.cpu_seconds < np.inf:
        raise RejectedResult(f"{partial.cpu_seconds} processor seconds")


def _check_products(
    products: Sums, bound: Sums, times: int = 1, slack: float = 1e-9, least: float = 1e-150
) -> None:
    """No n numbers have a sum whose square is above n times the sum of their squares, and no pairs a sum of
    products above the root of both sums of squares (Cauchy-Schwarz). `times`: n; `slack`: a part."""
    # The slack is for rounding; `least` for squares that are too small for a float64.
    excess = bound * (times * (1 + slack))
    np.subtract(products, excess, out=excess)
    if not excess.max() <= least:
        raise RejectedResult("sums of values and of their squares or products that no samples have")
