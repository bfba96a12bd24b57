"""Published media by name. Numbers and sources: data/media.toml; of skin, data/skin.toml."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from nocturne_scene.media import rayleigh, skin
from nocturne_scene.spectra.published import Floats, data_file, visible_wavelengths

AIR = "air"


@dataclass(frozen=True)
class Coefficients:
    """Absorption and scattering, 1/m, at `visible_wavelengths`."""

    absorption: Floats
    scattering: Floats


@lru_cache(maxsize=1)
def names() -> tuple[str, ...]:
    """All names, those of `droplets` included."""
    return (AIR, *droplets(), *data_file("media.toml")["measured"]["media"], *skin.layers())


def droplets() -> dict[str, dict[str, Any]]:
    """Return the distributions of droplets by name: mode_radius (m), alpha, gamma, number (1/m3)."""
    found = data_file("media.toml")["droplets"]
    return {name: {key: entry[key] for key in entry if key != "source"} for name, entry in found.items()}


def coefficients(name: str) -> Coefficients:
    """Return those of air at sea level (288.15 K, 101325 Pa), a layer of skin or a measured medium.

    Raises KeyError for another name.
    """
    wavelengths = visible_wavelengths()
    if name == AIR:
        scattering = rayleigh.number_density() * rayleigh.cross_section(wavelengths)
        return Coefficients(np.zeros_like(scattering), scattering)
    if name in skin.layers():
        return Coefficients(skin.absorption(name, wavelengths), skin.scattering(name, wavelengths))
    measured = data_file("media.toml")["measured"]
    entry, at = measured["media"][name], np.array(measured["wavelengths"])
    order = np.argsort(at)
    absorption, scattering = (
        1e3 * np.interp(wavelengths, at[order], np.array(entry[key])[order])
        for key in ("absorption", "scattering")
    )
    return Coefficients(absorption, scattering)


def ozone_cross_section(wavelengths: Floats) -> Floats:
    """Return the absorption cross-section of a molecule, m2, at wavelengths in nm; held beyond the table."""
    ozone = data_file("media.toml")["ozone"]
    values = np.array(ozone["cross_section"])
    at = ozone["first_nm"] + ozone["step_nm"] * np.arange(len(values))
    return np.asarray(np.interp(wavelengths, at, values), dtype=np.float64)


def ozone_layer() -> Floats:
    """Return altitude (m) and density relative to its maximum, shape (n, 2); linear in between."""
    return np.array(data_file("media.toml")["ozone"]["layer"], dtype=np.float64)


def dobson_unit() -> float:
    """Return the molecules above a square metre for 1 Dobson unit."""
    return float(data_file("media.toml")["ozone"]["dobson_unit"])
