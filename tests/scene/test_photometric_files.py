"""Photometric files are read as the standard says, read back as written, and refused where they are wrong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nocturne_scene.photometry import ies as photometric_files
from nocturne_scene.photometry.intensities import BadPhotometryError, Photometry, flux, scaled


def file(
    horizontal: str, rows: str, *, head: str = "IESNA:LM-63-2002", tail: str = "1 1 100", kind: int = 1
) -> bytes:
    count = len(horizontal.split())
    return (
        f"{head}\n[MANUFAC] Nobody\n[MORE] at all\nTILT=NONE\n2 500 2 3 {count} {kind} 1 1 2 0\n{tail}\n"
        f"0 45 90\n{horizontal}\n{rows}\n"
    ).encode()


def test_numbers_and_keywords() -> None:
    found = photometric_files.read(file("0", "100 70 0", tail="0.5 3 42"))
    assert found.keywords == {"MANUFAC": "Nobody\nat all"}
    assert found.candela == pytest.approx(np.array([[100, 70, 0]]))  # 2 x 0.5; the 3 is kept for future use
    assert found.lamp_lumens == 1000
    assert found.opening == pytest.approx((0.3048, 0.6096, 0))
    assert found.input_watts == 42


def test_the_ballast_lamp_factor_of_old_files() -> None:
    for head in ("IESNA91", "[TEST] 1986 has no first line"):
        found = photometric_files.read(file("0", "100 70 0", head=head, tail="0.5 3 42"))
        assert found.candela[0, 0] == pytest.approx(300)


# https://github.com/dlippok/photometric-viewer/issues/127 and
# https://github.com/PixarAnimationStudios/OpenUSD/issues/2758 and /3182: first lines of files that are about.
@pytest.mark.parametrize(
    ("head", "third_counts"),
    [
        ("IESNA: LM-63-2002", False),
        ("iesna:lm-63-2002", False),
        ("  IESNA : LM-63-2002 ", False),
        ("IESNA:LM-63-1995", False),
        # ANSI/IES LM-63-19, whose third number says how the file was made.
        ("IES:LM-63-2019", False),
        ("IES: LM-63-19", False),
        ("IESNA91", True),
        ("IESNA:LM-63-1991", True),
        ("IESNA 86", True),
        ("IESNA LIGHTING FIXTURE", True),
        ("A lamp", True),
        ("\n\nIESNA:LM-63-2002", False),
    ],
)
def test_first_lines(head: str, third_counts: bool) -> None:
    found = photometric_files.read(file("0", "100 70 0", head=head, tail="0.5 3 42"))
    assert found.candela[0, 0] == pytest.approx(300 if third_counts else 100)


@pytest.mark.parametrize(
    "tilt", ["tilt=none", "TILT = NONE", "Tilt=None", "  TILT=NONE", "TILT=include\n1 1 0 1"]
)
def test_tilt_in_letters_of_either_case(tilt: str) -> None:
    data = file("0", "100 70 0").replace(b"TILT=NONE", tilt.encode())
    assert photometric_files.read(data).candela[0, 0] == 200


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "\t\r\n", "\n\n"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
def test_text_of_other_systems(encoding: str, end: str) -> None:
    """https://github.com/IfcOpenShell/IfcOpenShell/issues/4256: with a byte order mark the version was not
    seen.
    """
    text = file("0", "100\t70\t0", tail="0.5 3 42").decode().replace("Nobody", "Bü…ro")
    if encoding == "latin-1":
        # Of Windows, where 0x85 is no end of a line.
        data = text.replace("\n", end).encode("cp1252")
        expected = "Bü\x85ro"
    else:
        data, expected = text.replace("\n", end).encode(encoding), "Bü…ro"
    found = photometric_files.read(data)
    assert found.candela[0, 0] == 100
    assert found.keywords["MANUFAC"].split("\n")[0] == expected


@pytest.mark.parametrize(
    ("horizontal", "rows", "at_30", "at_210", "at_330"),
    [
        ("0 90", "1 1 1  4 4 4", 2, 2, 2),
        ("0 90 180", "1 1 1  4 4 4  7 7 7", 2, 6, 2),
        ("90 180 270", "1 1 1  4 4 4  7 7 7", 3, 5, 5),
        ("90 270", "1 1 1  7 7 7", 3, 5, 5),
        ("0 90 180 270 360", "1 1 1  4 4 4  7 7 7  10 10 10  1 1 1", 2, 8, 4),
        ("0 90 180 270", "1 1 1  4 4 4  7 7 7  10 10 10", 2, 8, 4),
    ],
)
def test_symmetries(horizontal: str, rows: str, at_30: float, at_210: float, at_330: float) -> None:
    found = photometric_files.read(file(horizontal, rows))
    assert (found.horizontal[0], found.horizontal[-1]) == (0, 360)
    values = np.interp([30, 210, 330], found.horizontal, found.candela[:, 0]) / 2
    assert values == pytest.approx([at_30, at_210, at_330])


def test_a_tilt_table_is_read_past() -> None:
    text = file("0", "100 70 0").replace(b"TILT=NONE", b"TILT=INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8")
    assert photometric_files.read(text).candela[0, 0] == 200


def test_flux_of_distributions_with_an_answer_on_paper() -> None:
    vertical = np.linspace(0, 180, 181)
    even = Photometry(vertical, np.zeros(1), np.ones((1, 181)))
    assert flux(even) == pytest.approx(4 * np.pi)
    around = Photometry(vertical, np.array([0.0, 90.0, 360.0]), np.ones((3, 181)))
    assert flux(around) == pytest.approx(4 * np.pi)
    # Lambert: pi. Straight lines between degrees are wrong by (pi / 180)^2 / 12.
    cosine = np.maximum(np.cos(np.deg2rad(vertical)), 0)[None]
    assert flux(Photometry(vertical, np.zeros(1), cosine)) == pytest.approx(np.pi, rel=3e-5)
    half = scaled(even, 0.5)
    assert flux(half) == pytest.approx(2 * np.pi)


@st.composite
def photometries(draw: st.DrawFn) -> Photometry:
    inner = st.lists(st.integers(1, 1799), max_size=6, unique=True)
    vertical = np.array([0, *sorted(draw(inner)), 1800]) / 10
    horizontal = np.array([0, *sorted(draw(inner)), 3600]) / 10 if draw(st.booleans()) else np.zeros(1)
    values = st.floats(0, 1e6, allow_subnormal=False)
    count = len(vertical) * len(horizontal)
    candela = np.array(draw(st.lists(values, min_size=count, max_size=count)))
    lumens = draw(st.none() | st.floats(0, 1e6))
    words = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=1, max_size=20)
    keywords = draw(st.dictionaries(words.filter(lambda key: key.upper() != "MORE"), words, max_size=3))
    shape = (len(horizontal), len(vertical))
    return Photometry(vertical, horizontal, candela.reshape(shape), lumens, (-0.5, 1.0, 0.0), 12.5, keywords)


@given(photometries())
@settings(max_examples=60)
def test_what_is_written_reads_back(photometry: Photometry) -> None:
    text = photometric_files.write(photometry)
    assert max(len(line) for line in text.splitlines()) <= 256
    found = photometric_files.read(text)
    assert np.array_equal(found.vertical, photometry.vertical)
    assert np.array_equal(found.horizontal, photometry.horizontal)
    assert np.array_equal(found.candela, photometry.candela)
    assert found.lamp_lumens == photometry.lamp_lumens
    assert (found.opening, found.input_watts) == (photometry.opening, photometry.input_watts)
    assert found.keywords == photometry.keywords


@given(st.binary(max_size=400), st.integers(0, 150))
@settings(max_examples=200)
def test_spoiled_files_give_results_or_errors_with_a_line(noise: bytes, at: int) -> None:
    good = file("0 90", "1 1 1  4 4 4")
    places = []
    for data in (noise, good[:at], good[:at] + noise[:3] + good[at:]):
        try:
            photometric_files.read(data)
        except BadPhotometryError as error:
            places.append(error.line)
    assert all(line >= 1 for line in places)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "line 1: there is no line TILT="),
        (file("0", "1 1 1", kind=2), "line 9: 3 vertical angles, horizontal ones from 0 to 0 degrees; "),
        (
            file("-90 -9", "1 1 1 1 1 1", kind=3),
            "expected of type A two or more, and horizontal ones from -90",
        ),
        (file("-91 90", "1 1 1 1 1 1", kind=3), "expected increasing angles within -90 and 90 degrees"),
        (file("0", "1 1"), "line 9: the file ends before a candela value"),
        (file("0", "1 x 1"), 'line 9: expected a candela value, found "x"'),
        (file("0", "1 -1 1"), "negative"),
        (file("0", "1 nan 1"), 'found "nan"'),
        (file("0 30", "1 1 1 1 1 1"), "horizontal angles from 0 to 30"),
        (file("90 0", "1 1 1 1 1 1"), "expected increasing angles"),
        (file("0", "1 1 1").replace(b" 3 1 1 1 ", b" 3 99999999 1 1 "), "a whole number from 1 to 3601"),
        (file("0", "1 1 1").replace(b" 3 1 1 1 ", b" 3000 3000 1 1 "), "9000000|3000 x 3000 values"),
        (file("0", "1 1 1").replace(b"TILT=NONE", b"TILT=lamp.tlt"), "refers to another file"),
        (file("0", "1 1 1", head="IESNA:LM-63-2050"), "unknown version"),
        (b"x" * (photometric_files.MAX_BYTES + 1), "at most"),
    ],
)
def test_refused(data: bytes, message: str) -> None:
    with pytest.raises(BadPhotometryError, match=message):
        photometric_files.read(data)
