"""How Mitsuba's numbers stand for light."""

from nocturne_scene.formats.reading.colours import luminance_of_d65
from nocturne_scene.spectra.published import MAX_LUMINOUS_EFFICACY

# Its film divides by this, nearly its integral of y-bar: MI_CIE_Y_NORMALIZATION in its spectrum.h.
_FILM_DIVISOR = 106.7502593994140625

CANDELAS_PER_UNIT = MAX_LUMINOUS_EFFICACY * _FILM_DIVISOR
"""Luminance in cd/m2 of an image value Y = 1, radiance being in W m-2 sr-1 nm-1."""

# Its D65 is the table times this: MI_CIE_D65_NORMALIZATION in its spectrum.h.
_D65_FACTOR = 1.0 / 98.99741751876255


def white() -> float:
    """cd/m2 of light of the colour (1, 1, 1)."""
    return luminance_of_d65() * _D65_FACTOR
