"""Spectra of a compiled scene as exporters write them: knots and values."""

from dataclasses import dataclass

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.compile.spectra import knots_of
from nocturne_scene.spectra.published import FIRST, LAST, visible_wavelengths

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Table:
    """A function of wavelength: straight lines between knots in nm, zero beyond; or one value everywhere."""

    values: Array
    wavelengths: Array | None = None

    @property
    def constant(self) -> float | None:
        """The value, if it is the same everywhere."""
        return float(self.values[0]) if self.wavelengths is None else None

    @property
    def is_black(self) -> bool:
        """Whether it is zero everywhere."""
        return not np.any(self.values)

    def at(self, wavelengths: Array) -> Array:
        """Values at wavelengths, nm."""
        if self.wavelengths is None:
            return np.full(wavelengths.shape, self.values[0])
        found: Array = np.interp(wavelengths, self.wavelengths, self.values, left=0.0, right=0.0)
        return found

    @classmethod
    def visible(cls, values: Array) -> "Table":
        """A table by whole nm; one value where all are the same."""
        if np.all(values == values[0]):
            return cls(values[:1])
        return cls(values, visible_wavelengths())


def table_of(message: scene_pb2.Spectrum) -> Table:
    """A spectrum as knots from FIRST to LAST; its lines are triangles among them."""
    values = np.array(message.values, dtype=np.float64)
    if len(values) == 1 and not message.lines:
        return Table(values)
    knots = knots_of(message)
    if len(values) == 1:
        knots, values = np.array([FIRST, LAST]), np.repeat(values, 2)
    elif not message.zero_outside:
        knots = np.concatenate([[min(FIRST, knots[0] - 1)], knots, [max(LAST, knots[-1] + 1)]])
        values = np.concatenate([values[:1], values, values[-1:]])
    if message.lines:
        bends = [line.centre_nm + side * line.width_nm for line in message.lines for side in (-1.0, 0.0, 1.0)]
        grid = np.union1d(knots, np.clip(bends, FIRST, LAST))
        values = np.interp(grid, knots, values, left=0.0, right=0.0)
        for line in message.lines:
            values += (
                line.power
                / line.width_nm
                * np.maximum(0.0, 1 - np.abs(grid - line.centre_nm) / line.width_nm)
            )
        knots = grid
    return Table(values, np.asarray(knots, dtype=np.float64))
