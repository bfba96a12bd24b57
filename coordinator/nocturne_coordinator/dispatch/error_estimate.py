"""The error of an image or a tile, estimated from its own sums. Pure."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nocturne_coordinator.dispatch.merge import Counts, Sums

Pixels = npt.NDArray[np.float64]


def variance_of_mean(sums: Sums, counts: Counts) -> Pixels:
    """Estimated variance of each pixel's mean Y, shape (height, width); 0 below two samples."""
    n = np.maximum(counts, 2).astype(np.float64)
    y = sums[..., 1]
    variance: Pixels = np.maximum(0.0, (sums[..., 3] - y * y / n) / (n * (n - 1.0)))
    variance[counts < 2] = 0.0
    return variance


def relative_error(sums: Sums, counts: Counts) -> float:
    """Root mean square over pixels of Y's standard error relative to Y; 0 where unknown.

    Each pixel's variance is divided by Y^2 + 0.01 M^2, M the image's mean Y: a lamp in the picture does not
    drown the error of what it lights, and black pixels do not make it infinite.
    """
    variances = _relative_variances(sums, counts)
    return 0.0 if variances is None else float(np.sqrt(np.mean(variances)))


def _relative_variances(sums: Sums, counts: Counts) -> Pixels | None:
    """What `relative_error` takes the mean of, shape (height, width); None where it is unknown."""
    y = sums[..., 1] / np.maximum(counts, 1)
    mean = float(np.mean(y))
    if mean <= 0.0 or int(counts.min()) < 2:
        return None
    variances: Pixels = variance_of_mean(sums, counts) / (y * y + 0.01 * mean * mean)
    return variances


@dataclass(frozen=True, slots=True)
class Spread:
    """An image's relative error, and how its square is spread over the pixels; all 0 where unknown."""

    relative_error: float = 0.0
    worst_share: float = 0.0
    """Part of it that the worst 1 % of the pixels have, 0 to 1; about 0.03 where noise is even."""
    effective_pixels: float = 0.0
    """How many pixels carry it: (sum v)^2 / sum v^2, as Kish's effective sample size; all, where they are
    equal. Where few do, the error is itself known badly: with 1/sqrt of them, relatively."""


def spread_of(sums: Sums, counts: Counts) -> Spread:
    """The error and how it is spread; the error is that of `relative_error`."""
    variances = _relative_variances(sums, counts)
    total = 0.0 if variances is None else float(np.sum(variances))
    if variances is None or total <= 0.0:
        return Spread()
    flat = variances.ravel()
    worst = max(1, flat.size // 100)
    return Spread(
        relative_error=float(np.sqrt(total / flat.size)),
        worst_share=float(np.sum(np.partition(flat, flat.size - worst)[flat.size - worst :])) / total,
        effective_pixels=total * total / float(np.dot(flat, flat)),
    )
