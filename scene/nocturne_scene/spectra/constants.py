"""Constants of nature, and the wavelengths of the CIE's observers. Imports no files: the coordinator's pure
core has units by it."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# nm. The range of the CIE 1931 2-degree observer (CIE 018:2019, table 6), and its step.
FIRST = 360.0
LAST = 830.0
STEP = 1.0

# SI 2019, exact: J s, m/s, J/K, 1/mol.
PLANCK = 6.62607015e-34
LIGHT_SPEED = 299_792_458.0
BOLTZMANN = 1.380649e-23
AVOGADRO = 6.02214076e23
