"""Sunlight by ASTM G173-03: above the air, and at the ground after 1.5 air masses. Numbers: data/g173.csv."""

from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from nocturne_scene.spectra.published import Floats, data_bytes

SolarName = Literal["extraterrestrial", "global", "direct"]
NAMES: tuple[SolarName, ...] = get_args(SolarName)

FIRST, LAST = 280.0, 4000.0
"""nm, of the table."""


def table(name: SolarName) -> tuple[Floats, Floats]:
    """Return wavelengths in nm and the spectral irradiance there, W m-2 nm-1, linear in between.

    `global`: on a plane tilted by 37 degrees towards the Sun, sky and ground included; `direct`: from the
    Sun and 2.5 degrees around it, across the beam.
    """
    rows = _rows()
    return rows[:, 0], rows[:, 1 + NAMES.index(name)]


@lru_cache(maxsize=1)
def _rows() -> Floats:
    lines = data_bytes("g173.csv").decode("ascii").splitlines()
    numbers = [line.split(",") for line in lines if line and line[0].isdigit()]
    return np.array(numbers, dtype=np.float64)
