"""Photometric files: ANSI/IESNA LM-63 of 1986, 1991, 1995, 2002 and 2019, read; type C written.

Letters of first lines and of TILT= count in either case, with or without blanks between their parts, as
programs write them. Numbers follow in the order of LM-63-2002, section 5; words may be split over lines
anywhere. Luminous intensity is in cd over a vertical angle from straight down (the axis, 0 to 180 degrees)
and a horizontal angle about it; types A and B have another axis (types_a_and_b.py).
"""

import io
import math
import re
from collections.abc import Iterator
from typing import Literal

import numpy as np

from nocturne_scene.photometry.intensities import (
    ANGLE_ERROR,
    LARGEST,
    MAX_ANGLES,
    MAX_VALUES,
    BadPhotometryError,
    Photometry,
    all_around,
    need_type_c,
    number_text,
)
from nocturne_scene.photometry.types_a_and_b import about_an_axis
from nocturne_scene.spectra.published import Floats
from nocturne_scene.texts import text_of

# A file with 1 degree in both directions has 181 x 361 values of some 8 bytes.
MAX_BYTES = 16 * 2**20
_MAX_LINE = 64 * 2**10
_MAX_KEYWORDS = 1000

# The first line since 1991; before, there was none, and some programs write one all the same.
_VERSIONS = ("IESNA91", "IESNA:LM-63-1995", "IESNA:LM-63-2002", "IES:LM-63-2019")
_VERSION = re.compile(r"IES(?:NA)?:?(?:LM-?63-?)?((?:19|20)?\d\d)")
_YEARS = {"86": 1986, "91": 1991, "95": 1995, "02": 2002, "19": 2019}
_TYPES: tuple[Literal["C", "B", "A"], ...] = ("C", "B", "A")
_TILT = re.compile(r"TILT\s*=\s*(.*)", re.IGNORECASE)


def lines_of(data: bytes) -> list[str]:
    """The lines of a file, one at least. Raises BadPhotometryError."""
    if len(data) > MAX_BYTES:
        raise BadPhotometryError(1, f"the file has {len(data)} bytes; at most {MAX_BYTES} are accepted")
    try:
        return [line.rstrip("\n") for line in text_of(io.BytesIO(data))] or [""]
    except UnicodeError as error:
        raise BadPhotometryError(1, f"the file is no text: {error}") from None


def is_lm_63(lines: list[str]) -> bool:
    """Whether there is a line TILT=, which all of them have."""
    return any(_TILT.match(line.strip()) for line in lines)


def read(data: bytes) -> Photometry:
    """Read a file; raises BadPhotometryError. Quadrants and halves are mirrored to all directions."""
    lines = lines_of(data)
    first = next((index for index, line in enumerate(lines) if line.strip()), 0)
    year = _year(lines[first], first + 1)
    keywords, tilt_line = _head(lines)
    words = _Words(lines, tilt_line + 1)
    _tilt(lines[tilt_line], tilt_line + 1, words)
    # That number is kept for future use since 1995, and says how the file was made since 2019.
    return _body(words, keywords, has_ballast_lamp_factor=year < 1995)


def write(photometry: Photometry) -> bytes:
    """Write a file of LM-63-2002, absolute photometry without `lamp_lumens`. Read back, it is equal. Raises
    ValueError for other types than C."""
    need_type_c(photometry)
    lines = ["IESNA:LM-63-2002"]
    lines += [f"[{key}] {_one_line(value)}" for key, value in photometry.keywords.items()]
    lines.append("TILT=NONE")
    lumens = -1.0 if photometry.lamp_lumens is None else photometry.lamp_lumens
    vertical, horizontal = photometry.vertical, photometry.horizontal
    counts = f"{len(vertical)} {len(horizontal)} 1 2"
    size = " ".join(number_text(each) for each in photometry.opening)
    lines.append(f"1 {number_text(lumens)} 1 {counts} {size}")
    lines.append(f"1 1 {number_text(photometry.input_watts)}")
    for row in (vertical, horizontal, *photometry.candela):
        numbers = [number_text(value) for value in row]
        # LM-63 limits lines to 256 characters.
        lines += [" ".join(numbers[i : i + 10]) for i in range(0, len(numbers), 10)]
    return ("\r\n".join(lines) + "\r\n").encode("latin-1", "replace")


def _year(text: str, line: int) -> int:
    """The standard that a file's first line names; 1986 without one."""
    first = "".join(text.split()).upper()
    named = _VERSION.fullmatch(first)
    if named is None and not re.match(r"IES(NA)?:?(LM-?63|\d)", first):
        return 1986
    digits = "" if named is None else named[1]
    if digits[-2:] not in _YEARS or int(digits) not in (_YEARS[digits[-2:]], int(digits[-2:])):
        expected = ", ".join(_VERSIONS)
        raise BadPhotometryError(line, f'unknown version "{text.strip()[:40]}"; expected one of {expected}')
    return _YEARS[digits[-2:]]


def _head(lines: list[str]) -> tuple[dict[str, str], int]:
    """Return keywords, and the index of the line TILT=."""
    keywords: dict[str, str] = {}
    last = ""
    for index, line in enumerate(lines):
        text = line.strip()
        if len(line) > _MAX_LINE or index > _MAX_KEYWORDS:
            raise BadPhotometryError(index + 1, "no TILT= so far; is this a photometric file?")
        if _TILT.match(text):
            return keywords, index
        if text.startswith("[") and "]" in text:
            key, _, value = text[1:].partition("]")
            if key.strip().upper() == "MORE" and last:
                keywords[last] += "\n" + value.strip()
            elif key.strip():
                last = key.strip()
                keywords[last] = value.strip()
    raise BadPhotometryError(max(1, len(lines)), "there is no line TILT=")


class _Words:
    """Numbers of the lines from one on, in order."""

    def __init__(self, lines: list[str], first: int) -> None:
        self.line = first
        self._words = self._all(lines, first)

    def _all(self, lines: list[str], first: int) -> Iterator[str]:
        for index in range(first, len(lines)):
            self.line = index + 1
            yield from lines[index].replace(",", " ").split()

    def number(self, what: str) -> float:
        word = next(self._words, None)
        if word is None:
            raise BadPhotometryError(self.line, f"the file ends before {what}")
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not abs(value) <= LARGEST:
            raise BadPhotometryError(self.line, f'expected {what}, found "{word[:40]}"')
        return value

    def count(self, what: str, largest: int) -> int:
        value = self.number(what)
        if value != int(value) or not 1 <= value <= largest:
            raise BadPhotometryError(
                self.line, f"expected {what}, a whole number from 1 to {largest}; found {value:g}"
            )
        return int(value)

    def numbers(self, count: int, what: str) -> Floats:
        return np.array([self.number(what) for _ in range(count)], dtype=np.float64)


def _tilt(text: str, line: int, words: _Words) -> None:
    """Read past the lamp's tilt table. It is for lamps that are turned with the luminaire, which ours are
    not.
    """
    named = _TILT.match(text.strip())
    kind = "" if named is None else named[1].strip()
    if kind.upper() == "NONE":
        return
    if kind.upper() != "INCLUDE":
        raise BadPhotometryError(
            line, f'TILT={kind[:40]} refers to another file; expected "NONE" or "INCLUDE"'
        )
    words.count("the lamp-to-luminaire geometry", 3)
    pairs = words.count("the number of tilt angles", MAX_ANGLES)
    words.numbers(pairs, "a tilt angle")
    words.numbers(pairs, "a tilt factor")


def _body(words: _Words, keywords: dict[str, str], *, has_ballast_lamp_factor: bool) -> Photometry:
    lamps = words.count("the number of lamps", 10**6)
    lumens = words.number("lumens per lamp")
    multiplier = words.number("the candela multiplier")
    verticals = words.count("the number of vertical angles", MAX_ANGLES)
    horizontals = words.count("the number of horizontal angles", MAX_ANGLES)
    if verticals * horizontals > MAX_VALUES:
        raise BadPhotometryError(
            words.line, f"{verticals} x {horizontals} values; at most {MAX_VALUES} are accepted"
        )
    kind = _TYPES[words.count("the photometric type", 3) - 1]
    unit = 0.3048 if words.count("the units", 2) == 1 else 1.0
    width, length, height = (unit * words.number("a size of the luminous opening") for _ in range(3))
    ballast, ballast_lamp, watts = (words.number("ballast factors or input watts") for _ in range(3))
    factor = multiplier * ballast * (ballast_lamp if has_ballast_lamp_factor else 1.0)
    least, most = ((0.0, 0.0), (180.0, 360.0)) if kind == "C" else ((-90.0, -90.0), (90.0, 90.0))
    vertical = _angles(words, verticals, "a vertical angle", least[0], most[0])
    horizontal = _angles(words, horizontals, "a horizontal angle", least[1], most[1])
    candela = factor * words.numbers(verticals * horizontals, "a candela value").reshape(
        horizontals, verticals
    )
    if np.any(candela < 0) or not np.all(candela <= LARGEST):
        raise BadPhotometryError(words.line, "a candela value is negative or too large")
    total = None if lumens < 0 else lamps * lumens
    opening = width, length, height
    if kind == "C":
        horizontal, candela = all_around(words.line, horizontal, candela)
        return Photometry(vertical, horizontal, candela, total, opening, watts, keywords)
    if len(vertical) < 2 or not (horizontal[0] <= 0 < horizontal[-1]):
        raise BadPhotometryError(
            words.line,
            f"{len(vertical)} vertical angles, horizontal ones from {horizontal[0]:g} to {horizontal[-1]:g} "
            f"degrees; expected of type {kind} two or more, and horizontal ones from -90 or 0 to 90",
        )
    found = about_an_axis(kind, vertical, horizontal, candela)
    table = found.vertical, found.horizontal, found.candela
    return Photometry(*table, total, opening, watts, keywords, found.axis, found.zero)


def _angles(words: _Words, count: int, what: str, smallest: float, largest: float) -> Floats:
    """Increasing angles in degrees, in [smallest, largest]."""
    angles = np.empty(count)
    before = smallest - 1.0
    for index in range(count):
        angle = words.number(what)
        if not smallest <= angle <= largest + ANGLE_ERROR or angle <= before:
            raise BadPhotometryError(
                words.line,
                f"{what} is {angle:g}; expected increasing angles within {smallest:g} and {largest:g} "
                "degrees",
            )
        angles[index] = before = min(angle, largest)
    return angles


def _one_line(value: str) -> str:
    return value.replace("\r", " ").replace("\n", "\r\n[MORE] ")
