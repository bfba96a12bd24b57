"""Responses by name: what sensors weigh light by, apart from the CIE's observers.

One table for documents, units and tests: a name, the curve with its source, and what the weighted power is
measured in. A new one is an entry here.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from nocturne_scene.spectra.constants import AVOGADRO, LIGHT_SPEED, PLANCK, Floats
from nocturne_scene.spectra.wavelength_range import LONGEST, SHORTEST, WavelengthRange

Curve = Callable[[Floats], Floats]


@dataclass(frozen=True)
class NamedResponse:
    """Response per nanometre and unit of spectral power."""

    curve: Curve
    """Called with wavelengths in nm; values only count from `first` to `last`."""
    first: float
    last: float
    """nm. At an end that jumps, the curve counts half: then its integral is exact."""
    source: str
    amount: str = "W"
    """What power becomes: of an irradiance the unit is this m-2."""
    quantity: str = ""
    """What an irradiance, a radiance and an intensity are called before these words; empty: as the name."""

    def at(self, grid: Floats) -> Floats:
        """Values at whole nm, linear in between, zero beyond."""
        inside = (grid >= self.first) & (grid <= self.last)
        values = np.where(inside, self.curve(np.clip(grid, self.first, self.last)), 0.0)
        # At the grid's own ends there is half of a hat already.
        jumps = np.isin(grid, (self.first, self.last)) & ~np.isin(grid, (grid[0], grid[-1]))
        values[jumps] *= 0.5
        return np.asarray(values)

    def within(self, wavelengths: WavelengthRange) -> Floats:
        """The same at a range's grid."""
        return self.at(wavelengths.grid())


def _photons(wavelengths: Floats) -> Floats:
    """Micromoles of photons in a joule."""
    return np.asarray(wavelengths * 1e-9 / (PLANCK * LIGHT_SPEED * AVOGADRO) * 1e6)


def _erythemal(wavelengths: Floats) -> Floats:
    middle = 10.0 ** (0.094 * (298.0 - wavelengths))
    long = 10.0 ** (0.015 * (140.0 - wavelengths))
    return np.asarray(np.where(wavelengths <= 298, 1.0, np.where(wavelengths <= 328, middle, long)))


def _dna(wavelengths: Floats) -> Floats:
    return np.asarray(np.exp(13.82 * (1.0 / (1.0 + np.exp((wavelengths - 310.0) / 9.0)) - 1.0)))


# Wavelength in nm and S(lambda).
_ACTINIC = np.array(
    [
        *((200, 0.030), (205, 0.051), (210, 0.075), (215, 0.095), (220, 0.120), (225, 0.150), (230, 0.190)),
        *((235, 0.240), (240, 0.300), (245, 0.360), (250, 0.430), (254, 0.500), (255, 0.520), (260, 0.650)),
        *((265, 0.810), (270, 1.000), (275, 0.960), (280, 0.880), (285, 0.770), (290, 0.640), (295, 0.540)),
        *((297, 0.460), (300, 0.300), (303, 0.120), (305, 0.060), (308, 0.026), (310, 0.015), (313, 0.006)),
        *((315, 0.003), (316, 2.4e-3), (317, 2.0e-3), (318, 1.6e-3), (319, 1.2e-3), (320, 1.0e-3)),
        *((322, 6.7e-4), (323, 5.4e-4), (325, 5.0e-4), (328, 4.4e-4), (330, 4.1e-4), (333, 3.7e-4)),
        *((335, 3.4e-4), (340, 2.8e-4), (345, 2.4e-4), (350, 2.0e-4), (355, 1.6e-4), (360, 1.3e-4)),
        *((365, 1.1e-4), (370, 9.3e-5), (375, 7.7e-5), (380, 6.4e-5), (385, 5.3e-5), (390, 4.4e-5)),
        *((395, 3.6e-5), (400, 3.0e-5)),
    ]
)

# Wavelength in nm and power response over its maximum.
_SILICON = np.array(
    [
        *((290, 0.00), (350, 0.27), (400, 0.37), (500, 0.52), (650, 0.71), (800, 0.88), (900, 0.97)),
        *((950, 1.00), (1000, 0.93), (1050, 0.58), (1100, 0.21), (1150, 0.05), (1190, 0.00)),
    ]
)


def _actinic(wavelengths: Floats) -> Floats:
    knots, values = _ACTINIC.T
    return np.asarray(np.exp(np.interp(wavelengths, knots, np.log(values))))


def _silicon(wavelengths: Floats) -> Floats:
    return np.asarray(np.interp(wavelengths, _SILICON[:, 0], _SILICON[:, 1]))


RESPONSES: Mapping[str, NamedResponse] = {
    "radiant": NamedResponse(
        np.ones_like, SHORTEST, LONGEST, "all power of the scene's wavelengths", quantity=" "
    ),
    "photons": NamedResponse(
        _photons, SHORTEST, LONGEST, "photons of all of the scene's wavelengths", "umol s-1", "photon"
    ),
    "PAR": NamedResponse(
        _photons,
        400.0,
        700.0,
        "photosynthetically active radiation: photons from 400 to 700 nm (K. J. McCree, Agricultural "
        "Meteorology 10, 1972); of an irradiance the PPFD",
        "umol s-1",
        "photosynthetic photon",
    ),
    "erythemal": NamedResponse(
        _erythemal,
        250.0,
        400.0,
        "ISO/CIE 17166:2019, of reddened skin; an erythemal dose of 100 J m-2 is 1 SED",
    ),
    "actinic": NamedResponse(
        _actinic,
        200.0,
        400.0,
        "S(lambda) of ICNIRP, Health Physics 87, 171-186 (2004), as in CIE S 009 and IEC 62471, of eye and "
        "skin; its logarithm is linear between the table's wavelengths",
    ),
    "DNA": NamedResponse(
        _dna,
        250.0,
        370.0,
        "damage to DNA: R. B. Setlow, PNAS 71, 3363 (1974), by the formula of A. E. S. Green and J. H. "
        "Miller (1975)",
        quantity="DNA-damaging",
    ),
    "silicon": NamedResponse(
        _silicon,
        290.0,
        1190.0,
        "of a crystalline silicon cell over its maximum, A. Driesse and J. Stein, Sandia report "
        "SAND2020-12693 (2020); linear between 13 wavelengths",
        quantity="silicon-weighted",
    ),
}
"""By the names that documents use."""
