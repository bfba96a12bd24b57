"""What glares in an image: connected pixels, by a luminance or by the part of each that luminaires fill.

Of a pixel at a luminaire's edge, only a part is the luminaire's solid angle, and only the luminance above the
background's is its light; as a whole pixel it would make the source larger and darker. A rating goes by L_s^2
w_s, so that far luminaires of few pixels would lose units.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.photometry.directions import PixelDirections
from nocturne_scene.tile_sums import Values

Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]

_FIRST_WINDOW = 5
"""Pixels: as far as the nearest background of an edge's pixel is, and enough of them to calm its noise."""


@dataclass(frozen=True, slots=True)
class GlareSource:
    """Connected pixels that glare."""

    luminance: float
    """Mean over its solid angle, cd/m2."""
    solid_angle: float
    """sr."""
    position_index: float
    azimuth_degrees: float
    """To the right of the line of sight."""
    elevation_degrees: float
    """Above the line of sight."""
    pixels: float
    """Sum of the parts that it fills."""

    @property
    def brings(self) -> float:
        """Its summand in both ratings, L_s^2 w_s / p_s^2."""
        return self.luminance**2 * self.solid_angle / self.position_index**2


@dataclass(frozen=True, slots=True, eq=False)
class Glaring:
    """The sources of an image, pixel by pixel; arrays of shape (height, width)."""

    labels: Labels
    """Numbers of sources from 1; 0: background."""
    count: int
    part: Values
    """Of each pixel's solid angle, that of its source."""
    own: Values
    """Luminance that each pixel has from its source: all but that of the rest of an edge's pixel."""
    changed: Callable[[Values], Values]
    """From how something changes with `own`, how it changes with the pixels' luminance."""

    def summed(self, values: Values) -> Values:
        """Over the pixels of each source."""
        sums = np.bincount(self.labels.ravel(), values.ravel(), self.count + 1)[1:]
        return np.asarray(sums, dtype=np.float64)

    def spread(self, values: Values) -> Values:
        """To the pixels of each source; 0 in the background."""
        return np.concatenate([[0.0], values])[self.labels]


def brighter_than(luminance: Values, threshold: float, seen: PixelDirections, wraps: bool) -> Glaring:
    """By whole pixels at or above a luminance; `wraps`: left and right borders are neighbours."""
    labels, count = _connected((luminance >= threshold) & (seen.solid_angle > 0.0), wraps)
    within = labels > 0
    return Glaring(
        labels,
        count,
        within.astype(np.float64),
        np.where(within, luminance, 0.0),
        lambda slope: slope * within,
    )


def of_luminaires(luminance: Values, part: Values, seen: PixelDirections, wraps: bool) -> Glaring:
    """By the part of each pixel that luminaires fill, as the layer `emission` tells it. The rest of a pixel
    has the luminance of the background near it."""
    part = np.where(seen.solid_angle > 0.0, part, 0.0)
    labels, count = _connected(part > 0.0, wraps)
    near = _Background((part == 0.0) & (seen.solid_angle > 0.0), (part > 0.0) & (part < 1.0), wraps)
    rest = 1.0 - part
    own = np.where(part > 0.0, luminance - rest * near.of(luminance), 0.0)

    def changed(slope: Values) -> Values:
        slope = slope * (part > 0.0)
        return slope - near.changed(rest * slope)

    return Glaring(labels, count, part, own, changed)


class _Background:
    """Means over the background in windows around pixels, as small as have any."""

    def __init__(self, background: Mask, wanted: Mask, wraps: bool) -> None:
        self._background = background.astype(np.float64)
        self._mode = ["constant", "wrap" if wraps else "constant"]
        self._windows: list[tuple[int, Mask, Values]] = []
        """Width, the pixels that take it, and the background's part of it."""
        width, left = _FIRST_WINDOW, wanted.copy()
        while left.any() and background.any():
            filled = self._mean(self._background, width)
            # Means are made of running sums, which leave rests.
            taken = left & (filled > 0.5 / width**2)
            self._windows.append((width, taken, np.where(taken, filled, 1.0)))
            left &= ~taken
            width = 2 * width + 1

    def of(self, luminance: Values) -> Values:
        """At the pixels that are wanted; 0 elsewhere."""
        found = np.zeros(luminance.shape)
        for width, taken, filled in self._windows:
            found += np.where(taken, self._mean(luminance * self._background, width) / filled, 0.0)
        return found

    def changed(self, slope: Values) -> Values:
        """From how something changes with what `of` gives, how it changes with the luminance."""
        found = np.zeros(slope.shape)
        for width, taken, filled in self._windows:
            # A window is alike on both sides: who is in mine has me in its own.
            found += self._mean(np.where(taken, slope / filled, 0.0), width)
        return found * self._background

    def _mean(self, values: Values, width: int) -> Values:
        # Late: it takes a tenth of a second to import, and services seldom need it.
        from scipy import ndimage

        return np.asarray(ndimage.uniform_filter(values, width, mode=self._mode), dtype=np.float64)


def _connected(within: Mask, wraps: bool) -> tuple[Labels, int]:
    """Numbers of sources from 1, and how many; neighbours by edge or corner are one, across a panorama's seam
    too."""
    from scipy import ndimage

    labels, count = ndimage.label(within, structure=np.ones((3, 3)))
    labels = np.asarray(labels, dtype=np.int64)
    if wraps and count:
        names = np.arange(count + 1)
        for one, other in zip(labels[:, 0], labels[:, -1], strict=True):
            if one and other:
                names[names == names[other]] = names[one]
        kept, labels = np.unique(names[labels], return_inverse=True)
        # 0 stays 0 where anything is dark.
        labels = labels.reshape(within.shape) + (0 if kept[0] == 0 else 1)
        count = int(labels.max())
    return labels, int(count)
