"""Luminous intensities over directions, whichever file they are from: cd over a vertical angle from an axis
and a horizontal one about it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from nocturne_scene.photometry.types_a_and_b import C0, DOWN, Vector
from nocturne_scene.spectra.published import Floats

MAX_VALUES = 2**20
# Angles of one kind: a tenth of a degree all around.
MAX_ANGLES = 3601
LARGEST = 1e18
"""cd. Beyond any lamp; squares stay finite in float32."""

ANGLE_ERROR = 0.01
"""Degrees. Files round their angles to hundredths."""


class BadPhotometryError(Exception):
    """The file can't be used; the message says in which line, and why."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


Spectrum = tuple[Floats, Floats]
"""Wavelengths, nm, increasing, and values per nm."""


@dataclass(frozen=True)
class Photometry:
    """Intensity over directions."""

    # Degrees, increasing. `vertical` within [0, 180]. `horizontal` from 0 to 360 or, the same all around,
    # only 0; of types A and B from 0 to the last known angle, and the rest is dark.
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
    # From which angles are, and horizontal angle 0: in D, Z and S of types_a_and_b.py.
    axis: Vector = DOWN
    zero: Vector = C0
    # Of the light, where the file tells it; of any size.
    spectrum: Spectrum | None = None


def need_type_c(photometry: Photometry) -> None:
    """Raise ValueError for intensities about another axis than straight down, or not all around it."""
    around = photometry.horizontal
    if (photometry.axis, photometry.zero) != (DOWN, C0) or (len(around) > 1 and around[-1] != 360):
        raise ValueError("photometry of type A or B is read, and not written")


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
    return abs(angle - wanted) <= ANGLE_ERROR


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


def number_text(value: float) -> str:
    """The shortest text that reads back as the same number."""
    text = repr(float(value))
    return text[:-2] if text.endswith(".0") else text
