"""Compiled spectra have the published values and lose nothing of the document's."""

from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne.v1 import scene_pb2
from nocturne_scene.compile import spectra
from nocturne_scene.document.spectra import (
    BlackbodySpectrum,
    ChartSpectrum,
    ConstantSpectrum,
    IlluminantSpectrum,
    LineSpectrum,
    RgbSpectrum,
    TableSpectrum,
)
from nocturne_scene.spectra import published
from nocturne_scene.spectra import rgb as rgb_spectra


def chromaticity(message: scene_pb2.Spectrum) -> tuple[float, float]:
    wavelengths = np.arange(360.0, 831.0)
    x, y, z = spectra.evaluate(message, wavelengths) @ spectra.response()
    return x / (x + y + z), y / (x + y + z)


def test_the_response_is_the_cie_1931_observer_times_683() -> None:
    assert spectra.response().shape == (471, 3)
    # CIE 018:2019 table 6: sums of the colour matching functions at 1 nm; y is 1 at 555 nm.
    sums = spectra.response().sum(axis=0) / 683
    assert sums == pytest.approx([106.865469, 106.856917, 106.892251], abs=2e-6)
    assert spectra.response()[555 - 360, 1] == pytest.approx(683, rel=1e-5)


def test_equal_energy_has_the_luminance_of_the_sum_of_y() -> None:
    message = spectra.radiance(ConstantSpectrum(constant=1 / 683))
    assert spectra.luminance(message) == pytest.approx(106.856917, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "x", "y"),
    # CIE 015:2018, table T.3, 1931 2-degree observer.
    [("A", 0.44758, 0.40745), ("D50", 0.34567, 0.35851), ("D65", 0.31272, 0.32903), ("E", 1 / 3, 1 / 3)],
)
def test_illuminants_have_their_published_chromaticity_and_the_wanted_luminance(
    name: str, x: float, y: float
) -> None:
    spectrum = IlluminantSpectrum.model_validate({"illuminant": name, "luminance": 250})
    message = spectra.radiance(spectrum)
    assert chromaticity(message) == pytest.approx((x, y), abs=1e-4)
    assert spectra.luminance(message) == pytest.approx(250, rel=1e-6)


def test_planck_has_the_values_of_the_constants_on_paper() -> None:
    # At 3000 K and 555 nm, c2 / (wavelength T) = 8.641303, c1L = 1.19104297e-16 W m2 sr-1.
    on_paper = 1.1910429723971884e-16 / 555e-9**5 / np.expm1(1.438776877503933e-2 / (555e-9 * 3000)) * 1e-9
    assert published.planck(3000, np.array([555.0]))[0] == pytest.approx(on_paper, rel=1e-9)


def test_planck_integrates_to_the_law_of_stefan_and_boltzmann() -> None:
    wavelengths = np.arange(50.0, 200_000.0, 5.0)
    radiance = np.trapezoid(published.planck(3000, wavelengths), wavelengths)
    assert radiance == pytest.approx(5.670374419e-8 * 3000**4 / np.pi, rel=1e-4)


def test_a_black_body_is_absolute_unless_scaled() -> None:
    message = spectra.radiance(BlackbodySpectrum(blackbody=2042, luminance=None))
    # The old candela: a black body at the freezing point of platinum has 60 cd/cm2.
    assert spectra.luminance(message) == pytest.approx(600_000, rel=0.01)
    scaled = spectra.radiance(BlackbodySpectrum(blackbody=2042, luminance=10))
    assert spectra.luminance(scaled) == pytest.approx(10, rel=1e-6)


def test_a_cold_body_does_not_overflow() -> None:
    assert spectra.is_black(spectra.radiance(BlackbodySpectrum(blackbody=1, luminance=None)))


def table(knots: list[tuple[float, float]], outside: str | None = None) -> TableSpectrum:
    return TableSpectrum.model_validate({"table": knots, "outside": outside})


@pytest.mark.parametrize(
    ("wavelengths", "step"),
    [
        ([400, 500, 700], 100),
        ([400, 404, 412], 4),
        ([400, 410, 425], 5),
        ([400.5, 401, 700], 0.5),
        ([400, 400.3, 500], 0.1),
        ([400, 400.001, 500], 0.1),
    ],
)
def test_a_table_takes_the_coarsest_grid_with_all_knots(wavelengths: list[float], step: float) -> None:
    message = spectra.reflectance(
        table([(wavelength, 0.1 + 0.1 * i) for i, wavelength in enumerate(wavelengths)])
    )
    assert message.step_nm == step


@given(
    st.lists(st.integers(300, 900), min_size=2, max_size=20, unique=True),
    st.sampled_from(["hold", "zero"]),
    st.randoms(use_true_random=False),
)
def test_a_compiled_table_has_the_values_that_were_written(
    wavelengths: list[int], outside: str, random: Random
) -> None:
    knots = [(float(wavelength), random.random()) for wavelength in sorted(wavelengths)]
    message = spectra.reflectance(table(knots, outside))
    visible = np.arange(360.0, 830.5, 0.5)
    at, values = np.array(knots).T
    end = 0.0 if outside == "zero" else None
    expected = np.interp(visible, at, values, left=end, right=end)
    assert spectra.evaluate(message, visible) == pytest.approx(expected, abs=1e-6)


def test_a_table_that_fits_no_grid_is_close_to_what_was_written() -> None:
    knots = [(400.0, 0.0), (450.033, 1.0), (500.0, 0.0)]
    message = spectra.reflectance(table(knots))
    fine = np.arange(400.0, 500.0, 0.001)
    error = np.abs(spectra.evaluate(message, fine) - np.interp(fine, *np.array(knots).T))
    assert error.max() <= 0.025 * (1 / 50.033 + 1 / 49.967)  # as docs/reference/scene.md promises


def test_what_nobody_sees_is_cut_off() -> None:
    message = spectra.reflectance(table([(200, 0.1), (300, 0.2), (1000, 0.9)]))
    assert (message.first_nm, len(message.values)) == (300, 7)  # 300 to 900 nm
    assert spectra.is_black(spectra.radiance(table([(900, 1), (1000, 2)])))
    assert list(spectra.reflectance(table([(900, 0.25), (1000, 0.5)])).values) == [0.25]


def test_light_without_visible_part_has_no_luminance() -> None:
    spectrum = TableSpectrum.model_validate({"table": [[900, 1], [1000, 2]], "luminance": 5})
    with pytest.raises(spectra.NotCompilableError, match="no visible light"):
        spectra.radiance(spectrum)


def test_lines_have_their_power_and_a_width() -> None:
    lines = [{"nm": 546.1, "power": 2, "width": 1}, {"nm": 611, "power": 3}]
    message = spectra.radiance(LineSpectrum.model_validate({"lines": lines}))
    fine = np.arange(500.0, 650.0, 0.001)
    values = spectra.evaluate(message, fine)
    powers = [values[part].sum() * 0.001 for part in (fine < 580, fine >= 580)]
    assert powers == pytest.approx([2, 3], rel=1e-3)
    assert values[np.searchsorted(fine, 546.1)] == pytest.approx(
        2 * values[np.searchsorted(fine, 545.6)], rel=1e-2
    )


@pytest.mark.parametrize("rgb", [(0.2, 0.5, 0.8), (1.0, 1.0, 1.0), (0.9, 0.1, 0.05)])
def test_a_colour_has_a_smooth_spectrum_of_that_colour(rgb: tuple[float, float, float]) -> None:
    message = spectra.reflectance(RgbSpectrum.model_validate({"rgb": rgb}))
    wavelengths = np.arange(360.0, 831.0)
    found = spectra.evaluate(message, wavelengths) @ rgb_spectra.rgb_weights()
    assert found == pytest.approx(rgb, abs=4e-3)
    assert max(message.values) <= 1
    radiance = spectra.radiance(RgbSpectrum.model_validate({"rgb": rgb, "luminance": 80}))
    assert spectra.luminance(radiance) == pytest.approx(80, rel=1e-6)


def test_a_patch_of_the_chart_is_as_published() -> None:
    message = spectra.reflectance(ChartSpectrum.model_validate({"chart_patch": "white"}))
    assert (message.first_nm, message.step_nm, len(message.values)) == (380, 10, 36)
    assert message.values[20] == pytest.approx(0.9, abs=0.03)
