"""Skin, layer by layer, of blood and melanosomes. Numbers and sources: data/skin.toml."""

import math
from typing import Any

import numpy as np

from nocturne_scene.spectra.published import Floats, data_file

_PER_CM = 100.0


def layers() -> tuple[str, ...]:
    """Names of the layers."""
    return tuple(data_file("skin.toml")["layers"])


def absorption(layer: str, wavelengths: Floats) -> Floats:
    """Return the absorption coefficient of a layer, 1/m, at wavelengths in nm; KeyError for another name.

    S. L. Jacques, Phys. Med. Biol. 58, R37 (2013), equation 12, of blood and melanosomes.
    """
    parts = data_file("skin.toml")["layers"][layer]
    oxygenated, deoxygenated = blood(wavelengths)
    share = parts["oxygenated"]
    mixed = share * oxygenated + (1.0 - share) * deoxygenated
    return np.asarray(parts["blood"] * mixed + parts["melanosomes"] * melanosome(wavelengths))


def scattering(layer: str, wavelengths: Floats) -> Floats:
    """Return the reduced scattering coefficient of a layer, 1/m, at wavelengths in nm; KeyError else."""
    data = data_file("skin.toml")
    entry: dict[str, Any] = data["scattering"][data["layers"][layer]["scattering"]]
    relative = wavelengths / 500.0
    small, large = relative**-4.0, relative ** -entry["mie"]
    mixed = entry["rayleigh"] * small + (1.0 - entry["rayleigh"]) * large
    return np.asarray(_PER_CM * entry["at_500"] * mixed)


def ends() -> tuple[float, float]:
    """Return the wavelengths from and to which blood's absorption is tabulated, nm."""
    data = data_file("skin.toml")["haemoglobin"]
    first = float(data["first_nm"])
    return first, first + data["step_nm"] * (len(data["oxygenated"]) - 1)


def blood(wavelengths: Floats) -> tuple[Floats, Floats]:
    """Return the absorption coefficients of oxygenated and deoxygenated blood, 1/m; held beyond the table."""
    data = data_file("skin.toml")["haemoglobin"]
    # Extinction is to base 10.
    factor = _PER_CM * math.log(10.0) * data["in_blood"] / data["molar_mass"]
    at = data["first_nm"] + data["step_nm"] * np.arange(len(data["oxygenated"]))
    return (
        factor * np.interp(wavelengths, at, data["oxygenated"]),
        factor * np.interp(wavelengths, at, data["deoxygenated"]),
    )


def melanosome(wavelengths: Floats) -> Floats:
    """Return the absorption coefficient of the inside of a melanosome, 1/m, at wavelengths in nm."""
    data = data_file("skin.toml")["melanosome"]
    return np.asarray(_PER_CM * data["scale"] * wavelengths ** data["power"])
