"""The error of an image or a tile, estimated from its own sums. Pure."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from nocturne_scene import uncertainty
from nocturne_scene.pixel_errors import variance_of_mean

from nocturne_coordinator.dispatch.heavy_tails import unevenness
from nocturne_coordinator.dispatch.merge import Counts, Sums

_FEW = 2**14
"""Pixels that tell where the largest of many begin."""


@dataclass(frozen=True, slots=True)
class ErrorEstimate:
    """An image's mean Y and its error, and how the error is spread over the pixels; 0 where unknown."""

    relative_error: float = 0.0
    """Root mean square over pixels of Y's standard error relative to Y, sqrt(mean(var / (Y^2 + 0.01 M^2))), M
    the image's mean Y: a lamp in the picture does not drown the error of lit surfaces, and black pixels do
    not make it infinite."""
    mean: float = 0.0
    """Over pixels, of Y."""
    mean_error: float = 0.0
    """The mean's standard error; see nocturne_scene.uncertainty."""
    top_percent_share: float = 0.0
    """Part of relative_error's square that the worst 1 % of the pixels have, 0 to 1; about 0.03 where noise
    is even."""
    effective_pixels: float = 0.0
    """How many pixels carry it: (sum v)^2 / sum v^2, as Kish's effective sample size; all, where they are
    equal. Where few do, the error is itself known badly: with 1/sqrt of them, relatively."""
    unevenness: float = 0.0
    """See heavy_tails.unevenness."""
    pixels: int = 0
    zero_pixels: int = 0
    """Pixels in which no sample found light."""
    samples: int = 0
    """Of the pixel that has the fewest."""
    mean_samples: float = 0.0
    """Over pixels, harmonic: relative_error falls as one over its root. 0: unknown, or a pixel has none."""


class Squares(NamedTuple):
    """Sums for the correlation of neighbours' errors; see nocturne_scene.tile_sums."""

    of_blocks: Sums
    """Products, shape (blocks down, blocks across, 6)."""
    of_tiles: Sums
    """The same of tiles, shape (tiles down, tiles across, 6 or, with further responses, more)."""
    tile_size: int


def estimate_error(sums: Sums, counts: Counts, squares: Squares | None = None) -> ErrorEstimate:
    """From an image's or a tile's sums; no error below two samples, in the dark, or without any noise.

    Without `squares`, pixels are taken as independent of each other.
    """
    # Numbers of one kind are far apart in a film's sums: they are collected once, not for each step below.
    sums_y, squares_y = np.ascontiguousarray(sums[..., 1]), np.ascontiguousarray(sums[..., 3])
    y = sums_y / np.maximum(counts, 1)
    mean, samples = float(np.mean(y)), int(counts.min())
    unseen = int(np.count_nonzero(sums_y <= 0.0))
    known = ErrorEstimate(mean=mean, pixels=y.size, zero_pixels=unseen, samples=samples)
    if samples:
        known = replace(known, mean_samples=float(y.size / np.sum(1.0 / counts)))
    variances = variance_of_mean(sums_y, squares_y, counts)
    if mean <= 0.0 or samples < 2 or not variances.any():
        return known
    flat = (variances / (y * y + 0.01 * mean * mean)).ravel()
    total = float(np.sum(flat))
    return replace(
        known,
        relative_error=float(np.sqrt(total / flat.size)),
        mean_error=uncertainty.mean_y_error(sums_y, variances, counts, squares),
        top_percent_share=float(np.sum(_largest(flat, max(1, flat.size // 100)))) / total,
        effective_pixels=total * total / float(np.dot(flat, flat)),
        unevenness=unevenness(y, variances),
    )


def _largest(numbers: Sums, count: int) -> Sums:
    """The `count` largest ones: by far most are seen not to be among them by a look at a few."""
    if numbers.size > _FEW:
        few = numbers[:: numbers.size // _FEW]
        surely = int(few.size * (1.0 - 1.5 * count / numbers.size))
        above = numbers[numbers >= np.partition(few, surely)[surely]]
        numbers = above if above.size >= count else numbers
    return np.partition(numbers, numbers.size - count)[numbers.size - count :]
