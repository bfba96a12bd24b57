"""Scattering by spheres, by Bohren and Huffman's formulas for each size: what tables are compared with."""

import numpy as np
from nocturne_scene.media import mie
from nocturne_scene.spectra.published import Floats


def elements(index: float, sizes: Floats, cosines: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """S11, S12, S33 and S34, a row for each size: equations 4.47, 4.74 and 4.77."""
    a, b = mie.coefficients(index, sizes)
    before, pi = np.zeros_like(cosines), np.ones_like(cosines)
    s1, s2 = np.zeros((2, len(sizes), len(cosines)), dtype=complex)
    for n in range(1, a.shape[1] + 1):
        tau = n * cosines * pi - (n + 1) * before
        weight = (2 * n + 1) / (n * (n + 1))
        electric, magnetic = weight * a[:, n - 1, None], weight * b[:, n - 1, None]
        s1 += electric * pi + magnetic * tau
        s2 += electric * tau + magnetic * pi
        before, pi = pi, ((2 * n + 1) * cosines * pi - (n + 1) * before) / n
    one, two, product = np.abs(s1) ** 2, np.abs(s2) ** 2, s2 * s1.conj()
    return 0.5 * (two + one), 0.5 * (two - one), product.real, product.imag
