"""Spectra of a scene document as the tracer's tables. One file, though long: each kind of spectrum
becomes one message, and all that is done with these.

The tracer samples wavelengths of the scene's range only, so tables are cut to it and the visible, by which
they are scaled to a luminance, and lines outside are left out. `within` is that range.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_scene.document.spectra import (
    BlackbodySpectrum,
    ChartSpectrum,
    ConstantSpectrum,
    IlluminantSpectrum,
    LineSpectrum,
    RgbSpectrum,
    SolarSpectrum,
    Spectrum,
    TableSpectrum,
)
from nocturne_scene.spectra import lines as line_spectra
from nocturne_scene.spectra import published, solar
from nocturne_scene.spectra import rgb as rgb_spectra
from nocturne_scene.spectra.published import STEP, visible_wavelengths
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange, means

# The observer of photometry: whose Y is luminance.
STANDARD_OBSERVER = "CIE 1931 2 degree"

# nm. Coarsest first; FALLBACK_STEP is used when none fits.
STEPS = (100.0, 50.0, 20.0, 10.0, 5.0, 4.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
FALLBACK_STEP = 0.1
_ON_GRID = 1e-6  # steps; knots are decimal fractions, grids are binary ones


Outside = Literal["hold", "zero"]


class NotCompilableError(Exception):
    """The spectrum has no usable size; the message says why."""


def response(observer: str = STANDARD_OBSERVER, within: WavelengthRange = VISIBLE) -> NDArray[np.float64]:
    """Return the response curves X, Y, Z, shape (n, 3), at the range's grid.

    They are K_m times the colour matching functions of one of `published.OBSERVERS`; zero beyond 360 to 830
    nm.

    Summed over wavelengths against spectral radiance in W m-2 sr-1 nm-1 they give XYZ with Y in cd/m2.
    """
    curves = published.MAX_LUMINOUS_EFFICACY * published.observer(observer)
    if within.is_usual:
        return curves
    grid, visible = within.grid(), visible_wavelengths()
    return np.stack([np.interp(grid, visible, curve, left=0.0, right=0.0) for curve in curves.T], axis=1)


def reflectance(spectrum: Spectrum, within: WavelengthRange = VISIBLE) -> scene_pb2.Spectrum:
    """Compile a reflectance (constant or table), held beyond its table unless it says otherwise."""
    return _message(_sampled(spectrum, "hold", within), within)


def tabulated(
    knots: Sequence[tuple[float, float]], outside: Outside = "hold", within: WavelengthRange = VISIBLE
) -> scene_pb2.Spectrum:
    """Compile pairs of wavelength and value, such as an index of refraction."""
    values = np.array(knots, dtype=np.float64)
    return _message(_from_table(values[:, 0], values[:, 1], outside, within), within)


def response_curve(spectrum: Spectrum, within: WavelengthRange = VISIBLE) -> NDArray[np.float64]:
    """Return a sensor's further response at the range's grid; zero beyond a table.

    Straight lines between these wavelengths are exact for tables with whole nm that begin and end at zero.
    A part that is narrower or steeper than the grid, such as a line, keeps its integral and its centre, and
    becomes as wide as the grid's step.
    """
    sampled = _sampled(spectrum, "zero", within)
    lines = line_spectra.projected(sampled.lines, within)
    if _on_response_grid(sampled, within):
        return _table_at(_message(replace(sampled, lines=()), within), within.grid()) + lines
    return _projected(sampled, within) + lines


def at_grid(
    values: NDArray[np.float64], within: WavelengthRange = VISIBLE, *, zero_outside: bool = True
) -> scene_pb2.Spectrum:
    """Compile values at the range's grid, zero beyond or else held."""
    return _message(_Sampled(within.first, STEP, values, zero_outside=zero_outside), within)


def radiance(spectrum: Spectrum, within: WavelengthRange = VISIBLE) -> scene_pb2.Spectrum:
    """Compile a spectral radiance in W m-2 sr-1 nm-1, zero beyond its table unless it says otherwise.

    Raises NotCompilableError if the spectrum should be scaled to a luminance and has none, or does not fit
    into float32.
    """
    sampled = _sampled(spectrum, "zero", within)
    wanted = None if isinstance(spectrum, ChartSpectrum) else spectrum.luminance
    if wanted is not None:
        sampled = sampled.scaled(_factor(wanted, luminance(_message(sampled, within))))
    message = _message(sampled, within)
    check_finite(message)
    return message


def check_finite(message: scene_pb2.Spectrum) -> None:
    """Raise NotCompilableError where a radiance does not fit into float32."""
    with np.errstate(over="ignore"):
        heights = np.array([line.power / line.width_nm for line in message.lines], dtype=np.float32)
    if not (np.all(np.isfinite(message.values)) and np.all(np.isfinite(heights))):
        raise NotCompilableError("the radiance is too large for a 32-bit number")


def luminance(message: scene_pb2.Spectrum) -> float:
    """Return the luminance of a compiled spectral radiance, cd/m2.

    The sum of its table against the response for Y, and the integrals of its lines.
    """
    return float(integral(message, response()[:, 1]))


def integral(
    message: scene_pb2.Spectrum, curves: NDArray[np.float64], within: WavelengthRange = VISIBLE
) -> NDArray[np.float64]:
    """Return the integral of a compiled spectrum times curves, given as rows at the range's grid.

    The sum of its table each nm; exact for its lines.
    """
    table = _table_at(message, within.grid())
    return np.asarray(table @ curves * STEP + line_spectra.integrals(message.lines, curves, within))


def evaluate(message: scene_pb2.Spectrum, wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a compiled spectrum's values at increasing wavelengths in nm, as the tracer sees them."""
    return _table_at(message, wavelengths) + line_spectra.values_at(message.lines, wavelengths)


def knots_of(message: scene_pb2.Spectrum) -> NDArray[np.float64]:
    """Return where a compiled spectrum's table has its values, nm."""
    return np.asarray(message.first_nm + message.step_nm * np.arange(len(message.values)), dtype=np.float64)


def _table_at(message: scene_pb2.Spectrum, wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    values = np.asarray(message.values, dtype=np.float64)
    if len(values) == 1:
        return np.full(wavelengths.shape, values[0])
    end = 0.0 if message.zero_outside else None
    return np.interp(wavelengths, knots_of(message), values, left=end, right=end)


def scaled_to_luminance(message: scene_pb2.Spectrum, wanted: float) -> scene_pb2.Spectrum:
    """Return a compiled radiance with the luminance `wanted`, cd/m2; raises NotCompilableError."""
    return scaled_evenly(message, _factor(wanted, luminance(message)))


def scaled_to_integral(
    message: scene_pb2.Spectrum, wanted: float, within: WavelengthRange = VISIBLE
) -> scene_pb2.Spectrum:
    """Return a compiled radiance with the integral `wanted` over a range; raises NotCompilableError."""
    found = float(integral(message, np.ones(len(within.grid())), within))
    if not found > 0:
        raise NotCompilableError(f"the spectrum has no light from {within}, so it can't be scaled to watts")
    return scaled_evenly(message, wanted / found)


def scaled_evenly(message: scene_pb2.Spectrum, factor: float) -> scene_pb2.Spectrum:
    """Return a compiled spectrum times a number."""
    result = scene_pb2.Spectrum()
    result.CopyFrom(message)
    with np.errstate(over="ignore"):
        # In float64: arrays of a message are in float32.
        values = np.asarray(message.values, dtype=np.float64)
        result.values[:] = (factor * values).astype(np.float32).tolist()
    for line in result.lines:
        line.power *= factor
    return result


def scaled(
    message: scene_pb2.Spectrum, factors: NDArray[np.float64], within: WavelengthRange = VISIBLE
) -> scene_pb2.Spectrum:
    """Return a compiled spectrum times factors at the range's grid; a line times that at its centre.

    Where factors differ, the table becomes one at these wavelengths, zero beyond.
    """
    if np.all(factors == factors[0]):
        return scaled_evenly(message, float(factors[0]))
    result = at_grid(factors * _table_at(message, within.grid()), within)
    result.lines.extend(message.lines)
    for line in result.lines:
        line.power *= float(np.interp(line.centre_nm, within.grid(), factors))
    return result


def is_black(message: scene_pb2.Spectrum) -> bool:
    """Whether the spectrum is zero everywhere."""
    return not any(message.values) and not any(line.power for line in message.lines)


def is_dark(message: scene_pb2.Spectrum, within: WavelengthRange) -> bool:
    """Whether the spectrum has no power within a range; one wavelength at its end is none."""
    if is_black(message):
        return True
    lit = any(line.power and line_spectra.is_within(line, within) for line in message.lines)
    # A table may shine between two whole nm.
    own = knots_of(message)
    at = np.union1d(within.grid(), own[(own >= within.first) & (own <= within.last)])
    return not lit and not np.trapezoid(_table_at(message, at), at) > 0


def _factor(wanted: float, found: float) -> float:
    if not found > 0:
        raise NotCompilableError("the spectrum has no visible light, so it can't be scaled to a luminance")
    return wanted / found


@dataclass(frozen=True)
class _Sampled:
    """Values at first, first + step, ..., nm; a single value holds everywhere. And lines."""

    first: float
    step: float
    values: NDArray[np.float64]
    zero_outside: bool
    lines: tuple[scene_pb2.Line, ...] = ()

    def scaled(self, factor: float) -> "_Sampled":
        lines = [
            scene_pb2.Line(centre_nm=line.centre_nm, power=factor * line.power, width_nm=line.width_nm)
            for line in self.lines
        ]
        return replace(self, values=self.values * factor, lines=tuple(lines))


def _constant(value: float) -> _Sampled:
    return _Sampled(0.0, 0.0, np.array([value]), zero_outside=False)


def _on_response_grid(sampled: _Sampled, within: WavelengthRange) -> bool:
    """Whether straight lines between whole nm are the table itself."""
    if len(sampled.values) == 1:
        return True
    last = sampled.first + sampled.step * (len(sampled.values) - 1)
    begins = sampled.values[0] > 0 and sampled.first > within.first
    jumps = begins or (sampled.values[-1] > 0 and last < within.last)
    whole = (sampled.first - within.first) % STEP == 0 and sampled.step % STEP == 0
    return whole and not (jumps and sampled.zero_outside)


def _projected(sampled: _Sampled, within: WavelengthRange) -> NDArray[np.float64]:
    """Return what a table is around each wavelength of the range's grid, held beyond or zero."""
    knots = sampled.first + sampled.step * np.arange(len(sampled.values))
    values = sampled.values
    if not sampled.zero_outside:
        ends = [min(knots[0], within.first) - STEP], [max(knots[-1], within.last) + STEP]
        knots = np.concatenate([ends[0], knots, ends[1]])
        values = np.concatenate([values[:1], values, values[-1:]])
    return means(np.asarray(knots, dtype=np.float64), np.asarray(values, dtype=np.float64), within)


def _message(sampled: _Sampled, within: WavelengthRange) -> scene_pb2.Spectrum:
    sampled = _simplest(sampled, within)
    with np.errstate(over="ignore"):  # the caller looks for infinities
        values = sampled.values.astype(np.float32)
    return scene_pb2.Spectrum(
        first_nm=sampled.first,
        step_nm=sampled.step,
        values=values.tolist(),
        zero_outside=sampled.zero_outside,
        lines=sampled.lines,
    )


def _simplest(sampled: _Sampled, within: WavelengthRange) -> _Sampled:
    """A single value where a table has the same everywhere that the tracer looks."""
    last = sampled.first + sampled.step * (len(sampled.values) - 1)
    everywhere = not sampled.zero_outside or (sampled.first <= within.first and last >= within.last)
    if everywhere and np.all(sampled.values == sampled.values[0]):
        return replace(_constant(float(sampled.values[0])), lines=sampled.lines)
    return sampled


def _sampled(spectrum: Spectrum, outside: Outside, within: WavelengthRange) -> _Sampled:
    match spectrum:
        case ConstantSpectrum():
            return _constant(spectrum.constant)
        case TableSpectrum():
            knots = np.array(spectrum.table, dtype=np.float64)
            return _from_table(knots[:, 0], knots[:, 1], spectrum.outside or outside, within)
        case BlackbodySpectrum():
            planck = published.planck(spectrum.blackbody, within.grid())
            return _Sampled(within.first, STEP, planck, zero_outside=True)
        case IlluminantSpectrum():
            return _illuminant(spectrum.illuminant, within)
        case SolarSpectrum():
            values = spectrum.factor * means(*solar.table(spectrum.solar), within)
            return _Sampled(within.first, STEP, values, zero_outside=True)
        case LineSpectrum():
            return _lines(spectrum, within)
        case RgbSpectrum():
            return _rgb(spectrum, outside, within)
        case ChartSpectrum():
            return _from_table(*published.chart_patch(spectrum.chart_patch), "hold", within)


def _illuminant(name: str, within: WavelengthRange) -> _Sampled:
    """The relative spectrum as it is published, linear in between."""
    if name == "E":
        return _constant(1.0)
    return _from_table(*published.illuminant(name, within.first, within.last), "zero", within)


def line_messages(spectrum: LineSpectrum) -> list[scene_pb2.Line]:
    """Return the lines as they are written."""
    return [
        scene_pb2.Line(centre_nm=line.nm, power=line.power, width_nm=line.width) for line in spectrum.lines
    ]


def _lines(spectrum: LineSpectrum, within: WavelengthRange) -> _Sampled:
    lit = (line for line in line_messages(spectrum) if line.power > 0)
    seen = tuple(line for line in lit if line_spectra.is_within(line, within))
    return replace(_constant(0.0), lines=seen)


def _rgb(spectrum: RgbSpectrum, outside: Outside, within: WavelengthRange) -> _Sampled:
    """The smooth spectrum of a colour, held beyond 360 to 830 nm, where its formula goes to 0 or 1: in a room
    that reflects all, light never ends. As radiance times D65, which is there from 360 to 830 nm."""
    rgb = np.array(spectrum.rgb)
    if outside == "hold":
        coefficients = rgb_spectra.rgb_to_coefficients(rgb)
        at = np.clip(within.grid(), VISIBLE.first, VISIBLE.last)
        values = rgb_spectra.spectra_of(coefficients.astype(np.float64), at)
        return _Sampled(within.first, STEP, values, zero_outside=False)
    scale, coefficients = rgb_spectra.emission(rgb)
    shape = rgb_spectra.spectra_of(coefficients.astype(np.float64), visible_wavelengths())
    values = float(scale) * shape * rgb_spectra.d65_of_luminance(1.0)[1]
    return _Sampled(VISIBLE.first, STEP, values, zero_outside=True)


def _from_table(
    wavelengths: NDArray[np.float64], values: NDArray[np.float64], outside: Outside, within: WavelengthRange
) -> _Sampled:
    """Put a table on a uniform grid, cut to the range."""
    first, last = within.first, within.last
    if wavelengths[-1] <= first or wavelengths[0] >= last or len(wavelengths) == 1:
        return _unseen(wavelengths, values, outside, within)
    if outside == "hold" and np.all(values == values[0]):
        return _constant(float(values[0]))
    step = next((step for step in STEPS if _fits(wavelengths, step)), None)
    if step is None:
        step, first = FALLBACK_STEP, max(wavelengths[0], first)
    else:
        first = wavelengths[0] + step * max(0, math.floor((first - wavelengths[0]) / step))
    count = math.ceil((min(wavelengths[-1], last) - first) / step - _ON_GRID) + 1
    grid = first + step * np.arange(count)
    sampled = np.interp(grid, wavelengths, values)
    return _Sampled(float(first), step, sampled, zero_outside=outside == "zero")


def _unseen(
    wavelengths: NDArray[np.float64], values: NDArray[np.float64], outside: Outside, within: WavelengthRange
) -> _Sampled:
    """A table that has no extent in the range: only its rule for the outside counts."""
    if outside == "zero":
        return _constant(0.0)
    return _constant(float(values[-1] if wavelengths[-1] <= within.first else values[0]))


def _fits(wavelengths: NDArray[np.float64], step: float) -> bool:
    """Whether every knot lies on the grid of `step` that starts at the first one."""
    steps = (wavelengths - wavelengths[0]) / step
    return bool(np.all(np.abs(steps - np.round(steps)) < _ON_GRID))
