"""Published spectra give the published colours."""

import warnings
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from nocturne_scene.compile import spectra
from nocturne_scene.spectra import published, sun
from numpy.typing import NDArray

Floats = NDArray[np.float64]
WAVELENGTHS = published.visible_wavelengths()


def cmf() -> Floats:
    return published.observer("CIE 1931 2 degree")


def shape_of(illuminant: str) -> Floats:
    return np.interp(WAVELENGTHS, *published.illuminant(illuminant))


def xy(xyz: Floats) -> Floats:
    return np.asarray(xyz[:2] / xyz.sum())


@pytest.mark.parametrize(
    ("name", "x", "y"),
    # 1 nm sums of the CIE 1931 table with the tables of CIE 015.
    [
        ("E", 0.33331438, 0.33328771),
        ("D65", 0.31272695, 0.32902322),
        ("D50", 0.34568422, 0.35850409),
        ("A", 0.44757355, 0.40743939),
    ],
)
def test_whites(name: str, x: float, y: float) -> None:
    assert xy(shape_of(name) @ cmf()) == pytest.approx((x, y), abs=2e-7)


@pytest.mark.parametrize(
    ("name", "x", "y"),
    # CIE 015:2018, tables T.3 and T.8 to T.12, as published to four or five places.
    [
        ("C", 0.31006, 0.31616),
        ("D55", 0.33243, 0.34744),
        ("D75", 0.29903, 0.31488),
        ("FL2", 0.3721, 0.3751),
        ("FL7", 0.3129, 0.3292),
        ("FL11", 0.3805, 0.3769),
        ("LED-B1", 0.4560, 0.4078),
        ("HP1", 0.5330, 0.4150),
    ],
)
def test_more_illuminants(name: str, x: float, y: float) -> None:
    # Each 5 nm, as the tables were made.
    assert xy(shape_of(name)[::5] @ cmf()[::5]) == pytest.approx((x, y), abs=2e-4)


def test_every_illuminant_is_there_and_positive() -> None:
    for name in published.ILLUMINANTS:
        wavelengths, values = published.illuminant(name)
        assert np.all(np.diff(wavelengths) > 0)
        assert np.all(values >= 0)
        assert shape_of(name) @ cmf()[:, 1] > 0


def test_the_wide_observer_has_its_published_sums() -> None:
    # CIE 015:2018, table T.5, 1 nm from 360 to 830 nm: equal energy is white.
    sums = published.observer("CIE 1964 10 degree").sum(axis=0)
    assert sums == pytest.approx([116.6485, 116.6616, 116.6737], rel=2e-4)


@pytest.mark.parametrize(
    ("name", "bias"),
    [
        ("E", (-9.717e-05, -4.593e-06, -0.0004319)),
        ("D65", (-5.304e-05, -2.594e-06, -0.0002031)),
        ("A", (-1.861e-05, -4.832e-06, -0.0001016)),
    ],
)
def test_light_outside_of_380_to_780_nm(name: str, bias: tuple[float, ...]) -> None:
    inside = (WAVELENGTHS >= 380) & (WAVELENGTHS <= 780)
    products = shape_of(name)[:, None] * cmf()
    assert products[inside].sum(axis=0) / products.sum(axis=0) - 1 == pytest.approx(bias, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "first", "last", "deviations"),
    [
        ("E", 360, 830, (1.4029, 1.478, 2.1879)),
        ("E", 380, 780, (1.236, 1.3082, 1.9827)),
        ("A", 360, 830, (1.6401, 1.4971, 2.1036)),
    ],
)
def test_spread_of_uniform_wavelengths(
    name: str, first: int, last: int, deviations: tuple[float, ...]
) -> None:
    drawn = (first <= WAVELENGTHS) & (last >= WAVELENGTHS)
    products = (shape_of(name)[:, None] * cmf())[drawn]
    assert products.std(axis=0) / products.mean(axis=0) == pytest.approx(deviations, rel=1e-3)


@pytest.mark.parametrize(
    ("temperature", "luminance", "x", "y"),
    # Planck's law with the constants of SI 2019, K_m = 683.002 lm/W.
    [
        (2042.15, 599126.67, 0.52211207, 0.41393796),
        (2856, 19749784.0, 0.44753514, 0.40742829),
        (5772, 1843714300.0, 0.32655303, 0.33583366),
        (6500, 3072528000.0, 0.31352588, 0.3236283),
    ],
)
def test_black_bodies(temperature: float, luminance: float, x: float, y: float) -> None:
    xyz = published.planck(temperature, WAVELENGTHS) @ spectra.response()
    assert xyz[1] * 683.002 / 683 == pytest.approx(luminance, rel=3e-6)
    assert xy(xyz) == pytest.approx((x, y), rel=3e-6)


# XYZ of BabelColor's averages, linear between 10 nm and held beyond; sums each nm, CIE 1931.
CHART = {
    "dark skin": ((12.06216, 10.34029, 6.25232), (11.14691, 10.07746, 6.80555), (14.72191, 11.22249, 2.2441)),
    "blue sky": (
        (18.09714, 18.51889, 31.63971),
        (17.64797, 18.8509, 34.44192),
        (17.40725, 17.33385, 11.0567),
    ),
    "foliage": ((11.16983, 13.23338, 6.37378), (10.5978, 13.30807, 6.95266), (12.73113, 13.11439, 2.3779)),
    "bluish green": (
        (31.67382, 41.61956, 40.77983),
        (30.96576, 42.6317, 44.87831),
        (31.82807, 38.31283, 15.33576),
    ),
    "orange": ((40.85318, 31.23354, 5.82771), (37.13019, 29.6839, 6.3449), (52.89647, 36.38307, 2.18591)),
    "purplish blue": (
        (13.59983, 11.54209, 35.29261),
        (13.55191, 11.83944, 38.57687),
        (11.35478, 10.40031, 12.15175),
    ),
    "purple": ((8.95093, 6.47863, 13.05525), (8.39934, 6.37328, 13.97656), (9.73382, 6.81575, 4.26314)),
    "yellow green": (
        (35.66936, 44.01679, 10.34699),
        (33.66172, 44.13656, 11.39116),
        (42.01601, 43.97653, 4.42803),
    ),
    "blue": ((7.80231, 5.91089, 25.64315), (7.96631, 6.13963, 28.21672), (5.62882, 5.02343, 8.88045)),
    "red": ((22.28307, 12.79555, 4.62586), (19.62308, 11.75373, 5.02821), (31.22422, 16.40548, 1.64146)),
    "yellow": ((60.66212, 60.50189, 8.49207), (56.03279, 59.36426, 9.32461), (75.9255, 64.73515, 3.72223)),
    "cyan": ((14.52463, 19.12266, 35.57189), (14.65937, 19.97857, 39.2748), (12.15755, 16.13185, 13.17822)),
    "white": (
        (90.76073, 91.26743, 87.18182),
        (86.21545, 91.23491, 95.30846),
        (100.46799, 91.40314, 31.39584),
    ),
    "neutral 8": (
        (58.51961, 58.84063, 58.29627),
        (55.66337, 58.86058, 63.61755),
        (64.27283, 58.77646, 20.85608),
    ),
    "neutral 5": (
        (18.98637, 19.11541, 19.14189),
        (18.07125, 19.12789, 20.86956),
        (20.77683, 19.07233, 6.82726),
    ),
    "black": ((3.21095, 3.20075, 3.25474), (3.05254, 3.20081, 3.53991), (3.51821, 3.20024, 1.15359)),
}


@pytest.mark.parametrize("patch", CHART)
def test_chart_patches(patch: str) -> None:
    reflectance = np.interp(WAVELENGTHS, *published.chart_patch(patch))
    for name, expected in zip(("E", "D65", "A"), CHART[patch], strict=True):
        light = shape_of(name)[:, None] * cmf()
        xyz = 100 * reflectance @ light / light[:, 1].sum()
        assert xyz == pytest.approx(expected, abs=2e-5)


def test_the_chart_has_24_patches() -> None:
    assert len(published.CHART_PATCHES) == 24
    for name in published.CHART_PATCHES:
        wavelengths, values = published.chart_patch(name)
        assert (wavelengths[0], wavelengths[-1], len(values)) == (380, 730, 36)


def test_the_sun_has_its_illuminance() -> None:
    # ASTM G173-03, extraterrestrial, 1 nm sum with K_m = 683.002 lm/W.
    xyz = sun.irradiance() @ cmf()
    assert xyz[1] * 683.002 == pytest.approx(133100.8, rel=1e-5)
    assert xy(xyz) == pytest.approx((0.32337981, 0.3326608), abs=1e-7)
    solid_angle = np.pi * np.sin(sun.half_angle()) ** 2
    assert solid_angle == pytest.approx(6.7999247e-05, rel=1e-6)
    assert xyz[1] * 683.002 / solid_angle == pytest.approx(1.9573864e9, rel=1e-5)


def test_the_sun_is_that_of_the_standards_table() -> None:
    """All columns of ASTM G173-03: power from 280 to 4000 nm, and illuminances below air mass 1.5 on a tilted
    plane and across the beam, by the sum over our wavelengths."""
    with warnings.catch_warnings():
        # Of packages that colour-science would plot with.
        warnings.simplefilter("ignore")
        tables = import_module("colour.plotting.datasets.astm_g_173")
    space, tilted, across = (
        np.array(list(getattr(tables, f"DATA_ASTMG173_{column}").items())).T
        for column in ("ETR", "GLOBAL_TILT", "DIRECT_CIRCUMSOLAR")
    )
    assert np.trapezoid(space[1], space[0]) == pytest.approx(1347.934, rel=1e-6)
    assert np.array_equal(np.interp(WAVELENGTHS, *space), sun.irradiance())
    for table, lux in ((tilted, 109495.2), (across, 97142.534)):
        assert 683.002 * np.interp(WAVELENGTHS, *table) @ cmf()[:, 1] == pytest.approx(lux, rel=1e-5)


@pytest.mark.parametrize("darkened", [False, True])
def test_the_suns_disc_gives_its_irradiance_back(darkened: bool) -> None:
    disc = sun.sun(darkened=darkened)
    # Over mu: solid angle times cosine is 2 pi sin^2(half angle) mu dmu.
    mu, weights = np.polynomial.legendre.leggauss(20)
    mu, weights = (mu + 1) / 2, weights / 2
    centre = spectra.evaluate(disc.radiance, WAVELENGTHS)
    darkening = np.ones((len(WAVELENGTHS), len(mu)))
    if darkened:
        pairs = zip(disc.limb_plus, disc.limb_minus, strict=True)
        a = [
            spectra.evaluate(plus, WAVELENGTHS) - spectra.evaluate(minus, WAVELENGTHS)
            for plus, minus in pairs
        ]
        darkening = np.stack(a, axis=1) @ mu ** np.arange(6)[:, None]
    irradiance = centre * 2 * np.pi * np.sin(disc.half_angle) ** 2 * (darkening @ (weights * mu))
    assert irradiance == pytest.approx(sun.irradiance(), rel=1e-6)


def test_limb_darkening_has_the_means_that_its_authors_give() -> None:
    rows = np.array(published.data_file("sun.toml")["limb_darkening"]["rows"])
    a = rows[:, 1:7]
    assert a.sum(axis=1) == pytest.approx(1, abs=2.1e-5)
    assert a @ (2 / (np.arange(6) + 2)) == pytest.approx(rows[:, 7], abs=7e-5)
    darkening = sun.limb_darkening()
    for mu in (0.0, 0.1, 0.5, 1.0):
        values = darkening @ mu ** np.arange(6)
        assert np.all((values > 0.05) & (values < 1 + 1e-9))


@pytest.mark.parametrize("damage", [b"", b"\x93NUMPY\x01\x00 not a table"])
def test_a_table_is_read_once_and_again_if_it_is_damaged(
    damage: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    read = published.observer.__wrapped__
    first = read("CIE 1931 2 degree")
    [kept] = (tmp_path / "nocturne").iterdir()
    with monkeypatch.context() as without:
        without.setattr(published, "_colour", lambda: pytest.fail("colour-science was asked again"))
        assert read("CIE 1931 2 degree").tobytes() == first.tobytes()
    kept.write_bytes(damage)
    assert read("CIE 1931 2 degree").tobytes() == first.tobytes()
    assert np.load(kept).tobytes() == first.tobytes()
