"""EULUMDAT files, read: one value on each line, in a fixed order (A. W. Stockmar, Licht, 1990).

Intensities are in cd per 1000 lm of the lamps over gamma from straight down and planes C about that; C is the
horizontal angle here, which increases in the same sense. The first of several sets of lamps is taken.
"""

from collections.abc import Sequence

import numpy as np

from nocturne_scene.photometry.ies import (
    MAX_ANGLES,
    MAX_VALUES,
    BadPhotometryError,
    Photometry,
    all_around,
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
    number = {_TO_C0: count // 2 + 1, _TO_C90: count // 2 + 1, _TO_BOTH: count // 4 + 1}.get(symmetry, count)
    found = around[first : first + number]
    if np.any(np.diff(found) <= 0):
        raise BadPhotometryError(line, "expected increasing angles C")
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
