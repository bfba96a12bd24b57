"""Luminaires as XML are read as ANSI/IES TM-33-23 has them, read back as written, and refused where wrong."""

import contextlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nocturne_scene.photometry import files, tm33
from nocturne_scene.photometry.intensities import BadPhotometryError, Photometry, flux
from nocturne_scene.spectra import published

from tests.fuzzing import tried
from tests.scene.formats.test_any_scene import CHANGES, changed
from tests.scene.test_photometric_files import photometries


def file(emitter: str = "", root: str = "IESTM33-22", luminaire: str = "", kind: str = "") -> bytes:
    gear = f"<Equipment><Gonioradiometer><Type>{kind}</Type></Gonioradiometer></Equipment>" if kind else ""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<{root}>\n<Version>1.1</Version>\n<Header>\n'
        "<Manufacturer>Nobody</Manufacturer><Description>B&#252;ro</Description>\n</Header>\n"
        f"<Luminaire><Dimensions><Length>1.2</Length><Width>0.6</Width><Height>0.1</Height></Dimensions>{luminaire}"
        f"</Luminaire>\n{gear}\n{emitter or lambertian()}\n</{root}>\n"
    ).encode()


def lambertian(
    lumens: float = 1000.0, more: str = "", data: str = "LuminousData", name: str = "LuminousIntensity"
) -> str:
    rows = "\n".join(
        f'<IntData h="0" v="{v}">{float(lumens / np.pi * np.cos(np.deg2rad(v)))!r}</IntData>'
        for v in range(91)
    )
    span = (
        "<MinWavelength>400</MinWavelength><MaxWavelength>700</MaxWavelength>"
        if data != "LuminousData"
        else ""
    )
    counts = "<NumberMeasured>91</NumberMeasured><NumberHorz>1</NumberHorz><NumberVert>91</NumberVert>"
    return (
        f"<Emitter><Quantity>1</Quantity><InputWattage>10</InputWattage>\n<{data}>{span}<{name}>{counts}\n{rows}\n"
        f"</{name}></{data}>{more}</Emitter>"
    )


def spectrum(knots: str) -> str:
    pairs = "".join('<PwrData w="{}">{}</PwrData>'.format(*knot.split(":")) for knot in knots.split())
    return f"<SpectralData><EmitterSpectral>{pairs}</EmitterSpectral></SpectralData>"


def test_a_lambertian_of_1000_lm_has_318_cd_at_nadir() -> None:
    found = files.read(file())
    assert found.candela[0, 0] == pytest.approx(318.30989)
    assert flux(found) == pytest.approx(1000, rel=1e-4)
    assert found.opening == (0.6, 1.2, 0.1)
    assert found.keywords == {"MANUFAC": "Nobody", "LUMINAIRE": "Büro"}
    assert found.input_watts == 10
    assert found.spectrum is None


@pytest.mark.parametrize(
    "root",
    [
        "IESTM33",
        "IESTM33-18",
        "ATLA_S001_A",
        "UNI11733",
        'tm:LuminaireOpticalData xmlns:tm="http://www.ies.org/tm-33"',
    ],
)
def test_all_its_kin(root: str) -> None:
    data = file(root=root).replace(f"</{root}>".encode(), f"</{root.split()[0]}>".encode())
    for each in (data, data.replace(b'version="1.0"', b'version="1.1"')):
        assert files.read(each).candela[0, 0] == pytest.approx(318.30989)


def test_emitters_shine_together_each_with_its_light() -> None:
    """400 lm of a blue and 600 lm of a yellow source, whose luminous parts are these."""
    blue, yellow = spectrum("440:0 450:1 460:0"), spectrum("540:0 570:3 600:0")
    found = files.read(file(lambertian(400, blue) + lambertian(600, yellow)))
    assert flux(found) == pytest.approx(1000, rel=1e-4)
    assert found.input_watts == 20
    assert found.spectrum is not None
    nm = published.visible_wavelengths()
    luminous = np.interp(nm, *found.spectrum) * published.observer("CIE 1931 2 degree")[:, 1]
    assert luminous[nm < 500].sum() / luminous.sum() == pytest.approx(0.4, rel=1e-4)


@pytest.mark.parametrize(
    ("data", "name", "per_watt"),
    [
        ("RadiantData", "RadiantIntensity", 1.0),
        # A micromole of photons of 555 nm has N_A h c / 555 nm = 0.215544 J.
        ("PhotonData", "PhotonIntensity", 0.2155437),
    ],
)
def test_watts_and_photons_are_candelas_by_the_spectrum(data: str, name: str, per_watt: float) -> None:
    """Of 555 nm a watt has 683 lm."""
    emitter = lambertian(1000, spectrum("554:0 555:1 556:0"), data, name)
    assert files.read(file(emitter)).candela[0, 0] == pytest.approx(318.30989 * 683 * per_watt, rel=2e-4)


@pytest.mark.parametrize(("kind", "axis"), [("IES_A", (1, 0, 0)), ("IES_B", (0, 0, 1))])
def test_types_a_and_b(kind: str, axis: tuple[int, int, int]) -> None:
    rows = "".join(f'<IntData h="{h}" v="{v}">{100 + h + v}</IntData>' for h in (-90, 0, 90) for v in (-5, 5))
    emitter = f"<Emitter><LuminousData><LuminousIntensity>{rows}</LuminousIntensity></LuminousData></Emitter>"
    found = files.read(file(emitter, kind=kind))
    assert found.axis == axis
    assert sorted(found.candela.ravel()) == [5, 15, 95, 105, 185, 195]


def _spectra() -> st.SearchStrategy[tuple[list[float], list[float]] | None]:
    some = st.lists(st.integers(200, 2500), min_size=2, max_size=5, unique=True).map(sorted)
    return st.none() | some.map(
        lambda nm: ([float(each) for each in nm], [1.0, *(each / 2500 for each in nm[1:])])
    )


@given(photometries(), _spectra())
@tried(60)
def test_what_is_written_reads_back(made: Photometry, light: tuple[list[float], list[float]] | None) -> None:
    absolute = Photometry(made.vertical, made.horizontal, made.candela, None, (0.5, 1.0, 0.0), 12.5)
    known = None if light is None else (np.array(light[0]), np.array(light[1]))
    found = files.read(tm33.write(replace(absolute, spectrum=known)))
    assert np.array_equal(found.vertical, made.vertical)
    assert np.array_equal(found.horizontal, made.horizontal)
    assert np.array_equal(found.candela, made.candela)
    assert (found.opening, found.input_watts) == ((0.5, 1.0, 0.0), 12.5)
    assert (found.spectrum is None) == (known is None)
    if known is not None and found.spectrum is not None:
        assert np.array_equal(found.spectrum, known)


_TWICE = '<IntData h="0" v="0">1</IntData>\n<IntData h="0" v="0">1</IntData>'


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"<a>\n<b>\n</a>", "line 3: is no XML: mismatched tag"),
        (b"<html/>", "line 1: <html> is no luminaire; expected <IESTM33-22>"),
        (b'<!DOCTYPE a [<!ENTITY b "c">]>\n<IESTM33/>', "line 1: declares a document type or entities"),
        (b"<IESTM33>" + b"<a>" * 40, "line 1: elements are nested more than 32 deep"),
        (b"<IESTM33/>", "line 1: 0 elements <Emitter>; expected 1 to 1000"),
        (file("<Emitter/>"), "line 9: no intensities; expected <LuminousData> with <LuminousIntensity>"),
        (file(kind="CUSTOM"), 'line 8: <Type> is "CUSTOM"; expected IES_A, IES_B, IES_C or CIE_C'),
        (
            file(kind="IES_A"),
            "line 10: expected of type A angles v within -90 and 90, and h from -90 or 0 to 90",
        ),
        (file().replace(b'v="3"', b'v="x"'), 'line 14: expected angle v, found "x"'),
        (file().replace(b'v="0">3', b'v="0">-3'), "line 11: <IntData> is -318.31; expected at most"),
        (file().replace(b'v="1"', b'v="0"'), "line 12: <IntData> of h 0 and v 0 once more"),
        (file().replace(b'v="90"', b'v="190"'), "line 10: expected angles v within 0 and 180"),
        (file().replace(b"Vert>91", b"Vert>90"), "line 10: <NumberVert> is 90, and 91 angles are there"),
        (file().replace(b'h="0" v="7"', b'h="9" v="7"'), "<NumberHorz> is 1, and 2 angles are there"),
        (file(lambertian(1, spectrum("500:1"))), "a spectrum without light; expected two <PwrData> or more"),
        (
            file(lambertian(1, spectrum("500:1 500:2"))),
            "<PwrData> of 500 nm is 2; expected each wavelength once",
        ),
        (file(lambertian(1, "", "RadiantData", "RadiantIntensity")), "<RadiantIntensity> without a spectrum"),
        (file(lambertian() + lambertian().replace('v="90"', 'v="95"')), "emitters have different angles"),
    ],
)
def test_refused(data: bytes, message: str) -> None:
    with pytest.raises(BadPhotometryError, match=message.replace("(", r"\(")):
        files.read(data)


@given(st.data())
@tried(100)
def test_damaged_files_are_refused_in_words_or_read(data: st.DataObject) -> None:
    whole = file(lambertian(1000, spectrum("440:0 450:1 460:0")))
    with contextlib.suppress(BadPhotometryError):
        found = files.read(changed(whole, data.draw(CHANGES)))
        assert np.all(np.isfinite(found.candela))
