"""Published media by name. Numbers and sources: data/media.toml; of skin, data/skin.toml."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from nocturne_scene.media import rayleigh, skin
from nocturne_scene.spectra.published import Floats, data_file
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange

AIR = "air"


@dataclass(frozen=True)
class Coefficients:
    """Absorption and scattering, 1/m."""

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


def coefficients(name: str, within: WavelengthRange = VISIBLE) -> Coefficients:
    """Return those of air at sea level (288.15 K, 101325 Pa), a layer of skin or a measured medium, at a
    range's grid.

    Raises KeyError for another name.
    """
    wavelengths = within.grid()
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


OZONE_ENDS = (200.0, 1065.0)
"""nm, of its cross-section."""


def ends(name: str) -> tuple[float, float] | None:
    """Return the wavelengths from and to which a medium was measured, nm; None: it follows a formula."""
    if name in skin.layers():
        return skin.ends()
    if name in data_file("media.toml")["measured"]["media"]:
        at = data_file("media.toml")["measured"]["wavelengths"]
        return float(min(at)), float(max(at))
    return None


def ozone_cross_section(wavelengths: Floats) -> Floats:
    """Return the absorption cross-section of a molecule, m2, at wavelengths in nm.

    From 360 to 830 nm means over 10 nm, held at both ends; below, means over 1 nm from 200 nm on; above, over
    10 nm to 1065 nm, and zero beyond.
    """
    ozone, at = data_file("media.toml")["ozone"], np.asarray(wavelengths, dtype=np.float64)
    visible = np.interp(at, *_steps(ozone))
    ultraviolet = np.interp(at, *_steps(ozone["ultraviolet"]))
    infrared = np.interp(at, *_steps(ozone["infrared"]), right=0.0)
    return np.where(at < VISIBLE.first, ultraviolet, np.where(at > VISIBLE.last, infrared, visible))


def _steps(entry: dict[str, Any]) -> tuple[Floats, Floats]:
    values = np.array(entry["cross_section"], dtype=np.float64)
    return entry["first_nm"] + entry["step_nm"] * np.arange(len(values)), values


def ozone_layer() -> Floats:
    """Return altitude (m) and density relative to its maximum, shape (n, 2); linear in between."""
    return np.array(data_file("media.toml")["ozone"]["layer"], dtype=np.float64)


def dobson_unit() -> float:
    """Return the molecules above a square metre for 1 Dobson unit."""
    return float(data_file("media.toml")["ozone"]["dobson_unit"])
