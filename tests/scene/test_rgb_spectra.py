"""Smooth spectra of colours have these colours."""

import numpy as np
import numpy.typing as npt
import pytest
from nocturne_scene.spectra import published
from nocturne_scene.spectra import rgb as rgb_spectra
from numpy.typing import NDArray

WAVELENGTHS = published.visible_wavelengths()


def back(coefficients: npt.ArrayLike) -> NDArray[np.float64]:
    """Linear sRGB of reflectances under D65."""
    return rgb_spectra.spectra_of(coefficients, WAVELENGTHS) @ rgb_spectra.rgb_weights()


def test_the_primaries_are_those_of_srgb() -> None:
    # IEC 61966-2-1; its white is rounded to four places.
    matrix = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
    assert rgb_spectra.xyz_to_rgb() == pytest.approx(np.array(matrix), abs=5e-4)
    assert rgb_spectra.rgb_weights().sum(axis=0) == pytest.approx([1, 1, 1])


def test_table_entries_are_exact() -> None:
    table = rgb_spectra.table()
    assert len(table.scales) == 32
    scale = table.scales[16]
    rgb = back(table.coefficients[1, 16, 10, 20])
    assert rgb == pytest.approx([scale * 10 / 31, scale, scale * 20 / 31], abs=1e-4)


def test_reflectances_come_back() -> None:
    rng = np.random.default_rng(1)
    rgb = rng.random((4000, 3))
    error = np.abs(back(rgb_spectra.rgb_to_coefficients(rgb)) - rgb).max(axis=1)
    # 8-bit linear steps are 0.004. Largest where two channels are nearly 1.
    assert error.mean() < 1e-3
    assert np.quantile(error, 0.99) < 3e-3
    assert error.max() < 0.015


@pytest.mark.parametrize("brightest", [0.01, 0.02, 0.05, 0.1, 0.2])
def test_dark_colours_come_back(brightest: float) -> None:
    """To less than a step of sRGB in 8 bits, 1 / 255 / 12.92 of the linear channel at its dark end."""
    rgb = np.random.default_rng(3).uniform(0.1, 1, (1000, 3))
    rgb *= brightest / rgb.max(axis=1, keepdims=True)
    error = np.abs(back(rgb_spectra.rgb_to_coefficients(rgb)) - rgb)
    assert error.max() < 1 / 255 / 12.92


def test_primaries_and_greys_come_back() -> None:
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)], dtype=np.float64)
    assert back(rgb_spectra.rgb_to_coefficients(corners)) == pytest.approx(corners, abs=3e-4)
    greys = np.linspace(1e-4, 1 - 1e-4, 100)[:, None] * np.ones(3)
    coefficients = rgb_spectra.rgb_to_coefficients(greys)
    assert np.all(coefficients[:, :2] == 0)
    assert back(coefficients) == pytest.approx(greys, abs=1e-6)


def test_our_fit_agrees_with_the_table() -> None:
    rgb = np.array([[0.2, 0.5, 0.7], [0.9, 0.3, 0.1]])
    fitted, error = rgb_spectra.gauss_newton(rgb, np.zeros((2, 3)))
    assert error.max() < 1e-12
    assert back(rgb_spectra.unscaled(fitted)) == pytest.approx(rgb, abs=1e-9)
    table = rgb_spectra.spectra_of(rgb_spectra.rgb_to_coefficients(rgb), WAVELENGTHS)
    assert table == pytest.approx(rgb_spectra.spectra_of(rgb_spectra.unscaled(fitted), WAVELENGTHS), abs=0.02)


def test_emission_has_luminance_and_colour_of_any_size() -> None:
    rng = np.random.default_rng(2)
    rgb = rng.random((2000, 3)) ** 3 * 10.0 ** rng.uniform(-3, 6, (2000, 1))
    scales, coefficients = rgb_spectra.emission(rgb)
    found = scales[:, None] * back(coefficients)
    y = np.linalg.inv(rgb_spectra.xyz_to_rgb())[1]
    assert found @ y == pytest.approx(rgb @ y, rel=3e-3)
    assert np.abs(found - rgb).max(axis=1) / rgb.max(axis=1) == pytest.approx(0, abs=0.06)


def test_emission_of_pictures_is_that_of_their_colours() -> None:
    rng = np.random.default_rng(5)
    rgb = rng.random((20_000, 3)) ** rng.choice([0.2, 1, 4], (20_000, 1)) * 10.0 ** rng.uniform(
        -3, 6, (20_000, 1)
    )
    rgb[:100], rgb[100:200] = rgb[:100, :1], 0
    rgb[200:300, 1:], rgb[300:400, :2], rgb[400:500, ::2] = 0, 0, 0
    pixels = rgb.astype(np.float32)
    found = rgb_spectra.emission_of_pixels(pixels)
    scales, coefficients = rgb_spectra.emission(pixels)
    assert found[:, 0] == pytest.approx(scales, rel=4e-3)
    assert np.median(np.abs(found[200:, 0] / scales[200:] - 1)) < 1e-4
    assert found[:500, 0] == pytest.approx(scales[:500], rel=1e-6)
    lit = scales > 0
    shape = rgb_spectra.spectra_of(coefficients[lit], WAVELENGTHS[::20])
    assert rgb_spectra.spectra_of(found[lit, 1:], WAVELENGTHS[::20]) == pytest.approx(shape, abs=2e-3)


def test_black_and_white_light() -> None:
    scales, coefficients = rgb_spectra.emission(np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]))
    assert scales == pytest.approx([0, 2])
    assert np.all(coefficients[1] == 0)
    wavelengths, radiance = rgb_spectra.d65_of_luminance(250.0)
    y = published.observer("CIE 1931 2 degree")[:, 1]
    assert 683 * radiance @ y == pytest.approx(250)
    assert len(wavelengths) == 471
