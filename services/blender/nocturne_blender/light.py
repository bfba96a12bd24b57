"""Amounts and colours of light, between Blender and scene documents.

Blender's colours are linear with the primaries of Rec. 709, its lamps have watts, and radiance is in
W m-2 sr-1 by colour. A document's radiance is spectral. The two meet in one white: colour (1, 1, 1) of
1 W m-2 sr-1 is D65 with as many watts from 360 to 830 nm.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Json = Any

LUMENS_PER_WATT = 183.142
"""Of D65 from 360 to 830 nm: 683 lm/W times the mean of the CIE 1931 2-degree y-bar, weighed by D65 (CIE
015:2018), in 1 nm steps."""

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Y of linear red, green and blue: ITU-R BT.709."""

# From X, Y, Z with Y = 1 for white: the primaries of ITU-R BT.709 and the white that the tables of D65 and of
# the observer give.
_RGB_OF_XYZ = np.array(
    [
        [3.24044358, -1.53713349, -0.49852978],
        [-0.96926681, 1.87601236, 0.04155605],
        [0.05564352, -0.20402625, 1.05722691],
    ]
)


def rgb_of_xyz(xyz: NDArray[np.float32]) -> NDArray[np.float32]:
    """Blender's colours of X, Y, Z in cd/m2, shape (..., 3)."""
    return np.asarray(xyz @ (_RGB_OF_XYZ.T / LUMENS_PER_WATT), dtype=np.float32)


def luminance(rgb: Sequence[float]) -> float:
    """Y of a colour, white being 1."""
    return math.fsum(part * max(0.0, value) for part, value in zip(LUMINANCE, rgb, strict=True))


def reflectance(rgb: Sequence[float]) -> Json:
    """A reflectance of linear red, green, blue, held in [0, 1]; greys are the same at every wavelength."""
    held = [min(1.0, max(0.0, float(value))) for value in rgb]
    return held[0] if held[0] == held[1] == held[2] else {"rgb": held}


def radiance(rgb: Sequence[float], lumens_per_watt: float = LUMENS_PER_WATT) -> Json:
    """Spectral radiance of Blender's W m-2 sr-1 by colour; 0 where none is positive."""
    held = [max(0.0, float(value)) for value in rgb]
    brightest = max(held)
    if brightest == 0.0:
        return 0.0
    amount = lumens_per_watt * luminance(held)
    return {"rgb": [value / brightest for value in held], "luminance": amount}


def textured_radiance(use: Json, strength: float) -> Json:
    """Radiance of an image's colours times a number of W m-2 sr-1."""
    return use | {"spectrum": radiance([strength] * 3)} if strength > 0 else 0.0
