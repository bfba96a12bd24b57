"""Bands of wavelengths: further responses that are named as spectral EXR files have it.

A. Fichet, R. Pacanowski, A. Wilkie, "An OpenEXR Layout for Spectral Images" (Journal of Computer Graphics
Techniques 10(3), 2021): one channel for each wavelength, S0 for light whose polarisation is not told, the
number with a comma as points separate layers; an attribute for the layout's version and one for the unit.
"""

import re
from collections.abc import Iterable

from nocturne_scene.quantities import Quantity

_NAME = re.compile(r"S0\.\d{1,4},\d{6}nm")
_VERSION = "1.0"


def band_name(middle_nm: float) -> str:
    """The channel of a band with its middle there."""
    number = f"{middle_nm:.6f}".replace(".", ",")
    return f"S0.{number}nm"


def is_band(name: str) -> bool:
    """Whether a channel is one of a band."""
    return _NAME.fullmatch(name) is not None


def band_middle(name: str) -> float:
    """Where the band of such a name has its middle, nm."""
    return float(name.removeprefix("S0.").removesuffix("nm").replace(",", "."))


def spectral_attributes(names: Iterable[str], quantity: Quantity) -> dict[str, str]:
    """What a file with bands says of itself. The layout leaves "per nanometre" out of its units."""
    if not any(is_band(name) for name in names):
        return {}
    unit = quantity.response_unit.replace("-", "^-").replace(" ", ".")
    return {"spectralLayoutVersion": _VERSION, "emissiveUnits": unit}
