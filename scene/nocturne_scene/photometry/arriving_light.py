"""The colour of the light that arrives at a meter or in a part of an image, with standard errors.

From the readings of `spectra.colour_basis` and their covariance; errors are to first order in the noise
(JCGM 100:2008, 5.2.2). Where the noise moves colours by as much as the light itself does, Rf and Ra are too
low by about their error, for differences of colour are never negative.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.quantities import ILLUMINANCE, INTENSITY, Quantity
from nocturne_scene.responses import COLOUR
from nocturne_scene.spectra import colour_basis, published
from nocturne_scene.spectra.colour_rendering import colour_rendering, reference_hues, weights
from nocturne_scene.spectra.published import Floats
from nocturne_scene.spectra.temperature import FARTHEST, colour_temperature_of
from nocturne_scene.tile_sums import Values
from nocturne_scene.uncertainty import RegionReading

_KIND = {ILLUMINANCE: ("irradiance", "daylight illuminance"), INTENSITY: ("intensity", "daylight intensity")}
_OTHERWISE = ("radiance", "daylight luminance")


@dataclass(frozen=True, slots=True)
class ColourValue:
    """One number that tells of a light's colour."""

    name: str
    value: float
    """NaN where the light has none: a correlated temperature too far from the locus."""
    error: float
    """Standard error; NaN where it is not known."""
    unit: str
    """In ASCII; empty: it has none."""


def has_colour(names: Sequence[str]) -> bool:
    """Whether an image's channels tell it."""
    return set(COLOUR) <= set(names)


def colour_of(reading: RegionReading, names: Sequence[str], quantity: Quantity) -> list[ColourValue]:
    """Of the light of a region; `names` are those of the reading's values. Empty in the dark.

    Raises InputError where the image has no channels for it.
    """
    if not has_colour(names):
        raise InputError.at(
            "$.colour", "the image has no channels for it; render with `colour` of the sensor true"
        )
    places = [list(names).index(name) for name in COLOUR]
    found = np.array(reading.mean)[places]
    if not reading.mean[1] > 0.0 or not found.any():
        return []
    covariance = _covariance(reading, places)
    named, base = _names(quantity), _values(found, hues := reference_hues(found @ _on_basis()[:, :_COLOURS]))
    errors = np.full(len(base), np.nan)
    if covariance is not None:
        slopes = _slopes(found, hues)
        errors = np.sqrt(np.maximum(0.0, np.einsum("vi,ij,vj->v", slopes, covariance, slopes)))
    if abs(base[1]) > FARTHEST:
        base[0] = errors[0] = np.nan
    return [
        ColourValue(name, float(value), float(error), unit)
        for (name, unit), value, error in zip(named, base, errors, strict=True)
    ]


def _covariance(reading: RegionReading, places: list[int]) -> Values | None:
    if reading.correlations is None:
        return None
    error = np.array(reading.error)[places]
    found: Values = reading.correlations[np.ix_(places, places)] * error[:, None] * error[None, :]
    return found


_COLOURS = 3 * (1 + 14) + 3 * (1 + 99)
"""How many integrals colour rendering needs."""


@lru_cache(maxsize=1)
def _on_basis() -> Floats:
    """Of integrals for colour rendering, then of alpha-opic ones."""
    return colour_basis.on_basis(np.hstack([weights(), published.alpha_opic_spectra()]))


@lru_cache(maxsize=1)
def daylight_efficacies() -> Floats:
    """Of ALPHA_OPIC for D65, W/lm: what one lux of daylight gives (CIE S 026/E:2018, 3.9)."""
    wavelengths = published.colour_wavelengths()
    d65 = np.interp(wavelengths, *published.illuminant("D65"))
    found = d65 @ published.alpha_opic_spectra()
    return np.asarray(found / (published.MAX_LUMINOUS_EFFICACY * (d65 @ weights())[1]), dtype=np.float64)


def _values(readings: Floats, hues: Floats) -> Floats:
    """In the order of `_names`."""
    integrals = readings @ _on_basis()
    rendering = colour_rendering(integrals[:_COLOURS], hues)
    alpha_opic = integrals[_COLOURS:]
    equivalent = alpha_opic / daylight_efficacies()
    photopic = published.MAX_LUMINOUS_EFFICACY * integrals[1]
    return np.array(
        [
            *colour_temperature_of(integrals[:3]),
            *rendering,
            *alpha_opic,
            *equivalent,
            equivalent[published.ALPHA_OPIC.index("melanopic")] / photopic,
        ]
    )


def _slopes(readings: Floats, hues: Floats) -> Floats:
    """Of values by readings, shape (values, readings)."""
    # Of the mean response: far above rounding, far below what bends the formulas.
    step = 1e-4 * float(np.abs(readings).mean())
    found = [
        (_values(readings + step * one, hues) - _values(readings - step * one, hues)) / (2.0 * step)
        for one in np.eye(len(readings))
    ]
    return np.stack(found, axis=-1)


def _names(quantity: Quantity) -> list[tuple[str, str]]:
    energy, daylight = _KIND.get(quantity, _OTHERWISE)
    return [
        ("correlated colour temperature", "K"),
        ("Duv", ""),
        ("Ra", ""),
        ("R9", ""),
        ("Rf", ""),
        ("Rg", ""),
        *((f"{name} {energy}", quantity.response_unit) for name in published.ALPHA_OPIC),
        *((f"{name} equivalent {daylight}", quantity.unit) for name in published.ALPHA_OPIC),
        ("melanopic daylight efficacy ratio", ""),
    ]
