"""Emission lines, and where wavelengths should be drawn so that no line is missed.

A line is a triangle over wavelength, as a monochromator's slit makes it: `width_nm` wide at half its height,
twice that at its foot. The tracer evaluates it as such, so that a narrow line needs no fine table.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange

DEFAULT_WIDTH = 0.1

# nm. Wavelengths in float32 are 6e-5 nm apart, and few instruments tell narrower lines from this one.
MIN_WIDTH = 0.01
MAX_WIDTH = 100.0

# nm. Narrower lines are missed by wavelengths that are drawn from the response alone: a photon in some
# hundred finds one, and then carries all of its light.
NARROW = 5.0

# Lines that the density of wavelengths knows, the strongest: three knots each, within what a worker takes.
DENSITY_LINES = 10_000


def is_within(line: scene_pb2.Line, within: WavelengthRange = VISIBLE) -> bool:
    """Whether any of it lies in a range."""
    return line.centre_nm + line.width_nm > within.first and line.centre_nm - line.width_nm < within.last


def is_narrow(line: scene_pb2.Line) -> bool:
    """Whether wavelengths should be drawn for it."""
    return line.width_nm < NARROW


def values_at(lines: Iterable[scene_pb2.Line], wavelengths: Floats) -> Floats:
    """Return the sum of lines at increasing wavelengths in nm."""
    values = np.zeros(wavelengths.shape)
    for line in lines:
        reach = slice(*np.searchsorted(wavelengths, _ends(line)))
        distance = np.abs(wavelengths[reach] - line.centre_nm)
        values[reach] += line.power / line.width_nm * np.maximum(0.0, 1 - distance / line.width_nm)
    return values


def integrals(lines: Iterable[scene_pb2.Line], curves: Floats, within: WavelengthRange = VISIBLE) -> Floats:
    """Return the integral over wavelength of the sum of lines times each curve.

    `curves` have one row for each wavelength of the range's grid, are linear in between and zero beyond.
    Exact: between knots a product is a parabola, for which Simpson's rule is.
    """
    base = within.grid()
    total = np.zeros(curves.shape[1:])
    for line in lines:
        low = max(line.centre_nm - line.width_nm, within.first)
        high = min(line.centre_nm + line.width_nm, within.last)
        if low >= high:
            continue
        inside = base[slice(*np.searchsorted(base, (low, high)))]
        knots = np.unique(np.clip([low, *inside, line.centre_nm, high], low, high))
        at = np.stack([knots[:-1], (knots[:-1] + knots[1:]) / 2, knots[1:]])
        share = np.maximum(0.0, 1 - np.abs(at - line.centre_nm) / line.width_nm) / line.width_nm
        weights = line.power * share * np.array([[1], [4], [1]]) / 6 * np.diff(knots)
        total += np.tensordot(weights, interpolated(curves, at, within), axes=2)
    return total


def projected(lines: Iterable[scene_pb2.Line], within: WavelengthRange = VISIBLE) -> Floats:
    """Return values at a range's grid, linear in between, that keep each line's power and centre."""
    base = within.grid()
    values = np.zeros(base.shape)
    for line in lines:
        low, high = np.searchsorted(base, _ends(line))
        reach = slice(max(low - 1, 0), high + 1)
        # The curves of the grid's own hats.
        hats = np.zeros((len(base), len(base[reach])))
        hats[reach] = np.eye(len(base[reach]))
        values[reach] += integrals([line], hats, within)
    return values


def interpolated(curves: Floats, wavelengths: Floats, within: WavelengthRange = VISIBLE) -> Floats:
    """Return curves, given at a range's grid along the first axis, at wavelengths in nm within."""
    position = wavelengths - within.first
    cell = np.clip(position.astype(np.int64), 0, len(curves) - 2)
    t = (position - cell).reshape(position.shape + (1,) * (curves.ndim - 1))
    return np.asarray(curves[cell] * (1 - t) + curves[cell + 1] * t)


def wavelength_density(
    response: Floats,
    emission: Iterable[Sequence[scene_pb2.Line]],
    *,
    share: float = 0.5,
    within: WavelengthRange = VISIBLE,
) -> tuple[Floats, Floats]:
    """Return knots in nm and a density per nm, linear in between, zero outside, that finds narrow lines.

    `response` has one weight for each wavelength of the range's grid, such as the sum of the curves. A
    part 1 - `share` of the density is in proportion to the response alone, so that nothing is ever missed
    and a weight is at most 1 / (1 - share) of its value without lines. The rest goes in equal parts to the
    spectra whose lines are given and reach the sensor at all, as nobody knows yet which of them a pixel sees;
    each in proportion to response times lines, for which a line's photons then all weigh the same. Knots are
    the response's, and the feet and the centre of each line; of more than DENSITY_LINES the strongest count.
    """
    base = within.grid()
    total = np.trapezoid(response, base)
    if not total > 0:
        raise ValueError("the response is zero everywhere")
    known = _strongest([list(lines) for lines in emission], response / total, within)
    bends = [nm for lines in known for line in lines for nm in (line.centre_nm, *_ends(line))]
    knots = np.unique([*base, *(nm for nm in bends if within.first < nm < within.last)])
    sensitivity = interpolated(response / total, knots, within)
    parts = []
    for lines in known:
        part = sensitivity * values_at(lines, knots)
        reached = np.trapezoid(part, knots)
        if reached > 0:
            parts.append(part / reached)
    density = sensitivity if not parts else (1 - share) * sensitivity + share * np.mean(parts, axis=0)
    return knots, density / np.trapezoid(density, knots)


def _strongest(
    emission: list[list[scene_pb2.Line]], response: Floats, within: WavelengthRange
) -> list[list[scene_pb2.Line]]:
    """At most DENSITY_LINES, by their part of what the response makes of their spectrum."""
    if sum(len(lines) for lines in emission) <= DENSITY_LINES:
        return emission
    weighed = []
    for number, lines in enumerate(emission):
        weights = [float(integrals([line], response, within)) for line in lines]
        total = max(sum(weights), np.finfo(float).tiny)
        weighed += [(weight / total, number, line) for weight, line in zip(weights, lines, strict=True)]
    weighed.sort(key=lambda entry: -entry[0])
    kept: list[list[scene_pb2.Line]] = [[] for _ in emission]
    for _, number, line in weighed[:DENSITY_LINES]:
        kept[number].append(line)
    return kept


def _ends(line: scene_pb2.Line) -> tuple[float, float]:
    return line.centre_nm - line.width_nm, line.centre_nm + line.width_nm
