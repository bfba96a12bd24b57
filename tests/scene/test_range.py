"""Scenes of other wavelengths than 360 to 830 nm, as compiled: published integrals and closed forms."""

import math
from typing import Any

import numpy as np
import pytest
from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile import spectra
from nocturne_scene.compile.compiler import compile_scene
from nocturne_scene.document.read import check_document
from nocturne_scene.document.spectra import BlackbodySpectrum, RgbSpectrum, SolarSpectrum
from nocturne_scene.errors import InputError
from nocturne_scene.media import presets, rayleigh
from nocturne_scene.quantities import quantity_named, quantity_of
from nocturne_scene.scene_ranges import range_of, schedule_of, wavelengths_of
from nocturne_scene.spectra import indices, published, solar, sun
from nocturne_scene.spectra.constants import AVOGADRO
from nocturne_scene.spectra.named_responses import RESPONSES
from nocturne_scene.spectra.published import _colour
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange, means

from tests.scene.conftest import Compile

UV, NIR, ALL = WavelengthRange(280.0, 400.0), WavelengthRange(900.0, 2500.0), WavelengthRange(200.0, 2500.0)
Document = dict[str, Any]


def meter(within: WavelengthRange | None, radiance: Any, **sensor: Any) -> Document:
    """A film of one side under an even sky."""
    return {
        "nocturne": 1,
        **({} if within is None else {"wavelengths": {"first": int(within.first), "last": int(within.last)}}),
        "sensor": {
            "type": "irradiance_meter",
            "position": [0, 0, 0],
            "normal": [0, 1, 0],
            "height": 1,
            **sensor,
        },
        "surfaces": [
            {
                "shape": {"type": "sphere", "centre": [0, -9, 0], "radius": 1},
                "kernel": {"type": "lambertian", "reflectance": 0.5},
            }
        ],
        "environment": {"radiance": radiance},
    }


def problems(document: Document) -> str:
    with pytest.raises(InputError) as caught:
        check_document(document)
    return str(caught.value)


# --- documents ---


def test_a_scene_that_says_nothing_is_the_one_that_says_360_to_830(compiled: Compile) -> None:
    usual = compiled(meter(None, 1.0))
    assert compiled(meter(VISIBLE, 1.0)) == usual
    assert usual.format == 3
    assert not schedule_of(usual, 8, 8, 16).last_nm


def test_the_sensor_of_a_range_has_its_grid(compiled: Compile) -> None:
    scene = compiled(meter(ALL, 1.0, named_responses=["radiant"]))
    sensor = scene.sensor
    assert (scene.format, range_of(sensor)) == (7, ALL)
    assert len(sensor.response_y) == len(sensor.further_responses[0].values) == 2301
    y, at = np.array(sensor.response_y), ALL.grid()
    usual = compiled(meter(None, 1.0)).sensor
    assert y[(at >= 360) & (at <= 830)].tolist() == list(usual.response_y)
    assert not y[(at < 360) | (at > 830)].any()
    assert wavelengths_of(schedule_of(scene, 8, 8, 16)) == ALL


@pytest.mark.parametrize(
    ("wavelengths", "words"),
    [
        ({"first": 199, "last": 400}, "$.wavelengths.first"),
        ({"first": 360, "last": 2501}, "$.wavelengths.last"),
        ({"first": 500, "last": 500}, "$.wavelengths.last: expected more than first, 500 nm"),
        ({"first": 360.5, "last": 830}, "$.wavelengths.first"),
    ],
)
def test_a_range_is_of_whole_nanometres_within_bounds(wavelengths: Document, words: str) -> None:
    assert words in problems(meter(None, 1.0) | {"wavelengths": wavelengths})


def test_luminance_needs_all_that_the_eye_sees() -> None:
    assert "$.wavelengths: the sensor's X, Y and Z are of 360 to 830 nm" in problems(meter(UV, 1.0))
    check_document(meter(UV, 1.0, measures="radiant"))


def test_bands_lie_in_the_range() -> None:
    document = meter(UV, 1.0, measures="radiant", bands={"first": 280, "last": 410, "width": 10})
    assert "$.sensor.bands: reach from 280 to 410 nm" in problems(document)


def test_a_published_response_keeps_its_name_for_itself() -> None:
    assert '"PAR" is a published response' in problems(meter(None, 1.0, responses={"PAR": 1.0}))


def test_a_response_without_any_of_the_range_is_refused(compiled: Compile) -> None:
    with pytest.raises(InputError, match=r'\$\.sensor\.measures: "erythemal" is of 250 to 400 nm'):
        compiled(meter(NIR, 1.0, measures="erythemal"))


def test_responses_to_colour_are_of_the_range(compiled: Compile) -> None:
    """Each has its integral over the default range's grid, which has the same step."""
    wide = compiled(meter(ALL, 1.0, colour=True)).sensor.further_responses
    visible = compiled(meter(None, 1.0, colour=True)).sensor.further_responses
    assert {len(each.values) for each in wide} == {len(ALL.grid())}
    assert [each.name for each in wide] == [each.name for each in visible]
    np.testing.assert_allclose([sum(each.values) for each in wide], [sum(each.values) for each in visible])
    with pytest.raises(InputError, match="380 to 780 nm"):
        compiled(meter(UV, 1.0, colour=True, measures="radiant"))


def test_a_lamp_without_light_in_the_range_is_left_out(compiled: Compile) -> None:
    document = meter(UV, {"lines": [{"nm": 546.1, "power": 1}]}, measures="radiant")
    with pytest.raises(InputError, match="no luminaire emits light from 280 to 400 nm"):
        compiled(document)


def test_what_is_measured_has_its_unit(compiled: Compile) -> None:
    told = {
        "radiant": ("irradiance", "W m-2"),
        "erythemal": ("erythemal irradiance", "W m-2"),
        "photons": ("photon flux density", "umol m-2 s-1"),
        "PAR": ("photosynthetic photon flux density", "umol m-2 s-1"),
    }
    for name, (quantity, unit) in told.items():
        found = quantity_of(compiled(meter(ALL, 1.0, measures=name)).sensor)
        assert (found.name, found.unit, found.response_unit) == (quantity, unit, "W m-2")
        assert quantity_named(quantity) == found
    names = ["X", "Y", "Z", "PAR", "S0.555,000000nm"]
    assert quantity_named("illuminance").of_channel("PAR", names) == ("PAR", "umol m-2 s-1")
    assert quantity_named("luminance").of_channel("PAR", names) == ("PAR", "umol m-2 sr-1 s-1")
    assert quantity_named("illuminance").of_channel(names[-1], names)[1] == "W m-2"


# --- published spectra ---


def test_sunlight_has_the_integrals_of_astm_g173() -> None:
    # ASTM G173-03: 1000.4 W/m2 on the tilted plane and 900.1 W/m2 direct, from 280 to 4000 nm.
    for name, whole in (("global", 1000.4), ("direct", 900.1)):
        wavelengths, values = solar.table(name)  # type: ignore[arg-type]
        assert np.trapezoid(values, wavelengths) == pytest.approx(whole, abs=0.2)
        cut = wavelengths <= 2500
        compiled = spectra.radiance(SolarSpectrum(solar=name), ALL)  # type: ignore[arg-type]
        ours = float(spectra.integral(compiled, np.ones(2301), ALL))
        assert ours == pytest.approx(np.trapezoid(values[cut], wavelengths[cut]), rel=1e-5)


def test_the_sun_above_the_air_keeps_its_visible_bits_and_the_integral_of_its_table() -> None:
    wide = sun.irradiance(ALL)
    at = ALL.grid()
    assert np.array_equal(wide[(at >= 360) & (at <= 830)], sun.irradiance())
    wavelengths, values = solar.table("extraterrestrial")
    cut = wavelengths <= 2500
    assert np.trapezoid(wide, at) == pytest.approx(np.trapezoid(values[cut], wavelengths[cut]), rel=1e-4)
    assert not wide[at < 279].any()


@pytest.mark.parametrize("kelvin", [2856.0, 5772.0])
@pytest.mark.parametrize("within", [UV, NIR, ALL, VISIBLE])
def test_a_black_body_has_the_fraction_of_its_band(kelvin: float, within: WavelengthRange) -> None:
    compiled = spectra.radiance(BlackbodySpectrum(blackbody=kelvin), within)
    ours = float(np.trapezoid(spectra.evaluate(compiled, within.grid()), within.grid()))
    stefan_boltzmann = 5.670374419e-8 * kelvin**4 / math.pi
    below = [planck_fraction(nm * 1e-9 * kelvin) for nm in (within.first, within.last)]
    # The trapezoid rule each nm, where the Planck curve rises by its 21st power.
    assert ours == pytest.approx(stefan_boltzmann * (below[1] - below[0]), rel=2e-4)


def planck_fraction(metre_kelvin: float) -> float:
    """Of a black body's radiance below a wavelength: the series of Chang and Rhee (1984)."""
    x = published.PLANCK * published.LIGHT_SPEED / published.BOLTZMANN / metre_kelvin
    terms = (math.exp(-n * x) * (x**3 / n + 3 * x**2 / n**2 + 6 * x / n**3 + 6 / n**4) for n in range(1, 200))
    return 15 / math.pi**4 * sum(terms)


def test_means_keep_the_integral_of_any_table() -> None:
    knots = np.array([281.3, 300.0, 300.25, 399.9])
    values = np.array([0.0, 2.0, 1.0, 3.0])
    assert np.trapezoid(means(knots, values, UV), UV.grid()) == pytest.approx(np.trapezoid(values, knots))


# --- responses by name ---


def test_photons_are_counted_as_si_counts_them() -> None:
    # A photon of 555 nm has h c / l; a micromole 6.022e17 of them.
    joules = published.PLANCK * published.LIGHT_SPEED / 555e-9 * AVOGADRO * 1e-6
    at = ALL.grid()
    assert RESPONSES["photons"].within(ALL)[at == 555] == pytest.approx(1 / joules)
    par = RESPONSES["PAR"].within(ALL)
    # Of one watt per nm, in closed form: the integral of l from 400 to 700 nm.
    factor = 1e-3 / (published.PLANCK * published.LIGHT_SPEED * AVOGADRO)
    assert np.trapezoid(par, at) == pytest.approx(factor * (700**2 - 400**2) / 2, rel=1e-9)


def test_illuminant_a_has_its_published_photons_per_lumen() -> None:
    # 20.3 umol/s per klm for incandescent light: McCree 1981 as in R. W. Thimijan and R. D. Heins,
    # "Photometric, radiometric, and quantum light units of measure", HortScience 18, 1983: 50 lx per umol.
    at = WavelengthRange(380.0, 780.0).grid()
    values = np.interp(at, *published.illuminant("A"))
    lumens = (
        published.MAX_LUMINOUS_EFFICACY
        * values
        @ np.interp(at, VISIBLE.grid(), published.observer("CIE 1931 2 degree")[:, 1])
    )
    assert lumens / (values @ RESPONSES["PAR"].at(at)) == pytest.approx(50, rel=0.02)


def test_erythemal_weights_are_those_of_iso_cie_17166() -> None:
    at = WavelengthRange(250.0, 400.0).grid()
    values = dict(zip(at.tolist(), RESPONSES["erythemal"].within(WavelengthRange(250.0, 400.0)), strict=True))
    # Its formula at the ends of its parts, and at 311 nm of narrow-band lamps.
    assert values[250.0] == values[298.0] == 1
    assert values[311.0] == pytest.approx(10 ** (0.094 * -13))
    assert values[328.0] == pytest.approx(1.5136e-3, rel=1e-3)
    assert values[400.0] == pytest.approx(10 ** (0.015 * -260))


def test_actinic_weights_are_those_of_icnirp() -> None:
    at = ALL.grid()
    values = RESPONSES["actinic"].within(ALL)
    # ICNIRP 2004, table 1; and the exposure of 30 J/m2 at 270 nm, 60 at the mercury line of 254 nm.
    for nm, weight in (
        (200, 0.03),
        (222, None),
        (254, 0.5),
        (270, 1.0),
        (302, None),
        (313, 0.006),
        (365, 1.1e-4),
    ):
        if weight is not None:
            assert values[at == nm] == pytest.approx(weight)
    # IEC 62471 tells the logarithm between: table of IES RP-27 as guv-calcs 0.10 has it.
    assert values[at == 222] == pytest.approx(0.131203, rel=1e-5)
    assert not values[at > 400].any()


# --- media ---


@pytest.mark.parametrize("nm", [250.0, 300.0, 350.0, 400.0, 900.0, 1000.0, 1600.0])
def test_air_scatters_beyond_the_visible_as_bodhaine_says(nm: float) -> None:
    # Equations 22 to 26, from the refractive index of air, by colour-science; ours is the fit of equation 29.
    told = _colour().phenomena
    cross_section = told.scattering_cross_section(np.array([nm * 1e-7]), 360.0, 288.15)[0]
    assert rayleigh.cross_section(np.array([nm]))[0] * 1e4 == pytest.approx(cross_section, rel=1e-3)
    king = told.rayleigh.F_air_Bodhaine1999(np.array([nm * 1e-3]), 360.0)[0]
    ratio = 6 * (king - 1) / (7 * king + 3)
    assert rayleigh.depolarisation(np.array([nm]))[0] == pytest.approx(ratio, rel=1e-3)


def test_ozone_absorbs_ultraviolet() -> None:
    # At the mercury line, 253.65 nm: 11.3329(+-0.31 %)e-18 cm2 at 296 K (CCQM 2019 consensus: 11.329); colder
    # by less than 1 %.
    assert presets.ozone_cross_section(np.array([253.65]))[0] * 1e4 == pytest.approx(11.329e-18, rel=0.01)
    visible = presets.ozone_cross_section(VISIBLE.grid())
    wide = presets.ozone_cross_section(ALL.grid())
    assert np.array_equal(wide[160:631], visible)
    assert not wide[ALL.grid() > 1065].any()


# --- ends of tables ---


def sentences(document: Document, blobs: BlobStore) -> list[str]:
    return [warning.sentence for warning in compile_scene(check_document(document), blobs).warnings]


def test_what_ends_within_the_range_is_said(blobs: BlobStore) -> None:
    document = meter(WavelengthRange(280.0, 900.0), {"illuminant": "D65", "luminance": 10})
    document["surfaces"][0]["kernel"]["reflectance"] = {"table": [[380, 0.2], [730, 0.5]]}
    document["spectra"] = {"unused": {"table": [[400, 1], [500, 1]]}}
    told = sentences(document, blobs)
    assert told == [
        "$.surfaces[0].kernel.reflectance: its table is known from 380 to 730 nm, and the scene is of 280 to "
        "900 nm; the values at its ends are held beyond",
        "$.environment.radiance: the illuminant is known from 300 to 830 nm, and the scene is of 280 to 900 "
        "nm; it is dark beyond",
    ]
    del document["wavelengths"]
    assert not sentences(document, blobs)


def test_a_table_that_says_what_is_outside_is_not_told(blobs: BlobStore) -> None:
    document = meter(WavelengthRange(280.0, 900.0), 1.0)
    document["surfaces"][0]["kernel"]["reflectance"] = {"table": [[380, 0.2], [730, 0.5]], "outside": "zero"}
    assert not sentences(document, blobs)


def test_watts_are_those_of_the_range(compiled: Compile) -> None:
    document = meter(WavelengthRange(200.0, 300.0), 1.0, measures="radiant")
    del document["environment"]
    document["surfaces"][0]["luminaire"] = {
        "watts": 20,
        "radiance": {"lines": [{"nm": 253.65, "power": 1}, {"nm": 546.1, "power": 5}]},
    }
    scene = compiled(document)
    emitted = scene.spectra[scene.luminaires[0].radiance.spectrum]
    seen = next(line for line in emitted.lines if line.centre_nm < 300)
    # A sphere of 1 m: 20 W over pi and its area.
    assert seen.power == pytest.approx(20 / (math.pi * 4 * math.pi), rel=1e-6)


def test_a_colour_is_held_beyond_the_visible(blobs: BlobStore) -> None:
    """Its formula would go to 0 or 1: fog that only scatters, and rooms that light never leaves."""
    wide = spectra.reflectance(RgbSpectrum(rgb=(0.24, 0.11, 0.19)), ALL)
    usual = spectra.reflectance(RgbSpectrum(rgb=(0.24, 0.11, 0.19)))
    assert spectra.evaluate(wide, VISIBLE.grid()).tolist() == list(usual.values)
    ends = spectra.evaluate(wide, np.array([200.0, 2500.0]))
    assert ends.tolist() == [usual.values[0], usual.values[-1]]
    document = meter(ALL, 1.0)
    document["surfaces"][0]["kernel"]["reflectance"] = {"rgb": [0.24, 0.11, 0.19]}
    assert sentences(document, blobs)[0].endswith("the values at its ends are held beyond")


def test_light_between_two_whole_nm_is_light(compiled: Compile) -> None:
    peak = {"table": [[587.51, 0.0], [587.56, 1.0], [587.61, 0.0]], "outside": "zero"}
    assert compiled(meter(None, peak)).HasField("environment")
    dark = {"table": [[850.2, 0.0], [850.4, 1.0], [850.6, 0.0]], "outside": "zero"}
    with pytest.raises(InputError, match="no luminaire emits visible light"):
        compiled(meter(None, dark))


@pytest.mark.parametrize("glass", indices.dielectrics())
def test_every_glass_has_an_index_from_200_to_2500_nm(glass: str) -> None:
    """N-SF11's formula has a pole at 250 nm, and no index from there to 237 nm."""
    glass_n, (first, _) = indices.dielectric(glass).n, indices.dielectric(glass).valid
    compiled = indices.compile_dielectric(glass_n, ALL)
    assert compiled.values[0] == pytest.approx(float(glass_n(np.array([max(200.0, min(first, 360.0))]))[0]))
    assert list(compiled.values) == sorted(compiled.values, reverse=True)
