"""Parts of a film that are measured: rectangles, polygons and lines, and which pixels they have.

Coordinates are pixels from the film's upper left corner, x to the right and y down: the pixel in column i and
row j covers [i, i + 1) times [j, j + 1). Rectangles and polygons have the pixels whose centres they hold; a
line has the pixels that it crosses.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.errors import InputError

Kind = Literal["rectangle", "polygon", "line"]
Point = tuple[float, float]

MAX_CORNERS = 256


@dataclass(frozen=True, slots=True)
class Outline:
    """A part of a film."""

    kind: Kind
    points: tuple[Point, ...]
    """Of a rectangle two opposite corners, of a polygon all corners in order, of a line the middles of its
    first and last pixel, less half a pixel: (0, 0) is the first pixel of the film."""

    def check(self, width: int, height: int, place: str = "$") -> None:
        """Raises InputError unless it lies in the film and has pixels."""
        kinds = get_args(Kind)
        if self.kind not in kinds:
            raise InputError.at(f"{place}.kind", f"{self.kind!r} is no outline; expected {', '.join(kinds)}")
        few, many = (3, MAX_CORNERS) if self.kind == "polygon" else (2, 2)
        if not few <= len(self.points) <= many:
            expected = f"{few} to {many}" if few < many else f"{few}"
            raise InputError.at(f"{place}.points", f"{len(self.points)} points; a {self.kind} has {expected}")
        last = (width - 1, height - 1) if self.kind == "line" else (width, height)
        for x, y in self.points:
            # Not finite is outside, too.
            if not (0 <= x <= last[0] and 0 <= y <= last[1]):
                raise InputError.at(
                    f"{place}.points", f"({x:g}, {y:g}) is outside of the film of {width} x {height}"
                )
        left, top, right, bottom = self.bounds()
        if not self.mask(left, top, right - left, bottom - top).any():
            raise InputError.at(f"{place}.points", f"no pixel has its centre in this {self.kind}")

    def bounds(self) -> tuple[int, int, int, int]:
        """Left, top, right and bottom of the pixels that it can have; the last two are not among them."""
        x, y = zip(*self.points, strict=True)
        if self.kind == "line":
            return math.floor(min(x)), math.floor(min(y)), math.floor(max(x)) + 1, math.floor(max(y)) + 1
        return math.floor(min(x)), math.floor(min(y)), math.ceil(max(x)), math.ceil(max(y))

    def mask(self, left: int, top: int, width: int, height: int) -> NDArray[np.bool_]:
        """Which pixels of a part of the film belong to it, shape (height, width)."""
        if self.kind == "line":
            found = np.zeros((height, width), dtype=np.bool_)
            x, y = (each - corner for each, corner in zip(self.pixels(), (left, top), strict=True))
            inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
            found[y[inside], x[inside]] = True
            return found
        return _inside(self._corners(), left, top, width, height)

    def pixels(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Columns and rows of a line's pixels in order, one for each step along its longer axis."""
        (x0, y0), (x1, y1) = self.points
        steps = max(1, math.ceil(max(abs(x1 - x0), abs(y1 - y0))))
        along = np.arange(steps + 1) / steps
        columns, rows = (np.floor(a + along * (b - a) + 0.5) for a, b in ((x0, x1), (y0, y1)))
        # A half-pixel beyond the last one belongs to that.
        return (
            np.clip(columns, 0, math.floor(max(x0, x1))).astype(np.int64),
            np.clip(rows, 0, math.floor(max(y0, y1))).astype(np.int64),
        )

    def _corners(self) -> Sequence[Point]:
        if self.kind == "polygon":
            return self.points
        (x0, y0), (x1, y1) = self.points
        return (x0, y0), (x1, y0), (x1, y1), (x0, y1)


def _inside(corners: Sequence[Point], left: int, top: int, width: int, height: int) -> NDArray[np.bool_]:
    """By the even-odd rule: how many edges a ray from a pixel's centre to the right meets."""
    found = np.zeros((height, width), dtype=np.bool_)
    x = left + 0.5 + np.arange(width)
    y = top + 0.5 + np.arange(height)
    for (x0, y0), (x1, y1) in zip(corners, [*corners[1:], corners[0]], strict=True):
        if y0 == y1:
            continue
        rows = (y > min(y0, y1)) & (y <= max(y0, y1))
        crossing = x0 + (y[rows] - y0) * ((x1 - x0) / (y1 - y0))
        found[rows] ^= x[None, :] < crossing[:, None]
    return found
