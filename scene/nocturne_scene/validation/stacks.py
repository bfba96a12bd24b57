"""Thin films by characteristic matrices: F. Abeles, Annales de Physique 12(5), 1950; H. A. Macleod, Thin-Film
Optical Filters, chapter 2. The tracer sums amplitudes from the base outwards instead."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Layer = tuple[complex, float]
"""Index n + i k, and thickness in nm."""


def polarised(
    wavelengths: Floats, degrees: float, layers: Sequence[Layer], beyond: complex, here: float = 1.0
) -> dict[str, tuple[Floats, Floats]]:
    """Reflectance and transmittance of s and of p."""
    along = here * np.sin(np.radians(degrees))

    def normal(index: complex) -> NDArray[np.complex128]:
        root = np.sqrt(np.complex128(index * index - along * along))
        return np.asarray(np.where(root.imag < 0, -root, root))

    def of(admittance: Callable[[complex], NDArray[np.complex128]]) -> tuple[Floats, Floats]:
        matrix = np.broadcast_to(np.eye(2, dtype=np.complex128), (*wavelengths.shape, 2, 2))
        for index, thickness in layers:
            phase, eta = 2 * np.pi * thickness * normal(index) / wavelengths, admittance(index)
            rows = [[np.cos(phase), -1j * np.sin(phase) / eta], [-1j * np.sin(phase) * eta, np.cos(phase)]]
            matrix = matrix @ np.moveaxis(np.array(rows), (0, 1), (-2, -1))
        fields = matrix @ np.array([1.0, admittance(beyond)])
        outside, inside = admittance(complex(here)), admittance(beyond)
        total = outside * fields[..., 0] + fields[..., 1]
        reflected = np.abs((outside * fields[..., 0] - fields[..., 1]) / total) ** 2
        return reflected, 4 * outside.real * inside.real / np.abs(total) ** 2

    return {"s": of(normal), "p": of(lambda index: index * index / normal(index))}


def unpolarised(
    wavelengths: Floats, degrees: float, layers: Sequence[Layer], beyond: complex, here: float = 1.0
) -> tuple[Floats, Floats]:
    """The mean of both polarisations."""
    found = polarised(wavelengths, degrees, layers, beyond, here)
    return (found["s"][0] + found["p"][0]) / 2, (found["s"][1] + found["p"][1]) / 2


Sheet = tuple[Floats, Floats, Floats]
"""Reflectance of the front, of the back, and transmittance."""


def one_behind_other(first: Sheet, second: Sheet) -> Sheet:
    """EN 410:2011, section 5.2."""
    echo = 1 - first[1] * second[0]
    return (
        first[0] + first[2] ** 2 * second[0] / echo,
        second[1] + second[2] ** 2 * first[1] / echo,
        first[2] * second[2] / echo,
    )
