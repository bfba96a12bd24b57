"""Values of an image on the grid of the standard, their mean and their least value."""

import math
from dataclasses import dataclass

import numpy as np
from nocturne_scene.document.instruments import MeterGrid
from nocturne_scene.photometry.arriving_light import ColourValue, colour_of, has_colour
from nocturne_scene.photometry.measuring import DaylightFactor, Measured, Measuring, daylight_factor
from nocturne_scene.photometry.noisy_grids import Least, calmed, least, least_is_at_least
from nocturne_scene.photometry.outlines import Outline
from nocturne_scene.photometry.places import Part, Places
from nocturne_scene.photometry.requirements import Certainty
from nocturne_scene.quantities import Quantity
from nocturne_scene.uncertainty import ImageMoments
from numpy.typing import NDArray

Values = NDArray[np.float64]
_Y = 1


@dataclass(frozen=True)
class GridValues:
    """Of one instrument, or of a film."""

    part: Part
    values: Values
    """By row and column of the grid, from above; points are one row. lx."""
    errors: Values
    """Standard errors."""
    unseen: int
    """Pixels in which no sample found light."""
    measured: Measured
    colour: tuple[ColourValue, ...]
    daylight: DaylightFactor | None
    outdoor: Measured | None

    @property
    def is_grid(self) -> bool:
        """Whether it has a plan."""
        return not self.part.places and self.values.size > 1

    @property
    def least(self) -> Least | None:
        """Of the true values, lx; None where errors are not known or a meter has seen nothing yet."""
        return _not_below_dark(least(self.values, self.errors)) if self._has_errors else None

    @property
    def u0(self) -> Least | None:
        """The least over the mean, with the mean's error in the interval."""
        found, mean = self.least, self.measured.mean
        if found is None or mean <= 0.0:
            return None
        below = least(self.values / mean, self._relative_errors(found.value / mean))
        return _not_below_dark(Least(found.value / mean, below.low, below.high))

    @property
    def calmed(self) -> Values:
        """For lines."""
        return calmed(self.values, self.errors) if self._has_errors and self.is_grid else self.values

    def u0_is_at_least(self, limit: float) -> Certainty:
        """Whether the least value is at least this part of the mean."""
        mean = self.measured.mean
        if not self._has_errors or mean <= 0.0:
            return Certainty(0.0, 0.0)
        return Certainty(*least_is_at_least(self.values / mean, self._relative_errors(limit), limit))

    @property
    def _has_errors(self) -> bool:
        return self.unseen == 0 and bool(np.isfinite(self.errors).all())

    def _relative_errors(self, ratio: float) -> Values:
        """Of values over the mean, near a ratio, to first order; a value's part in the mean goes with it."""
        mean, error = self.measured.mean, self.measured.mean_error
        own = self.errors**2
        square = own + (ratio * error) ** 2 - 2.0 * ratio * own / self.values.size
        return np.asarray(np.sqrt(np.maximum(square, 0.0)) / mean)


def _not_below_dark(found: Least) -> Least:
    return Least(max(found.value, 0.0), max(found.low, 0.0), found.high)


def grids_of(
    moments: ImageMoments, places: Places, names: tuple[str, ...], quantity: Quantity
) -> list[GridValues]:
    """Of all instruments of an image but the one outdoors."""
    outdoor = None
    for part in places.parts:
        if part.name == places.outdoor and places.outdoor:
            outdoor = _measured(moments, part.outline)
    found = []
    for part in places.parts:
        if part.name == places.outdoor and places.outdoor:
            continue
        whole = _measured(moments, part.outline)
        if whole is None:
            continue
        shown = part if places.is_of_meters else _on_standard_grid(part)
        values, errors = _cells(moments, part, shown)
        colour = tuple(colour_of(whole.reading, names, quantity)) if has_colour(names) else ()
        daylight = None if outdoor is None else daylight_factor(whole, outdoor)
        found.append(GridValues(shown, values, errors, whole.zero_pixels, whole, colour, daylight, outdoor))
    return found


def _measured(moments: ImageMoments, outline: Outline) -> Measured | None:
    adding = Measuring(outline, moments.mean.shape[-1], _Y)
    adding.add(moments, 0, 0)
    return adding.measured()


def _on_standard_grid(film: Part) -> Part:
    """A film's area in the cells of EN 12464-1, none smaller than a pixel."""
    across, down = np.array(film.across), np.array(film.down)
    width, height = film.columns * np.linalg.norm(across), film.rows * np.linalg.norm(down)
    columns, rows = MeterGrid(
        corner=(0.0, 0.0, 0.0), right=(float(width), 0.0, 0.0), up=(0.0, float(height), 0.0)
    ).cells()
    columns, rows = min(columns, film.columns), min(rows, film.rows)
    wide, high = across * film.columns / columns, down * film.rows / rows
    first = np.array(film.first) - 0.5 * (across + down) + 0.5 * (wide + high)
    a, b, c = (tuple(float(each) for each in vector) for vector in (first, wide, high))
    return Part("film", film.measures, 0, 0, columns, rows, a, b, c)  # type: ignore[arg-type]


def _cells(moments: ImageMoments, part: Part, shown: Part) -> tuple[Values, Values]:
    """A cell is a pixel, or the mean of those whose edges are nearest to its own."""
    if (part.columns, part.rows) == (shown.columns, shown.rows):
        rows = slice(part.top, part.top + part.rows)
        columns = slice(part.left, part.left + part.columns)
        variance = moments.variance[rows, columns, _Y] + moments.one_more[rows, columns, _Y]
        known = moments.samples[rows, columns] > 1
        return moments.mean[rows, columns, _Y], np.where(known, np.sqrt(variance), np.nan)
    values, errors = np.zeros((2, shown.rows, shown.columns))
    downs = np.rint(np.linspace(0, part.rows, shown.rows + 1))
    acrosses = np.rint(np.linspace(0, part.columns, shown.columns + 1))
    for row in range(shown.rows):
        for column in range(shown.columns):
            corners = (
                (float(acrosses[column]), float(downs[row])),
                (float(acrosses[column + 1]), float(downs[row + 1])),
            )
            cell = _measured(moments, Outline("rectangle", corners))
            values[row, column] = math.nan if cell is None else cell.mean
            errors[row, column] = math.nan if cell is None else cell.mean_error
    return values, errors
