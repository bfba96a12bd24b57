"""How clean, dry air scatters light.

B. A. Bodhaine, N. B. Wood, E. G. Dutton and J. R. Slusser, "On Rayleigh optical depth calculations", Journal
of Atmospheric and Oceanic Technology 16, 1999: 45 degrees north, 360 ppm of carbon dioxide. Numbers and
sources of the parts: data/media.toml.
"""

from typing import Any

import numpy as np

from nocturne_scene.spectra.published import Floats, data_file


def cross_section(wavelengths: Floats) -> Floats:
    """Return the scattering cross-section of a molecule of air, m2, at wavelengths in nm (equation 29)."""
    a, b, c, d, e = _air()["cross_section"]
    squared = (np.asarray(wavelengths, dtype=np.float64) * 1e-3) ** 2
    return np.asarray(1e-32 * (a + b / squared + c * squared) / (1 + d / squared + e * squared))


def optical_depth(wavelengths: Floats, pressure: float = 101_325.0) -> Floats:
    """Return that of the whole atmosphere, straight up, from where the pressure is `pressure` Pa (eq. 30)."""
    return column(pressure) * cross_section(wavelengths)


def column(pressure: float = 101_325.0) -> float:
    """Return the molecules above a square metre where the pressure is `pressure` Pa."""
    return float(_air()["column"]) * pressure / 101_325.0


def number_density() -> float:
    """Return the molecules in a cubic metre at 288.15 K and 101325 Pa."""
    return float(_air()["number_density"])


def depolarisation(wavelengths: Floats) -> Floats:
    """Return the depolarisation ratio for natural light, from King's factor F: 6 (F - 1) / (7 F + 3).

    D. R. Bates, "Rayleigh scattering by air", Planetary and Space Science 32, 1984, as in Bodhaine et al.,
    equations 5, 6 and 23.
    """
    inverse = (np.asarray(wavelengths, dtype=np.float64) * 1e-3) ** -2
    total, weights = np.zeros_like(inverse), 0.0
    for gas in _air()["gases"].values():
        total += gas["percent"] * np.polynomial.polynomial.polyval(inverse, gas["king"])
        weights += gas["percent"]
    king = total / weights
    return np.asarray(6 * (king - 1) / (7 * king + 3))


def _air() -> dict[str, Any]:
    found: dict[str, Any] = data_file("media.toml")["air"]
    return found
