"""Indices of refraction have their catalogue values."""

import numpy as np
import pytest
from nocturne_scene.compile import spectra
from nocturne_scene.spectra import indices

F, D, C = 486.1327, 587.5618, 656.2725


@pytest.mark.parametrize(
    ("name", "n_f", "n_d", "n_c"),
    # Schott's dispersion formula at the lines F, d and C.
    [
        ("N-BK7", 1.52237629, 1.51680003, 1.51432235),
        ("SF10", 1.74648091, 1.72825024, 1.72084751),
        ("F2", 1.63208146, 1.62004014, 1.61503169),
        ("N-SF11", 1.80651274, 1.78471994, 1.77595511),
    ],
)
def test_glasses_at_fraunhofer_lines(name: str, n_f: float, n_d: float, n_c: float) -> None:
    lines, expected = np.array([F, D, C]), (n_f, n_d, n_c)
    curve = indices.dielectric(name).n
    assert curve(lines) == pytest.approx(expected, abs=1e-8)
    # Rounded to float32 and interpolated, as the tracer has it.
    compiled = spectra.evaluate(indices.compile_dielectric(curve), lines)
    assert compiled == pytest.approx(expected, abs=1.2e-7)


@pytest.mark.parametrize(
    ("name", "wavelength", "n", "error"),
    [
        # Catalogue codes.
        ("N-LAK8", D, 1.71300, 5e-6),
        ("fused silica", D, 1.45846, 5e-6),
        ("sapphire", D, 1.76817, 5e-6),
        # Daimon and Masumura's formula at 20 C.
        ("water", 404.656, 1.34312306, 1e-8),
        ("water", 486.1327, 1.33749186, 1e-8),
        ("water", 589.3, 1.33334906, 1e-8),
        ("water", 656.2725, 1.3315126, 1e-8),
        # Gemmology's constant for diamond at the D line; Sultanova's measured value for PMMA.
        ("diamond", 589.3, 2.4175, 5e-4),
        ("acrylic", 587.6, 1.491, 1e-3),
    ],
)
def test_other_dielectrics(name: str, wavelength: float, n: float, error: float) -> None:
    assert indices.dielectric(name).n(np.array([wavelength])) == pytest.approx([n], abs=error)


def test_every_name_compiles_and_tells_its_source() -> None:
    for name in indices.dielectrics():
        values = np.array(indices.compile_dielectric(indices.dielectric(name).n).values)
        assert np.all(np.diff(values) < 0), name  # normal dispersion
        assert indices.dielectric(name).source
    for name in indices.metals():
        n, k = indices.compile_metal(name)
        assert min(n.values) > 0
        assert min(k.values) > 0
        assert indices.metal(name).valid[0] <= 360
        assert indices.metal(name).valid[1] >= 830


@pytest.mark.parametrize(
    ("name", "wavelength", "n", "k", "reflectance"),
    # Johnson and Christy 1972 at measured points; Rakic 1995. Reflectance: textbook values to two places.
    [
        ("Au", 632.8, 0.18377, 3.4313, 0.94),
        ("Ag", 548.6, 0.06, 3.586, 0.98),
        ("Cu", 659.5, 0.22, 3.747, 0.94),
        ("Al", 563.57, 1.0728, 6.7839, 0.91),
    ],
)
def test_metals(name: str, wavelength: float, n: float, k: float, reflectance: float) -> None:
    found = indices.metal(name)
    at = np.array([wavelength])
    assert (found.n(at)[0], found.k(at)[0]) == pytest.approx((n, k), rel=5e-3)
    index = found.n(at)[0] + 1j * found.k(at)[0]
    assert abs((index - 1) / (index + 1)) ** 2 == pytest.approx(reflectance, abs=0.015)


def test_cauchy_and_constant_formulas() -> None:
    curve = indices.cauchy([1.5, 0.004, 1e-4])
    assert curve(np.array([500.0])) == pytest.approx([1.5 + 0.016 + 0.0016])
    assert list(indices.compile_dielectric(indices.cauchy([1.25])).values) == [1.25]


def test_a_formula_with_a_resonance_in_the_visible_is_refused() -> None:
    with pytest.raises(indices.BadIndexError, match=r"expected 0\.001 to 1000 from 360 to 830 nm"):
        indices.compile_dielectric(indices.sellmeier([1.0], [0.25]))
