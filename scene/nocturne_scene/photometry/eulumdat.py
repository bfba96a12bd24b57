"""EULUMDAT files, read and written: one value on each line, in a fixed order (A. W. Stockmar, Licht, 1990).

Intensities are in cd per 1000 lm of the lamps over gamma from straight down and planes C about that; C is the
horizontal angle here, which increases in the same sense. The first of several sets of lamps is taken.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from nocturne_scene.photometry.intensities import (
    MAX_ANGLES,
    MAX_VALUES,
    BadPhotometryError,
    Photometry,
    all_around,
    flux,
    need_type_c,
    number_text,
)
from nocturne_scene.spectra.published import Floats

_LARGEST = 1e18
# Lines up to the sets of lamps, of each set, and of direct ratios after them.
_BEFORE_SETS, _OF_SET, _RATIOS = 26, 6, 10
_MAX_SETS = 20

# Isym: none, about the axis, to the plane C0-C180, to C90-C270, to both.
_NONE, _ABOUT_THE_AXIS, _TO_C0, _TO_C90, _TO_BOTH = range(5)


def is_eulumdat(lines: Sequence[str]) -> bool:
    """Whether lines 2 to 7 are type, symmetry, planes and angles, as of no other kind of file."""
    try:
        numbers = [float(_plain(line) or "0") for line in lines[1:7]]
    except ValueError:
        return False
    kind, symmetry, planes, _, angles, _ = numbers if len(numbers) == 6 else (-1.0,) * 6
    return kind in range(4) and symmetry in range(5) and planes >= 1 and angles >= 1 and min(numbers) >= 0


def read(lines: Sequence[str]) -> Photometry:
    """Read a file's lines; raises BadPhotometryError. Symmetric parts are mirrored to all directions."""
    file = _Lines(lines)
    symmetry = file.whole(3, "the symmetry", 0, 4)
    planes = file.whole(4, "the number of C-planes", 1, MAX_ANGLES)
    angles = file.whole(6, "the number of angles in a plane", 1, MAX_ANGLES)
    if planes * angles > MAX_VALUES:
        raise BadPhotometryError(4, f"{planes} x {angles} values; at most {MAX_VALUES} are accepted")
    length, width, height = (0.001 * file.number(at, "a size, mm") for at in (16, 17, 18))
    factor = file.number(24, "the conversion factor")
    sets = file.whole(26, "the number of sets of lamps", 1, _MAX_SETS)
    lamps = file.number(27, "the number of lamps")
    flux = file.number(29, "the lamps' flux, lm")
    watts = file.number(32, "the lamps' power, W")
    start = _BEFORE_SETS + _OF_SET * sets + _RATIOS + 1
    all_planes = file.numbers(start, planes, "an angle C")
    horizontal = _stored(all_planes, symmetry, start)
    gamma = file.numbers(start + planes, angles, "an angle gamma")
    if np.any(np.diff(gamma) <= 0) or not 0 <= gamma[0] <= gamma[-1] <= 180:
        raise BadPhotometryError(start + planes, "expected increasing angles gamma within 0 and 180 degrees")
    count = len(horizontal)
    values = file.numbers(start + planes + angles, count * angles, "an intensity")
    if np.any(values < 0) or not 0 <= factor * abs(flux) <= _LARGEST:
        raise BadPhotometryError(start + planes + angles, "an intensity is negative or too large")
    candela = (factor * flux / 1000) * values.reshape(count, angles)
    if symmetry == _TO_C90:
        # From 270 over 0 to 90 degrees, which the plane mirrors to those from 270 to 90 over 180.
        horizontal, candela = (540 - horizontal)[::-1] % 360, candela[::-1]
    horizontal, candela = all_around(start, horizontal, candela)
    # Round where there is no width; the length is across the plane C0.
    opening = (-length, -length, height) if width == 0 else (length, width, height)
    names = {"MANUFAC": 1, "TEST": 8, "LUMINAIRE": 9, "LUMCAT": 10}
    keywords = {key: lines[at - 1].strip() for key, at in names.items() if lines[at - 1].strip()}
    # A negative number of lamps: absolute photometry.
    return Photometry(gamma, horizontal, candela, flux if lamps >= 0 else None, opening, watts, keywords)


def write(photometry: Photometry) -> bytes:
    """Write a file with the least planes that its symmetry needs; absolute photometry, with a negative number
    of lamps, without `lamp_lumens`. Direct ratios, of a method of planning by hand, are 0. Raises ValueError
    where there is no light to be relative to, and for other types than C.
    """
    need_type_c(photometry)
    total = flux(photometry)
    lumens = total if photometry.lamp_lumens is None else photometry.lamp_lumens
    if not lumens > 0:
        raise ValueError("the lamp emits no light, and EULUMDAT tells intensities per 1000 lm of it")
    planes, symmetry = photometry.horizontal[:-1], _symmetry(photometry)
    if symmetry == _ABOUT_THE_AXIS:
        planes = np.zeros(1)
    rows = photometry.candela[_rows_of(symmetry, len(planes))] * (1000.0 / lumens)
    gamma = photometry.vertical
    below = flux(_lower_half(photometry))
    width, length, height = (1000.0 * each for each in photometry.opening)
    size = (-width, 0.0) if width < 0 else (width, length)
    key = photometry.keywords.get
    lines: list[object] = [key("MANUFAC", ""), 1 if symmetry == _ABOUT_THE_AXIS else 3, symmetry, len(planes)]
    lines += [_step(planes), len(gamma), _step(gamma), key("TEST", ""), key("LUMINAIRE", "")]
    lines += [key("LUMCAT", ""), "", key("ISSUEDATE", ""), *size, height, *size, *[height] * 4]
    lines += [100.0 * below / total if total else 0.0, 100.0 * total / lumens, 1, 0, 1]
    lines += [-1 if photometry.lamp_lumens is None else 1, "", lumens, "", "", photometry.input_watts]
    lines += [*[0] * _RATIOS, *planes, *gamma, *rows.ravel()]
    texts = (line[:78] if isinstance(line, str) else number_text(float(str(line))) for line in lines)
    return ("\r\n".join(" ".join(text.split()) for text in texts) + "\r\n").encode("latin-1", "replace")


def _lower_half(photometry: Photometry) -> Photometry:
    """The flux downwards, to gamma 90."""
    gamma = photometry.vertical
    kept = np.append(gamma[gamma < 90], [90.0] if gamma[-1] >= 90 else [])
    rows = [np.interp(kept, gamma, row) for row in photometry.candela]
    return replace(photometry, vertical=kept, candela=np.array(rows).reshape(len(rows), len(kept)))


def _symmetry(photometry: Photometry) -> int:
    """The highest that planes and intensities have, exactly."""
    planes, candela = photometry.horizontal[:-1], photometry.candela[:-1]
    if len(photometry.horizontal) == 1:
        return _ABOUT_THE_AXIS

    def mirrors(about: float) -> bool:
        """In the plane through this angle and the opposite one."""
        angles = (2 * about - planes) % 360
        order = np.argsort(angles, kind="stable")
        here = np.argsort(planes % 360, kind="stable")
        return bool(
            np.array_equal(angles[order], (planes % 360)[here])
            and np.array_equal(candela[order], candela[here])
        )

    def has(*angles: float) -> bool:
        return all(np.any(planes == angle) for angle in angles)

    to_c0 = has(0, 180) and mirrors(0)
    to_c90 = has(90, 270) and mirrors(90)
    if to_c0 and to_c90:
        return _TO_BOTH
    return _TO_C0 if to_c0 else _TO_C90 if to_c90 else _NONE


def _rows_of(symmetry: int, planes: int) -> list[int]:
    """Which rows a file has, in its order."""
    first = 3 * planes // 4 if symmetry == _TO_C90 else 0
    return [(first + index) % planes for index in range(_stored_count(symmetry, planes))]


def _stored_count(symmetry: int, planes: int) -> int:
    """How many of so many planes C a file has intensities of."""
    half, quarter = planes // 2 + 1, planes // 4 + 1
    return {_ABOUT_THE_AXIS: 1, _TO_C0: half, _TO_C90: half, _TO_BOTH: quarter}.get(symmetry, planes)


def _step(angles: Floats) -> float:
    """The step of equal ones, else 0."""
    steps = np.diff(angles)
    return float(steps[0]) if len(steps) and np.allclose(steps, steps[0]) else 0.0


def _stored(planes: Floats, symmetry: int, line: int) -> Floats:
    """The planes C whose intensities are in the file; from 270 to 450 degrees for C90-C270."""
    count = len(planes)
    if symmetry == _ABOUT_THE_AXIS:
        return np.zeros(1)
    needed = {_TO_C0: 2, _TO_C90: 4, _TO_BOTH: 4}.get(symmetry, 1)
    if count % needed:
        raise BadPhotometryError(
            4, f"{count} C-planes; expected a multiple of {needed} for symmetry {symmetry}"
        )
    around = np.append(planes, planes + 360)
    first = {_TO_C90: 3 * count // 4}.get(symmetry, 0)
    found = around[first : first + _stored_count(symmetry, count)]
    if np.any(np.diff(found) <= 0) or not 0 <= planes.min() <= planes.max() <= 360:
        raise BadPhotometryError(line, "expected increasing angles C within 0 and 360 degrees")
    return found


def _plain(text: str) -> str:
    """A number as Python reads it: some programs write a decimal comma."""
    return text.strip().replace(",", ".")


class _Lines:
    """A file's lines by their numbers, from 1 on."""

    def __init__(self, lines: Sequence[str]) -> None:
        self._lines = lines

    def number(self, at: int, what: str) -> float:
        if at > len(self._lines):
            raise BadPhotometryError(len(self._lines), f"the file ends before {what}")
        try:
            value = float(_plain(self._lines[at - 1]) or "0")
        except ValueError:
            value = float("nan")
        if not abs(value) <= _LARGEST:
            raise BadPhotometryError(at, f'expected {what}, found "{self._lines[at - 1].strip()[:40]}"')
        return value

    def whole(self, at: int, what: str, smallest: int, largest: int) -> int:
        value = self.number(at, what)
        if value != int(value) or not smallest <= value <= largest:
            raise BadPhotometryError(
                at, f"expected {what}, a whole number from {smallest} to {largest}; found {value:g}"
            )
        return int(value)

    def numbers(self, at: int, count: int, what: str) -> Floats:
        return np.array([self.number(at + index, what) for index in range(count)], dtype=np.float64)
