"""Colour rendering and alpha-opic quantities against published numbers and an independent implementation, and
what smooth responses keep of them."""

import warnings
from typing import Any

import numpy as np
import pytest
from nocturne_scene.photometry.arriving_light import colour_of, daylight_efficacies
from nocturne_scene.quantities import ILLUMINANCE
from nocturne_scene.responses import COLOUR
from nocturne_scene.spectra import colour_basis, published
from nocturne_scene.spectra.colour_rendering import ColourRendering, colour_rendering, weights
from nocturne_scene.spectra.published import Floats
from nocturne_scene.uncertainty import RegionReading

NAMES = ["X", "Y", "Z", *COLOUR]


def _each_nm(name: str) -> Floats:
    return np.interp(published.colour_wavelengths(), *published.illuminant(name))


def _each_5_nm(name: str) -> Floats:
    """Sums over a table each 5 nm, as published indices of lamps are made of."""
    values = np.zeros(len(published.colour_wavelengths()))
    values[::5] = _each_nm(name)[::5]
    return values


def _of(spectrum: Floats) -> ColourRendering:
    return colour_rendering(spectrum @ weights())


@pytest.mark.parametrize(
    ("name", "ra"),
    [("FL1", 76), ("FL2", 64), ("FL4", 51), ("FL7", 90), ("FL9", 90), ("FL11", 83), ("FL12", 83), ("HP1", 8)],
)
def test_general_indices_of_cie_015(name: str, ra: int) -> None:
    """CIE 015:2004, tables T.7 to T.9, whole numbers."""
    assert _of(_each_5_nm(name)).ra == pytest.approx(ra, abs=0.75)


def test_fl2() -> None:
    """Ra: CIE 13.3. Rf and Rg: the calculator of ANSI/IES TM-30 and CIE 224."""
    found = _of(_each_5_nm("FL2"))
    assert found.ra == pytest.approx(64.2, abs=0.05)
    assert found.rf == pytest.approx(70.12, abs=0.005)
    assert found.rg == pytest.approx(86.42, abs=0.01)


@pytest.mark.parametrize("name", ["A", "D65", "FL2", "FL11", "LED-B3", "LED-RGB1", "HP1"])
def test_another_implementation(name: str) -> None:
    """colour-science, which finds temperatures for CIE 13.3 by Robertson's table: Ra differs by up to 0.2
    where the light is strongly coloured."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import colour

        spectrum = _each_nm(name)
        light = colour.SpectralDistribution(dict(zip(published.colour_wavelengths(), spectrum, strict=True)))
        ra = colour.colour_rendering_index(light)
        other: Any = colour.colour_fidelity_index(light, additional_data=True, method="ANSI/IES TM-30-18")
    found = _of(spectrum)
    assert found.ra == pytest.approx(ra, abs=0.2)
    assert found.rf == pytest.approx(other.R_f, abs=0.006)
    assert found.rg == pytest.approx(other.R_g, abs=0.006)


@pytest.mark.parametrize("name", ["A", "D65", "FL2", "FL11", "LED-B3", "LED-RGB1", "HP1"])
def test_smooth_responses_are_enough(name: str) -> None:
    spectrum = _each_nm(name)
    found, known = _seen(spectrum), _of(spectrum)
    assert found["Ra"] == pytest.approx(known.ra, abs=0.04)
    assert found["Rf"] == pytest.approx(known.rf, abs=0.01)
    assert found["Rg"] == pytest.approx(known.rg, abs=0.02)


def test_daylight_efficacies_of_cie_s_026() -> None:
    """CIE S 026/E:2018, table 3, mW/lm."""
    known = [0.8173, 1.4558, 1.6289, 1.4497, 1.3262]
    assert 1000.0 * daylight_efficacies() == pytest.approx(known, abs=5e-5)


def test_one_lux_of_daylight_is_one_of_each() -> None:
    spectrum = _each_nm("D65")
    spectrum /= published.MAX_LUMINOUS_EFFICACY * (spectrum @ weights())[1]
    found = _seen(spectrum)
    for name in published.ALPHA_OPIC:
        assert found[f"{name} equivalent daylight illuminance"] == pytest.approx(1.0, abs=2e-4)
    assert found["melanopic daylight efficacy ratio"] == pytest.approx(1.0, abs=2e-4)
    assert found["correlated colour temperature"] == pytest.approx(6503, abs=3)


def test_melanopic_ratio_of_illuminant_a() -> None:
    """CIE S 026 toolbox: 0.496 (melanopic DER of illuminant A)."""
    assert _seen(_each_nm("A"))["melanopic daylight efficacy ratio"] == pytest.approx(0.496, abs=1e-3)


def test_errors_are_those_of_many_draws() -> None:
    """Of noise that goes together by half, the scatter of 400 draws."""
    numbers = np.random.default_rng(7)
    spectrum = _each_nm("LED-B3")
    right = spectrum @ colour_basis.responses()
    size = len(NAMES)
    correlations = 0.5 * np.eye(size) + 0.5
    error = np.concatenate([np.ones(3), 2e-3 * right])
    drawn = [
        right + error[3:] * (np.sqrt(0.5) * numbers.standard_normal(len(right)) + common)
        for common in np.sqrt(0.5) * numbers.standard_normal(400)
    ]
    told = {
        each.name: each.error for each in colour_of(_reading(right, error, correlations), NAMES, ILLUMINANCE)
    }
    scatter: dict[str, list[float]] = {}
    for readings in drawn:
        for each in colour_of(_reading(readings, error, None), NAMES, ILLUMINANCE):
            scatter.setdefault(each.name, []).append(each.value)
    for name, values in scatter.items():
        assert told[name] == pytest.approx(float(np.std(values)), rel=0.15), name


def test_without_covariances_there_are_no_errors_and_in_the_dark_no_colour() -> None:
    right = _each_nm("D65") @ colour_basis.responses()
    found = colour_of(_reading(right, np.ones(len(NAMES)), None), NAMES, ILLUMINANCE)
    assert all(np.isnan(each.error) for each in found)
    assert colour_of(_reading(0.0 * right, np.ones(len(NAMES)), None), NAMES, ILLUMINANCE) == []


def _seen(spectrum: Floats) -> dict[str, float]:
    reading = _reading(spectrum @ colour_basis.responses(), np.ones(len(NAMES)), None)
    return {each.name: each.value for each in colour_of(reading, NAMES, ILLUMINANCE)}


def _reading(readings: Floats, error: Floats, correlations: Floats | None) -> RegionReading:
    mean = (readings.sum(), readings.sum(), readings.sum(), *readings)
    nothing = (0.0, 0.0)
    return RegionReading(mean, tuple(error), nothing, nothing, 1.0, 1.96, 1, 0, 100, (100, 100), correlations)
