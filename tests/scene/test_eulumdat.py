"""EULUMDAT files say the same light as files of LM-63 that are made of the same numbers."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nocturne_scene.photometry import eulumdat, files, ies
from nocturne_scene.photometry.intensities import BadPhotometryError, Photometry, flux
from numpy.typing import NDArray

GAMMA = np.arange(0.0, 181.0, 5.0)
# How many planes C of 24 are stored, and which one is first, for each symmetry.
STORED = {0: (24, 0), 1: (1, 0), 2: (13, 0), 3: (13, 18), 4: (7, 0)}


def intensity(symmetry: int, c: NDArray[Any]) -> NDArray[np.float64]:
    """cd/klm over C and gamma, with that symmetry."""
    a, g = np.radians(c)[:, None], np.radians(GAMMA)
    around = {
        0: 2 + np.cos(a) + 0.5 * np.sin(a) + 0.2 * np.sin(2 * a),
        1: np.full(a.shape, 2.0),
        2: 2 + np.cos(a) + 0.3 * np.cos(2 * a),
        3: 2 + np.sin(a) + 0.3 * np.cos(2 * a),
        4: 2 + np.cos(2 * a),
    }[symmetry]
    return np.asarray(100 * around * (1.1 + np.cos(g)))


def file(symmetry: int, *, flux: float = 3600, lamps: int = 1, factor: float = 1, **more: Any) -> bytes:
    count, first = STORED[symmetry]
    planes = np.arange(24) * 15.0
    shown = intensity(symmetry, np.arange(first, first + count) * 15.0)
    sets = more.get("sets", 1)
    lines: list[Any] = [
        "Somebody",
        1,
        symmetry,
        24,
        15,
        len(GAMMA),
        5,
        "report",
        "Lamp",
        "N-1",
        "a.ldt",
        "2026",
    ]
    lines += [1200, 300, 60, *more.get("luminous", (1100, 250, 0)), 0, 0, 0, 100, 80, factor, 0, sets]
    lines += [lamps, "LED", flux, 4000, 80, 30] + [1, "other", 99, 2700, 90, 7] * (sets - 1)
    lines += [0.5] * 10 + [*planes, *GAMMA, *shown.ravel()]
    return "\r\n".join(str(line) for line in lines).encode("latin-1")


@pytest.mark.parametrize("symmetry", STORED)
def test_symmetries(symmetry: int) -> None:
    found = files.read(file(symmetry))
    assert found.vertical.tolist() == GAMMA.tolist()
    everywhere = np.arange(25) * 15.0
    expected = 3.6 * intensity(symmetry, everywhere)
    if symmetry == 1:
        assert found.horizontal.tolist() == [0]
        assert found.candela == pytest.approx(expected[:1])
    else:
        assert found.horizontal == pytest.approx(everywhere)
        assert found.candela == pytest.approx(expected)


def test_the_same_as_a_file_of_lm_63() -> None:
    found = files.read(file(4))
    again = files.read(ies.write(found))
    assert np.array_equal(again.candela, found.candela)
    assert again.opening == pytest.approx(found.opening)


def test_an_even_lamps_flux_is_that_of_its_lamps() -> None:
    """1000 / (4 pi) cd/klm in all directions."""
    values = str(1000 / (4 * math.pi))
    lines = file(1, flux=3600).decode().split("\r\n")
    even = "\r\n".join([*lines[: -len(GAMMA)], *[values] * len(GAMMA)]).encode()
    assert flux(files.read(even)) == pytest.approx(3600, rel=1e-3)


def test_what_else_is_said() -> None:
    found = files.read(file(1, lamps=2))
    assert found.lamp_lumens == 3600
    assert found.input_watts == 30
    assert found.opening == pytest.approx((1.1, 0.25, 0))
    assert found.keywords == {"MANUFAC": "Somebody", "TEST": "report", "LUMINAIRE": "Lamp", "LUMCAT": "N-1"}
    assert files.read(file(1, luminous=(200, 0, 0))).opening == pytest.approx((-0.2, -0.2, 0))
    # Absolute photometry, and a factor.
    assert files.read(file(1, lamps=-1)).lamp_lumens is None
    twice = files.read(file(1, factor=2))
    assert twice.candela == pytest.approx(2 * found.candela)
    # Of several sets of lamps the first.
    assert files.read(file(1, sets=2)).candela == pytest.approx(found.candela)


@pytest.mark.parametrize("change", [("\r\n", "\n"), ("\r\n", "\r"), (".", ","), ("Somebody", "B\xfcro")])
def test_text_of_other_systems(change: tuple[str, str]) -> None:
    expected = files.read(file(3))
    found = files.read(file(3).decode("latin-1").replace(*change).encode("latin-1"))
    assert found.candela == pytest.approx(expected.candela)
    found = files.read(b"\xef\xbb\xbf" + file(3))
    assert found.candela == pytest.approx(expected.candela)


def changed(line: int, text: str, symmetry: int = 2) -> bytes:
    lines = file(symmetry).split(b"\r\n")
    lines[line - 1] = text.encode()
    return b"\r\n".join(lines)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\r\n".join(file(2).split(b"\r\n")[:60]), "ends before an angle C"),
        (file(2)[:-3000], "ends before an intensity"),
        (changed(4, "25"), "line 4: 25 C-planes; expected a multiple of 2"),
        (changed(24, "bright"), 'line 24: expected the conversion factor, found "bright"'),
        (changed(26, "0"), "line 26: expected the number of sets of lamps, a whole number from 1"),
        (changed(45, "0"), "expected increasing angles C"),
        (changed(46, "65536"), "expected increasing angles C within 0 and 360 degrees"),
        (changed(70, "500"), "expected increasing angles gamma"),
        (changed(120, "-1"), "an intensity is negative"),
        (changed(4, "3000").replace(b"\r\n37\r\n", b"\r\n3000\r\n"), "9000000|3000 x 3000 values"),
    ],
)
def test_refused(data: bytes, message: str) -> None:
    with pytest.raises(BadPhotometryError, match=message):
        files.read(data)


@given(st.binary(max_size=40), st.integers(0, 3000))
@settings(max_examples=200)
def test_spoiled_files_give_results_or_errors_with_a_line(noise: bytes, at: int) -> None:
    good, places = file(4), []
    for data in (good[:at], good[:at] + noise + good[at:]):
        try:
            assert isinstance(files.read(data), Photometry)
        except BadPhotometryError as error:
            places.append(error.line)
    assert all(line >= 1 for line in places)


@pytest.mark.parametrize("symmetry", STORED)
@pytest.mark.parametrize("lumens", [None, 2500.0])
def test_what_is_written_is_read_again(symmetry: int, lumens: float | None) -> None:
    """With the planes that its symmetry needs, the same light, and the flux that the file states."""
    read = files.read(file(symmetry))
    lamp = Photometry(
        read.vertical, read.horizontal, read.candela, lumens, read.opening, 30.0, {"TEST": "a, b"}
    )
    written = eulumdat.write(lamp)
    lines = written.decode().splitlines()
    assert int(lines[2]) == symmetry
    assert max(map(len, lines)) <= 78
    again = files.read(written)
    assert np.array_equal(again.vertical, lamp.vertical)
    assert again.horizontal == pytest.approx(lamp.horizontal)
    # Twelve digits are written: half a unit of the last is 5e-12 at most.
    assert again.candela == pytest.approx(lamp.candela, rel=6e-12)
    assert again.lamp_lumens == lumens
    assert again.opening == pytest.approx(lamp.opening)
    assert again.input_watts == 30.0
    stated = float(lines[28]) * float(lines[22]) / 100.0
    assert stated == pytest.approx(flux(lamp), rel=1e-12)
    assert flux(again) == pytest.approx(stated, rel=1e-12)


@given(power=st.floats(0.0, 8.0), lumens=st.floats(1.0, 1e6))
@settings(max_examples=30)
def test_cosine_lamps_have_their_flux_and_shine_down(power: float, lumens: float) -> None:
    """I = I0 cos^n has 2 pi I0 / (n + 1); lines between degrees are off by 1e-4 of its second derivative."""
    gamma = np.arange(0.0, 181.0)
    peak = lumens * (power + 1.0) / (2.0 * math.pi)
    values = peak * np.clip(np.cos(np.radians(gamma)), 0.0, None) ** max(power, 1.0)
    true = lumens if power >= 1.0 else math.pi * peak
    lamp = Photometry(gamma, np.zeros(1), values[None], None)
    lines = eulumdat.write(lamp).decode().splitlines()
    assert float(lines[28]) == pytest.approx(true, rel=2e-3)
    assert float(lines[21]) == pytest.approx(100.0, abs=1e-6)
    assert flux(files.read("\n".join(lines).encode())) == pytest.approx(true, rel=2e-3)


def test_a_dark_lamp_has_nothing_to_be_relative_to() -> None:
    with pytest.raises(ValueError, match="emits no light"):
        eulumdat.write(Photometry(GAMMA, np.zeros(1), np.zeros((1, len(GAMMA)))))
