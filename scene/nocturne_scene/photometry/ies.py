"""Photometric files: ANSI/IESNA LM-63 of 1986, 1991, 1995, 2002 and 2019, type C, read and written.

Letters of first lines and of TILT= count in either case, with or without blanks between their parts, as
programs write them. Numbers follow in the order of LM-63-2002, section 5; words may be split over lines
anywhere. Luminous intensity is in cd over a vertical angle from straight down (the axis, 0 to 180 degrees)
and a horizontal angle about it.
"""

import io
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from nocturne_scene.spectra.published import Floats
from nocturne_scene.texts import text_of

# A file with 1 degree in both directions has 181 x 361 values of some 8 bytes.
MAX_BYTES = 16 * 2**20
MAX_VALUES = 2**20
# Angles of one kind: a tenth of a degree all around.
MAX_ANGLES = 3601
_MAX_LINE = 64 * 2**10
_MAX_KEYWORDS = 1000

# cd. Beyond any lamp; squares stay finite in float32.
_LARGEST = 1e18

# Degrees. Files round their angles to hundredths.
_ANGLE_ERROR = 0.01

# The first line since 1991; before, there was none, and some programs write one all the same.
_VERSIONS = ("IESNA91", "IESNA:LM-63-1995", "IESNA:LM-63-2002", "IES:LM-63-2019")
_VERSION = re.compile(r"IES(?:NA)?:?(?:LM-?63-?)?((?:19|20)?\d\d)")
_YEARS = {"86": 1986, "91": 1991, "95": 1995, "02": 2002, "19": 2019}
_TILT = re.compile(r"TILT\s*=\s*(.*)", re.IGNORECASE)


class BadPhotometryError(Exception):
    """The file can't be used; the message says in which line, and why."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


@dataclass(frozen=True)
class Photometry:
    """Intensity over directions."""

    # Degrees, increasing. `vertical` within [0, 180]. `horizontal` from 0 to 360 or, the same all around,
    # only 0.
    vertical: Floats
    horizontal: Floats
    # cd, shape (len(horizontal), len(vertical)), with ballast factors and multiplier in it.
    candela: Floats
    # Of all lamps together, lm; None for absolute photometry.
    lamp_lumens: float | None = None
    # Luminous opening in metres: width across, length along horizontal angle 0, height; negative: round.
    opening: tuple[float, float, float] = (0.0, 0.0, 0.0)
    input_watts: float = 0.0
    # As in the file, such as {"MANUFAC": "..."}; without brackets.
    keywords: Mapping[str, str] = field(default_factory=dict)


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
    """Write a file of LM-63-2002, absolute photometry without `lamp_lumens`. Read back, it is equal."""
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


def flux(photometry: Photometry) -> float:
    """Total luminous flux in lm: the integral over the sphere of the intensity, linear between the angles."""
    theta = np.deg2rad(photometry.vertical)
    if len(theta) < 2:
        return 0.0
    weights = _sine_weights(theta)
    if len(photometry.horizontal) == 1:
        return float(2 * np.pi * photometry.candela[0] @ weights)
    around = np.trapezoid(photometry.candela, np.deg2rad(photometry.horizontal), axis=0)
    return float(around @ weights)


def scaled(photometry: Photometry, factor: float) -> Photometry:
    """The same distribution, so many times as bright."""
    lumens = None if photometry.lamp_lumens is None else photometry.lamp_lumens * factor
    return replace(photometry, candela=photometry.candela * factor, lamp_lumens=lumens)


def _sine_weights(theta: Floats) -> Floats:
    """Weights that integrate a function that is linear between angles against sin(theta), exactly."""
    a, b = theta[:-1], theta[1:]
    width = b - a
    # Integrals of sin, and of (theta - a) / width times sin.
    whole = np.cos(a) - np.cos(b)
    rising = (np.sin(b) - np.sin(a)) / width - np.cos(b)
    weights = np.zeros(len(theta))
    weights[1:] += rising
    weights[:-1] += whole - rising
    return weights


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
        if not abs(value) <= _LARGEST:
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
    kind = words.count("the photometric type", 3)
    if kind != 1:
        raise BadPhotometryError(
            words.line, f"photometry of type {'CBA'[kind - 1]}; only type C is supported"
        )
    unit = 0.3048 if words.count("the units", 2) == 1 else 1.0
    width, length, height = (unit * words.number("a size of the luminous opening") for _ in range(3))
    ballast, ballast_lamp, watts = (words.number("ballast factors or input watts") for _ in range(3))
    factor = multiplier * ballast * (ballast_lamp if has_ballast_lamp_factor else 1.0)
    vertical = _angles(words, verticals, "a vertical angle", 180.0)
    horizontal = _angles(words, horizontals, "a horizontal angle", 360.0)
    candela = factor * words.numbers(verticals * horizontals, "a candela value").reshape(
        horizontals, verticals
    )
    if np.any(candela < 0) or not np.all(candela <= _LARGEST):
        raise BadPhotometryError(words.line, "a candela value is negative or too large")
    horizontal, candela = all_around(words.line, horizontal, candela)
    total = None if lumens < 0 else lamps * lumens
    return Photometry(vertical, horizontal, candela, total, (width, length, height), watts, keywords)


def _angles(words: _Words, count: int, what: str, largest: float) -> Floats:
    """Increasing angles in degrees, in [0, largest]."""
    angles = np.empty(count)
    before = -1.0
    for index in range(count):
        angle = words.number(what)
        if not 0 <= angle <= largest + _ANGLE_ERROR or angle <= before:
            raise BadPhotometryError(
                words.line,
                f"{what} is {angle:g}; expected increasing angles within 0 and {largest:g} degrees",
            )
        angles[index] = before = min(angle, largest)
    return angles


def all_around(line: int, horizontal: Floats, candela: Floats) -> tuple[Floats, Floats]:
    """Mirror a quadrant or a half, so that horizontal angles reach from 0 to 360 degrees."""
    first, last = horizontal[0], horizontal[-1]
    if len(horizontal) == 1:
        return np.zeros(1), candela
    if _near(first, 0) and _near(last, 90):
        horizontal, candela = _mirrored(horizontal, candela, 180.0)
        last = 180.0
    elif _near(first, 90) and _near(last, 270):
        # Symmetric about the plane of 90 and 270 degrees.
        behind = horizontal <= 180
        mirrored = np.append(180 - horizontal[behind][::-1], 540 - horizontal[~behind][::-1])
        order = np.argsort(np.append(mirrored, horizontal), kind="stable")
        turned = np.concatenate([candela[behind][::-1], candela[~behind][::-1], candela])[order]
        return _closed(np.append(mirrored, horizontal)[order], turned)
    if _near(first, 0) and _near(last, 180):
        return _closed(*_mirrored(horizontal, candela, 360.0))
    if _near(first, 0) and last > 180:
        return _closed(horizontal, candela)
    raise BadPhotometryError(
        line,
        f"horizontal angles from {first:g} to {last:g} degrees; "
        "expected 0 alone, 0 to 90, 0 to 180, 90 to 270 or 0 to 360",
    )


def _near(angle: float, wanted: float) -> bool:
    return abs(angle - wanted) <= _ANGLE_ERROR


def _mirrored(angles: Floats, rows: Floats, at: float) -> tuple[Floats, Floats]:
    """Append what the mirror at half of `at` shows."""
    exact = np.append(angles[:-1], at / 2)
    return np.append(exact, at - exact[-2::-1]), np.concatenate([rows, rows[-2::-1]])


def _closed(angles: Floats, rows: Floats) -> tuple[Floats, Floats]:
    """Drop repeated angles; begin at 0 and end at 360 degrees with the same row where one of them is not
    there.
    """
    keep = np.append(True, np.diff(angles) > 0)
    angles, rows = angles[keep], rows[keep]
    if angles[0] > 0:
        before = angles[-1] - 360
        share = -before / (angles[0] - before)
        angles, rows = (
            np.append(0.0, angles),
            np.concatenate([(1 - share) * rows[-1:] + share * rows[:1], rows]),
        )
    if _near(angles[-1], 360):
        return np.append(angles[:-1], 360.0), rows
    return np.append(angles, 360.0), np.concatenate([rows, rows[:1]])


def _one_line(value: str) -> str:
    return value.replace("\r", " ").replace("\n", "\r\n[MORE] ")


def number_text(value: float) -> str:
    """The shortest text that reads back as the same number."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text
