"""Indices of refraction by name or formula, as the tracer's tables.

Names, formulas, tables and their sources: data/indices.toml.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.spectra.published import Floats, data_file
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange

# nm of compiled tables: linear in between, the error is below 1e-7 for the strongest flint here at the F
# line.
STEP = 0.5

# What an index of a dielectric may be; the tracer divides by it.
SMALLEST = 1e-3
LARGEST = 1e3


class BadIndexError(Exception):
    """A formula has no usable index somewhere in the range; the message says where."""


@dataclass(frozen=True)
class Index:
    """n + i k over wavelength in nm; k is zero for a dielectric."""

    n: Callable[[Floats], Floats]
    k: Callable[[Floats], Floats]
    source: str
    # nm within which the source vouches for it. Beyond, a table is held. A formula is continued, but not to
    # less than 360 nm, below which it is held.
    valid: tuple[float, float]


def dielectrics() -> tuple[str, ...]:
    """Names for `dielectric`, in the order of the data file."""
    return tuple(data_file("indices.toml")["dielectrics"])


def metals() -> tuple[str, ...]:
    """Names for `metal`, in the order of the data file."""
    return tuple(data_file("indices.toml")["metals"])


def dielectric(name: str) -> Index:
    """Return the index of one of `dielectrics`; KeyError else."""
    entry = data_file("indices.toml")["dielectrics"][name]
    formula = entry["sellmeier"]
    first, last = entry["range_nm"]
    n = sellmeier(formula["b"], formula["c_um2"])
    # In the ultraviolet lie the formula's poles, where it is no index.
    lowest = min(first, VISIBLE.first)
    return Index(lambda at: n(np.maximum(at, lowest)), _zero, entry["source"], (first, last))


def metal(name: str) -> Index:
    """Return n and k of one of `metals`, linear between the measured ones; KeyError else."""
    entry = data_file("indices.toml")["metals"][name]
    rows = np.array(entry["table"], dtype=np.float64)
    n, k = (_table(rows[:, 0], rows[:, column]) for column in (1, 2))
    return Index(n, k, entry["source"], (float(rows[0, 0]), float(rows[-1, 0])))


def sellmeier(b: Sequence[float], c_um2: Sequence[float]) -> Callable[[Floats], Floats]:
    """n of n^2 = 1 + sum of b l^2 / (l^2 - c), l in micrometres; called with nm. NaN where n^2 < 0."""

    def n(wavelengths: Floats) -> Floats:
        squares = (np.asarray(wavelengths, dtype=np.float64)[..., None] * 1e-3) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(
                np.sqrt(1 + np.sum(np.array(b) * squares / (squares - np.array(c_um2)), axis=-1))
            )

    return n


def cauchy(coefficients: Sequence[float]) -> Callable[[Floats], Floats]:
    """n = A + B / l^2 + C / l^4 + ..., l in micrometres; called with nm."""

    def n(wavelengths: Floats) -> Floats:
        inverse = (np.asarray(wavelengths, dtype=np.float64) * 1e-3) ** -2
        return np.asarray(np.polynomial.polynomial.polyval(inverse, np.array(coefficients, dtype=np.float64)))

    return n


def compile_curve(curve: Callable[[Floats], Floats], within: WavelengthRange = VISIBLE) -> scene_pb2.Spectrum:
    """Tabulate n or k over a range, each STEP nm."""
    values = curve(_wavelengths(within))
    if np.all(values == values[0]):
        return scene_pb2.Spectrum(values=[values[0]])
    return scene_pb2.Spectrum(first_nm=within.first, step_nm=STEP, values=values.astype(np.float32).tolist())


def compile_dielectric(
    n: Callable[[Floats], Floats], within: WavelengthRange = VISIBLE
) -> scene_pb2.Spectrum:
    """Tabulate the index of a dielectric; raises BadIndexError unless it stays in [SMALLEST, LARGEST]."""
    wavelengths = _wavelengths(within)
    values = n(wavelengths)
    bad = ~((values >= SMALLEST) & (values <= LARGEST))
    if np.any(bad):
        where = int(np.argmax(bad))
        raise BadIndexError(
            f"the index of refraction is {values[where]:g} at {wavelengths[where]:g} nm; "
            f"expected {SMALLEST:g} to {LARGEST:g} from {within}"
        )
    return compile_curve(n, within)


def compile_metal(
    name: str, within: WavelengthRange = VISIBLE
) -> tuple[scene_pb2.Spectrum, scene_pb2.Spectrum]:
    """Tabulate n and k of one of `metals`."""
    found = metal(name)
    return compile_curve(found.n, within), compile_curve(found.k, within)


def _wavelengths(within: WavelengthRange) -> Floats:
    count = round((within.last - within.first) / STEP) + 1
    return np.asarray(within.first + STEP * np.arange(count), dtype=np.float64)


def _zero(wavelengths: Floats) -> Floats:
    return np.zeros_like(wavelengths, dtype=np.float64)


def _table(at: Floats, values: Floats) -> Callable[[Floats], Floats]:
    return lambda wavelengths: np.interp(wavelengths, at, values)
