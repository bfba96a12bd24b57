"""Extremes, mean and uniformity of one quantity over a part of an image, with standard errors, and its values
along a line and as a histogram.

The mean and its error are those of `nocturne_scene.uncertainty`. The minimum and the maximum are those of
single pixels and have their errors; a minimum over many noisy pixels is too low, and a maximum too high, by
up to some of these. Uniformity, EN 12464-1 and EN 12193: U0 = minimum / mean, Ud = minimum / maximum.
"""

import csv
import io
import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from nocturne_scene.photometry.outlines import Outline
from nocturne_scene.tile_sums import Values
from nocturne_scene.uncertainty import ImageMoments, RegionReading, RegionSums

MAX_BINS = 512


@dataclass(frozen=True, slots=True)
class PixelValue:
    """What one pixel shows."""

    x: int
    y: int
    value: float
    standard_error: float
    """NaN where it is not known."""


@dataclass(frozen=True, slots=True)
class Measured:
    """One quantity over the pixels of an outline that have samples; errors are standard errors, NaN where
    unknown."""

    pixels: int
    zero_pixels: int
    """In which no sample found light."""
    mean: float
    mean_error: float
    minimum: PixelValue
    maximum: PixelValue
    u0: float
    """Minimum over mean; NaN in the dark."""
    u0_error: float
    ud: float
    """Minimum over maximum; NaN in the dark."""
    ud_error: float
    profile: tuple[PixelValue, ...]
    """Of a line: its pixels in order."""
    reading: RegionReading
    """Of all quantities over the outline."""


@dataclass(frozen=True, slots=True)
class DaylightFactor:
    """Illuminance over that outdoors, unobstructed and horizontal, in percent (EN 17037); standard errors."""

    mean: float
    mean_error: float
    minimum: float
    minimum_error: float


def daylight_factor(found: Measured, outdoor: Measured) -> DaylightFactor:
    """Of a part of an image; `outdoor` is another of the same image.

    Samples of different meters are drawn independently, so the errors of numerator and denominator know
    nothing of each other; the part outdoors has 100 % of itself, without an error."""
    mean, mean_error = _over(found.mean, found.mean_error, outdoor)
    low = found.minimum
    minimum, minimum_error = _over(low.value, low.standard_error, outdoor)
    return DaylightFactor(100.0 * mean, 100.0 * mean_error, 100.0 * minimum, 100.0 * minimum_error)


class Measuring:
    """Adds up what an outline has of an image, some rows of tiles after the other."""

    def __init__(self, outline: Outline, values: int, index: int) -> None:
        """`values`: X, Y, Z and further responses; `index`: which of them is measured."""
        self._outline = outline
        self._index = index
        self._sums = RegionSums(values)
        self._unseen = 0
        self._extremes: dict[str, PixelValue] = {}
        self._on_line: dict[tuple[int, int], PixelValue] = {}

    def add(self, image: ImageMoments, left: int, top: int) -> None:
        """`image`: a part of the film whose upper left pixel is at (left, top)."""
        chosen = self._outline.mask(left, top, *reversed(image.samples.shape)) & (image.samples > 0)
        if not chosen.any():
            return
        self._sums.add(image, chosen)
        rows, columns = np.nonzero(chosen)
        mean, error = _values_and_errors(image, self._index)
        found = mean[rows, columns]
        self._unseen += int(np.count_nonzero(image.mean[rows, columns, 1] <= 0.0))

        def at(index: int) -> PixelValue:
            row, column = int(rows[index]), int(columns[index])
            return PixelValue(left + column, top + row, float(mean[row, column]), float(error[row, column]))

        low, high = at(int(found.argmin())), at(int(found.argmax()))
        self._extremes["low"] = min(self._extremes.get("low", low), low, key=lambda pixel: pixel.value)
        self._extremes["high"] = max(self._extremes.get("high", high), high, key=lambda pixel: pixel.value)
        if self._outline.kind == "line":
            pixels = (at(index) for index in range(len(rows)))
            self._on_line |= {(pixel.x, pixel.y): pixel for pixel in pixels}

    def measured(self) -> Measured | None:
        """None where no pixel has samples."""
        reading = self._sums.reading()
        if reading is None:
            return None
        mean, mean_error = reading.mean[self._index], reading.error[self._index]
        low, high = self._extremes["low"], self._extremes["high"]
        # The darkest pixel is one of those whose mean it is: their covariance is its variance over their
        # number.
        together = low.standard_error**2 / reading.pixels
        return Measured(
            reading.pixels,
            self._unseen,
            mean,
            mean_error,
            low,
            high,
            *ratio(low.value, low.standard_error, mean, mean_error, together),
            *ratio(low.value, low.standard_error, high.value, high.standard_error, _covariance(low, high)),
            tuple(self._in_order()),
            reading,
        )

    def _in_order(self) -> Iterable[PixelValue]:
        if self._outline.kind == "line":
            columns, rows = self._outline.pixels()
            for place in zip(columns.tolist(), rows.tolist(), strict=True):
                if place in self._on_line:
                    yield self._on_line[place]


def _values_and_errors(image: ImageMoments, index: int) -> tuple[Values, Values]:
    """Of one quantity in all pixels; below two samples an error is not known."""
    variance = image.variance[..., index] + image.one_more[..., index]
    error = np.where(image.samples > 1, np.sqrt(variance), np.nan)
    return image.mean[..., index], error


def _covariance(low: PixelValue, high: PixelValue) -> float:
    """One pixel's with itself; pixels are drawn independently."""
    return low.standard_error**2 if (low.x, low.y) == (high.x, high.y) else 0.0


def _over(value: float, error: float, outdoor: Measured) -> tuple[float, float]:
    same = (value, error) == (outdoor.mean, outdoor.mean_error)
    return ratio(value, error, outdoor.mean, outdoor.mean_error, error**2 if same else 0.0)


def ratio(
    above: float, above_error: float, below: float, below_error: float, covariance: float
) -> tuple[float, float]:
    """above / below and its standard error, to first order in the errors (JCGM 100:2008, 5.2.2); NaN for 0 /
    0."""
    if below == 0.0:
        return math.nan, math.nan
    found = above / below
    variance = above_error**2 - 2.0 * found * covariance + (found * below_error) ** 2
    return found, math.sqrt(max(0.0, variance)) / abs(below) if not math.isnan(variance) else math.nan


@dataclass(slots=True)
class Histogram:
    """How many pixels have which values: bins of equal width between `low` and `high`, of the logarithm where
    `logarithmic`."""

    low: float
    high: float
    bins: int
    logarithmic: bool
    counts: NDArray[np.int64] = field(init=False)
    outside: int = 0
    """Pixels below `low` or above `high`; with a logarithm also those that are not above 0."""

    def __post_init__(self) -> None:
        self.counts = np.zeros(self.bins, dtype=np.int64)

    def edges(self) -> Values:
        """Where bins begin and end."""
        if self.logarithmic:
            return np.geomspace(self.low, self.high, self.bins + 1)
        return np.linspace(self.low, self.high, self.bins + 1)

    def add(self, values: Values) -> None:
        """Values of pixels."""
        counts, _ = np.histogram(values, self.edges())
        self.counts += counts
        self.outside += len(values) - int(counts.sum())


def histogram_range(found: Measured, low: float, high: float, logarithmic: bool) -> tuple[float, float]:
    """The bounds asked for, or with (0, 0) those of the values; never equal, and above 0 for a logarithm."""
    if low == high == 0.0:
        low, high = found.minimum.value, found.maximum.value
        if logarithmic:
            # Six decades are what a picture of one can show.
            low = max(low, 1e-6 * high) if high > 0.0 else 1.0
    if logarithmic and low <= 0.0:
        low = max(high, 1.0) * 1e-6
    return (low, high) if high > low else (low, low + max(abs(low), 1.0))


_COLUMNS = (
    *(
        "name",
        "kind",
        "points",
        "quantity",
        "unit",
        "pixels",
        "mean",
        "mean_error",
        "minimum",
        "minimum_error",
    ),
    *("minimum_x", "minimum_y", "maximum", "maximum_error", "maximum_x", "maximum_y"),
    *("u0", "u0_error", "ud", "ud_error", "zero_pixels"),
)


def as_csv(rows: Iterable[tuple[str, Outline, Measured]], quantity: str, unit: str) -> str:
    """A table of measurements, RFC 4180; errors are standard errors, empty where they are not known."""
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(_COLUMNS)
    for name, outline, found in rows:
        points = " ".join(f"{x:g},{y:g}" for x, y in outline.points)
        low, high = found.minimum, found.maximum
        numbers = (
            *(found.pixels, found.mean, found.mean_error, low.value, low.standard_error, low.x, low.y),
            *(high.value, high.standard_error, high.x, high.y),
            *(found.u0, found.u0_error, found.ud, found.ud_error, found.zero_pixels),
        )
        # A name that begins like a formula would be one in a spreadsheet.
        safe = f"'{name}" if name[:1] in "=+-@\t\r" and name else name
        table.writerow([safe, outline.kind, points, quantity, unit, *map(_cell, numbers)])
    return text.getvalue()


def profile_as_csv(found: Measured, quantity: str, unit: str) -> str:
    """A line's pixels in order, RFC 4180."""
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(("distance_pixels", "x", "y", f"{quantity} {unit}".strip(), "standard_error"))
    if found.profile:
        first = found.profile[0]
        for pixel in found.profile:
            distance = math.hypot(pixel.x - first.x, pixel.y - first.y)
            table.writerow(map(_cell, (distance, pixel.x, pixel.y, pixel.value, pixel.standard_error)))
    return text.getvalue()


def _cell(value: float) -> str:
    if isinstance(value, int):
        return str(value)
    return "" if math.isnan(value) else f"{value:.8g}"
