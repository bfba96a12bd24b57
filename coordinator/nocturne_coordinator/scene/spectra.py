"""Spectra of a scene document as the tracer's tables. The only user of colour-science.

The tracer samples wavelengths from FIRST to LAST only, so tables are cut to that range.
"""

import math
import warnings
from dataclasses import dataclass, replace
from functools import lru_cache
from types import ModuleType
from typing import Literal

import numpy as np
from nocturne.v1 import scene_pb2
from numpy.typing import NDArray

from nocturne_coordinator.scene.spectrum_model import (
    BlackbodySpectrum,
    ConstantSpectrum,
    IlluminantSpectrum,
    Spectrum,
    TableSpectrum,
)

# nm. The range of the CIE 1931 2-degree observer (CIE 018:2019, table 6), and its step.
FIRST = 360.0
LAST = 830.0
RESPONSE_STEP = 1.0

# lm/W. CIE 018:2019: the luminous efficacy that makes Y the luminance in cd/m2.
MAXIMUM_LUMINOUS_EFFICACY = 683.0

# SI 2019, exact: J s, m/s, J/K.
PLANCK = 6.62607015e-34
LIGHT_SPEED = 299_792_458.0
BOLTZMANN = 1.380649e-23

# nm. Coarsest first; FALLBACK_STEP is used when none fits.
STEPS = (100.0, 50.0, 20.0, 10.0, 5.0, 4.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)
FALLBACK_STEP = 0.1
_ON_GRID = 1e-6  # steps; knots are decimal fractions, grids are binary ones


Outside = Literal["hold", "zero"]


class NotCompilableError(Exception):
    """The spectrum has no usable size; the message says why."""


@lru_cache(maxsize=1)
def _colour() -> ModuleType:
    """Import colour-science late, as that takes a second; nobody here needs its remark about Matplotlib."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message='"Matplotlib" related API features are not available')
        import colour
    return colour


@lru_cache(maxsize=1)
def response() -> NDArray[np.float64]:
    """Return the response curves X, Y, Z, shape (471, 3), each 1 nm from FIRST.

    They are K_m times the colour matching functions of the CIE 1931 2-degree observer.

    Summed over wavelengths against spectral radiance in W m-2 sr-1 nm-1 they give XYZ with Y in cd/m2.
    """
    observer = _colour().MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    visible = (observer.wavelengths >= FIRST) & (observer.wavelengths <= LAST)
    return MAXIMUM_LUMINOUS_EFFICACY * np.asarray(observer.values[visible], dtype=np.float64)


def _response_wavelengths() -> NDArray[np.float64]:
    return np.asarray(FIRST + RESPONSE_STEP * np.arange(len(response())), dtype=np.float64)


def planck(temperature: float, wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the spectral radiance of a black body in vacuum, W m-2 sr-1 nm-1, at wavelengths in nm.

    Temperature in K.
    """
    metres = wavelengths * 1e-9
    exponent = PLANCK * LIGHT_SPEED / (metres * BOLTZMANN * temperature)
    # exp(-x) / (1 - exp(-x)) instead of 1 / (exp(x) - 1): no overflow for a cold body.
    per_metre = 2 * PLANCK * LIGHT_SPEED**2 / metres**5 * np.exp(-exponent) / -np.expm1(-exponent)
    return per_metre * 1e-9


def reflectance(spectrum: Spectrum) -> scene_pb2.Spectrum:
    """Compile a reflectance (constant or table), held beyond its table unless it says otherwise."""
    return _message(_sampled(spectrum, outside="hold"))


def radiance(spectrum: Spectrum) -> scene_pb2.Spectrum:
    """Compile a spectral radiance in W m-2 sr-1 nm-1, zero beyond its table unless it says otherwise.

    Raises NotCompilableError if the spectrum should be scaled to a luminance and has none, or does not fit
    into float32.
    """
    sampled = _sampled(spectrum, outside="zero")
    if spectrum.luminance is not None:
        sampled = sampled.scaled(_factor(spectrum.luminance, luminance(_message(sampled))))
    message = _message(sampled)
    if not np.all(np.isfinite(message.values)):
        raise NotCompilableError("the radiance is too large for a 32-bit number")
    return message


def luminance(message: scene_pb2.Spectrum) -> float:
    """Return the luminance of a compiled spectral radiance, cd/m2: its sum against the response for Y."""
    wavelengths = _response_wavelengths()
    return float(evaluate(message, wavelengths) @ response()[:, 1]) * RESPONSE_STEP


def evaluate(message: scene_pb2.Spectrum, wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a compiled spectrum's values at wavelengths in nm, as the tracer sees them."""
    values = np.asarray(message.values, dtype=np.float64)
    if len(values) == 1:
        return np.full(wavelengths.shape, values[0])
    knots = message.first_nm + message.step_nm * np.arange(len(values))
    end = 0.0 if message.zero_outside else None
    return np.interp(wavelengths, knots, values, left=end, right=end)


def is_black(message: scene_pb2.Spectrum) -> bool:
    """Whether the spectrum is zero everywhere."""
    return not any(message.values)


def _factor(wanted: float, found: float) -> float:
    if not found > 0:
        raise NotCompilableError("the spectrum has no visible light, so it can't be scaled to a luminance")
    return wanted / found


@dataclass(frozen=True)
class _Sampled:
    """Values at first, first + step, ..., nm; a single value holds everywhere."""

    first: float
    step: float
    values: NDArray[np.float64]
    zero_outside: bool

    def scaled(self, factor: float) -> "_Sampled":
        return replace(self, values=self.values * factor)


def _constant(value: float) -> _Sampled:
    return _Sampled(0.0, 0.0, np.array([value]), zero_outside=False)


def _message(sampled: _Sampled) -> scene_pb2.Spectrum:
    with np.errstate(over="ignore"):  # the caller looks for infinities
        values = sampled.values.astype(np.float32)
    return scene_pb2.Spectrum(
        first_nm=sampled.first,
        step_nm=sampled.step,
        values=values.tolist(),
        zero_outside=sampled.zero_outside,
    )


def _sampled(spectrum: Spectrum, outside: Outside) -> _Sampled:
    match spectrum:
        case ConstantSpectrum():
            return _constant(spectrum.constant)
        case TableSpectrum():
            knots = np.array(spectrum.table, dtype=np.float64)
            return _from_table(knots[:, 0], knots[:, 1], spectrum.outside or outside)
        case BlackbodySpectrum():
            wavelengths = _response_wavelengths()
            return _Sampled(FIRST, RESPONSE_STEP, planck(spectrum.blackbody, wavelengths), zero_outside=True)
        case IlluminantSpectrum():
            return _illuminant(spectrum.illuminant)


def _illuminant(name: str) -> _Sampled:
    """The relative spectrum as CIE 015:2018 tabulates it, each 5 nm and linear in between.

    D and A end at 780 nm.
    """
    if name == "E":
        return _constant(1.0)
    found = _colour().SDS_ILLUMINANTS[name]
    return _from_table(np.asarray(found.wavelengths), np.asarray(found.values), "zero")


def _from_table(wavelengths: NDArray[np.float64], values: NDArray[np.float64], outside: Outside) -> _Sampled:
    """Put a table on a uniform grid, without what lies outside of FIRST to LAST."""
    if wavelengths[-1] <= FIRST or wavelengths[0] >= LAST or len(wavelengths) == 1:
        return _unseen(wavelengths, values, outside)
    if outside == "hold" and np.all(values == values[0]):
        return _constant(float(values[0]))
    step = next((step for step in STEPS if _fits(wavelengths, step)), None)
    if step is None:
        step, first = FALLBACK_STEP, max(wavelengths[0], FIRST)
    else:
        first = wavelengths[0] + step * max(0, math.floor((FIRST - wavelengths[0]) / step))
    count = math.ceil((min(wavelengths[-1], LAST) - first) / step - _ON_GRID) + 1
    grid = first + step * np.arange(count)
    sampled = np.interp(grid, wavelengths, values)
    return _Sampled(float(first), step, sampled, zero_outside=outside == "zero")


def _unseen(wavelengths: NDArray[np.float64], values: NDArray[np.float64], outside: Outside) -> _Sampled:
    """A table that has no visible extent: only what it says about the outside counts."""
    if outside == "zero":
        return _constant(0.0)
    return _constant(float(values[-1] if wavelengths[-1] <= FIRST else values[0]))


def _fits(wavelengths: NDArray[np.float64], step: float) -> bool:
    """Whether every knot lies on the grid of `step` that starts at the first one."""
    steps = (wavelengths - wavelengths[0]) / step
    return bool(np.all(np.abs(steps - np.round(steps)) < _ON_GRID))
