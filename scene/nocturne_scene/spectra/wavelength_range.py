"""The wavelengths of a scene: from whole nm to whole nm, in steps of 1 nm."""

from dataclasses import dataclass

import numpy as np

from nocturne_scene.spectra.constants import FIRST, LAST, STEP, Floats

# nm. What a scene may ask for: UV-C to where silicon, glass and published spectra of the Sun still matter.
SHORTEST = 200.0
LONGEST = 2500.0


@dataclass(frozen=True)
class WavelengthRange:
    """Both ends in whole nm."""

    first: float = FIRST
    last: float = LAST

    def grid(self) -> Floats:
        """From first to last each STEP, nm."""
        return np.arange(self.first, self.last + STEP / 2, STEP)

    @property
    def with_visible(self) -> "WavelengthRange":
        """The same and what the CIE's observers see, by which spectra are scaled to a luminance."""
        return WavelengthRange(min(self.first, FIRST), max(self.last, LAST))

    @property
    def has_all_visible(self) -> bool:
        """Whether X, Y and Z are whole."""
        return self.with_visible == self

    @property
    def is_usual(self) -> bool:
        """Whether it is the range of a scene that says nothing."""
        return self == VISIBLE

    def __str__(self) -> str:
        return f"{self.first:g} to {self.last:g} nm"


VISIBLE = WavelengthRange()
"""Of the CIE's observers, and of scenes that say nothing."""


def means(knots: Floats, values: Floats, within: WavelengthRange) -> Floats:
    """Return what a table is around each wavelength of a range's grid, zero beyond the table.

    The integral of the table times the hat of the grid there over that of the hat: grid and table have one
    integral. Between the knots of both a product is a parabola, for which Simpson's rule is exact.
    """
    grid = within.grid()
    totals = np.zeros(grid.shape)
    low, high = max(knots[0], within.first), min(knots[-1], within.last)
    if low >= high:
        return totals
    bends = np.concatenate([grid, knots])
    ends = np.unique(np.concatenate([[low], bends[(bends > low) & (bends < high)], [high]]))
    at = np.stack([ends[:-1], (ends[:-1] + ends[1:]) / 2, ends[1:]])
    parts = np.interp(at, knots, values) * np.array([[1], [4], [1]]) / 6 * np.diff(ends)
    cell = np.minimum((at[1] - within.first).astype(np.int64), len(grid) - 2)
    right = at - grid[cell]
    np.add.at(totals, cell, (parts * (1 - right)).sum(axis=0))
    np.add.at(totals, cell + 1, (parts * right).sum(axis=0))
    totals[[0, -1]] *= 2  # half of a hat
    return totals
