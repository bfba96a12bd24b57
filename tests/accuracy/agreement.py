"""Do two images with standard errors agree? Statistics of Y.

z is a difference over its standard error, normal where each pixel sums enough samples. With m values looked
at, the Sidak bound is the |z| that the largest of them stays below with probability 1 - ALPHA. Seeds are
fixed, so a test passes always or never; ALPHA is how often other random numbers fail it by bad luck.
"""

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
import numpy.typing as npt
from scipy import special

from tests.system.images import Image

ALPHA = 0.01

ROUNDING = 1e-5
"""Relative deviation of a reading that is allowed beyond chance: single precision along a path of many
vertices, and rounded tables of the observer.
"""

_TILE = 8

Values = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Agreement:
    """z of two images."""

    pixels: Values
    """Shape (height, width)."""
    tiles: Values
    """z of sums over 8 x 8 pixels, which show deviations too faint for single pixels."""
    mean: float
    """Of the image's mean: sees a bias everywhere."""

    def check(self) -> None:
        """Fails unless all pixels, all tiles and the mean agree; false alarms: 0.01 + 0.01 + 0.003."""
        self.check_mean_and_tiles()
        assert np.abs(self.pixels).max() < sidak_bound(self.pixels.size), self

    def check_mean_and_tiles(self) -> None:
        """Also where single pixels have too few samples to be normal; false alarms: 0.01 + 0.003."""
        assert abs(self.mean) < 3.0, self
        assert np.abs(self.tiles).max() < sidak_bound(self.tiles.size), self

    def __str__(self) -> str:
        pixels, tiles = np.abs(self.pixels).max(), np.abs(self.tiles).max()
        bounds = sidak_bound(self.pixels.size), sidak_bound(self.tiles.size)
        return (
            f"z of mean {self.mean:.2f}; largest |z| of pixels {pixels:.2f} (bound {bounds[0]:.2f}), "
            f"of tiles {tiles:.2f} (bound {bounds[1]:.2f})"
        )


def sidak_bound(count: int) -> float:
    """The |z| that the largest of `count` independent values exceeds with probability ALPHA."""
    return -NormalDist().inv_cdf((1.0 - (1.0 - ALPHA) ** (1.0 / count)) / 2.0)


def student_bound(count: int, degrees: int) -> float:
    """The same of Student's t: where each standard error comes from only `degrees` + 1 values."""
    tail = (1.0 - (1.0 - ALPHA) ** (1.0 / count)) / 2.0
    return -float(special.stdtrit(degrees, tail))


def compare(one: Image, other: Image) -> Agreement:
    """Independent estimates of the same image, edges multiples of 8."""
    difference = one.y - other.y
    variance = one.y_error.astype(np.float64) ** 2 + other.y_error.astype(np.float64) ** 2
    mean = _z(difference.sum(keepdims=True), variance.sum(keepdims=True))
    return Agreement(
        _z(difference, variance), _z(_tile_sums(difference), _tile_sums(variance)), float(mean.item())
    )


def _z(difference: Values, variance: Values) -> Values:
    """Where there is no variance (both black, or no noise) the two must be equal: 0, else infinity."""
    z = np.where(difference == 0.0, 0.0, np.inf)
    return np.divide(difference, np.sqrt(variance), out=z, where=variance > 0.0)


def _tile_sums(values: Values) -> Values:
    height, width = values.shape
    tiles: Values = values.reshape(height // _TILE, _TILE, width // _TILE, _TILE).sum(axis=(1, 3))
    return tiles
