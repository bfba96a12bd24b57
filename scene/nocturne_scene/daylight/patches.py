"""The sky in patches: Tregenza's 145, and Reinhart's finer ones; as worker/src/luminaires/sky_patches.h."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.spectra.published import Floats

_AROUND = (30, 30, 24, 24, 18, 12, 6)
_PARTS = 4
"""Points along each edge of a patch that stand for it."""


@dataclass(frozen=True)
class Patches:
    """Of a whole sphere: 0 is all below the horizon, then rows from the horizon to the zenith, each from
    north to east, the first patch around north."""

    divisions: int
    """Of each of Tregenza's patches along an edge: 145 patches for 1, 577 for 2, 2305 for 4."""

    @cached_property
    def rows(self) -> list[int]:
        """How many patches each has."""
        return [n * self.divisions for n in _AROUND for _ in range(self.divisions)] + [1]

    @cached_property
    def count(self) -> int:
        """With the one below the horizon."""
        return 1 + sum(self.rows)

    @cached_property
    def height(self) -> float:
        """Of a row, rad; the zenith's patch is half as high."""
        return 0.5 * np.pi / (len(self.rows) - 0.5)

    @cached_property
    def solid_angles(self) -> Floats:
        """Steradians; 2 pi for all below the horizon."""
        edges = np.minimum(self.height * np.arange(len(self.rows) + 1), 0.5 * np.pi)
        bands = 2 * np.pi * np.diff(np.sin(edges))
        return np.concatenate([[2 * np.pi], np.repeat(bands / self.rows, self.rows)])

    def numbers(self, towards: Floats) -> NDArray[np.intp]:
        """Of unit vectors to the east, to the north and up, shape (..., 3)."""
        first = np.cumsum([1, *self.rows[:-1]])
        around = np.array(self.rows)
        altitude = np.arcsin(np.clip(towards[..., 2], -1.0, 1.0))
        row = np.clip((altitude / self.height).astype(int), 0, len(around) - 1)
        turn = np.arctan2(towards[..., 0], towards[..., 1]) / (2 * np.pi) % 1.0
        place = (turn * around[row] + 0.5).astype(int) % around[row]
        return np.where(towards[..., 2] < 0.0, 0, first[row] + place)

    @cached_property
    def points(self) -> Floats:
        """Unit vectors of points that stand for equal parts of each patch above the horizon, shape (count -
        1, points, 3)."""
        found = []
        inside = (np.arange(_PARTS) + 0.5) / _PARTS
        for row, around in enumerate(self.rows):
            low = np.sin(row * self.height)
            high = np.sin(min((row + 1) * self.height, 0.5 * np.pi))
            up = low + inside * (high - low)
            turns = np.arange(around)[:, None, None] / around + (inside - 0.5) / around
            azimuth = 2 * np.pi * turns
            across = np.sqrt(1 - up**2)[:, None]
            vectors = np.broadcast_arrays(
                across * np.sin(azimuth), across * np.cos(azimuth), up[:, None] + 0 * azimuth
            )
            found.append(np.stack(vectors, axis=-1).reshape(around, -1, 3))
        return np.concatenate(found)
